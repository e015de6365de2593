"""Adhesion at the contact edges: work of adhesion per length of profile, with or without the slope term.

An edge at x is in equilibrium when its energy release rate equals w(x) = gamma sqrt(1 + h'(x)^2) (slope term: the
adhesive energy is counted on the true length of the profile, Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30
(2009) 65) or w = gamma (JKR on the projected length), i.e. K = sqrt(2 E* w), and U_ad = - int_contact w dx.
The true length of the profile is integrated once, on panels, to rounding at any slope.

`Adhesion` is in SI; the laws are dimensionless: w in units of E* a^2 q0 / 2, K = 2 sqrt(w), slopes h' times q0 a.
Imported only when a scene has an [adhesion] table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile
from bem.geometry.scaling import Scales
from bem.geometry.table import limits, table
from bem.kernels.heights import integral

NODES = 16  # speed: of a panel on which sqrt(1 + h'^2) is a Chebyshev series
UNRESOLVED = 1e-15  # derived: rounding of the last coefficients of a panel, over its largest value and part of 2 pi
MAXIMUM_HALVINGS = np.finfo(float).nmant - 6  # of a panel, which then has a few digits left


@table("adhesion")
class Adhesion:
    """Adhesion of an interface.

    Parameters
    ----------
    work_of_adhesion : float
        Energy of separating a unit of area, J/m^2, > 0.
    slope_term : bool
        True: the energy counts on the true length of the profile; False: on its projection.
    """

    work_of_adhesion: Annotated[float, limits("adhesion.work_of_adhesion")]
    slope_term: bool = False


@dataclass(frozen=True, eq=False)
class UniformLaw:
    """Equal work of adhesion everywhere, dimensionless."""

    work: float

    @property
    def least_work(self) -> float:
        """gamma: w where the profile has no slope, as on its crests; no shift of the profile changes it."""
        return self.work

    def work_of_adhesion(self, x: FloatArray) -> FloatArray:
        """Return w at the positions x, shape of x."""
        return np.full(x.shape, self.work)

    def work_and_gradient(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return w and dw/dx at the positions x, shape of x."""
        return np.full(x.shape, self.work), np.zeros(x.shape)

    def work_curvature(self, x: FloatArray) -> FloatArray:
        """Return d2w/dx2 at the positions x, shape of x."""
        return np.zeros(x.shape)

    def energy(self, patches: Patches) -> float:
        """Return U_ad = -int w dx over the patches."""
        return -self.work * float(np.sum(patches.width))


@dataclass(frozen=True, eq=False)
class TrueLength:
    """int_0^x sqrt(1 + h'^2) dx as a Chebyshev series on each of the panels that fill the circle, dimensionless.

    Parameters
    ----------
    start : (P,) array
        Left ends of the panels, ascending from 0.
    width : (P,) array
    series : (P, n) array
        Chebyshev coefficients of the integral.
    whole : float
        Integral over the circle.
    """

    start: FloatArray
    width: FloatArray
    series: FloatArray
    whole: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return int_0^x sqrt(1 + h'^2) dx at the positions x on the line, (n,)."""
        return integral(self.start, self.width, self.series, self.whole, x)


def true_length(profile: Profile, slope_scale: float) -> TrueLength:
    """Integrate sqrt(1 + (slope_scale h')^2); halve panels until their series have decayed.

    Where slopes are steep the integrand has kinks of the width 1 / (slope_scale h'') at crests and troughs.
    """
    count = profile.max_order
    start, width = np.arange(count) * (TWO_PI / count), np.full(count, TWO_PI / count)
    panels: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    for halvings in range(MAXIMUM_HALVINGS):
        x = start[:, None] + width[:, None] * (1 + chebyshev.basis_nodes(NODES)) / 2
        series = chebyshev.coefficients(np.hypot(1.0, slope_scale * profile.slope(x)))
        last = np.abs(series[:, -2:]).max(axis=1)
        done = last * width <= UNRESOLVED * TWO_PI * np.abs(series[:, 0])
        if halvings == MAXIMUM_HALVINGS - 1:
            done[:] = True
        panels.append((start[done], width[done], series[done]))
        half = width[~done] / 2
        start, width = np.concatenate([start[~done], start[~done] + half]), np.concatenate([half, half])
        if start.size == 0:
            break
    start, width, series = (np.concatenate(parts) for parts in zip(*panels, strict=True))
    order = np.argsort(start)
    start, width, series = start[order], width[order], series[order]
    summed = np.ascontiguousarray(np.polynomial.chebyshev.chebint(series, lbnd=-1, axis=1) * (width / 2)[:, None])
    pieces = summed.sum(axis=1)
    summed[:, 0] += np.cumsum(pieces) - pieces
    return TrueLength(np.asarray(start, dtype=np.float64), width, summed, float(pieces.sum()))


@dataclass(frozen=True, eq=False)
class SlopeLaw(UniformLaw):
    """Work of adhesion on the true length of the profile, w = gamma sqrt(1 + h'^2), dimensionless.

    Parameters
    ----------
    work : float
        gamma.
    profile : Profile
        Dimensionless.
    slope_scale : float
        True slope per dimensionless slope, q0 a.
    length : TrueLength
        int sqrt(1 + h'^2) dx.
    """

    profile: Profile
    slope_scale: float
    length: TrueLength

    def work_of_adhesion(self, x: FloatArray) -> FloatArray:
        """Return w at the positions x, shape of x."""
        return np.asarray(self.work * np.hypot(1.0, self.slope_scale * self.profile.slope(x)))

    def work_and_gradient(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return w and dw/dx at the positions x, shape of x."""
        _, slope, curvature = self.profile.height_slope_curvature(x)
        stretch = np.hypot(1.0, self.slope_scale * slope)
        return self.work * stretch, self.work * self.slope_scale**2 * slope * curvature / stretch

    def work_curvature(self, x: FloatArray) -> FloatArray:
        """Return d2w/dx2 at the positions x, shape of x."""
        _, slope, curvature, third = self.profile.derivatives(x)
        stretch = np.hypot(1.0, self.slope_scale * slope)
        bent = curvature**2 / stretch**2 + slope * third
        return np.asarray(self.work * self.slope_scale**2 * bent / stretch)

    def energy(self, patches: Patches) -> float:
        """Return U_ad = -int w dx over the patches."""
        ends = self.length(np.concatenate([patches.left, patches.right]))
        return -self.work * float((ends[patches.count :] - ends[: patches.count]).sum())


def dimensionless_law(adhesion: Adhesion, profile: Profile, scales: Scales) -> UniformLaw:
    """Return the law of an interface in the units of the solver.

    Parameters
    ----------
    adhesion : Adhesion
        SI.
    profile : Profile
        Dimensionless.
    scales : Scales
        Units of the dimensionless problem.
    """
    work = adhesion.work_of_adhesion / scales.release_rate
    if not adhesion.slope_term:
        return UniformLaw(work)
    return SlopeLaw(work, profile, scales.slope, true_length(profile, scales.slope))
