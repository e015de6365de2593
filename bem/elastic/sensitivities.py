"""Exact derivatives of the stress intensities with respect to outward motion of the edges.

An edge moved outward by delta adds the homogeneous solution whose singularity there is -K_e / (2 r^(3/2)); its
values at the other edges i are the edge compliance G_ie of the skeleton (collocation.py), completed by the modes
that the skeleton does not carry:

    Z_ie = -pi^2 G_ie + p (p - 1) [same edge] + (2 sum_{1 <= n < p} n (-1)^n + 1/2) [other edge of the same patch],
    dK_i/d out_e = -Z_ie K_e / (2 sqrt(r_i r_e)) - delta_ie (K_e / (4 r) + sqrt(pi/r) f'_e / 2),

f' = sum n^2 (+-1)^n Q_n / r the outward derivative by t of f = q / r at the edge.  The last term is the regular
part of the pressure, which the moving edge brings to the tip.

and the Hessian of U = U_el + U_ad is H_ef = (K_e/2) dK_e/d out_f - delta_ef dw_e/d out_e (dimensionless, G = K^2/4),
which is symmetric and, at an equilibrium, positive definite exactly where it is a minimum.
"""

from __future__ import annotations

import numpy as np

from bem.elastic.collocation import Evaluation
from bem.geometry.arrays import FloatArray
from bem.kernels import edges


def stress_intensity_jacobian(state: Evaluation) -> FloatArray:
    """Return dK_i / d(outward motion of edge e), (2 L, 2 L), dimensionless."""
    half_width, modes = state.patches.half_width, state.resolution.modes
    return edges.stress_intensity_jacobian(
        half_width, modes, state.stress_intensity, state.edge_compliance, state.edge_slope
    )


def own_sensitivity(state: Evaluation) -> FloatArray:
    """Return dK_e / d(outward motion of edge e), (2 L,).

    If the compliance of the edges is unknown, the term -Z_ee K_e / (2 r_e), which vanishes with K, is left out.
    """
    if state.edge_compliance.size:
        return np.diagonal(stress_intensity_jacobian(state))
    half_width = np.concatenate([state.patches.half_width, state.patches.half_width])
    return np.asarray(-state.stress_intensity / (4 * half_width) - np.sqrt(np.pi / half_width) * state.edge_slope / 2)
