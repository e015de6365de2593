"""Heights of the generated profiles: the rms height asked for, and how far from Gaussian they are.

Each profile is sampled on a grid that resolves its shortest wave 16 times.  A sum of waves with independent phases has
mean skewness 0 (no skewness but that of triples m1 + m2 = m3, of random sign) and mean excess kurtosis

    <h^4> / h_rms^4 - 3 = -(3/2) sum h_m^4 / (sum h_m^2)^2,

which tends to the Gaussian's 0 only when many waves share the variance.  For H = 0.7 the longest wave has 72 % of it.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5.
"""

from __future__ import annotations

import numpy as np

from validation.case import Outcome
from validation.replicate.evidence import Evidence, joined, mean_and_error
from validation.replicate.members import RMS_HEIGHT
from validation.replicate.statements import disagreement, statement
from validation.schema import Figure, Panel, Reference, Row, Series, Table, Tolerance

BOUNDS = np.linspace(-3.5, 3.5, 36)  # of h_rms


CAUSE = (
    "the longest wave carries 72 % of the variance, so that the profiles are no Gaussian sample; phases are random as "
    "in the paper, and the fourth moment is the one that independent phases give"
)


def compute(evidence: Evidence) -> Outcome:
    """Rows, figure and table."""
    heights = [one.surface.grid[1] / RMS_HEIGHT for one in evidence.loading]
    rms = np.array([[np.sqrt(np.mean(h**2))] for h in heights])
    moments = np.array([[np.mean(h**3), np.mean(h**4) - 3] for h in heights])
    density = np.array([np.histogram(h, BOUNDS, density=True)[0] for h in heights])
    (skewness, excess), (skewness_error, excess_error) = mean_and_error(moments)
    where = "section 5: heights of the generated profiles are Gaussian"
    short = evidence.shortfall
    rows = (
        statement(
            "rms height over the one asked for, every profile", rms[:, 0].tolist(), 0.0, [1.0] * len(rms), 1e-12,
            measured=2e-16, where=where, shortfall=short,
        ),
        statement(
            "skewness of the heights, mean over profiles", float(skewness), float(skewness_error), 0.0, 0.2,
            measured=0.074, where=where, shortfall=short,
        ),
        Row(
            quantity="excess kurtosis of the heights, mean over profiles, against that of independent phases",
            unit="",
            reference=Reference(kind="exact", source="-(3/2) sum h_m^4 / (sum h_m^2)^2"),
            norm="absolute",
            expected=[_excess_of_independent_phases(evidence)],
            computed=[float(excess)],
            uncertainty=float(excess_error),
            tolerance=Tolerance(value=0.25, measured=0.11),
        ),
        disagreement(
            "fourth moment of the heights, mean over profiles, against a Gaussian's 3", float(excess) + 3,
            float(excess_error), 3.0, (0.6, 0.8), CAUSE, where=where, shortfall=short,
        ),
    )  # fmt: skip
    table = Table(
        caption="Profiles of the loading ensemble.",
        columns=["seed", "highest crest / um", "skewness", "excess kurtosis"],
        rows=[
            [one.result.scene["profile"]["seed"], one.surface.max_height * 1e6, float(a), float(b)]
            for one, (a, b) in zip(evidence.loading, moments, strict=True)
        ],
    )
    centre = ((BOUNDS[1:] + BOUNDS[:-1]) / 2).tolist()
    mean, error = mean_and_error(density)
    x, y = joined([(centre, one) for one in density])
    figure = Figure(
        id="height-distribution",
        caption="Distribution of the heights: every profile, their mean with its standard error, the Gaussian.",
        solution=Panel(
            xlabel="height / h_rms",
            ylabel="density",
            series=[
                Series(label="mean and standard error", x=centre, y=(mean - error).tolist(),
                       upper=(mean + error).tolist(), style="band"),
                Series(label="Gaussian", x=centre, y=[float(np.exp(-(c**2) / 2) / np.sqrt(2 * np.pi)) for c in centre]),
                Series(label="profiles", x=x, y=y, style="thin"),
            ],
        ),
    )  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), tables=(table,))


def _excess_of_independent_phases(evidence: Evidence) -> float:
    power = evidence.loading[0].surface.amplitudes ** 2
    return float(-1.5 * np.sum(power**2) / np.sum(power) ** 2)
