"""Baselines: what the cases gave when someone last looked, one JSON file a case, and how far a run may be from it.

The computed values of a row are pinned by the one farthest from zero, according to the class of the row: `exact` may
not move, `tight` not by 1e-10, `converged` by twice the tolerance of the row, or 2 % where a band stands in its place;
`unconverged` is not pinned.  `count` gates in a band of 20 %, because exact counts flip with the BLAS near events;
`diagnostic` (seconds) is shown and never gates.  A missing baseline is a failure.  An update needs a reason, rewrites
one case only, prints old and new values, and is refused from changed sources or from a report of other sources.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from validation.compare import combined_tolerance
from validation.provenance import provenance, sources_digest, working_tree
from validation.runner import write_atomically
from validation.schema import CaseRecord, Row
from validation.verdict import case_verdicts

FOLDER = Path(__file__).parent / "baselines"
COUNT_BAND = 0.2
TIGHT, BANDED = 1e-10, 0.02


class BaselineError(ValueError):
    """A baseline that is malformed, or a request that cannot be met."""


class Quantity(BaseModel):
    """One pinned value; `kind` is the class of the quantity."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    value: float
    unit: str
    kind: Literal["exact", "tight", "converged", "count", "diagnostic"]
    rtol: float = Field(ge=0)
    atol: float = Field(ge=0)
    basis: Literal["measured", "required", "provisional"]


class Baseline(BaseModel):
    """What is pinned of a case."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    case: str
    reason: str = Field(min_length=1)
    date: str
    commit: str
    versions: dict[str, str]
    scene_sha256: str
    quantities: list[Quantity]


def read_baseline(case: str, folder: Path = FOLDER) -> Baseline | None:
    """The baseline of a case, None when there is none.

    Raises
    ------
    BaselineError
        The file is malformed or belongs to another case.
    """
    path = folder / f"{case}.json"
    if not path.exists():
        return None
    try:
        found = Baseline.model_validate_json(path.read_text())
    except (ValidationError, ValueError) as error:
        raise BaselineError(f"{path.name}: malformed baseline ({error})") from error
    if found.case != case:
        raise BaselineError(f"{path.name}: is the baseline of case {found.case!r}")
    return found


def quantities_of(record: CaseRecord) -> list[Quantity]:
    """What a record pins."""
    pinned = [_of_row(row) for row in record.rows if row.pinned != "unconverged"]
    pinned += [
        Quantity(name=name, value=count, unit="", kind="count", rtol=COUNT_BAND, atol=0, basis="required")
        for name, count in sorted(record.counts.items())
    ]
    seconds = Quantity(
        name="seconds", value=record.seconds, unit="s", kind="diagnostic", rtol=0, atol=0, basis="measured"
    )
    return [*pinned, seconds]


def differences(record: CaseRecord, folder: Path = FOLDER) -> list[str]:
    """What left its baseline, one sentence each; empty when nothing did.

    Raises
    ------
    BaselineError
        The baseline is malformed.
    """
    baseline = read_baseline(record.id, folder)
    if baseline is None:
        return [f"{record.id}: no baseline; `baseline update {record.id} --reason TEXT` makes one"]
    if record.status != "run":
        return [f"{record.id}: {record.status}, {record.message}"]
    now = {quantity.name: quantity for quantity in quantities_of(record)}
    pinned = {quantity.name: quantity for quantity in baseline.quantities}
    found = [f"{record.id}: {name} is new, not in the baseline" for name in now if name not in pinned]
    for name, old in pinned.items():
        if name not in now:
            found.append(f"{record.id}: {name} is gone")
            continue
        value = now[name].value
        allowed = old.atol + old.rtol * abs(old.value)
        if old.kind != "diagnostic" and not abs(value - old.value) <= allowed:
            found.append(f"{record.id}: {name} was {old.value:.10g}, is {value:.10g}, allowed +-{allowed:.2g}")
    return found


def update(record: CaseRecord, reason: str, folder: Path = FOLDER) -> list[str]:
    """Write the baseline of one case; the lines to print, old -> new.

    Raises
    ------
    BaselineError
        No reason, a case that failed, a value that is no number, sources that are not those of a commit.
    """
    tree = working_tree()
    if tree is None or tree[1]:
        raise BaselineError("the sources have changes that are not committed, or no commit is known: commit first")
    if not reason.strip():
        raise BaselineError("--reason: a text is needed that says why the numbers changed")
    verdicts = case_verdicts(record)
    if any(verdict not in ("agrees", "expected deviation") for verdict in verdicts):
        raise BaselineError(f"{record.id}: {', '.join(sorted(set(verdicts)))}; only what passes becomes a baseline")
    quantities = quantities_of(record)
    bad = [quantity.name for quantity in quantities if not math.isfinite(quantity.value)]
    if bad:
        raise BaselineError(f"{record.id}: not a number: {', '.join(bad)}")
    before = read_baseline(record.id, folder)
    old = {} if before is None else {quantity.name: quantity.value for quantity in before.quantities}
    facts = provenance()
    baseline = Baseline(
        case=record.id,
        reason=reason,
        date=datetime.now(UTC).date().isoformat(),
        commit=str(facts["commit"]),
        versions={name: str(facts[name]) for name in ("python", "numpy", "scipy", "blas")},
        scene_sha256=hashlib.sha256(record.scene.encode()).hexdigest(),
        quantities=quantities,
    )
    folder.mkdir(exist_ok=True)
    write_atomically(folder / f"{record.id}.json", json.dumps(baseline.model_dump(), indent=1) + "\n")
    return [f"{record.id}: {q.name}: {_shown(old.get(q.name))} -> {q.value:.10g}" for q in quantities]


def refuse_other_sources(facts: Mapping[str, Any]) -> None:
    """Refuse the provenance of a report that other sources than the present ones made.

    Raises
    ------
    BaselineError
        The digests differ.
    """
    if facts.get("sources_sha256") != sources_digest():
        raise BaselineError("the report was made by other sources: run it again, then update")


def changes(records: Iterable[CaseRecord], folder: Path = FOLDER) -> list[str]:
    """Differences of all records."""
    return [line for record in records for line in differences(record, folder)]


def _of_row(row: Row) -> Quantity:
    """The value of a row that stands for it: the one farthest from zero."""
    values = [math.nan if value is None else value for value in row.computed]
    value = max(values, key=abs) if not any(math.isnan(v) for v in values) else math.nan
    if row.pinned == "exact":
        rtol, atol, basis = 0.0, 0.0, "required"
    elif row.pinned == "tight":
        rtol, atol, basis = TIGHT, 0.0, "required"
    elif row.tolerance is None:
        rtol, atol, basis = BANDED, 0.0, "provisional"
    else:
        rtol, atol, basis = 0.0, 2 * combined_tolerance(row) * row.scale, row.tolerance.basis
    kind = "converged" if row.pinned == "unconverged" else row.pinned
    return Quantity(name=row.quantity, value=value, unit=row.unit, kind=kind, rtol=rtol, atol=atol, basis=basis)


def _shown(value: Any) -> str:
    return "none" if value is None else f"{value:.10g}"
