"""Distribution of the stress in a contact that its edges hold with adhesion (adhesive_edges.py).

The stress is that of the contact without adhesion under the reference load p_d less the tension of the edges, T in all.
Both are taken over the share f in (0, 1] of the contact that is nearer to an edge: without adhesion the stress
falls to zero there, and the tension of equally spaced edges is

    t(f) = T cos(x) / sqrt(sin^2(pi A / 2) - sin^2 x),    x = (1 - f) pi A / 2,

so that sigma(f) = sigma_d(f) - t(f) grows with f and P(sigma) = A df/dsigma.  Without adhesion P_d is the difference of
two Gaussians at +-p_d whose variance makes its area A; its load is p_d.  So int P = A and int sigma P = p_d - T = p
hold exactly, and P -> 2 T^2 / (pi tan(pi A/2)) |sigma|^-3 = (2 n w / pi) |sigma|^-3 for sigma -> -infinity, the tail
of n edges at the stress intensity sqrt(2 w E*).

Source: derived here; tail: bem/README.md, section on the distribution.  Stresses in units of E*.  Limits: means over
phases; that the tension follows the order of the stress without adhesion is exact for one patch in each period.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import erfinv

from persson.mathematics.arrays import FloatArray

LOWEST, REACH = 1e-7, 9.5  # standard deviations of sigma_d: the first node, and the last beyond the mean
NODES = 6000


@dataclass(frozen=True, eq=False)
class EdgeDistribution:
    """P(sigma) of one contact at nodes of sigma.

    Attributes
    ----------
    stress, density : (NODES,) arrays
        sigma, increasing, and P there.
    tail : float
        Of P = tail |sigma|^-3 below the first node.
    """

    stress: FloatArray
    density: FloatArray
    tail: float

    def at(self, stress: FloatArray) -> FloatArray:
        """P at stresses, of the same shape; 0 above the last node."""
        between = np.exp(np.interp(stress, self.stress, np.log(self.density), right=-np.inf))
        far = stress < self.stress[0]
        return np.where(far, self.tail / np.abs(np.where(far, stress, 1.0)) ** 3, between)


def edge_distribution(reference_load: float, contact_fraction: float, tension: float) -> EdgeDistribution:
    """P(sigma) from p_d > 0, A in (0, 1) and T > 0.

    Examples
    --------
    >>> found = edge_distribution(0.02, 0.2, 0.01)
    >>> round(float(np.trapezoid(found.density, found.stress)), 5)
    0.2
    """
    width = reference_load / (np.sqrt(2) * erfinv(contact_fraction))
    dry = np.geomspace(LOWEST * width, reference_load + REACH * width, NODES)
    mean = reference_load / width
    density = (
        np.exp(-((dry / width - mean) ** 2) / 2) * -np.expm1(-2 * dry * mean / width) / (np.sqrt(2 * np.pi) * width)
    )
    steps = (density[1:] * dry[1:] + density[:-1] * dry[:-1]) / 2 * np.diff(np.log(dry))
    share = np.concatenate([[0.0], np.cumsum(steps)]) + density[0] * dry[0] / 2  # P_d ~ sigma_d at first
    share /= share[-1]
    half = np.pi * contact_fraction / 2
    x = half * (1 - share)
    room = np.sin(half * share) * np.sin(half + x)  # sin^2 half - sin^2 x
    steep = tension * half * np.sin(x) * np.cos(half) ** 2 / room**1.5  # -dt/df
    found = contact_fraction / (contact_fraction / density + steep)
    return EdgeDistribution(dry - tension * np.cos(x) / np.sqrt(room), found, 2 * tension**2 / (np.pi * np.tan(half)))


def full_contact(load: float, variance: float) -> EdgeDistribution:
    """The Gaussian of complete contact, which adhesion holds against tension too; there is no edge and no tail."""
    width = np.sqrt(variance)
    stress = load + width * np.linspace(-REACH, REACH, NODES)
    return EdgeDistribution(stress, np.exp(-(((stress - load) / width) ** 2) / 2) / (np.sqrt(2 * np.pi) * width), 0.0)
