"""The standings run for real: every entrant through the public door on every problem, into standings.json.

Answers on grids, each twice as fine, are extrapolated to what they tend to, with the error estimated.  Contact counted
in whole points is wrong by a term in the spacing; cohesion of a range that must span some spacings is wrong by its
range, which falls as the root of the spacing.  With r = 2 without adhesion and r = sqrt 2 with it, and the two finest
grids,

    x = fine + (fine - coarse) / (r - 1).
"""

import json
import math
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from bem.scene.atomic_file import write_atomically
from validation.challenge import run_judge
from validation.challenge.judging import judged
from validation.challenge.problem import COUNTS, ChallengeError, Shipped
from validation.challenge.standings import ENTRANTS, RECORD, SCHEMA, SOLVERS, Entrant, recorded
from validation.harness.execution import Listener, Note
from validation.harness.provenance import provenance
from validation.harness.route import Answer
from validation.harness.store import plain
from validation.report.challenge_page import drawn_standings, overall_curves
from validation.report.figures import save

DIGITS = 3.0
EXTRAPOLATED = ", extrapolated"
TITLE = "All problems: geometric means over the problems that a solver answers"
MACHINE, TOLD = ("system", "processor", "cores"), ("date", "commit", "python", "numpy", "scipy", "kernels")
OF_PROBLEM = ("problem", "status", "message", "seconds", "cpu_seconds")
OF_QUANTITY = ("quantity", "status", "digits", "error", "answered", "asked")
Entry = dict[str, Any]  # of standings.json: what a solver at a setting made of a problem


def record(folder: Path, solvers: Sequence[str], limit: float, report: Listener) -> Path:
    """Run entrants and write standings.json; those not run, or not installed, keep their entries.

    What was finished in `folder` is taken. `solvers` are names of SOLVERS, empty for all that are installed; `limit` is
    in seconds for each problem. ChallengeError where a solver does not exist, or is named and not installed.
    """
    for name in solvers:
        if name not in SOLVERS:
            raise ChallengeError(f"solver {name!r}: one of {', '.join(SOLVERS)} is needed")
    for entrant in ENTRANTS:
        if solvers and entrant.name not in solvers:
            continue
        if entrant.missing:
            if solvers:
                raise ChallengeError(f"solver {entrant.name!r}: {', '.join(entrant.missing)} not installed")
            report(Note(f"{entrant.name}: {', '.join(entrant.missing)} not installed, its entries are kept"))
            continue
        _replace(entrant, _entries(entrant, limit, folder, report))
    return RECORD


def _replace(entrant: Entrant, made: list[Entry]) -> None:
    """Put the entries of an entrant in the place of those on record, and draw the record anew."""
    before = recorded()  # another solver may have been run meanwhile
    replaced = (entrant.name, entrant.name + EXTRAPOLATED)
    entries = [entry for entry in before["entries"] if entry["solver"] not in replaced] + made
    entries.sort(key=lambda entry: SOLVERS.index(entry["solver"].removesuffix(EXTRAPOLATED)))
    facts = provenance()
    spent = sum(entry["cpu_seconds"] or 0.0 for entry in made if entry["solver"] == entrant.name)
    told = {name: facts[name] for name in TOLD} | {name: metadata.version(name) for name in entrant.needs}
    run = ", ".join(f"{name} {value}" for name, value in told.items()) + f"; {spent:.0f} CPU seconds in all"
    ran = before["run_on"] | {name: facts[name] for name in MACHINE} | {entrant.name: run}
    content = plain({"schema": SCHEMA, "digits": DIGITS, "run_on": ran, "entries": entries})
    save(drawn_standings(TITLE, overall_curves(entries)), RECORD.with_suffix(".svg"))
    write_atomically(RECORD, json.dumps(content, allow_nan=False).replace('{"solver"', '\n{"solver"') + "\n")


def _entries(entrant: Entrant, limit: float, folder: Path, report: Listener) -> list[Entry]:
    """An entry for each setting and problem, and for what grids tend to."""
    problems, made, answers = run_judge.chosen(None), list[Entry](), list[list[Answer]]()
    for setting, door in entrant.doors.items():
        report(Note(f"{entrant.name}, {setting}"))
        answers.append(run_judge.solved(door, problems, limit, folder, report))
        made += [_entry(entrant.name, setting, one, found) for one, found in zip(problems, answers[-1], strict=True)]
    for one, *grids in zip(problems, *answers, strict=True) if entrant.grids else ():
        found = extrapolated(one.data, grids)
        entry = _entry(entrant.name + EXTRAPOLATED, "from the two finest grids", one, found)
        for row in entry["rows"]:
            row["estimated"] = estimated(one, row["quantity"], grids[-1], found)
        made.append(entry)
    return made


def _entry(solver: str, setting: str, one: Shipped, found: Answer) -> Entry:
    def told(record: Any, names: Sequence[str]) -> Entry:
        return {name: _rounded(getattr(record, name)) for name in names}

    row = judged(one, found, DIGITS)
    rows = [told(each, OF_QUANTITY) for each in row.rows]
    return {"solver": solver, "setting": setting, **told(row, OF_PROBLEM), "rows": rows}


def estimated(one: Shipped, quantity: str, finest: Answer, limit: Answer) -> float | None:
    """What extrapolation says of the error of the finest grid, over the scale; None where a value is not there."""
    values, limits = (np.array(found.values.get(quantity), dtype=np.float64) for found in (finest, limit))
    if values.shape != limits.shape or np.any(np.isnan(values - limits)):
        return None
    return float(_rounded(float(np.max(np.abs(values - limits))) / one.answers[quantity].scale))


def _rounded(value: Any) -> Any:
    """A number that is no count, to three digits; all else as it is."""
    return float(f"{value:.3g}") if isinstance(value, float) else value


def extrapolated(problem: Mapping[str, Any], grids: Sequence[Answer]) -> Answer:
    """The answers to a problem that grids, coarsest first, tend to; as the finest where it has none.

    Of counts those of the finest grid stand.
    """
    coarse, fine = grids[-2:]
    if fine.status != "answered" or coarse.status != "answered":
        return fine if fine.status != "answered" else coarse
    ratio = math.sqrt(2) if "adhesion" in problem else 2.0
    answers = {
        name: value if name in COUNTS else _limit(value, coarse.values[name], ratio)
        for name, value in fine.values.items()
        if name in coarse.values
    }
    spent = [sum(getattr(grid, name) or 0.0 for grid in grids[-2:]) for name in ("seconds", "cpu_seconds")]
    told = f"from the two finest grids, errors falling by {ratio:.3g}"
    return Answer("answered", told, answers, seconds=spent[0], cpu_seconds=spent[1])


def _limit(fine: Any, coarse: Any, ratio: float) -> list[float | None] | None:
    """Of a list of numbers or None, of which it is None that remains; None where the lists do not fit."""
    x, y = (np.array(values, dtype=np.float64) for values in (fine, coarse))
    if x.shape != y.shape:
        return None
    return [None if math.isnan(value) else value for value in (x + (x - y) / (ratio - 1)).tolist()]
