"""Heights of the profiles, the deformed shapes of one of them, and the gain of area by faint adhesion.

Heights.  Each profile is sampled on a grid that resolves its shortest wave 16 times.  Over independent uniform phases,
with v_m = h_m^2 / sum h_k^2, the mean fourth moment and the mean square of the third are

    <h^4> / h_rms^4 = 3 - (3/2) sum_m v_m^2,
    <<h^3>^2> / h_rms^6 = (9/2) sum_(m,n) v_m v_n v_(m+n) - (9/4) sum_m v_m^2 v_2m,

since <cos^4> = 3/8, and h^3 has a mean from waves m, n and m + n alone.  For the paper's spectrum: 2.182, and .473^2; a
Gaussian has 3 and 0, which heights reach only when many waves share the variance.

Shapes at s = 86, 48, 38 and 9.6 um: the text of the paper says 38 um where its caption says 48 um.  Seeds 0 and 1 have
crests of 84 and 85 um, below 86 um: they do not touch there.

Faint adhesion.  At every edge K = sqrt(2 E* gamma), which moves it by a length ~ sqrt(gamma) at small gamma: loading
without adhesion is the limit.  On the way out jumps remain; the paper's statement is of loading.  Gains of area are
means over the loads of `FAINT_AT`.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, sections 4 and 5.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from bem.geometry.profile import Profile
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import Figure, Series, drawn, trace
from validation.paper.ensemble import Ensemble, Realisation, estimate, jackknife
from validation.paper.members import FAINT_AT, FAINT_WORKS, SHAPES_AT
from validation.paper.statements import Measured
from validation.references.paper_problem import MODULUS, RMS_HEIGHT

MOST_POINTS = 2400  # of a curve in a figure


def measured(ensemble: Ensemble) -> dict[str, Measured]:
    """Return our numbers of heights and of faint adhesion."""
    numbers = of_heights([member.profile for member in ensemble.loading])
    groups = [group for work in FAINT_WORKS if (group := ensemble.whole(f"faint {work:g}"))]
    if len(groups) == len(FAINT_WORKS):
        areas = [
            [[member.value_at(load, lambda state: state.contact_fraction) for load in FAINT_AT] for member in group]
            for group in groups
        ]
        numbers["gain by faint adhesion"] = of_faint_adhesion(np.array(areas))
    return numbers


def of_faint_adhesion(areas: FloatArray) -> Measured:
    """Return the gain by faint adhesion from areas (n_works, n_seeds, n_loads); the gain by the paper's is excluded."""
    gains = np.mean(areas[1:] / areas[0] - 1, axis=2)
    return Measured(*estimate(gains[0]), excluded=float(gains[1].mean()))


def of_heights(profiles: Sequence[Profile]) -> dict[str, Measured]:
    """Return third and fourth moment of the heights of profiles that share a spectrum, beside the expected numbers."""
    heights = [profile.grid[1] / RMS_HEIGHT for profile in profiles]
    third, fourth = expected_moments(profiles[0].amplitudes)
    squares = np.array([[np.mean(h**3) ** 2] for h in heights])
    note = "expected of random phases and this spectrum: {:.3f}"
    return {
        "skewness": Measured(*jackknife(lambda mean: float(np.sqrt(mean[0])), squares), note=note.format(third)),
        "fourth moment": Measured(*estimate([np.mean(h**4) for h in heights]), note=note.format(fourth)),
    }


def expected_moments(amplitudes: FloatArray) -> tuple[float, float]:
    """Return rms skewness and mean fourth moment over random phases (formulas of the module).

    Examples
    --------
    >>> tuple(round(moment, 12) for moment in expected_moments(np.array([1.0])))
    (0.0, 1.5)
    """
    share = amplitudes**2 / np.sum(amplitudes**2)
    twice = share[1::2] @ share[: share.size // 2] ** 2
    triples = share[1:] @ np.convolve(share, share)[: share.size - 1]
    return float(np.sqrt(4.5 * triples - 2.25 * twice)), float(3 - 1.5 * share @ share)


def figures(ensemble: Ensemble) -> Iterator[Figure]:
    """Yield the deformed shapes."""
    shapes = ensemble.whole("shapes")
    if shapes is not None:
        yield _shapes(*shapes)


def _shapes(member: Realisation) -> Figure:
    """Draw all shapes over the period, in one frame."""
    series: list[Series] = []
    for k, separation in enumerate(SHAPES_AT):
        x, solid, profile = _about_highest_crest(member, k)
        if not series:
            series.append(trace("rigid profile", x, (profile + separation) * 1e6, "thin"))
        state = member.result.targets[k]
        place = f"s = {separation * 1e6:g} µm, p = {state.mean_pressure / MODULUS:.3g} E*, "
        series.append(trace(f"{place}A/A0 = {state.contact_fraction:.3g}", x, (solid + separation) * 1e6, hue=k))
    return drawn(
        "shapes",
        "Deformed shapes above one profile at the separations of the paper, in one frame; its caption has 48 µm where "
        f"its text has 38 µm. The profile is ours: seed {member.result.scene['profile']['seed']}, highest crest at "
        f"{member.profile.max_height * 1e6:.1f} µm.",
        "distance from the highest crest / mm",
        "height / µm",
        *series,
    )


def _about_highest_crest(member: Realisation, k: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return places from the highest crest in mm, solid and profile in m, at target k."""
    fields, period = member.result.fields, member.profile.period
    crests, heights = member.profile.crests
    place = (fields[f"x_{k}"] - crests[np.argmax(heights)] + period / 2) % period - period / 2
    order = np.argsort(place)[:: max(1, place.size // MOST_POINTS)]
    solid = fields[f"displacement_{k}"][order]
    return place[order] * 1e3, solid, solid - fields[f"gap_{k}"][order]
