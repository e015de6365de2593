"""Loading with a work of adhesion that vanishes, against the same profile without adhesion at the same load.

At every edge K = sqrt(2 E* gamma), which moves it by a length ~ sqrt(gamma) at small gamma: contact without adhesion
is the limit, met as slowly as that.  On the way out there is no such limit with the slope of a straight line, as jumps
remain; the paper's statement is of loading.  Gains of area are means over the loads of `FAINT_AT` and over the seeds;
the exponent is that of the mean gain, fitted to the works of `FITTED`, with the jackknife's error over the seeds.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

from operator import attrgetter

import numpy as np

from validation.harness.figure_data import drawn, loglog, trace
from validation.paper.evidence import Evidence, estimate, jackknife, scattered
from validation.paper.members import FAINT_AT, FAINT_WORKS
from validation.paper.statements import Check, Topic

WORKS = np.array(FAINT_WORKS[1:])  # J/m^2
FITTED = WORKS < 1e-3
JUDGED = 1e-6  # J/m^2
AREA = attrgetter("contact_fraction")


def compute(evidence: Evidence) -> Topic:
    """Return statement, check and figure."""
    question = "Does loading with vanishing adhesion tend to loading without?"
    if len(evidence.faint) < 2:
        return Topic(question, message=f"{len(evidence.faint)} profiles with every work of adhesion; 2 are needed")
    areas = np.array(
        [[[realisation.value_at(load, AREA) for load in FAINT_AT] for realisation in group] for group in evidence.faint]
    )  # (n_seeds, n_works + 1, n_loads)
    gains = np.mean(areas[:, 1:] / areas[:, :1] - 1, axis=2)
    mean = gains.mean(axis=0)
    fitted = WORKS[FITTED].tolist()
    power, power_error = jackknife(lambda gain: float(np.polyfit(np.log(fitted), np.log(gain[FITTED]), 1)[0]), gains)
    place, full = FAINT_WORKS.index(JUDGED) - 1, float(mean[-1])
    statement = evidence.statement(
        "text: with vanishing adhesion, loading tends to that without adhesion",
        f"gain of contact area by {JUDGED:g} J/m^2 over that without adhesion, mean of 0.005 to 0.02 E*",
        estimate(gains[:, place]),
        0.0,
        0.01,
        full,
        f"excluded: the gain of {WORKS[-1]:g} J/m^2",
    )
    check = Check(
        f"exponent of the gain of area, {fitted[0]:g} to {fitted[-1]:g} J/m^2: edges move by ~ sqrt(gamma)",
        power,
        0.5,
        max(0.012, 2 * power_error),
    )
    through = float(mean[place]) * np.sqrt(WORKS / JUDGED)
    figure = drawn(
        "vanishing-adhesion",
        "Gain of contact area by adhesion over that without at the same load, against the work of adhesion: every "
        "profile, the mean with its standard error, and the square root.",
        loglog(
            r"work of adhesion $\gamma$ / J/m$^2$",
            "gain of contact area",
            *scattered([(WORKS.tolist(), gain.tolist()) for gain in gains], WORKS.tolist(), gains, "profiles"),
            trace(r"$\sqrt{\gamma}$", WORKS, through, "dashed", hue=1),
        ),
    )
    return Topic(question, (statement,), () if evidence.shortfall else (check,), (figure,))
