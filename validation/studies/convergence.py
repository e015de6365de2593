"""Does every code converge as its theory says: BEM geometrically, FEM and the rest at their orders, the path at once.

Curves and predictions: convergence_curves.py; fits: rates.py.  A rate is bounded on both sides: converging too fast is
as wrong as too slowly.  The path of the solver has no rate: its events are resolved whatever the increments, so the
states at its targets must agree to the tolerance; that is self-convergence and gives no digits.  A curve that cannot be
computed is a line with its message.  Finished parts are kept (harness/store.py): an interrupted study continues.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from validation.corpus.convergence_curves import (
    Curve,
    bem_curves,
    ensemble_curve,
    fem_curve,
    paper_method_curve,
    path_targets,
    persson_curves,
    predicted_line,
)
from validation.corpus.rates import RateError
from validation.harness.execution import Listener
from validation.harness.provenance import provenance
from validation.harness.store import store_in, write_json
from validation.report.study_figures import Line, Plot, write_svg
from validation.studies.shown import text_table

SCHEMA = "linecontact-convergence/1"
FILE = "convergence.json"
DRIFT = 1e-6  # largest change of a contact fraction with the increments of the path
INCREMENTS = (0.4, 0.2, 0.1, 0.05, 0.0125)  # of the path, in rms heights
PLATEAU = 1e-12  # largest plateau of a geometric curve
COLUMNS = ["curve", "knob", "predicted", "fitted", "low", "high", "fitted over", "plateau", "met"]


@dataclass(frozen=True)
class PathDrift:
    """Largest change of the contact fractions at targets against the finest increments."""

    increments: tuple[float, ...]
    drifts: tuple[float, ...]
    evaluations: tuple[int, ...]

    @property
    def met(self) -> bool:
        """Whether nothing changes beyond the tolerance."""
        return all(drift <= DRIFT for drift in self.drifts)


def curves_of(quick: bool) -> dict[str, Callable[[], Curve | Sequence[Curve]]]:
    """What computes the curves, by name, in order."""
    graded = (4, 8, 16) if quick else (4, 8, 16, 32)
    uniform = (8, 16, 32) if quick else (8, 16, 32, 64)
    quartic = {} if quick else {"fem, quartic elements, graded": partial(fem_curve, 4, (4, 6, 8, 12), True)}
    return {
        "bem, contact fraction 0.9": partial(bem_curves, 0.9, range(4, 49, 4)),
        "bem, contact fraction 0.95": partial(bem_curves, 0.95, range(4, 69, 4)),
        "fem, quadratic elements, graded": partial(fem_curve, 2, graded, True),
        "fem, quadratic elements, uniform": partial(fem_curve, 2, uniform, False),
        "fem, quartic elements, uniform": partial(fem_curve, 4, uniform[:3], False),
        **quartic,
        "persson": partial(persson_curves, (25, 50, 100, 200, 400), (6, 12, 25, 50, 100)),
        "paper's method": partial(paper_method_curve, (8, 16, 32, 64)),
        "ensemble": partial(ensemble_curve, *((12, 24) if quick else (30, 256))),
    }


def run(
    folder: Path,
    quick: bool,
    report: Listener,
    parts: Mapping[str, Callable[[], Curve | Sequence[Curve]]] | None = None,
    increments: tuple[float, ...] | None = None,
) -> int:
    """Run the study; 1 when a rate is outside its bounds, a curve fails, or the path depends on its increments.

    The folder gets convergence.json and the figures. Quick: fewer sizes, fewer realisations. Parts and increments,
    where they are given, are others than those of the study.
    """
    facts, store = provenance(), store_in(folder, report)
    curves: list[Curve] = []
    failures: list[str] = []
    for name, compute in (parts or curves_of(quick)).items():
        answer = store.alone(list[Curve], _listed, compute, name, quick)
        if isinstance(answer, Exception):  # a line with its message, never a missing one
            failures.append(f"{name}: {type(answer).__name__}: {answer}")
        else:
            curves += answer
    asked = 30 if quick else 100, increments or (INCREMENTS[::2] if quick else INCREMENTS)
    path = store.alone(PathDrift, path_drift, asked, "path", asked)
    print(text_table(COLUMNS, [row_of(curve) for curve in curves]))
    if isinstance(path, Exception):
        failures.append(f"path: {type(path).__name__}: {path}")
    else:
        drifts = [[i, d, n] for i, d, n in zip(path.increments, path.drifts, path.evaluations, strict=True)]
        print("\npath (self-convergence: no digits)")
        print(text_table(["increment / h_rms", "change against the finest", "evaluations"], drifts))
    for message in failures:
        print(f"FAILED: {message}")
    known = path if isinstance(path, PathDrift) else None
    good = not failures and known is not None and known.met and all(_met(curve) for curve in curves)
    told = {"met": known.met, "reference": "self-convergence: no digits"} if known else {}
    content = {
        "schema": SCHEMA,
        "provenance": facts,
        "quick": quick,
        "curves": list(_content(curves)),
        "path": asdict(known) | told if known else None,
        "ensemble": [area for curve in curves for area in curve.samples],
        "failures": failures,
        "met": good,
    }
    write_json(folder / FILE, content)
    for name, plot in figures_of(curves):
        write_svg(plot, folder / f"{name}.svg")
    return 0 if good else 1


def _listed(compute: Callable[[], Curve | Sequence[Curve]]) -> list[Curve]:
    """In a worker: the curves of a part."""
    found = compute()
    return [found] if isinstance(found, Curve) else list(found)


def path_drift(asked: tuple[int, Sequence[float]]) -> PathDrift:
    """How far the states at targets move with the increments, for a number of harmonics."""
    harmonics, increments = asked
    paths = [path_targets(harmonics, increment) for increment in increments]
    finest = np.array(paths[-1][0])
    drifts = tuple(float(np.max(np.abs(np.array(targets) - finest))) for targets, _ in paths)
    return PathDrift(tuple(increments), drifts, tuple(count for _, count in paths))


def row_of(curve: Curve) -> list[Any]:
    """A line of the table; what is wrong with the fit in place of a rate that cannot be fitted."""
    try:
        rate = curve.rate
    except RateError as error:
        return [curve.id, curve.knob, curve.predicted, str(error), curve.low, curve.high, "-", "-", "NOT MET"]
    span = f"{curve.sizes[rate.used[0]]:g}..{curve.sizes[rate.used[-1]]:g}"
    shown = "met" if _met(curve) else "NOT MET"
    return [curve.id, curve.knob, curve.predicted, rate.value, curve.low, curve.high, span, rate.plateau, shown]


def figures_of(curves: Sequence[Curve]) -> Iterator[tuple[str, Plot]]:
    """Names and figures: geometric curves, finite elements, other orders, the running mean of the ensemble."""
    geometric = [curve for curve in curves if curve.law == "geometric"]
    meshes = [curve for curve in curves if curve.id.startswith("fem-")]
    others = [c for c in curves if c.law == "algebraic" and c.id != "ensemble-area" and c not in meshes]
    spread = [curve for curve in curves if curve.id == "ensemble-area"]
    if geometric:
        yield "convergence-geometric", _plot("Geometric, to a plateau", "nodes per patch", geometric, "linear")
    if meshes:
        yield "convergence-fem", _plot("Finite elements, graded and uniform", "cells per period", meshes, "log")
    if others:
        yield "convergence-others", _plot("Persson's diffusion, the paper's method", "cells or steps", others, "log")
    if spread:
        yield "convergence-ensemble", _plot("Mean contact fraction over realisations", spread[0].knob, spread, "log")
        yield "convergence-mean-area", _running_mean(spread[0].samples)


def _met(curve: Curve) -> bool:
    try:
        return curve.met and (curve.law == "algebraic" or curve.rate.plateau <= PLATEAU)
    except RateError:
        return False


def _plot(title: str, xlabel: str, curves: Sequence[Curve], xscale: str) -> Plot:
    lines: list[Line] = []
    fits: list[tuple[str, Sequence[float], Sequence[float]]] = []
    for curve in curves:
        lines.append(Line(f"{curve.id} ({curve.kind}: {curve.reference})", curve.sizes, curve.errors))
        try:
            rate = curve.rate
        except RateError:
            fits.append(("no rate", [], []))
            continue
        words = f"predicted {curve.predicted:.3g} per node, fitted {rate.value:.3g}"
        if curve.law == "algebraic":
            words = f"predicted order {curve.predicted:g}, fitted {rate.value:.2f}"
        fits.append((words, *predicted_line(curve)))
    return Plot(title, xlabel, "error", lines, xscale=xscale, fits=fits, size=(8.4, 6.2))


def _running_mean(areas: Sequence[float]) -> Plot:
    count = list(range(2, len(areas) + 1))
    mean = [float(np.mean(areas[:n])) for n in count]
    half = [2 * float(np.std(areas[:n], ddof=1)) / math.sqrt(n) for n in count]
    shifts = {"mean of the first n": 0, "plus two standard errors": 1, "less two standard errors": -1}
    lines = [
        Line(label, count, [m + sign * h for m, h in zip(mean, half, strict=True)], joined=False)
        for label, sign in shifts.items()
    ]
    return Plot("Mean contact fraction", "realisations n", "contact fraction", lines, xscale="linear", yscale="linear")


def _content(curves: Sequence[Curve]) -> Iterator[dict[str, Any]]:
    for curve in curves:
        entry = asdict(replace(curve, samples=())) | {"met": _met(curve)}
        try:
            yield entry | {"rate": asdict(curve.rate)}
        except RateError as error:
            yield entry | {"rate": {"message": str(error)}}
