"""Baselines: what the cases gave when someone last looked, one JSON file a case, and how far a run may be from it.

Every computed value of a row is pinned, or of a long row (all states of a path) the one farthest from zero.  The class
of the row decides how far it may move: `exact` not at all, `tight` by 1e-10, `converged` by twice the tolerance of the
row, or 2 % where a band stands in its place; `unconverged` is not pinned.  `count` gates in a band of 20 %, because
exact counts flip with the BLAS near events; `diagnostic` (seconds) is shown and never gates.  A missing baseline is a
failure, and so is one that no case owns.  An update needs a reason, rewrites one case only, prints old and new values,
and is refused from changed sources or from a report of other sources.
"""

import hashlib
import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bem.scene.atomic_file import write_atomically
from validation.harness.compare import combined_tolerance
from validation.harness.provenance import provenance, sources_digest, versions, working_tree
from validation.harness.schema import CaseRecord, Row, mistakes_in
from validation.harness.verdict import PASSING, case_verdicts

FOLDER = Path(__file__).parents[1] / "baselines"
OWN_DIGEST = "own_cases_sha256"  # in the provenance of a report of cases outside the package
COUNT_BAND = 0.2
LONG_ROW = 16  # values; rows with more hold all states of a path, and how many these are may change
TIGHT, BANDED = 1e-10, 0.02


class BaselineError(ValueError):
    """A baseline that is malformed, or a request that cannot be met."""


class Quantity(BaseModel):
    """One pinned value.

    `kind` is the class of the quantity, `basis` says where its tolerances come from, `drift` is the numerical
    uncertainty that the case itself states (its change under the last refinement), in the unit of the value.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    value: float
    unit: str
    kind: Literal["exact", "tight", "converged", "count", "diagnostic"]
    rtol: float = Field(ge=0, allow_inf_nan=False)
    atol: float = Field(ge=0, allow_inf_nan=False)
    basis: Literal["measured", "required", "provisional"]
    drift: float = Field(0.0, ge=0, allow_inf_nan=False)


class Baseline(BaseModel):
    """What is pinned of a case; `resolution` holds its counts: unknowns, evaluations and the like."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    case: str
    reason: str = Field(min_length=1)
    date: str
    commit: str
    versions: dict[str, str]
    blas: str
    blas_threads: int
    scene_sha256: str
    resolution: dict[str, int]
    quantities: list[Quantity]


def read_baseline(case: str, folder: Path = FOLDER) -> Baseline | None:
    """The baseline of a case, None when it does not exist; BaselineError where it is malformed or of another case."""
    path = folder / f"{case}.json"
    if not path.exists():
        return None
    try:
        found = Baseline.model_validate_json(path.read_text("utf-8"))
    except ValidationError as error:
        raise BaselineError(f"{path.name}: malformed baseline ({mistakes_in(error)})") from error
    except ValueError as error:
        raise BaselineError(f"{path.name}: malformed baseline ({error})") from error
    if found.case != case:
        raise BaselineError(f"{path.name}: is the baseline of case {found.case!r}")
    return found


def orphans(cases: Iterable[str], folder: Path = FOLDER) -> list[str]:
    """Baselines in a folder that belong to none of these cases, those of the registry: one sentence each."""
    known = set(cases)
    return [f"{path.name}: no case of this name" for path in sorted(folder.glob("*.json")) if path.stem not in known]


def expected_seconds(cases: Iterable[str], folder: Path = FOLDER) -> dict[str, float]:
    """Seconds that cases took when their baselines were made; those without one are left out.

    BaselineError where one is malformed.
    """
    known = [found for case in cases if (found := read_baseline(case, folder)) is not None]
    return {found.case: q.value for found in known for q in found.quantities if q.name == "seconds"}


def quantities_of(record: CaseRecord) -> list[Quantity]:
    """What a record pins, under names that differ: values of rows that are pinned, counts, and the seconds."""
    pinned = [quantity for row in record.rows if row.pinned != "unconverged" for quantity in _of_row(row)]
    pinned += [
        Quantity(name=name, value=count, unit="", kind="count", rtol=COUNT_BAND, atol=0, basis="required")
        for name, count in sorted(record.counts.items())
    ]
    pinned.append(
        Quantity(name="seconds", value=record.seconds, unit="s", kind="diagnostic", rtol=0, atol=0, basis="measured")
    )
    seen: Counter[str] = Counter()
    named = []
    for quantity in pinned:
        seen[quantity.name] += 1
        times = seen[quantity.name]
        named.append(quantity if times == 1 else quantity.model_copy(update={"name": f"{quantity.name} #{times}"}))
    return named


def differences(record: CaseRecord, folder: Path = FOLDER) -> list[str]:
    """What left its baseline, one sentence each, empty when nothing did; BaselineError where that is malformed."""
    baseline = read_baseline(record.id, folder)
    if record.status == "not run":
        return []  # an extra is absent: the report counts the case and states the reason
    if baseline is None:
        return [f"{record.id}: no baseline; `baseline update {record.id} --reason TEXT` makes one"]
    if record.status != "run":
        return [f"{record.id}: {record.status}, {record.message}"]
    now = {quantity.name: quantity for quantity in quantities_of(record)}
    pinned = {quantity.name: quantity for quantity in baseline.quantities}
    found = [f"{record.id}: {name} is new, not in the baseline" for name in now if name not in pinned]
    if _scene_digest(record) != baseline.scene_sha256:
        found.append(f"{record.id}: the scene is not that of the baseline")
    for name, old in pinned.items():
        if name not in now:
            found.append(f"{record.id}: {name} is gone")
            continue
        value = now[name].value
        allowed = old.atol + old.rtol * abs(old.value)
        if old.kind != "diagnostic" and not abs(value - old.value) <= allowed:
            found.append(f"{record.id}: {name} was {old.value:.10g}, is {value:.10g}, allowed +-{allowed:.2g}")
    return found


def update(record: CaseRecord, reason: str, folder: Path = FOLDER, own: bool = False) -> list[str]:
    """Write the baseline of one case of a run from committed sources; the lines to print, old -> new.

    `reason` says why the numbers changed, `own` that they are kept outside the package: its sources need not be those
    of a commit. BaselineError for no reason, a case that failed, a value that is not a number, sources that are not
    those of a commit.
    """
    if not own and ((tree := working_tree()) is None or tree[1]):
        raise BaselineError("the sources have changes that are not committed, or no commit is known: commit first")
    if not reason.strip():
        raise BaselineError("--reason: a text is needed that says why the numbers changed")
    verdicts = case_verdicts(record)
    if not PASSING.issuperset(verdicts):
        raise BaselineError(f"{record.id}: {', '.join(sorted(set(verdicts)))}; only what passes becomes a baseline")
    quantities = quantities_of(record)
    bad = [quantity.name for quantity in quantities if not math.isfinite(quantity.value)]
    if bad:
        raise BaselineError(f"{record.id}: not a number: {', '.join(bad)}")
    before = read_baseline(record.id, folder)
    old = {} if before is None else {quantity.name: f"{quantity.value:.10g}" for quantity in before.quantities}
    facts = provenance()
    baseline = Baseline(
        case=record.id,
        reason=reason,
        date=datetime.now(UTC).date().isoformat(),
        commit=str(facts["commit"]),
        versions=versions(),
        blas=str(facts["blas"]),
        blas_threads=int(facts["blas_threads_per_worker"]),
        scene_sha256=_scene_digest(record),
        resolution=record.counts,
        quantities=quantities,
    )
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / f"{record.id}.json", json.dumps(baseline.model_dump(), indent=1) + "\n")
    return [f"{record.id}: {q.name}: {old.get(q.name, 'none')} -> {q.value:.10g}" for q in quantities]


def refuse_other_sources(facts: Mapping[str, Any], own_digest: str | None = None) -> None:
    """Refuse the provenance of a report that other sources than the present ones made, by a BaselineError.

    `own_digest` is of the files of cases outside the package; a report of other cases than these is refused as well.
    """
    if facts.get(OWN_DIGEST) is not None and own_digest is None:
        raise BaselineError("the report is of cases outside the package: --cases has to name them")
    if facts.get("sources_sha256") != sources_digest() or facts.get(OWN_DIGEST) != own_digest:
        raise BaselineError("the report was made by other sources: run it again, then update")


def changes(records: Iterable[CaseRecord], folder: Path = FOLDER) -> list[str]:
    """Differences of all records; BaselineError where a baseline is malformed."""
    return [line for record in records for line in differences(record, folder)]


def _scene_digest(record: CaseRecord) -> str:
    return hashlib.sha256(record.scene.encode()).hexdigest()


def _of_row(row: Row) -> list[Quantity]:
    """The values of a row that are pinned, with what they may move."""
    numbers = [math.nan if value is None else value for value in row.computed]
    if len(numbers) == 1:
        values = {row.quantity: numbers[0]}
    elif len(numbers) <= LONG_ROW:
        values = {f"{row.quantity} [{place}]": value for place, value in enumerate(numbers)}
    else:
        farthest = math.nan if any(math.isnan(value) for value in numbers) else max(numbers, key=abs)
        values = {f"{row.quantity} [farthest from zero]": farthest}
    rtol, atol, basis = _tolerances(row)
    kind = "converged" if row.pinned == "unconverged" else row.pinned
    return [
        Quantity(
            name=name, value=value, unit=row.unit, kind=kind, rtol=rtol, atol=atol, basis=basis, drift=row.uncertainty
        )
        for name, value in values.items()
    ]


def _tolerances(row: Row) -> tuple[float, float, Literal["measured", "required", "provisional"]]:
    """Relative and absolute tolerance of a pinned value, and their basis."""
    if row.pinned == "exact":
        return 0.0, 0.0, "required"
    if row.pinned == "tight":
        return TIGHT, 0.0, "required"
    if row.tolerance is None:
        return BANDED, 0.0, "provisional"
    return 0.0, 2 * combined_tolerance(row) * row.scale, row.tolerance.basis
