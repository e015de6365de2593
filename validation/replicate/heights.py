"""Heights of the generated profiles: the rms height asked for, and how far from Gaussian they are.

Each profile is sampled on a grid that resolves its shortest wave 16 times.  A sum of waves with independent phases has
mean skewness 0 (no skewness but that of triples m1 + m2 = m3, of random sign) and mean excess kurtosis

    <h^4> / h_rms^4 - 3 = -(3/2) sum h_m^4 / (sum h_m^2)^2,

which tends to the Gaussian's 0 only when many waves share the variance.  For H = 0.7 the longest wave has 72 % of it.
Where the long waves are taken out, more waves share the rest, and the fourth moment tends to the Gaussian's 3: shown.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bem.geometry.profile import Profile
from validation.harness.case import Outcome
from validation.harness.figure_data import axes, drawn, marks, shaded, trace
from validation.harness.rows import compared
from validation.harness.schema import Reference, Table
from validation.replicate.evidence import Evidence, joined, mean_and_error
from validation.replicate.members import RMS_HEIGHT
from validation.replicate.statements import Alternative, disagreement, statement

BOUNDS = np.linspace(-3.5, 3.5, 36)  # of h_rms
FIRST_KEPT = (1, 2, 4, 8, 16, 32)  # longest waves of the profiles whose fourth moment is shown

CAUSE = (
    "the longest wave carries 72 % of the variance, so that the profiles are no Gaussian sample; phases are random as "
    "in the paper, the fourth moment is the one that independent phases give, and without the long waves it tends to "
    "3 (table); the mean density over the profiles looks Gaussian all the same"
)


def compute(evidence: Evidence) -> Outcome:
    """Rows, figure and table."""
    heights = [one.surface.grid[1] / RMS_HEIGHT for one in evidence.loading]
    rms = np.array([[np.sqrt(np.mean(h**2))] for h in heights])
    moments = np.array([[np.mean(h**3), np.mean(h**4) - 3] for h in heights])
    density = np.array([np.histogram(h, BOUNDS, density=True)[0] for h in heights])
    (skewness, excess), (skewness_error, excess_error) = mean_and_error(moments)
    first = [order for order in FIRST_KEPT if order < evidence.size.harmonics / 2]
    fourth = [_fourth_moment(evidence, order) for order in first]
    where = "section 4: heights of the generated profiles are Gaussian"
    short = evidence.shortfall
    rows = (
        statement("rms height over the one asked for, every profile", rms[:, 0].tolist(), 0.0, [1.0] * len(rms), 1e-12,
                  Alternative(1 + 1e-9, "a profile that is not scaled"), measured=2e-16, where=where, shortfall=short),
        statement("skewness of the heights, mean over profiles", float(skewness), float(skewness_error), 0.0, 0.2,
                  Alternative(1.0, "a profile of crests"), measured=0.074, where=where, shortfall=short),
        compared("excess kurtosis of the heights, mean over profiles, against that of independent phases", "",
                 Reference(kind="exact", source="-(3/2) sum h_m^4 / (sum h_m^2)^2"),
                 [_excess_of_independent_phases(evidence)], [float(excess)], 0.25, 0.11, "absolute",
                 uncertainty=float(excess_error)),
        compared(f"fourth moment of the heights without the waves longer than order {first[-1]}, mean over "
                 "profiles, against a Gaussian's 3", "",
                 Reference(kind="exact", source="many waves of independent phases: Gaussian heights"), [3.0],
                 [fourth[-1][0]], 0.17, 0.057, "absolute", uncertainty=fourth[-1][1]),
        disagreement("fourth moment of the heights, mean over profiles, against a Gaussian's 3", float(excess) + 3,
                     float(excess_error), 3.0, (0.6, 0.8), CAUSE, where=where, shortfall=short),
    )  # fmt: skip
    table = Table(caption="Profiles of the loading ensemble.",
                  columns=["seed", "highest crest / um", "skewness", "excess kurtosis"],
                  rows=[[one.result.scene["profile"]["seed"], one.surface.max_height * 1e6, float(a), float(b)]
                        for one, (a, b) in zip(evidence.loading, moments, strict=True)])  # fmt: skip
    shares = Table(
        caption="Why the heights are no Gaussian sample: the fourth moment over the square of the variance, with the "
        "waves below an order taken out; mean over the profiles, and what independent phases give.",
        columns=["orders from", "share of the longest wave", "fourth moment", "standard error", "independent phases"],
        rows=[
            [order, _longest_share(evidence, order), *moment, 3 + _excess_of_independent_phases(evidence, order)]
            for order, moment in zip(first, fourth, strict=True)
        ],
    )
    centre = ((BOUNDS[1:] + BOUNDS[:-1]) / 2).tolist()
    mean, error = mean_and_error(density)
    x, y = joined([(centre, one) for one in density])
    smooth = np.linspace(BOUNDS[0], BOUNDS[-1], 141)
    figure = drawn("height-distribution",
                   "Distribution of the heights: every profile, their mean with its standard error, the Gaussian.",
                   axes("height $h/h_{rms}$", "density",
                        trace("profiles", x, y, "thin"),
                        shaded("mean and standard error", centre, mean - error, mean + error, 0),
                        marks("mean", centre, mean, hue=0),
                        trace("Gaussian", smooth, np.exp(-(smooth**2) / 2) / np.sqrt(2 * np.pi), hue=1)))  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), tables=(table, shares))


def _excess_of_independent_phases(evidence: Evidence, first: int = 1) -> float:
    power = _power_from(evidence, first)
    return float(-1.5 * np.sum(power**2) / np.sum(power) ** 2)


def _longest_share(evidence: Evidence, first: int) -> float:
    """Share of the longest wave kept in the variance of those kept."""
    power = _power_from(evidence, first)
    return float(power.max() / power.sum())


def _power_from(evidence: Evidence, first: int) -> NDArray[np.float64]:
    surface = evidence.loading[0].surface
    return np.asarray(surface.amplitudes[surface.orders >= first] ** 2)


def _fourth_moment(evidence: Evidence, first: int) -> tuple[float, float]:
    """Mean over the profiles, with the waves below an order taken out, and its standard error."""
    moments = []
    for one in evidence.loading:
        whole = one.surface
        kept = whole.orders >= first
        waves = Profile.from_harmonics(whole.period, whole.orders[kept], whole.amplitudes[kept], whole.phases[kept])
        heights = waves.grid[1]
        moments.append([float(np.mean(heights**4) / np.mean(heights**2) ** 2)])
    mean, error = mean_and_error(moments)
    return float(mean[0]), float(error[0])
