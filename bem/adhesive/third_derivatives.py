"""Change of the Hessian of the potential along a motion of edges and control: third derivatives, exact.

Of H_ef = (K_e/2) dK_e/df - delta_ef dw_e/de, with the change of dK/de by second_sensitivities.py; at fixed edges K and
dK/de are linear in the penetration.  Under control H_tau = H - beta rate k k^T, rate = 1/(alpha + beta dP/dDelta), and
k and dP/dDelta change by (dK dK/dDelta + K d(dK/dDelta))/2 and (dK/dDelta)^2/2.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bem.adhesive.equilibrium import Balance, System, balance, edge_positions
from bem.geometry.arrays import FloatArray


def with_slopes(system: System, forces: Balance, value: float, tolerance: float) -> Balance:
    """Return the forces on the edges with slopes at the edges; evaluate again unless the slopes are known."""
    if forces.state.slope_compliance.size:
        return forces
    state = forces.state
    return balance(system.sloped, state.patches, state.penetration, value, tolerance, state.resolution)


def hessian_change_times(
    system: System, forces: Balance, outward: FloatArray | None, change: float, x: FloatArray
) -> FloatArray:
    """Return the derivative of the Hessian under control along a motion, times x, (2 L,).

    Parameters
    ----------
    system : System
    forces : Balance
        Whose state knows the slopes that edges make at edges, unless they rest.
    outward : (2 L,) array or None
        Of the edges; None where they rest.
    change : float
        Of the control.
    x : (2 L,) array
    """
    motion, fields = _Motion(system, forces, outward, change), forces.edge_fields
    jacobian = motion.deeper * fields.times_jacobian_rate(x)
    if outward is not None:
        jacobian += fields.jacobian_change_times(outward, x)
    result = (motion.stronger * (forces.jacobian @ x) + forces.state.stress_intensity * jacobian) / 2
    if outward is not None:
        result -= system.law.work_curvature(edge_positions(forces.state.patches)) * outward * x
    if system.control.load_weight:
        result -= forces.load_gradient * (motion.carried @ x) + motion.carried * (forces.load_gradient @ x)
    return np.asarray(result)


@dataclass(frozen=True, eq=False)
class _Motion:
    """Change of K, w and the load gradient by a motion of edges (None: they rest) and control."""

    system: System
    forces: Balance
    outward: FloatArray | None
    change: float

    @property
    def rate(self) -> FloatArray:
        """dK/dDelta, (2 L,)."""
        return self.forces.state.stress_intensity_rate

    @cached_property
    def deeper(self) -> float:
        """Change of the penetration."""
        control, carried = self.system.control, 0.0
        if self.outward is not None and control.load_weight:
            carried = control.load_weight * float(self.forces.load_gradient @ self.outward)
        return control.rate(self.forces.state) * (self.change - carried)

    @cached_property
    def stronger(self) -> FloatArray:
        """Change of K, (2 L,)."""
        growth = self.deeper * self.rate
        return growth if self.outward is None else growth + self.forces.jacobian @ self.outward

    @cached_property
    def carried(self) -> FloatArray:
        """Vector v, (2 L,): with load gradient k, v k^T + k v^T is subtracted from the change of the Hessian."""
        state, control, fields = self.forces.state, self.system.control, self.forces.edge_fields
        change = self.stronger * self.rate / 2
        share = control.load_weight * control.rate(state)
        if self.outward is not None:
            change += state.stress_intensity * fields.times_jacobian_rate(self.outward) / 2
            change -= share / 4 * float(self.rate**2 @ self.outward) * self.forces.load_gradient
        return share * change
