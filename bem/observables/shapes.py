"""Shapes of a state: displacement, gap, pressure and patch on a grid that resolves edges and wavelengths.

Every patch and every gap has points of its own, clustered at its ends as x = a + w (1 - cos theta)/2 with equidistant
theta, where displacement and gap are smooth functions of theta although they leave an edge like a square root, and so
is sigma sin(theta) although sigma is singular.  No point lies on an edge.  In contact the displacement follows the
profile, u = h - h_max + Delta; in gaps it is the integral of the pressure (displacement.py).

Dimensionless (scaling.py), displacements mean-free.  Limits: 16 points per shortest wavelength in the middle of a
patch or gap, at least 24 on each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import dct

from bem.audit.displacement import ComplianceRatio
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile
from bem.observables.gaps import clustered, contact_shape, open_gaps, points_on, uniform

OUTSIDE = -1  # format: mark of points outside contact


@dataclass(frozen=True, eq=False)
class Shape:
    """Fields along the period, dimensionless; all (n_points,)."""

    x: FloatArray  # positions in [0, 2 pi), increasing
    displacement: FloatArray  # mean-free interface displacement u
    gap: FloatArray  # u - (h - h_max + Delta), zero in contact
    pressure: FloatArray  # sigma, nan outside contact
    patch: IntArray  # index of the patch, -1 outside contact


def shape(
    profile: Profile, pressure: PatchPressure, penetration: float, compliance_ratio: ComplianceRatio | None = None
) -> Shape:
    """Return the fields of a dimensionless state with patches and gaps.

    `compliance_ratio` is the compliance of a layer over the compliance of the half-space for orders m >= 1, (n,) to
    (n,). ValueError without a patch: use `separated_shape` or `complete_contact_shape`.
    """
    if pressure.left.size == 0:
        raise ValueError("pressure: without patches use separated_shape or complete_contact_shape")
    width = pressure.right - pressure.left
    patch_count = points_on(width, profile)
    patch = np.repeat(np.arange(patch_count.size), patch_count)
    inner_x = pressure.left[patch] + clustered(width, patch_count)
    gaps = open_gaps(profile, pressure, penetration, compliance_ratio)
    outer_x, outer = gaps.x, gaps.displacement

    inner = contact_shape(profile, inner_x, penetration)
    sigma = np.concatenate(
        [
            _pressure_at_midpoints(charge, n) / r
            for charge, n, r in zip(pressure.charges, patch_count, width / 2, strict=True)
        ]
    )
    x = np.concatenate([inner_x, outer_x]) % (2 * np.pi)
    order = np.argsort(x, kind="stable")
    return Shape(
        x=x[order],
        displacement=np.concatenate([inner, outer])[order],
        gap=np.concatenate([np.zeros(inner.size), gaps.height])[order],
        pressure=np.concatenate([sigma, np.full(outer.size, np.nan)])[order],
        patch=np.concatenate([patch, np.full(outer.size, OUTSIDE)])[order],
    )


def separated_shape(profile: Profile, penetration: float) -> Shape:
    """Return the fields of surfaces apart, on a uniform grid: no displacement, no pressure."""
    x = uniform(profile)
    return Shape(
        x=x,
        displacement=np.zeros(x.size),
        gap=-contact_shape(profile, x, penetration),
        pressure=np.full(x.size, np.nan),
        patch=np.full(x.size, OUTSIDE),
    )


def complete_contact_shape(profile: Profile, pressure: Profile, mean_pressure: float) -> Shape:
    """Return the fields of complete contact, on a uniform grid.

    The displacement is u = h; the pressure is sigma_0 + its zero-mean part `pressure`.
    """
    x = uniform(profile)
    return Shape(
        x=x,
        displacement=profile.height(x),
        gap=np.zeros(x.size),
        pressure=mean_pressure + pressure.height(x),
        patch=np.zeros(x.size, dtype=np.int64),
    )


def _pressure_at_midpoints(charge: FloatArray, n: int) -> FloatArray:
    """Return r sigma at t = -cos(theta), theta = (k + 1/2) pi / n, (n,)."""
    factor = -(-charge.size // n)
    factor += 1 - factor % 2  # an odd multiple of n has the points among its own
    padded = np.zeros(n * factor)
    padded[: charge.size] = charge / 2
    padded[0] = charge[0]
    q: FloatArray = dct(padded, type=3)[factor // 2 :: factor][::-1]
    return np.asarray(q / np.sin((np.arange(n) + 0.5) * np.pi / n))
