"""Magnitudes of a scene, relative to the scales of its profile, that exceed double precision or memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bem.geometry.profile import Profile
from bem.geometry.ranges import Mistake, as_said
from bem.geometry.scaling import Solid

THICKNESSES = (6e-5, 1e12)  # limit: layer.thickness over the period: an audit takes 65,536 modes; half-space
MOST_TARGET_HARMONICS = 1e9  # limit: targets times harmonics: weeks on one core
LARGEST_SHARE = 1e50  # derived: of lengths, pressures and energies to the scales of the profile, or its inverse


def magnitude_mistakes(tables: Mapping[str, Any], profile: Profile) -> Iterator[Mistake]:
    """Yield keys whose magnitudes, relative to the scales of the profile, exceed double precision or memory.

    scaling.py defines the scales; a flat profile has none.
    """
    largest = float(np.max(np.abs(profile.amplitudes)))
    period = profile.period
    layer, adhesion, loading = (tables.get(name) for name in ("layer", "adhesion", "loading"))
    lowest, highest = (as_said(share * period) for share in THICKNESSES)
    if layer is not None and not lowest <= layer["thickness"] <= highest:
        allowed = f"a number from {lowest:g} to {highest:g} (m), {THICKNESSES[0]:g} to {THICKNESSES[1]:g} periods"
        yield Mistake("layer.thickness", f"= {layer['thickness']!r}", f"{allowed}: thinner ones cannot be audited")
    if largest == 0:
        return
    if not LARGEST_SHARE**-1 <= largest / period <= LARGEST_SHARE:
        name = "rms_height" if "rms_height" in tables.get("profile", ()) else "amplitudes"
        allowed = f"from {1 / LARGEST_SHARE:g} to {LARGEST_SHARE:g} periods"
        yield Mistake(f"profile.{name}", f"reach {largest / period:.2g} periods", allowed)
        return
    modulus = Solid(**tables["solid"]).plane_strain_modulus
    scale = modulus * largest**2 / period
    if adhesion is not None:
        share = adhesion["work_of_adhesion"] / scale
        if not LARGEST_SHARE**-1 <= share <= LARGEST_SHARE:
            allowed = f"from {1 / LARGEST_SHARE:g} to {LARGEST_SHARE:g} times E* h^2 / period = {scale:g} J/m^2"
            yield Mistake("adhesion.work_of_adhesion", f"= {adhesion['work_of_adhesion']:g}", allowed)
    if loading is None:
        return
    count, order = len(loading["targets"]), profile.max_order
    if count * order > MOST_TARGET_HARMONICS:
        allowed = f"{MOST_TARGET_HARMONICS / order:.0f} with {order} harmonics: more take weeks"
        yield Mistake("loading.targets", f"are {count}", allowed)
        return
    pressed = loading["control"] == "mean_pressure"
    unit = modulus * largest / period if pressed else largest
    for k, target in enumerate(loading["targets"]):
        if not abs(target) <= LARGEST_SHARE * unit:
            name = "E* h / period" if pressed else "the largest amplitude"
            yield Mistake(f"loading.targets[{k}]", f"= {target:g}", f"at most {LARGEST_SHARE:g} times {name}, {unit:g}")
