"""Separation of the mean planes with adhesion, from the total energy along a ladder of loads.

Work balance sigma = -dU_tot / ds gives s(sigma_0) = int_{sigma_0}^inf (dU_tot / dsigma) dsigma / sigma.  The part
without adhesion is a closed form (nonadhesive.py); the difference D = U_tot - U_el,nonadhesive is smooth in ln sigma,

    s = s_nonadhesive + int D'(sigma) d ln sigma.

D is interpolated through Chebyshev points in ln sigma between sigma_0 and FULL_CONTACT standard deviations of the
stress; beyond, contact is complete and D constant.

Source: B. N. J. Persson, Phys. Rev. Lett. 99 (2007) 125502, doi:10.1103/PhysRevLett.99.125502; Carbone, Scaraggi,
Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  Loads in units of E*, energies over E* in m.
Limits: sigma_0 > 0 (the integral diverges at zero load); one branch of states from sigma_0 upwards.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial import Chebyshev

from persson.mathematics.arrays import FloatArray

FULL_CONTACT = 5.5  # standard deviations: 1 - A/A0 = 4e-8 without adhesion
QUADRATURE = 128


def load_ladder(load: float, slope_variance: float, count: int) -> FloatArray:
    """Return loads sigma / E* from sigma_0 up to complete contact, (count,).

    If contact is complete at sigma_0, the ladder holds sigma_0 alone.

    Examples
    --------
    >>> ladder = load_ladder(0.01, 0.04, 5)
    >>> ladder.shape, round(float(ladder[0]), 12), round(float(ladder[-1]), 12)
    ((5,), 0.01, 0.55)
    """
    top = FULL_CONTACT * np.sqrt(slope_variance / 4)
    if load >= top:
        return np.array([load])
    share = (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
    ladder = load * (top / load) ** share
    ladder[0] = load
    return np.asarray(ladder)


def adhesive_part(loads: FloatArray, excess_energy: FloatArray) -> float:
    """Return int D' d ln sigma in m over a ladder, from D / E* in m at its loads, (n_loads,).

    Examples
    --------
    >>> ladder = load_ladder(0.01, 0.04, 17)
    >>> round(float(adhesive_part(ladder, ladder**2) / (2 * (ladder[-1] - ladder[0]))), 9)
    1.0
    """
    if loads.size == 1:
        return 0.0
    position = np.log(loads)
    interpolant = Chebyshev.fit(position, excess_energy, loads.size - 1)
    point, weight = _rule(QUADRATURE)
    half, centre = (position[-1] - position[0]) / 2, (position[-1] + position[0]) / 2
    x = centre + half * point
    return float(half * np.sum(weight * interpolant.deriv()(x) * np.exp(-x)))


@cache
def _rule(count: int) -> tuple[FloatArray, FloatArray]:
    """Return the points and weights of Gauss-Legendre quadrature, (count,) each."""
    point, weight = np.polynomial.legendre.leggauss(count)
    return point, weight
