"""Loading with a work of adhesion that vanishes, against the same profile without adhesion at the same load.

At every edge K = sqrt(2 E* gamma), which moves it by a length ~ sqrt(gamma) at small gamma: contact without adhesion
is the limit, met as slowly as that.  On the way out there is no such limit with the slope of a straight line, as jumps
remain; the paper's statement is of loading.  Gains of area are means over the loads of `FAINT_AT` and over the seeds;
the exponent is that of the mean gain, fitted to the works of `FITTED`, with the jackknife's error over the seeds.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

from operator import attrgetter

import numpy as np

from validation.harness.case import Outcome
from validation.harness.compare import fitted_order
from validation.harness.figure_data import drawn, loglog, trace
from validation.harness.rows import Against
from validation.harness.schema import Table
from validation.replicate.evidence import Evidence, estimate, jackknife, mean_and_error, scattered
from validation.replicate.members import FAINT_AT, FAINT_WORKS
from validation.replicate.statements import Alternative, unless_short

WORKS = np.array(FAINT_WORKS[1:])  # J/m^2
FITTED = WORKS < 1e-3
JUDGED = 1e-6  # J/m^2
AREA = attrgetter("contact_fraction")


def compute(evidence: Evidence) -> Outcome:
    """Rows, figure and table."""
    if len(evidence.faint) < 2:
        return Outcome(skipped=f"{len(evidence.faint)} profiles with every work of adhesion; 2 at least are needed")
    areas = np.array(
        [[[one.value_at(load, AREA) for load in FAINT_AT] for one in group] for group in evidence.faint]
    )  # (n_seeds, n_works + 1, n_loads)
    gains = np.mean(areas[:, 1:] / areas[:, :1] - 1, axis=2)
    mean, error = mean_and_error(gains)
    fitted = WORKS[FITTED].tolist()
    power, power_error = jackknife(lambda gain: fitted_order(fitted, gain[FITTED].tolist()), gains)
    place, full = FAINT_WORKS.index(JUDGED) - 1, float(mean[-1])
    power_row = Against("exact", "edges move by a length ~ sqrt(gamma)").row(
        f"exponent of the gain of area, {fitted[0]:g} to {fitted[-1]:g} J/m^2", "", 0.5, power,
        (0.012, 0.0041), "absolute", uncertainty=power_error)  # fmt: skip
    rows = (
        evidence.paper("text: with vanishing adhesion, loading tends to that without adhesion").states(
            f"gain of contact area by {JUDGED:g} J/m^2 over that without adhesion, mean of 0.005 to 0.02 E*",
            *estimate(gains[:, place]), 0.0, 0.01, Alternative(full, f"that of {WORKS[-1]:g} J/m^2"), measured=0.0028),
        unless_short(power_row, evidence.shortfall),
    )  # fmt: skip
    table = Table(
        caption="Gain of contact area by adhesion at the same load, mean of 0.005 to 0.02 E*.",
        columns=["gamma / J/m^2", "gain", "standard error", "gain over sqrt(gamma)"],
        rows=np.stack([WORKS, mean, error, mean / np.sqrt(WORKS)], axis=1).tolist(),
    )
    through = float(mean[place]) * np.sqrt(WORKS / JUDGED)
    figure = drawn(
        "vanishing-adhesion",
        "Gain of contact area by adhesion over that without at the same load, against the work of adhesion: every "
        "profile, the mean with its standard error, and the square root.",
        loglog(r"work of adhesion $\gamma$ / J/m$^2$", "gain of contact area",
               *scattered([(WORKS.tolist(), one.tolist()) for one in gains], WORKS.tolist(), gains, "profiles"),
               trace(r"$\sqrt{\gamma}$", WORKS, through, "dashed", hue=1)),
    )  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), tables=(table,))
