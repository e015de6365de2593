"""Two crests whose patches merge across the end of the period, against the closed form of one patch.

The closed form is that of one_patch.py.  Here h = A (cos y - b cos 2y), b > 1/4: two crests with a shallow dip at y = 0
between them, and a deep valley behind.  The period begins in the dip or in the valley; the closed form knows nothing of
it, nor of the path.  SI units.
Limits: symmetric profiles, one patch; where patches merge is the solver's own.
"""

from itertools import chain

import numpy as np
from scipy.optimize import brentq

from validation.cases.shared.checks import Against, case, column, solved, work
from validation.harness.case import Outcome
from validation.harness.figure_data import axes, drawn, trace
from validation.references.one_patch import OnePatch

PERIOD, AMPLITUDE, SECOND = 0.01, 1e-4, 0.5
PATCH = OnePatch(PERIOD, 1e6 / (1 - 0.5**2), (AMPLITUDE, -SECOND * AMPLITUDE), 0.003)  # of the scene merged_crests
BEFORE, MERGED = 3, (1e4, 2e4, 4e4)  # loads before the coalescence, and mean pressures in Pa behind it
DIPS = {0.0: ("dip across the end of the period", "dots"), 0.5: ("dip in the middle of the period", "points")}


def _off_dip(x: float | None, dip: float) -> float | None:
    """Distance from the middle of the dip, over the period, to the nearest image."""
    if x is None:
        return None
    distance = x / PERIOD - dip
    return distance - round(distance)


def _at(load: float) -> float:
    """Contact fraction of one patch at a mean pressure in Pa."""
    return float(brentq(lambda f: float(PATCH.mean_pressure(np.pi * f)) - load, 0.4, 0.9, xtol=1e-15))


def _merged_crests() -> Outcome:
    shifts = {dip: 2 * np.pi * dip for dip in DIPS}
    results = {dip: solved("merged_crests", profile={"phases": [-shift, np.pi - 2 * shift]})
               for dip, shift in shifts.items()}  # fmt: skip
    exact = [_at(load) for load in MERGED]
    fractions = [column(result.targets, "contact_fraction") for result in results.values()]
    kinds = [column(result.events, "kind") for result in results.values()]
    merged = {dip: [event.position for event in result.events if event.kind == "coalescence"]
              for dip, result in results.items()}  # fmt: skip
    middles = [_off_dip(sum(state.edges[0]) / 2 if state.n_patches == 1 else None, dip)
               for dip, result in results.items() for state in result.targets[BEFORE:]]  # fmt: skip
    places = [_off_dip(met[0] if met else None, dip) for dip, met in merged.items()]
    symmetry = Against("exact", "symmetry about the dip")
    crests = Against("exact", "two crests, which merge between the third and the fourth load")
    # errors measured: the largest over a work of adhesion of 0.002 to 0.004 and a second harmonic of 0.45 and 0.5
    rows = (
        Against("exact", "closed form of one patch").row(
            "contact fraction behind the coalescence", "", exact * 2, [*fractions[0][BEFORE:], *fractions[1][BEFORE:]],
            2.8e-14),
        Against("self", "the same surface shifted by half a period").row(
            "contact fraction before the coalescence", "", fractions[1][:BEFORE], fractions[0][:BEFORE], 2.9e-14),
        symmetry.row("middle of the contact from the dip, over the period", "", [0.0] * len(middles), middles, 6.6e-14,
                     "absolute"),
        # a fold is located to rounding of its neutral mode: the largest of three processors
        symmetry.row("place of the coalescence from the dip, over the period", "", [0.0] * 2, places, 3e-13,
                     "absolute"),
        crests.count("patches", [2.0, 2.0, 2.0, 1.0, 1.0, 1.0] * 2,
                     chain.from_iterable(column(result.targets, "n_patches") for result in results.values())),
        crests.count("coalescences", [1.0] * 2, map(len, merged.values())),
        crests.count("first touches, and events of all kinds", [2.0, 3.0] * 2,
                     chain.from_iterable((met.count("first_touch"), len(met)) for met in kinds)),
    )  # fmt: skip
    curve = np.linspace(exact[0] - 0.05, exact[-1] + 0.05, 100)
    figure = drawn(
        "merged-crests",
        "Contact fraction against mean pressure: two patches merge, behind that the closed form of one holds.",
        axes("mean pressure / kPa", "contact fraction",
             trace("closed form of one patch", PATCH.mean_pressure(np.pi * curve) / 1e3, curve),
             *(trace(label, column(result.targets, "mean_pressure", 1e3), found, style)
               for (label, style), result, found in zip(DIPS.values(), results.values(), fractions, strict=True))),
        axes("mean pressure / kPa", "signed error of the contact fraction",
             *(trace(label, [p / 1e3 for p in MERGED], np.subtract(found[BEFORE:], exact), style)
               for (label, style), found in zip(DIPS.values(), fractions, strict=True))),
    )  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), counts=work("evaluations states", *results.values()))


CASES = (
    case("merged-crests", "closed forms", _merged_crests,
         "Do two patches that merge across the end of the period become the one patch of the closed form?",
         r"$p = Q(y) / \sqrt{(\cos y - \cos a) / 2}$, $Q(a) = -\sqrt{E^\ast w q \sin a / (2 \pi)}$, "
         r"mean pressure $= \sum_k c_k L_k(\cos a)$",
         "westergaard1939 johnson1995 muskhelishvili1953", "half_space adhesion", scene="merged_crests"),
)  # fmt: skip
