"""Patches that vanish and gaps that close while edges move: criteria, and the patches that remain.

A gap goes where both its edges advance and it is narrow against the shortest wavelength and against the widest gap; a
patch where both its edges recede and it is narrow against an isolated contact at pull-off.  What is as narrow to within
`TIED` goes with it, so that symmetric states stay symmetric.  Dimensionless.
Source: Barquins, J. Adhesion 26 (1988) 1, for the width at which an isolated contact pulls off.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.equilibrium import Balance, System
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import SHUT_GAP, Patches

ABOUT_TO_GO = 0.02  # of the shortest wave, for a gap; of the width at which an isolated contact pulls off, for a patch
LAST_GAP = 2e-4  # of the period: the only gap left, when it closes
TIED = 1e-3  # relative difference of what vanishes or touches at the same instant


class Change(NamedTuple):
    """Patch or gap that vanished in a descent."""

    kind: Literal["coalescence", "detachment", "complete_contact"]
    position: float


Remaining = tuple[tuple[Change, ...], Patches | None]


def closing_gaps(system: System, forces: Balance) -> IntArray:
    """Return the indices of the gaps about to close, by the patches before them, ascending.

    At fixed penetration the mean gap is fixed too, and the last gap stays.
    """
    gaps = forces.state.patches.gap_after
    wavelength = 2 * np.pi / system.elastic.profile.max_order
    narrow = min(ABOUT_TO_GO * wavelength, max(0.05 * float(gaps.max()), LAST_GAP * 2 * np.pi))
    closing = np.flatnonzero(gaps < max(narrow, SHUT_GAP * 2 * np.pi))
    if closing.size == 0:
        return closing
    closing = closing[pulled_shut(forces)[closing] | (gaps[closing] < SHUT_GAP * 2 * np.pi)]
    closing = closing[gaps[closing] <= (1 + TIED) * gaps[closing].min(initial=np.inf)]
    stays = closing.size == gaps.size and system.control.load_weight == 0
    return np.asarray(closing[:0] if stays else closing)


def without_gaps(patches: Patches, closing: IntArray) -> Remaining:
    """Close gaps; return the changes and the patches that remain, None if contact is complete."""
    positions = patches.right[closing] + patches.gap_after[closing] / 2
    if closing.size == patches.count:
        return tuple(Change("complete_contact", float(x)) for x in positions), None
    remaining = patches
    for x in positions:
        distance = np.abs((remaining.right + remaining.gap_after / 2 - x + np.pi) % (2 * np.pi) - np.pi)
        remaining = remaining.merged_after(int(np.argmin(distance)))
    return tuple(Change("coalescence", float(x)) for x in positions), remaining


def vanishing_patches(system: System, forces: Balance) -> IntArray:
    """Return the indices of the patches about to vanish, ascending."""
    patches, inward = forces.state.patches, forces.gradient > 0
    count, widest = patches.count, ABOUT_TO_GO / system.elastic.profile.max_order  # at pull-off
    narrow = np.flatnonzero(patches.half_width < widest)
    if not np.any(inward[narrow] & inward[count + narrow]):
        return narrow[:0]
    shrinking = np.flatnonzero(inward[:count] & inward[count:])
    relative = patches.half_width[shrinking] / pull_off_half_width(system, patches.center[shrinking])
    return np.asarray(shrinking[(relative <= (1 + TIED) * relative.min()) & (relative.min() < ABOUT_TO_GO)])


def without_patches(patches: Patches, gone: IntArray) -> Remaining:
    """Remove patches; return the changes and the patches that remain, None if the surfaces are apart."""
    changes = tuple(Change("detachment", float(x)) for x in patches.center[gone])
    if gone.size == patches.count:
        return changes, None
    return changes, Patches(np.delete(patches.left, gone), np.delete(patches.right, gone))


def pull_off_half_width(system: System, x: FloatArray) -> FloatArray:
    """Return the half width (2 w R^2 / (pi E*))^(1/3) of an isolated JKR line contact at pull-off, (n,), dimensionless.

    R is the radius of curvature at each position, at most the radius of the rms curvature of the profile.  A crest is
    no parabola beyond a fraction of the shortest wave, which bounds the width where adhesion is strong.
    Source: Barquins, J. Adhesion 26 (1988) 1.
    """
    profile = system.elastic.profile
    curvature = np.maximum(-profile.curvature(x), profile.rms_curvature)
    half_width = np.cbrt(system.law.work_of_adhesion(x) / (np.pi * curvature**2))
    return np.asarray(np.minimum(half_width, 1 / profile.max_order))


def pulled_shut(forces: Balance) -> NDArray[np.bool_]:
    """Return whether adhesion wins over the stiffness at both ends of the gap behind each patch, (L,)."""
    count = forces.state.patches.count
    outward = (forces.gradient <= 0) | (forces.state.stress_intensity <= 0)
    return np.asarray(outward[count:] & np.append(outward[1:count], outward[0]))
