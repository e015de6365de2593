"""Rates of convergence against those that theory predicts, bounded on both sides: too fast is as wrong as too slow."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from validation.cases.shared.checks import Against, Found, case
from validation.corpus import convergence_curves as made
from validation.corpus.convergence_curves import Curve, fem_curve
from validation.corpus.curves_shown import error_figure, error_table
from validation.harness.figure_data import table
from validation.harness.schema import Code, Row

# relative distance of the fitted rate from the predicted one
MEASURED = {
    "bem-intensity-0.9": 0.022,
    "bem-load-0.9": 0.095,  # the singularity at the next edge is integrable: a little faster than rho^-2n
    "fem-p2-graded": 0.107,
    "fem-p4-uniform": 0.022,
    "persson-cells": 0.022,
    "persson-steps": 0.053,
    "paper-method": 0.033,
    "ensemble-area": 0.18,  # of 64 realisations: two standard deviations of the fit are 0.4
}
CODES: dict[str, Code] = {  # of the curves
    "bem": "bem",
    "fem P2": "fem",
    "fem P4": "fem",
    "persson": "persson",
    "paper's method": "paper's method",
}
MEASURED_FULL = {"fem-p2-graded": 0.05, "fem-p4-graded": 0.023, "fem-p2-uniform": 0.099, "fem-p4-uniform": 0.022}


def _rate_rows(curves: Sequence[Curve], measured: dict[str, float]) -> Iterator[Row]:
    """Fitted against predicted rates."""
    for curve in curves:
        of = "order" if curve.law == "algebraic" else "factor per node"
        predicted = Against("predicted order", f"{curve.why}; errors against {curve.reference} ({curve.kind})")
        yield predicted.row(f"{of}: {curve.quantity} of {curve.id}", "", curve.predicted, curve.rate.value,
                            measured[curve.id], code=CODES[curve.code])  # fmt: skip


def _rates() -> Found:
    bem = made.bem_curves(0.9, range(4, 49, 4))
    fem = (fem_curve(2, (4, 8, 16), True), fem_curve(4, (8, 16, 32), False))
    others = (
        *made.persson_curves((25, 50, 100, 200, 400), (6, 12, 25, 50, 100)),
        made.paper_method_curve((8, 16, 32, 64)),
    )
    yield from _rate_rows((*bem, *fem, *others), MEASURED)
    yield Against("exact", "Johnson 1995").row(
        "plateau of K over critical and of the load over p*", "", [0.0, 0.0], [curve.rate.plateau for curve in bem],
        2.3e-14, "absolute", required=1e-12, code="bem")  # fmt: skip
    yield error_figure("convergence-bem", "Errors of the dense route at Johnson's edges, contact fraction 0.9.", bem)
    yield error_figure("convergence-fem", "Load at prescribed edges: meshes graded to the edges, and uniform.", fem)
    yield error_figure("convergence-others", "Persson's diffusion and the paper's own method.", others)
    yield error_table((*bem, *fem, *others))


def _elements() -> Found:
    curves = (
        fem_curve(2, (4, 8, 16, 32), True),
        fem_curve(4, (4, 6, 8, 12), True),
        fem_curve(2, (16, 32, 64), False),
        fem_curve(4, (8, 16, 32), False),
    )
    yield error_figure("convergence-elements", "Load at prescribed edges, graded and uniform meshes.", curves)
    yield from _rate_rows(curves, MEASURED_FULL)
    yield error_table(curves)


def _ensemble(harmonics: int, realisations: int) -> Found:
    curve = made.ensemble_curve(harmonics, realisations)
    areas = np.array(curve.samples)
    yield from _rate_rows((curve,), MEASURED)
    yield error_figure("convergence-ensemble", "Spread of the mean contact fraction over its mean.", (curve,))
    yield error_table((curve,))
    error = float(areas.std(ddof=1)) / realisations**0.5
    yield table(f"Contact fraction at a separation of 0.8 h_rms, {harmonics} harmonics.",
                {"realisations": [realisations], "mean": [float(areas.mean())], "standard error": [error]})  # fmt: skip


CASES = (
    case("convergence-rates", "convergence", _rates,
         "Does every code converge at the rate that its theory predicts, and to which plateau?",
         r"error $= C \rho^{-n}$ (K), $C \rho^{-2n}$ (load), $\rho = z + \sqrt{z^2 - 1}$, $z$ = 1 + gap / half width; "
         "FEM load: $h^{2m}$ graded, $h$ uniform; Persson: 2 in stress, 3 in variance; the paper's cells: 2",
         "johnson1995 persson2001 carbone2009", "half_space adhesion", code="suite"),
    case("convergence-ensemble", "convergence", partial(_ensemble, 20, 64),
         "Does the mean area of an ensemble converge like the square root of the number of realisations?",
         r"spread of the mean over groups of $n$ $\propto n^{-1/2}$",
         "carbone2009", "half_space adhesion slope_term", level="standard", code="suite"),
    case("convergence-elements", "convergence", _elements,
         "What do the edges cost finite elements on uniform meshes, and do graded ones win it back?",
         "energy norm $h^m$ graded, $h^{1/2}$ uniform, whatever $m$; load: twice the order",
         "johnson1995", "half_space adhesion", level="full", code="suite"),
)  # fmt: skip
