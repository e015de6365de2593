"""Scales from SI to the dimensionless problem and back: the only place that converts.

With q0 = 2 pi / period, a = rms height and E* = E / (1 - nu^2), the solver works with

    x q0,   heights / a,   stress / s*, s* = E* q0 a / 2,   stress intensity / (s* q0^-1/2),
    force per length / (s* / q0),   energy per length and period / (E* a^2 / 2),   energy release rate and
    work of adhesion / (E* a^2 q0 / 2),

so that the half-space relation is u(x) = -(1/pi) int log|2 sin((x - x')/2)| sigma(x') dx', complete contact
has sigma_m = m u_m, and G = K^2 / 4.  Limits: a > 0 (a flat profile has no such scale), -1 < nu <= 1/2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from bem.geometry.table import limits, table

ATOMIC = 3e-10  # format: m: distance of atoms in a solid, and range of the forces between surfaces


@table("solid")
class Solid:
    """Linear elastic, isotropic solid.

    Parameters
    ----------
    youngs_modulus : float
        E in Pa, 1e-60 to 1e60.
    poisson_ratio : float
        nu in (-1, 0.5].

    Examples
    --------
    >>> Solid(3.0, 0.5).plane_strain_modulus
    4.0
    """

    youngs_modulus: Annotated[float, limits("solid.youngs_modulus")]
    poisson_ratio: Annotated[float, limits("solid.poisson_ratio")]

    @property
    def plane_strain_modulus(self) -> float:
        """E* = E / (1 - nu^2), Pa."""
        return self.youngs_modulus / (1 - self.poisson_ratio**2)


@dataclass(frozen=True)
class Scales:
    """Units of the dimensionless problem, each in SI.

    Parameters
    ----------
    period, height : float
        Period and unit of height (the rms height), m.
    plane_strain_modulus : float
        E*, Pa.
    """

    period: float
    height: float
    plane_strain_modulus: float

    @property
    def length(self) -> float:
        """1 / q0, m."""
        return self.period / (2 * np.pi)

    @property
    def stress(self) -> float:
        """E* q0 a / 2, Pa."""
        return self.plane_strain_modulus * self.slope / 2

    @property
    def slope(self) -> float:
        """q0 a, dimensionless: slope of the profile per dimensionless slope."""
        return self.height / self.length

    @property
    def stress_intensity(self) -> float:
        """Unit of stress intensity, Pa m^1/2."""
        return self.stress * float(np.sqrt(self.length))

    @property
    def force(self) -> float:
        """Force per unit length in the third direction, N/m."""
        return self.stress * self.length

    @property
    def energy(self) -> float:
        """Energy per unit length in the third direction, per period: E* a^2 / 2, J/m."""
        return self.plane_strain_modulus * self.height**2 / 2

    @property
    def energy_per_area(self) -> float:
        """Energy per nominal area: E* a^2 / (2 period), J/m^2."""
        return self.energy / self.period

    @property
    def release_rate(self) -> float:
        """Energy release rate and work of adhesion: E* a^2 q0 / 2, J/m^2."""
        return self.energy / self.length

    @property
    def stiffness(self) -> float:
        """Mean pressure per penetration, Pa/m."""
        return self.stress / self.height
