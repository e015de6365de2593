"""Exact second derivatives of the stress intensities with respect to outward motion of the edges, along one motion.

An edge e that moves outward adds K_e S_e to the pressure, where S_e vanishes on the patches as a displacement and is
singular at its edge.  At a distance d from any edge i

    S_e = delta_ie / (2 sqrt(2 pi) d^(3/2)) - k_ie / sqrt(2 pi d) + sqrt(2/pi) c_ie sqrt(d) + ...,
    sigma = -K_i / sqrt(2 pi d) + sqrt(2/pi) (s_i sqrt(d) + t_i d^(3/2)) + ...

Motion of edge g changes S_e by k_ge S_g, since it is a pressure like any other, and what moves with the edge is the
next term of its series.  So the derivatives of K and k are

    dK_i/dg = k_ig K_g + delta_ig s_g,       dk_ie/dg = k_ig k_ge  (g neither i nor e),
    dk_ie/di = k_ii k_ie + c_ie  (i not e),  ds_i/dg = c_ig K_g - delta_ig (3/2) t_i,

k is symmetric, and a translation of all edges leaves it as it is, which gives dk_ee/de.  K and s follow from q and its
derivatives at the edges, as in sensitivities.py: on a patch sigma = q(t) / (r sqrt(1 - t^2)).  Of S_e the coupled modes
are what the edge vectors make of it, the others Q_n = -n (+-1)^n / sqrt(pi r); their divergent sums are finite parts
(of n, n^3: minus the sum of those before; with alternating signs Abel's: -1/4 and 1/8).
Source: Hadamard's variation, as for the weight functions of cracks (Rice, Int. J. Solids Struct. 21 (1985) 781).
Dimensionless.  Limits: equal profile and elasticity all along, no fields of frozen patches.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from bem.elastic.collocation import Evaluation
from bem.geometry.arrays import FloatArray
from bem.kernels import edges


@dataclass(frozen=True, eq=False)
class EdgeFields:
    """Fields that moving edges add to the pressure, at all edges.

    Parameters
    ----------
    state : Evaluation
        With K > 0; for c, and all that needs c, a state with the slopes that edges make at edges.
    jacobian : (2 L, 2 L) array
        dK_i/de.
    """

    state: Evaluation
    jacobian: FloatArray

    @cached_property
    def radius(self) -> FloatArray:
        """Half widths of the patches of the edges, (2 L,)."""
        return np.concatenate([self.state.patches.half_width] * 2)

    @cached_property
    def s(self) -> FloatArray:
        """Coefficient s_e of the pressure at the edges, (2 L,)."""
        return self._tip(self.state.stress_intensity, self.state.edge_slope)

    @cached_property
    def s_rate(self) -> FloatArray:
        """ds_e/dDelta, (2 L,)."""
        return self._tip(self.state.stress_intensity_rate, self.state.edge_slope_rate)

    @cached_property
    def _matrices(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """k_ie and c_ie with zeros on their diagonals, these diagonals, and sum_e +-k_ie^2."""
        state = self.state
        return edges.edge_fields(
            state.patches.half_width,
            state.resolution.modes,
            state.stress_intensity,
            self.jacobian,
            self.s,
            state.slope_compliance,
        )

    @property
    def k(self) -> tuple[FloatArray, FloatArray]:
        """k_ie with zeros on its diagonal, (2 L, 2 L), and the diagonal, (2 L,)."""
        return self._matrices[0], self._matrices[2]

    @property
    def c(self) -> tuple[FloatArray, FloatArray]:
        """c_ie with zeros on its diagonal, (2 L, 2 L), and the diagonal, (2 L,)."""
        if not self.state.slope_compliance.size:
            raise ValueError("the state is evaluated without slopes of edges: use System.sloped")
        return self._matrices[1], self._matrices[3]

    @cached_property
    def t(self) -> FloatArray:
        """Coefficient t_e of the pressure at the edges, (2 L,)."""
        charges = self.state.charges()
        value = (_of_t(charges.shape[1]) @ charges.T).ravel()
        return np.asarray(np.sqrt(np.pi / self.radius) / (2 * self.radius**2) * value)

    def times_jacobian_rate(self, x: FloatArray) -> FloatArray:
        """Return the derivative of dK/de by Delta, times x, (2 L,)."""
        k, own = self.k
        y = self.state.stress_intensity_rate * x
        return k @ y + own * y + self.s_rate * x

    def jacobian_change_times(self, a: FloatArray, x: FloatArray) -> FloatArray:
        """Return the derivative of dK/de along a motion of the edges at fixed penetration, times x, (2 L,)."""
        (k, own), (c, _), intensity = self.k, self.c, self.state.stress_intensity
        along, turned, bent = self._own_change(a)
        y = intensity * x
        z = k @ y
        beside = a * (own * z + c @ y) + (a * y) @ c
        return k @ (a * (z + own * y) + along * x) + beside - turned * y + bent * x

    def _own_change(self, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return dK along a motion a, and the terms of dk_ee/de and ds_e on the diagonal, (2 L,) each."""
        (_, own), (c, own_slope), intensity = self.k, self.c, self.state.stress_intensity
        along, turned = self.jacobian @ a, self._matrices[4] * a
        turned[: turned.size // 2] *= -1.0  # of left edges
        bent = own * along + c @ (a * intensity) + a * (intensity * own_slope - 1.5 * self.t)
        return along, turned, bent

    def _tip(self, intensity: FloatArray, slope: FloatArray) -> FloatArray:
        return np.asarray(-intensity / (8 * self.radius) - np.sqrt(np.pi / self.radius) * slope / 2)


@lru_cache(maxsize=64)
def _of_t(count: int) -> FloatArray:
    """Return what each Q_n adds to t at a left and at a right edge, (2, count)."""
    square = np.arange(count, dtype=np.float64) ** 2
    weight = 3 / 32 - square / 4 + square * (square - 1) / 6
    return np.stack([np.where(np.arange(count) % 2 == 0, weight, -weight), weight])
