"""Waves of an effect on one patch, projected on its coupled modes.

On a patch x = c + r t a wave of order m has the Chebyshev series (Jacobi, Anger; DLMF 10.12), z = m r,

    cos(z t) = J_0(z) + 2 sum_k (-1)^k J_2k(z) T_2k(t),   sin(z t) = 2 sum_k (-1)^k J_2k+1(z) T_2k+1(t).

with k from 1 on in the first sum, from 0 in the second.  The first p terms are all that p modes of the pressure feel,
and all that they answer to.  At p nodes the waves of a thin layer would alias, as z goes up to many half widths over
its thickness, far above p; their projections do not.  So a wide patch needs the modes of its pressure only, not those
of the kernel.  Dimensionless.

The pressure that an edge adds when it moves has all modes: of a unit edge vector Q_n = (2 n / pi^2) (+-1)^n as on the
half-space, and what the effect makes of it, which is smooth.  What the waves feel of those with n >= p is, as
2 n J_n = z (J_n-1 + J_n+1),

    int cos(m x) dQ = (z/pi) (-1)^k J_2k-1(z),  2k >= p,     int sin(m x) dQ = +-(z/pi) (-1)^k J_2k(z),  2k + 1 >= p,

with the least such k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.geometry.arrays import ComplexArray, FloatArray
from bem.geometry.chebyshev import basis

NO_MORE = 12.0  # derived: J_n(z) is 1e-18 of the largest at n = z + 12 z^(1/3), by Airy's function
SEED = 1e-290  # format: what the recurrence begins with


@dataclass(frozen=True, eq=False)
class PatchWaves:
    """Waves on a patch, counted from its middle: of cosines the even modes, of sines the odd ones.

    Attributes
    ----------
    cosines, sines : (p - p // 2, n_orders), (p // 2, n_orders) arrays
        Their coefficients.
    of_edge : pair of (n_orders,) arrays
        Moments of cosines and sines with the uncoupled modes of the pressure that the right edge adds; the left edge
        adds sines of the other sign.
    """

    cosines: FloatArray
    sines: FloatArray
    of_edge: tuple[FloatArray, FloatArray]

    @property
    def parities(self) -> tuple[tuple[FloatArray, FloatArray, FloatArray], ...]:
        """Parts of cosines and of sines: T_n of their modes at the nodes, coefficients, moments of the right edge."""
        values = basis(len(self.cosines) + len(self.sines)).values
        return (values[:, ::2], self.cosines, self.of_edge[0]), (values[:, 1::2], self.sines, self.of_edge[1])

    def at_nodes(self) -> ComplexArray:
        """Return the projections of exp(i m (x - c)) at the nodes, (n_orders, p)."""
        cosines, sines = (part.T @ values.T for values, part, _ in self.parities)
        return np.asarray(cosines + 1j * sines)

    def kernel(self, weights: FloatArray) -> FloatArray:
        """Return sum_m weight_m cos(m (x - x')) between the nodes, projected in both, (p, p)."""
        even, odd = (values @ ((part * weights) @ part.T) @ values.T for values, part, _ in self.parities)
        return even + odd

    def left_out(self, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the response of this kernel to uncoupled modes of the left and right edge.

        Fields at the nodes, (2, p), and the response at the edge itself and at the other edge, (2,).
        """
        even, odd = (values @ (part @ (weights * edge)) for values, part, edge in self.parities)
        cosines, sines = (weights @ edge**2 for edge in self.of_edge)
        return np.stack([even - odd, even + odd]), np.array([cosines + sines, cosines - sines])


def patch_waves(half_width: float, orders: FloatArray, modes: int) -> PatchWaves:
    """Return the waves of ascending orders on a patch with `modes` coupled modes."""
    z = orders * half_width
    table = bessel(modes + 1, z)
    weight = np.where(np.arange(modes) % 4 < 2, 2.0, -2.0)[:, None]
    weight[0] = 1.0
    first, second = (modes + 1) // 2, modes // 2  # k of the first cosine and of the first sine that are left out
    of_edge = z * table[2 * first - 1] * ((-1.0) ** first / np.pi), z * table[2 * second] * ((-1.0) ** second / np.pi)
    return PatchWaves(table[:modes:2] * weight[::2], table[1:modes:2] * weight[1::2], of_edge)


def bessel(count: int, z: FloatArray) -> FloatArray:
    """Return J_n(z) for n < count and ascending z > 0, (count, n_z), to rounding of the largest.

    Upwards from J_0 and J_1 where z >= count; elsewhere downwards from where J_n is nothing, scaled by
    J_0 + 2 J_2 + 2 J_4 + ... = 1 (Miller; DLMF 3.6).

    Examples
    --------
    >>> [round(float(value), 12) for value in bessel(2, np.array([1.0]))[:, 0]]
    [0.765197686558, 0.440050585745]
    """
    from scipy.special import j0, j1  # loaded where an effect has waves

    first = int(np.searchsorted(z, count))
    table = np.zeros((count, z.size))
    table[0, first:], table[1:2, first:], twice = j0(z[first:]), j1(z[first:]), 2 / z
    for n in range(1, count - 1):
        table[n + 1, first:] = n * twice[first:] * table[n, first:] - table[n - 1, first:]
    small = z[:first]
    begin = np.ceil(small + NO_MORE * (np.cbrt(small) + 1)).astype(np.int64)
    total, current, above = np.zeros(first), np.zeros(first), np.zeros(first)
    for n in range(int(begin.max(initial=0)), -1, -1):
        current[begin == n] = SEED
        if n < count:
            table[n, :first] = current
        if n % 2 == 0:
            total += current if n == 0 else 2 * current
        current, above = n * twice[:first] * current - above, current
    table[:, :first] /= total
    return table
