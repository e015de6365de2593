"""Does every code converge as its theory says: BEM geometrically, FEM and the rest at their orders, the path at once.

Curves and predictions: convergence_curves.py; fits: rates.py.  A rate is bounded on both sides: converging too fast is
as wrong as too slowly.  The path of the solver has no rate: its events are resolved whatever the increments, so the
states at its targets must agree to the tolerance; that is self-convergence and gives no digits.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
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
)
from validation.corpus.curves_shown import error_figure, error_table
from validation.corpus.rates import RateError
from validation.harness.case import Case, Found
from validation.harness.figure_data import axes, drawn, shaded, table, trace
from validation.harness.rows import Against
from validation.harness.schema import Figure, Row
from validation.studies.bench import Bench, failed, no_more, study_case

SCHEMA = "linecontact-convergence/2"
FILE = "convergence.json"
DRIFT = 1e-6  # largest change of a contact fraction with the increments of the path
INCREMENTS = (0.4, 0.2, 0.1, 0.05, 0.0125)  # of the path, in rms heights
PLATEAU = 1e-12  # largest plateau of a geometric curve
Parts = Mapping[str, Callable[[], Curve | Sequence[Curve]]]


@dataclass(frozen=True)
class PathDrift:
    """Largest change of the contact fractions at targets against the finest increments."""

    increments: tuple[float, ...]
    drifts: tuple[float, ...]
    evaluations: tuple[int, ...]


def curves_of(quick: bool) -> Parts:
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


def cases(bench: Bench, parts: Parts | None = None, increments: tuple[float, ...] | None = None) -> list[Case]:
    """The case of the study; parts and increments, where they are given, are others than its own."""
    asked = 30 if bench.quick else 100, increments or (INCREMENTS[::2] if bench.quick else INCREMENTS)
    find = partial(_rates, bench, parts or curves_of(bench.quick), asked)
    return [
        study_case("rates", find, "Does every code converge as its theory says, and the path at once?",
                   r"error $= C \rho^{-n}$ or $C h^p$, bounded on both sides; targets whatever the increments",
                   "johnson1995 persson2001 carbone2009", "half_space adhesion slope_term")
    ]  # fmt: skip


def _rates(bench: Bench, parts: Parts, asked: tuple[int, Sequence[float]]) -> Found:
    curves: list[Curve] = []
    for name, compute in parts.items():
        answer = bench.store.alone(list[Curve], _listed, compute, name, bench.quick)
        if isinstance(answer, Exception):
            yield failed(name, answer)
        else:
            curves += answer
            yield from (row for curve in answer for row in rate_rows(curve))
    yield error_table([curve for curve in curves if _has_rate(curve)])
    yield from figures_of(curves)
    path = bench.store.alone(PathDrift, path_drift, asked, "path", asked)
    if isinstance(path, Exception):
        yield failed("path", path)
    else:
        change = "change of contact fractions at targets with the increments of the path"
        yield no_more(change, "", float(np.max(path.drifts)), DRIFT)
        yield table("The path (self-convergence: no digits).",
                    {"increment / h_rms": path.increments, "change against the finest": path.drifts,
                     "evaluations": path.evaluations})  # fmt: skip
    bench.write(FILE, SCHEMA, curves=[asdict(curve) | {"rate": _rate(curve)} for curve in curves],
                path=None if isinstance(path, Exception) else asdict(path))  # fmt: skip


def _listed(compute: Callable[[], Curve | Sequence[Curve]]) -> list[Curve]:
    """In a worker: the curves of a part."""
    found = compute()
    return [found] if isinstance(found, Curve) else list(found)


def path_drift(asked: tuple[int, Sequence[float]]) -> PathDrift:
    """How far the states at targets move with the increments, for a number of harmonics."""
    harmonics, increments = asked
    paths = [path_targets(harmonics, increment) for increment in increments]
    finest = np.array(paths[-1][0])
    if any(len(targets) != finest.size for targets, _ in paths):
        raise ArithmeticError(
            f"path: {[len(targets) for targets, _ in paths]} targets met with increments {increments}"
        )
    drifts = tuple(float(np.max(np.abs(np.array(targets) - finest))) for targets, _ in paths)
    return PathDrift(tuple(increments), drifts, tuple(count for _, count in paths))


def rate_rows(curve: Curve) -> list[Row]:
    """The fitted rate between its bounds, and of a geometric curve its plateau; or what is wrong with the fit."""
    of = "order" if curve.law == "algebraic" else "factor per node"
    name = f"{of} of {curve.quantity}, {curve.id}"
    if not _has_rate(curve):
        return [failed(name, _rate(curve)["message"])]
    predicted = Against("predicted order", f"{curve.why}; errors against {curve.reference} ({curve.kind})")
    rows = [
        predicted.row(f"{name}: predicted {curve.predicted:.4g}, from {curve.low:.4g} to {curve.high:.4g}", "",
                      (curve.low + curve.high) / 2, curve.rate.value, None, "absolute",
                      required=(curve.high - curve.low) / 2, pinned="unconverged")
    ]  # fmt: skip
    if curve.law == "geometric":
        rows.append(no_more(f"plateau of {curve.quantity}, {curve.id}", "", curve.rate.plateau, PLATEAU))
    return rows


def figures_of(curves: Sequence[Curve]) -> Iterator[Figure]:
    """Geometric curves, finite elements, other orders, the spread of the ensemble and its running mean."""
    fitted = [curve for curve in curves if _has_rate(curve)]
    spread = [curve for curve in fitted if curve.samples]
    meshes = [curve for curve in fitted if curve.id.startswith("fem-")]
    geometric = [curve for curve in fitted if curve.law == "geometric"]
    others = [curve for curve in fitted if not any(curve in some for some in (spread, meshes, geometric))]
    for name, caption, some in (
        ("geometric", "Geometric, to a plateau.", geometric),
        ("fem", "Finite elements, graded and uniform meshes.", meshes),
        ("others", "Persson's diffusion, the paper's method.", others),
        ("ensemble", "Mean contact fraction over realisations.", spread),
    ):
        if some:
            yield error_figure(f"convergence-{name}", caption, some)
    for curve in spread:
        yield _running_mean(curve.samples)


def _running_mean(areas: Sequence[float]) -> Figure:
    count = list(range(2, len(areas) + 1))
    mean = np.array([np.mean(areas[:n]) for n in count])
    half = np.array([2 * np.std(areas[:n], ddof=1) / math.sqrt(n) for n in count])
    return drawn("convergence-mean-area", "Mean contact fraction of the first realisations, with two standard errors.",
                 axes("realisations", "contact fraction", trace("mean of the first n", count, mean),
                      shaded("two standard errors", count, mean - half, mean + half, 0)))  # fmt: skip


def _has_rate(curve: Curve) -> bool:
    return "value" in _rate(curve)


def _rate(curve: Curve) -> dict[str, Any]:
    """The fitted rate, or what is wrong with the fit."""
    try:
        return asdict(curve.rate)
    except RateError as error:
        return {"message": str(error)}
