"""challenge.html: a solver judged, and placed among the recorded standings; from challenge.json and them alone.

Its figures show error against seconds of every recorded solver, and of the one that is judged.  The error of a solver
on a problem is the geometric mean over its answers, 10 to the minus mean digits; a key's own uncertainty is the least
that shows.  A submission has no seconds: it is a horizontal line.
"""

import math
import statistics
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from validation.report.figures import COLOURS, inline_svg, styled
from validation.report.pages import filled
from validation.report.tick_labels import label_plainly

HUES = (*COLOURS, "#b0306a", "#2f8f9d", "#6b8e23", "#a0522d")
SIGNS = ("o", "s", "^", "D", "v", "x", "P", "<", ">", "h")
JUDGED = "#111111"
SIZE = (6.8, 4.6)
DECADES = 10.0  # of seconds, from which powers of ten alone are labelled


@dataclass(frozen=True)
class SolverCurve:
    """A solver: its points (seconds, error) from setting to setting; seconds None for answers without."""

    label: str
    points: tuple[tuple[float | None, float], ...]


NOBODY = SolverCurve("", ())


def drawn_standings(title: str, recorded: Sequence[SolverCurve], judged: SolverCurve = NOBODY) -> Figure:
    """Error against seconds on logarithmic axes; the judged solver as stars, or as a line where it has no seconds."""
    with styled():
        canvas = Figure(figsize=SIZE, layout="constrained")
        axes = canvas.subplots()
        for index, curve in enumerate(recorded):
            known = [(x, y) for x, y in curve.points if x is not None]
            if known:
                axes.plot(*zip(*known, strict=True), marker=SIGNS[index % len(SIGNS)], color=HUES[index % len(HUES)],
                          linewidth=1.1, markersize=4.4, label=curve.label)  # fmt: skip
        for x, y in judged.points:
            if x is None:
                axes.axhline(y, color=JUDGED, linestyle="--", linewidth=1.3, label=judged.label)
            else:
                axes.plot([x], [y], "*", color=JUDGED, markersize=13, label=judged.label)
        axes.set(xlabel="CPU seconds", ylabel="error over scale, geometric mean of the answers")
        axes.set(xscale="log", yscale="log")
        label_plainly(axes.xaxis, axes.yaxis)
        axes.set_title(title, fontsize=9.5)
        if axes.get_legend_handles_labels()[1]:
            canvas.legend(loc="outside lower center", ncols=2, fontsize=7.5)
        low, high = axes.get_xlim()
        if high > DECADES * low:
            axes.xaxis.set_minor_formatter(NullFormatter())
    return canvas


def standings_svg(prefix: str, title: str, recorded: Sequence[SolverCurve], judged: SolverCurve) -> Markup:
    """The same as an element of a page, described in words."""
    every = [curve for curve in (*recorded, judged) if curve.points]
    told = (f"{curve.label}: {', '.join(_word(x, y) for x, y in curve.points)}." for curve in every)
    return inline_svg(drawn_standings(title, recorded, judged), prefix, title, " ".join(told))


def error_of_digits(digits: Sequence[float]) -> float:
    """10 to the minus mean digits.

    Examples
    --------
    >>> error_of_digits([2.0, 4.0])
    0.001
    """
    return math.pow(10.0, -math.fsum(digits) / len(digits))


def _word(seconds: float | None, error: float) -> str:
    return f"error {error:.1e}" + ("" if seconds is None else f" in {seconds:.2g} s")


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


def render_challenge(judged: Mapping[str, Any], standings: Mapping[str, Any]) -> str:
    """The page as text, from the content of challenge.json and of standings.json."""
    names = [problem["problem"] for problem in judged["problems"]]
    entries = [entry for entry in standings["entries"] if entry["problem"] in names]
    module, _, function = judged["solver"].partition(":")
    label = f"{module.rpartition('.')[2]}:{function}" if function else judged["solver"]
    limit = judged["digits"]
    here = standing(judged["solver"], "judged here", judged["problems"], limit)
    table = [*(standing(*key, problems, limit) for key, problems in _grouped(entries).items()), here]
    table.sort(key=lambda row: (-row.right, math.inf if row.seconds is None else row.seconds))

    def figure(problem: Shipped) -> Markup:
        name = problem["problem"]
        of_problem = overall_curves(entry for entry in entries if entry["problem"] == name)
        return standings_svg(name, f"{name}: error against seconds", of_problem, _curve(label, [[problem]]))

    return filled(
        "challenge_page.jinja",
        {"tenths": lambda digits: "–" if digits is None else f"{digits:.1f}"},
        judged=judged,
        problems=[(problem, figure(problem)) for problem in judged["problems"]],
        ranking=table,
        here=here,
        place=1 + len({row.solver for row in table[: table.index(here)]}),
        solvers=len({row.solver for row in table}),
        overall=standings_svg("overall", "All problems: geometric means over the problems answered",
                              overall_curves(entries), _curve(label, [judged["problems"]])),
        grids=grid_errors(entries),
        run_on=standings["run_on"],
    )  # fmt: skip


def standing(solver: str, setting: str, problems: Sequence[Shipped], limit: float) -> Standing:
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
    )


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
