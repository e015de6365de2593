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
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from bem.scene.atomic_file import write_atomically
from validation.challenge import run_judge
from validation.challenge.judging import judged
from validation.challenge.problem import ChallengeError, Shipped, scale_of
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


def record(folder: Path, solvers: Sequence[str], limit: float, report: Listener) -> Path:
    """Run entrants and write standings.json; those not run, or not installed, keep their entries.

    What was finished in `folder` is taken. `solvers` are names of SOLVERS, empty for all that are installed; `limit` is
    in seconds for each problem. ChallengeError where a solver does not exist, or is named and not installed.
    """
    for name in solvers:
        if name not in SOLVERS:
            raise ChallengeError(f"solver {name!r}: one of {', '.join(SOLVERS)} is needed")
    problems = run_judge.chosen(None)
    for entrant in ENTRANTS:
        if solvers and entrant.name not in solvers:
            continue
        if entrant.missing:
            if solvers:
                raise ChallengeError(f"solver {entrant.name!r}: {', '.join(entrant.missing)} not installed")
            report(Note(f"{entrant.name}: {', '.join(entrant.missing)} not installed, its entries are kept"))
            continue
        made = _entries(entrant, problems, limit, folder, report)
        before = recorded()  # another solver may have been run meanwhile
        replaced = (entrant.name, entrant.name + EXTRAPOLATED)
        entries = [entry for entry in before["entries"] if entry["solver"] not in replaced] + made
        facts = provenance()
        spent = sum(entry["cpu_seconds"] or 0.0 for entry in made if entry["solver"] == entrant.name)
        told = {name: facts[name] for name in TOLD} | {name: metadata.version(name) for name in entrant.needs}
        run = ", ".join(f"{name} {value}" for name, value in told.items()) + f"; {spent:.0f} CPU seconds in all"
        ran = before["run_on"] | {name: facts[name] for name in MACHINE} | {entrant.name: run}
        order = {name: index for index, name in enumerate(SOLVERS)}
        entries.sort(key=lambda entry: order[entry["solver"].removesuffix(EXTRAPOLATED)])
        content = plain({"schema": SCHEMA, "digits": DIGITS, "run_on": ran, "entries": entries})
        save(drawn_standings(TITLE, overall_curves(entries)), RECORD.with_suffix(".svg"))
        write_atomically(RECORD, json.dumps(content, allow_nan=False).replace('{"solver"', '\n{"solver"') + "\n")
    return RECORD


def _entries(
    entrant: Entrant, problems: Sequence[Shipped], limit: float, folder: Path, report: Listener
) -> list[dict[str, Any]]:
    """An entry for each setting and problem."""
    made, by_problem = [], dict[str, list[Answer]]()
    for setting, spec in entrant.settings:
        report(Note(f"{entrant.name}, {setting}"))
        for one, found in zip(problems, run_judge.solved(spec, problems, limit, folder, report), strict=True):
            by_problem.setdefault(one.name, []).append(found)
            made.append(_entry(entrant.name, setting, one, found))
    if entrant.grids:
        for one in problems:
            found = extrapolated(one.data, by_problem[one.name])
            entry = _entry(entrant.name + EXTRAPOLATED, "from the two finest grids", one, found)
            finest = by_problem[one.name][-1]
            for row in entry["rows"]:
                row["estimated"] = estimated(one, row["quantity"], finest, found)
            made.append(entry)
    return made


def _entry(solver: str, setting: str, one: Shipped, found: Answer) -> dict[str, Any]:
    row = asdict(judged(one.key, found, DIGITS))
    kept = ("quantity", "status", "digits", "error", "answered", "asked")
    row["rows"] = [{name: _rounded(r[name]) for name in kept} for r in row["rows"]]
    del row["ignored"]
    return {"solver": solver, "setting": setting} | {name: _rounded(value) for name, value in row.items()}


def estimated(one: Shipped, quantity: str, finest: Answer, limit: Answer) -> float | None:
    """What extrapolation says of the error of the finest grid, over the scale; None where a value is not there."""
    values, limits = (np.atleast_1d(np.asarray(found.values.get(quantity), object)) for found in (finest, limit))
    if values.shape != limits.shape or any(value is None for value in (*values, *limits)):
        return None
    miss = np.abs(values.astype(np.float64) - limits.astype(np.float64))
    return float(_rounded(float(np.max(miss)) / scale_of(quantity, one.key.answers[quantity].value)))


def _rounded(value: Any) -> Any:
    """A number that is no count, to three digits; all else as it is."""
    return float(f"{value:.3g}") if isinstance(value, float) else value


WHOLE = ("patches",)  # counts, of which the finest grid's stands


def extrapolated(problem: Mapping[str, Any], grids: Sequence[Answer]) -> Answer:
    """The answers to a problem that grids, coarsest first, tend to; as the finest where it has none."""
    fine, coarse = grids[-1], grids[-2]
    if fine.status != "answered" or coarse.status != "answered":
        return fine if fine.status != "answered" else coarse
    ratio = math.sqrt(2) if "adhesion" in problem else 2.0
    answers = {
        name: value if name in WHOLE else _limit(value, coarse.values[name], ratio)
        for name, value in fine.values.items()
        if name in coarse.values
    }
    spent = [sum(getattr(grid, name) or 0.0 for grid in grids[-2:]) for name in ("seconds", "cpu_seconds")]
    told = f"from the two finest grids, errors falling by {ratio:.3g}"
    return Answer("answered", told, answers, seconds=spent[0], cpu_seconds=spent[1])


def _limit(fine: Any, coarse: Any, ratio: float) -> Any:
    if isinstance(fine, list):
        if len(fine) != len(coarse):
            return None
        return [_limit(x, y, ratio) for x, y in zip(fine, coarse, strict=True)]
    return None if fine is None or coarse is None else fine + (fine - coarse) / (ratio - 1)
