"""challenge.html: a solver judged, and placed among the recorded standings; from challenge.json and them alone."""

from __future__ import annotations

import math
import statistics
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from validation.report.challenge.challenge_figures import SolverCurve, error_of_digits, standings_svg
from validation.report.render import filled

AREAS = ("contact_fraction", "gap_fraction")
COUNTS = ("patches",)  # right or wrong: their 15 digits would hide those of all else
Shipped = Mapping[str, Any]  # of challenge.json, or an entry of standings.json


@dataclass(frozen=True)
class Standing:
    """A solver at one setting over all problems."""

    solver: str
    setting: str
    problems: int
    right: int  # quantities, as in the next two
    answered: int
    asked: int
    digits: float | None  # median over the quantities that have any
    seconds: float | None  # CPU seconds of the problems answered, in all
    judged: bool = False


def render_challenge(judged: Mapping[str, Any], standings: Mapping[str, Any]) -> str:
    """The page as text, from the content of challenge.json and of standings.json."""
    names = [problem["problem"] for problem in judged["problems"]]
    entries = [entry for entry in standings["entries"] if entry["problem"] in names]
    label = judged["solver"].rpartition(".")[2] if ":" in judged["solver"] else judged["solver"]
    problems = [(problem, _figure(problem, entries, label)) for problem in judged["problems"]]
    limit = judged["digits"]
    table = [*standing_rows(entries, limit), standing(judged["solver"], "judged here", judged["problems"], limit, True)]
    table.sort(key=lambda row: (-row.right, math.inf if row.seconds is None else row.seconds))
    ahead = table[: next(index for index, row in enumerate(table) if row.judged)]
    return filled(
        "challenge_page.jinja",
        judged=judged,
        problems=problems,
        table=table,
        place=1 + len({row.solver for row in ahead}),
        solvers=len({row.solver for row in table}),
        overall=standings_svg("overall", "All problems: geometric means over the problems answered",
                              overall_curves(entries), _curve(label, [judged["problems"]])),
        grids=grid_errors(entries),
        run_on=standings["run_on"],
    )  # fmt: skip


def standing(
    solver: str, setting: str, problems: Sequence[Shipped], limit: float = 3.0, judged: bool = False
) -> Standing:
    """One line of the table; a whole answer with `limit` digits is right."""
    rows = [row for problem in problems for row in problem["rows"]]
    digits = [digit for problem in problems for digit in _digits(problem)]
    seconds = [p["cpu_seconds"] for p in problems if p["cpu_seconds"] is not None and _digits(p)]
    return Standing(
        solver=solver,
        setting=setting,
        problems=sum(bool(_digits(problem)) for problem in problems),
        right=sum(row["answered"] == row["asked"] and (row["digits"] or 0.0) >= limit for row in rows),
        answered=sum(row["digits"] is not None for row in rows),
        asked=len(rows),
        digits=statistics.median(digits) if digits else None,
        seconds=sum(seconds) if seconds else None,
        judged=judged,
    )


def standing_rows(entries: Iterable[Shipped], limit: float = 3.0) -> list[Standing]:
    """A line for each solver and setting on record."""
    return [standing(*key, problems, limit) for key, problems in _grouped(entries).items()]


def grid_errors(entries: Sequence[Shipped]) -> list[tuple[str, str, str, float, float, float]]:
    """Of extrapolated grids, with adhesion or without: solver, problem, quantity, and three errors over the scale.

    The error of the finest grid, what extrapolation says of it, and the error that is left after extrapolation.
    """
    found = []
    for entry in entries:
        for row in entry["rows"]:
            if row.get("estimated") is None or row["error"] is None or row["quantity"] not in AREAS:
                continue
            solver = entry["solver"].rpartition(",")[0]
            finest = [e for e in entries if (e["solver"], e["problem"]) == (solver, entry["problem"])][-1]
            (true,) = (r["error"] for r in finest["rows"] if r["quantity"] == row["quantity"])
            found.append((solver, entry["problem"], row["quantity"], true, row["estimated"], row["error"]))
    return found


def overall_curves(entries: Iterable[Shipped]) -> list[SolverCurve]:
    """A curve for each solver on record: geometric means of seconds and errors over the problems it answered."""
    by_solver = defaultdict[str, list[list[Shipped]]](list)
    for (solver, _), problems in _grouped(entries).items():
        by_solver[solver].append(problems)
    return [_curve(solver, settings) for solver, settings in by_solver.items()]


def _figure(problem: Shipped, entries: Sequence[Shipped], solver: str) -> Markup:
    of_problem = [entry for entry in entries if entry["problem"] == problem["problem"]]
    title = f"{problem['problem']}: error against seconds"
    return standings_svg(problem["problem"], title, overall_curves(of_problem), _curve(solver, [[problem]]))


def _curve(label: str, settings: Iterable[Sequence[Shipped]]) -> SolverCurve:
    """A point for each setting that answered anything."""
    points = []
    for problems in settings:
        known = [(problem["cpu_seconds"], _digits(problem)) for problem in problems if _digits(problem)]
        if not known:
            continue
        seconds = [spent for spent, _ in known if spent is not None]
        mean = statistics.geometric_mean([max(s, 1e-6) for s in seconds]) if seconds else None
        points.append((mean, error_of_digits([statistics.mean(digits) for _, digits in known])))
    return SolverCurve(label, tuple(points))


def _digits(problem: Shipped) -> list[float]:
    """Those that the answers to a problem have, counts left out."""
    return [row["digits"] for row in problem["rows"] if row["digits"] is not None and row["quantity"] not in COUNTS]


def _grouped(entries: Iterable[Shipped]) -> dict[tuple[str, str], list[Shipped]]:
    found = defaultdict[tuple[str, str], list[Shipped]](list)
    for entry in entries:
        found[entry["solver"], entry["setting"]].append(entry)
    return found
