"""Contact area against load: single curves, mean and standard error, both theories, straight lines.

A/A0 = a + b p/E* by least squares over the loads of `FITTED` (chosen beforehand: from 0.005 E*, below which the paper
has few patches, to the highest load), each realisation on its own; a theory over the same loads.  Linearity is judged
by the largest distance of the mean curve from its own line.  Without adhesion the theory has the closed form A/A0 =
erf(sqrt 2 p / (E* h'_rms)).

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray
from validation.harness.case import Outcome
from validation.harness.drawings import axes, drawn, marks, shaded, trace
from validation.harness.schema import Figure, Table
from validation.replicate.evidence import Evidence, joined, mean_and_error
from validation.replicate.members import LOADS, MODULUS
from validation.replicate.statements import disagreement, statement

FITTED = tuple(load for load in LOADS if load >= 0.005)
COMPARED = (0.005, 0.01, 0.015, 0.02, 0.025)
CAUSE = (
    "the straight line does not pass through the origin: at small loads a profile of one period touches near its "
    "highest crest only, and the area per load falls from three times the theory's there to less than twice; the mean "
    "ratio over the same loads is about 2"
)


def line_through(load: ArrayLike, area: ArrayLike) -> tuple[float, float]:
    """Intercept and slope of the straight line by least squares.

    Examples
    --------
    >>> [round(value, 12) for value in line_through([1.0, 2.0, 3.0], [3.0, 5.0, 7.0])]
    [1.0, 2.0]
    """
    slope, intercept = np.polyfit(np.asarray(load), np.asarray(area), 1)
    return float(intercept), float(slope)


def compute(evidence: Evidence) -> Outcome:
    """Rows, figure and table."""
    areas = evidence.values(lambda state: state.contact_fraction)
    mean, error = mean_and_error(areas)
    wet = np.array([evidence.with_adhesion[load].contact_fraction for load in LOADS])
    dry = np.array([evidence.without_adhesion[load].contact_fraction for load in LOADS])
    fitted = np.array([load in FITTED for load in LOADS])
    compared = np.array([load in COMPARED for load in LOADS])
    load = np.array(LOADS)
    lines = np.array([line_through(load[fitted], one[fitted]) for one in areas])
    (intercept, slope), (intercept_error, slope_error) = mean_and_error(lines)
    residual = float(np.max(np.abs(mean[fitted] - intercept - slope * load[fitted])) / mean[-1])
    ratio, ratio_error = mean_and_error((areas / wet)[:, compared].mean(axis=1)[:, None])
    theory_slope = line_through(load[fitted], wet[fitted])[1]
    short = evidence.shortfall
    rows = (
        statement("contact area over that of Persson's theory with adhesion, mean of 0.005 to 0.025 E*",
                  float(ratio[0]), float(ratio_error[0]), 2.0, 0.3, measured=0.072,
                  where="abstract: the theory underestimates the area by about 50 %", shortfall=short),
        statement("largest distance of the area curve from a straight line, 0.005 to 0.025 E*, over the largest area",
                  residual, float(np.max(error[fitted]) / mean[-1]), 0.0, 0.03, measured=0.012,
                  where="abstract: the area is linear in the load also with adhesion", shortfall=short),
        disagreement("slope of the straight line over that of the theory with adhesion", float(slope / theory_slope),
                     float(slope_error / theory_slope), 2.0, (0.75, 0.95), CAUSE,
                     where="abstract: the theory underestimates the area by about 50 % at any load", shortfall=short),
    )  # fmt: skip
    slopes = Table(
        caption="Straight lines A/A0 = a + b p/E* through 0.005 to 0.025 E*; errors are standard errors of the mean.",
        columns=["curve", "a", "error of a", "b", "error of b", "b over that of the theory with adhesion"],
        rows=[
            ["bem, mean", *map(float, (intercept, intercept_error, slope, slope_error, slope / theory_slope))],
            ["Persson with adhesion", *_line_row(load[fitted], wet[fitted], theory_slope)],
            ["Persson without adhesion", *_line_row(load[fitted], dry[fitted], theory_slope)],
        ],
    )
    points = Table(caption="Contact fractions at the loads asked for.",
                   columns=["p/E*", "bem, mean", "standard error", "Persson with adhesion", "Persson without",
                            "bem/with", "bem/without"],
                   rows=[list(map(float, row))
                         for row in zip(load, mean, error, wet, dry, mean / wet, mean / dry, strict=True)])  # fmt: skip
    return Outcome(
        rows=rows,
        figures=(_figure(evidence, mean, error, wet, dry, (float(intercept), float(slope))),),
        tables=(slopes, points),
    )


def _line_row(load: ArrayLike, area: ArrayLike, reference: float) -> list[float | None]:
    intercept, slope = line_through(load, area)
    return [intercept, None, slope, None, slope / reference]


def _figure(
    evidence: Evidence, mean: FloatArray, error: FloatArray, wet: FloatArray, dry: FloatArray, line: tuple[float, float]
) -> Figure:
    curves = [
        ([s.mean_pressure / MODULUS for s in one.touching], [s.contact_fraction for s in one.touching])
        for one in evidence.loading
    ]
    x, y = joined(curves)
    loads = list(LOADS)
    lower, upper = mean - error, mean + error
    ends = [FITTED[0], FITTED[-1]]
    return drawn("landing-area-against-load",
                 "Contact area against load: every realisation, their mean with its standard error and straight line, "
                 "and both theories.",
                 axes("mean pressure $p/E^*$", "contact fraction $A/A_0$",
                      trace("realisations", x, y, "thin"),
                      shaded("mean and standard error", loads, lower, upper, 0),
                      marks("mean", loads, map(float, mean), hue=0),
                      trace(f"line through the mean, slope {line[1]:.3g}", ends,
                            [line[0] + line[1] * end for end in ends], "dashed", hue=0),
                      trace("Persson with adhesion", [0.0, *loads], [0.0, *map(float, wet)], hue=1),
                      trace("Persson without adhesion", [0.0, *loads], [0.0, *map(float, dry)], hue=2)))  # fmt: skip
