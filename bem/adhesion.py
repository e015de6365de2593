"""Adhesion at the contact edges: work of adhesion per length of profile, with or without the slope term.

An edge at x is in equilibrium when its energy release rate equals w(x) = gamma sqrt(1 + h'(x)^2) (slope term: the
adhesive energy is counted on the true length of the profile, Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30
(2009) 65) or w = gamma (JKR on the projected length), i.e. K = sqrt(2 E* w), and U_ad = - int_contact w dx.

`Adhesion` is in SI; the laws are dimensionless: w in units of E* a^2 q0 / 2, K = 2 sqrt(w), slopes h' times q0 a.
Imported only when a scene has an [adhesion] table.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem.patches import Patches
from bem.profile import Profile
from bem.scaling import Scales

FloatArray = NDArray[np.float64]

_POINTS_PER_WAVELENGTH = 64


@dataclass(frozen=True)
class Adhesion:
    """Adhesion of an interface.

    Parameters
    ----------
    work_of_adhesion : float
        gamma in J/m^2, > 0.
    slope_term : bool
        Whether the adhesive energy is counted on the true length of the profile.
    """

    work_of_adhesion: float
    slope_term: bool = False

    def __post_init__(self) -> None:
        if not (self.work_of_adhesion > 0 and np.isfinite(self.work_of_adhesion)):
            raise ValueError(f"work_of_adhesion: {self.work_of_adhesion} must be finite and > 0 (J/m^2)")


@dataclass(frozen=True, eq=False)
class UniformLaw:
    """Equal work of adhesion everywhere, dimensionless.

    Examples
    --------
    >>> float(UniformLaw(0.25).critical_stress_intensity(np.zeros(1))[0])
    1.0
    """

    work: float

    @property
    def least_work(self) -> float:
        """gamma: w where the profile has no slope, as on its crests; no shift of the profile changes it."""
        return self.work

    def work_of_adhesion(self, x: FloatArray) -> FloatArray:
        """w at the positions x, same shape."""
        return np.full(x.shape, self.work)

    def work_gradient(self, x: FloatArray) -> FloatArray:
        """dw/dx at the positions x, same shape."""
        return np.zeros(x.shape)

    def critical_stress_intensity(self, x: FloatArray) -> FloatArray:
        """K = 2 sqrt(w) at the positions x, same shape."""
        return np.asarray(2 * np.sqrt(self.work_of_adhesion(x)))

    def energy(self, patches: Patches) -> float:
        """U_ad = -int w dx over the patches."""
        return -self.work * float(np.sum(patches.width))


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
    excess : Profile
        The zero-mean part of int sqrt(1 + h'^2) dx, as harmonics.
    mean_stretch : float
        Mean of sqrt(1 + h'^2).
    """

    profile: Profile
    slope_scale: float
    excess: Profile
    mean_stretch: float

    def work_of_adhesion(self, x: FloatArray) -> FloatArray:
        """w at the positions x, same shape."""
        return np.asarray(self.work * np.hypot(1.0, self.slope_scale * self.profile.slope(x)))

    def work_gradient(self, x: FloatArray) -> FloatArray:
        """dw/dx at the positions x, same shape."""
        _, slope, curvature = self.profile.height_slope_curvature(x)
        stretch = np.hypot(1.0, self.slope_scale * slope)
        return np.asarray(self.work * self.slope_scale**2 * slope * curvature / stretch)

    def energy(self, patches: Patches) -> float:
        """U_ad = -int w dx over the patches."""
        left, right = np.split(self.excess.height(np.concatenate([patches.left, patches.right])), 2)
        return -self.work * float(np.sum(right - left) + self.mean_stretch * np.sum(patches.width))


def dimensionless_law(adhesion: Adhesion, profile: Profile, scales: Scales) -> UniformLaw:
    """The law of an interface in the units of the solver.

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
    points = 1 << int(np.ceil(np.log2(_POINTS_PER_WAVELENGTH * profile.max_order)))
    x = np.arange(points) * (2 * np.pi / points)
    spectrum = np.fft.rfft(np.hypot(1.0, scales.slope * profile.slope(x))) / points
    order = np.arange(1, points // 4)
    integral = 2 * spectrum[order] / (1j * order)
    kept = np.abs(integral) > 1e-17 * spectrum[0].real
    kept[0] = True
    last = int(np.flatnonzero(kept)[-1]) + 1
    excess = Profile(2 * np.pi, order[:last], np.abs(integral[:last]), np.angle(integral[:last]))
    return SlopeLaw(work, profile, scales.slope, excess, float(spectrum[0].real))
