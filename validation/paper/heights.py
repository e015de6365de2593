"""Heights of the generated profiles: the rms height asked for, and how far from Gaussian they are.

Each profile is sampled on a grid that resolves its shortest wave 16 times.  A sum of waves with independent phases has
mean skewness 0 (no skewness but that of triples m1 + m2 = m3, of random sign) and mean excess kurtosis

    <h^4> / h_rms^4 - 3 = -(3/2) sum h_m^4 / (sum h_m^2)^2,

which tends to the Gaussian's 0 only when many waves share the variance.  For H = 0.7 the longest wave has 72 % of it.
Where the long waves are taken out, more waves share the rest, and the fourth moment tends to the Gaussian's 3.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 4.
"""

import numpy as np

from bem.geometry.profile import Profile
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, trace
from validation.paper.evidence import Evidence, estimate, mean_and_error, scattered
from validation.paper.statements import Check, Topic
from validation.references.paper_problem import RMS_HEIGHT

BOUNDS = np.linspace(-3.5, 3.5, 36)  # of h_rms
WITHOUT = 32  # longest wave of the profiles whose fourth moment is that of a Gaussian

CAUSE = (
    "the longest wave carries 72 % of the variance, so that the profiles are no Gaussian sample; phases are random as "
    "in the paper, the fourth moment is the one that independent phases give, and without the long waves it tends to "
    "3; the mean density over the profiles looks Gaussian all the same"
)


def compute(evidence: Evidence) -> Topic:
    """Return statements, checks and figure."""
    heights = [realisation.surface.grid[1] / RMS_HEIGHT for realisation in evidence.loading]
    rms = [float(np.sqrt(np.mean(h**2))) for h in heights]
    moments = np.array([[np.mean(h**3), np.mean(h**4) - 3] for h in heights])
    density = np.array([np.histogram(h, BOUNDS, density=True)[0] for h in heights])
    (skewness, excess), (skewness_error, excess_error) = (map(float, both) for both in mean_and_error(moments))
    shared = evidence.loading[0].surface
    first = min(WITHOUT, 2 ** int(np.log2(evidence.size.harmonics / 2 - 1)))
    fourth, fourth_error = _fourth_moment(evidence, first)
    where = "section 4: heights of the generated profiles are Gaussian"
    statements = (
        evidence.statement(
            where, "skewness of the heights, mean over profiles", (skewness, skewness_error), 0.0, 0.2, 1.0
        ),
        evidence.statement(
            where,
            "fourth moment of the heights, mean over profiles, against a Gaussian's 3",
            (excess + 3, excess_error),
            3.0,
            0.3,
            None,
            CAUSE,
        ),
    )
    checks = (
        Check("largest rms height over the one asked for", max(rms), 1.0, 1e-12),
        Check(
            "excess kurtosis, mean over profiles, against -(3/2) sum h_m^4 / (sum h_m^2)^2 of independent phases",
            excess,
            _excess(shared.amplitudes**2),
            max(0.25, 2 * excess_error),
        ),
        Check(
            f"fourth moment without the waves longer than order {first}, against a Gaussian's 3",
            fourth,
            3.0,
            max(0.17, 2 * fourth_error),
        ),
    )
    centre, smooth = ((BOUNDS[1:] + BOUNDS[:-1]) / 2).tolist(), np.linspace(BOUNDS[0], BOUNDS[-1], 141)
    figure = drawn(
        "height-distribution",
        "Distribution of the heights: every profile, their mean with its standard error, the Gaussian.",
        axes(
            "height $h/h_{rms}$",
            "density",
            *scattered([(centre, profile) for profile in density], centre, density, "profiles"),
            trace("Gaussian", smooth, np.exp(-(smooth**2) / 2) / np.sqrt(2 * np.pi), hue=1),
        ),
    )
    return Topic("Are the heights of the profiles Gaussian?", statements, checks, (figure,))


def _excess(power: FloatArray) -> float:
    """Return the excess kurtosis of independent phases."""
    return float(-1.5 * np.sum(power**2) / np.sum(power) ** 2)


def _fourth_moment(evidence: Evidence, first: int) -> tuple[float, float]:
    """Return the mean fourth moment of the profiles without the waves below an order, and its standard error."""
    moments = []
    for whole in (realisation.surface for realisation in evidence.loading):
        short = whole.orders >= first
        waves = Profile.from_harmonics(whole.period, whole.orders[short], whole.amplitudes[short], whole.phases[short])
        heights = waves.grid[1]
        moments.append(float(np.mean(heights**4) / np.mean(heights**2) ** 2))
    return estimate(moments)
