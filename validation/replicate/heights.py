"""Heights of the generated profiles: the rms height asked for, and how far from Gaussian they are.

Each profile is sampled on a grid that resolves its shortest wave 16 times.  A sum of waves with independent phases has
mean skewness 0 (no skewness but that of triples m1 + m2 = m3, of random sign) and mean excess kurtosis

    <h^4> / h_rms^4 - 3 = -(3/2) sum h_m^4 / (sum h_m^2)^2,

which tends to the Gaussian's 0 only when many waves share the variance.  For H = 0.7 the longest wave has 72 % of it.
Where the long waves are taken out, more waves share the rest, and the fourth moment tends to the Gaussian's 3: shown.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 4.
"""

import numpy as np

from bem.geometry.profile import Profile
from validation.harness.arrays import FloatArray
from validation.harness.case import Outcome
from validation.harness.figure_data import axes, drawn, trace
from validation.harness.rows import Against
from validation.harness.schema import Table
from validation.references.paper_problem import RMS_HEIGHT
from validation.replicate.evidence import Evidence, estimate, mean_and_error, scattered
from validation.replicate.statements import Alternative

BOUNDS = np.linspace(-3.5, 3.5, 36)  # of h_rms
FIRST_KEPT = (1, 2, 4, 8, 16, 32)  # longest waves of the profiles whose fourth moment is shown

CAUSE = (
    "the longest wave carries 72 % of the variance, so that the profiles are no Gaussian sample; phases are random as "
    "in the paper, the fourth moment is the one that independent phases give, and without the long waves it tends to "
    "3 (table); the mean density over the profiles looks Gaussian all the same"
)


def compute(evidence: Evidence) -> Outcome:
    """Rows, figure and tables."""
    heights = [one.surface.grid[1] / RMS_HEIGHT for one in evidence.loading]
    rms = [float(np.sqrt(np.mean(h**2))) for h in heights]
    moments = np.array([[np.mean(h**3), np.mean(h**4) - 3] for h in heights])
    density = np.array([np.histogram(h, BOUNDS, density=True)[0] for h in heights])
    (skewness, excess), (skewness_error, excess_error) = (map(float, both) for both in mean_and_error(moments))
    first = [order for order in FIRST_KEPT if order < evidence.size.harmonics / 2]
    shared = evidence.loading[0].surface
    power = {order: np.asarray(shared.amplitudes[shared.orders >= order] ** 2) for order in first}
    fourth = {order: _fourth_moment(evidence, order) for order in first}
    paper = evidence.paper("section 4: heights of the generated profiles are Gaussian")
    rows = (
        paper.states("rms height over the one asked for, every profile", rms, 0.0, [1.0] * len(rms), 1e-12,
                     Alternative(1 + 1e-9, "a profile that is not scaled"), measured=2e-16),
        paper.states("skewness of the heights, mean over profiles", skewness, skewness_error, 0.0, 0.2,
                     Alternative(1.0, "a profile of crests"), measured=0.074),
        Against("exact", "-(3/2) sum h_m^4 / (sum h_m^2)^2").row(
            "excess kurtosis of the heights, mean over profiles, against that of independent phases", "",
            _excess(power[first[0]]), excess, (0.25, 0.11), "absolute", uncertainty=excess_error),
        Against("exact", "many waves of independent phases: Gaussian heights").row(
            f"fourth moment of the heights without the waves longer than order {first[-1]}, mean over profiles, "
            "against a Gaussian's 3", "", 3.0, fourth[first[-1]][0], (0.17, 0.057), "absolute",
            uncertainty=fourth[first[-1]][1]),
        paper.is_otherwise("fourth moment of the heights, mean over profiles, against a Gaussian's 3", excess + 3,
                           excess_error, 3.0, (0.6, 0.8), CAUSE),
    )  # fmt: skip
    table = Table(caption="Profiles of the loading ensemble.",
                  columns=["seed", "highest crest / um", "skewness", "excess kurtosis"],
                  rows=[[one.result.scene["profile"]["seed"], one.surface.max_height * 1e6, float(a), float(b)]
                        for one, (a, b) in zip(evidence.loading, moments, strict=True)])  # fmt: skip
    shares = Table(
        caption="Why the heights are no Gaussian sample: the fourth moment over the square of the variance, with the "
        "waves below an order taken out; mean over the profiles, and what independent phases give.",
        columns=["orders from", "share of the longest wave", "fourth moment", "standard error", "independent phases"],
        rows=[[order, float(power[order].max() / power[order].sum()), *fourth[order], 3 + _excess(power[order])]
              for order in first],
    )  # fmt: skip
    centre, smooth = ((BOUNDS[1:] + BOUNDS[:-1]) / 2).tolist(), np.linspace(BOUNDS[0], BOUNDS[-1], 141)
    figure = drawn("height-distribution",
                   "Distribution of the heights: every profile, their mean with its standard error, the Gaussian.",
                   axes("height $h/h_{rms}$", "density",
                        *scattered([(centre, one) for one in density], centre, density, "profiles"),
                        trace("Gaussian", smooth, np.exp(-(smooth**2) / 2) / np.sqrt(2 * np.pi), hue=1)))  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), tables=(table, shares))


def _excess(power: FloatArray) -> float:
    """Excess kurtosis of independent phases."""
    return float(-1.5 * np.sum(power**2) / np.sum(power) ** 2)


def _fourth_moment(evidence: Evidence, first: int) -> tuple[float, float]:
    """Mean over the profiles, with the waves below an order taken out, and its standard error."""
    moments = []
    for whole in (one.surface for one in evidence.loading):
        kept = whole.orders >= first
        waves = Profile.from_harmonics(whole.period, whole.orders[kept], whole.amplitudes[kept], whole.phases[kept])
        heights = waves.grid[1]
        moments.append(float(np.mean(heights**4) / np.mean(heights**2) ** 2))
    return estimate(moments)
