"""The recorded standings: each solver, at its coarsest setting, reaches the digits on record where that costs least."""

import pytest

from validation.challenge.judging import judged
from validation.challenge.problem import problem
from validation.challenge.solver_process import returned
from validation.challenge.standings import ENTRANTS, recorded


def cheapest(entrant):
    """Entry of the record: the answered one that costs least."""
    setting = next(iter(entrant.settings))
    entries = [
        entry for entry in recorded()["entries"] if (entry["solver"], entry["setting"]) == (entrant.name, setting)
    ]
    answered = [entry for entry in entries if entry["status"] == "answered" and entry["cpu_seconds"]]
    return min(answered, key=lambda entry: entry["cpu_seconds"])


@pytest.mark.parametrize("entrant", ENTRANTS, ids=lambda entrant: entrant.name)
def test_the_digits_on_record_are_reached_again(entrant):
    for module in entrant.needs:
        pytest.importorskip(module, reason=f"the extra with {module} is not installed", exc_type=ImportError)
    entry, door = cheapest(entrant), next(iter(entrant.doors.values()))
    one = problem(entry["problem"])
    found = judged(one, returned(door, one.text, 120.0), 3.0)
    digits = {row.quantity: row.digits for row in found.rows if row.digits is not None}
    before = {row["quantity"]: row["digits"] for row in entry["rows"] if row["digits"] is not None}
    assert digits.keys() == before.keys()
    for quantity, reached in digits.items():
        limit = 9.0  # beyond it rounding decides, and with it the processor
        assert min(reached, limit) == pytest.approx(min(before[quantity], limit), abs=0.3), quantity
