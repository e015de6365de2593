"""Contact state from given edges, in SI units: the solver's inner layer, usable alone.

For convergence studies and for checks of other codes: edges and penetration are prescribed, nothing is searched.
Edges are pairs (a_i, b_i); arrays that belong to edges have shape (L, 2), matrices the order of
`edges.ravel()`.  Formulas: collocation.py and sensitivities.py.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev as series
from numpy.typing import ArrayLike

from bem.elastic.collocation import Elastic, Evaluation, evaluate
from bem.elastic.gap import gap_field
from bem.elastic.sensitivities import stress_intensity_jacobian
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.geometry.ranges import check, refuse
from bem.geometry.scaling import Scales, Solid
from bem.scene.magnitudes import magnitude_mistakes

if TYPE_CHECKING:
    from bem.adhesive.adhesion import Adhesion, UniformLaw
    from bem.elastic.layer import Layer


class ContactState:
    """Elastic state of prescribed contact patches at prescribed penetration.

    Parameters
    ----------
    profile : Profile
        SI, not flat.
    solid : Solid
    edges : (L, 2) array
        Contact patches [a_i, b_i] in m, in order, disjoint, less than the period in all.
    penetration : float
        Distance in m by which the mean planes have come closer than at first touch.
    layer : Layer, optional
        A half-space without it.
    adhesion : Adhesion, optional
        Adds its energy to `energy`, `gradient` and `hessian`.
    tolerance : float
        Relative accuracy with which patches act on each other.

    Raises
    ------
    ValueError
        Edges of another shape, not finite, out of order or overlapping; flat profile; what a scene refuses too.

    Examples
    --------
    Westergaard, half of the period in contact:

    >>> profile = Profile.from_harmonics(1.0, [1], [0.01])
    >>> state = ContactState(profile, Solid(1.0, 0.0), [[-0.25, 0.25]], 0.005 * (1 + np.log(2)))
    >>> bool(abs(state.mean_pressure - 0.01 * np.pi / 2) < 1e-14), bool(abs(state.stress_intensity).max() < 1e-13)
    (True, True)
    """

    def __init__(
        self,
        profile: Profile,
        solid: Solid,
        edges: ArrayLike,
        penetration: float,
        layer: Layer | None = None,
        adhesion: Adhesion | None = None,
        tolerance: float = 1e-12,
    ) -> None:
        check(penetration=penetration)
        tables = {"solid": solid, "layer": layer, "adhesion": adhesion}
        plain = {name: None if table is None else vars(table) for name, table in tables.items()}
        refuse(*magnitude_mistakes(plain, profile))
        pairs = np.asarray(edges, dtype=np.float64)
        if pairs.ndim != 2 or pairs.shape[1] != 2 or pairs.shape[0] == 0:
            raise ValueError(f"edges: an array of pairs (L, 2) is needed, not shape {pairs.shape}")
        if not np.all(np.isfinite(pairs)):
            row, side = np.argwhere(~np.isfinite(pairs))[0]
            raise ValueError(f"edges[{row}, {side}] = {pairs[row, side]}: a finite number is needed")
        self.profile, self.solid, self.edges, self.penetration = profile, solid, pairs, float(penetration)
        self.scales = Scales(profile.period, profile.rms_height, solid.plane_strain_modulus)
        scaled = profile.scaled()
        compliance = None
        if layer is not None:
            from bem.elastic.compliance import Compliance

            compliance = Compliance(layer.kernel(solid, profile.period, 1e-3 * tolerance))
        self._elastic = Elastic(scaled, compliance)
        patches = Patches(pairs[:, 0] / self.scales.length, pairs[:, 1] / self.scales.length)
        if not patches.is_ordered:
            raise ValueError(f"edges: {pairs.tolist()} must be increasing, disjoint and shorter than the period in all")
        self._adhesion = adhesion
        self.evaluation: Evaluation = evaluate(self._elastic, patches, self.penetration / self.scales.height, tolerance)

    @property
    def load(self) -> float:
        """Force per period and unit length in the third direction, N/m."""
        return self.evaluation.load * self.scales.force

    @property
    def mean_pressure(self) -> float:
        """Load over the period, Pa."""
        return self.load / self.profile.period

    @property
    def stress_intensity(self) -> FloatArray:
        """K at the edges, > 0 in tension, (L, 2), Pa m^1/2; an edge opens where K > sqrt(2 E* w)."""
        return self._by_edge(self.evaluation.stress_intensity) * self.scales.stress_intensity

    @property
    def energy_release_rate(self) -> FloatArray:
        """G = K^2 / (2 E*) at the edges, (L, 2), J/m^2."""
        return np.asarray(self.stress_intensity**2 / (2 * self.solid.plane_strain_modulus))

    @property
    def elastic_energy(self) -> float:
        """U_el per period without the mean compression, J/m."""
        return self.evaluation.elastic_energy * self.scales.energy

    @property
    def energy(self) -> float:
        """U_el + U_ad per period, J/m."""
        if self._law is None:
            return self.elastic_energy
        return self.elastic_energy + self._law.energy(self.evaluation.patches) * self.scales.energy

    @property
    def gradient(self) -> FloatArray:
        """dU / d(edge position), (L, 2), J/m^2: -(G - w) at a_i, +(G - w) at b_i."""
        outward = self.evaluation.stress_intensity**2 / 4
        if self._law is not None:
            outward = outward - self._law.work_of_adhesion(self._positions)
        return np.asarray(self._by_edge(outward) * np.array([-1.0, 1.0]) * self.scales.release_rate)

    @property
    def hessian(self) -> FloatArray:
        """Second derivatives of U by the edge positions, (2 L, 2 L) in the order of edges.ravel(), J/m^3."""
        count = self.edges.shape[0]
        signs = np.repeat([-1.0, 1.0], count)
        matrix = (self.evaluation.stress_intensity / 2)[:, None] * stress_intensity_jacobian(self.evaluation)
        if self._law is not None:
            matrix = matrix - np.diag(signs * self._law.work_and_gradient(self._positions)[1])
        order = np.arange(2 * count).reshape(2, count).T.ravel()
        signed: FloatArray = matrix * np.outer(signs, signs)
        return np.asarray(signed[np.ix_(order, order)] * (self.scales.release_rate / self.scales.length))

    def pressure(self, x: ArrayLike) -> FloatArray:
        """Return the pressure in Pa at positions in m, nan outside contact and infinite at the edges, shape of x."""
        position = np.asarray(x, dtype=np.float64)
        value = np.full(position.shape, np.nan)
        carried = self.evaluation.pressure()
        patches = self.evaluation.patches
        for i, charge in enumerate(carried.charges):
            t = self._in_patch(position, i)
            inside = np.abs(t) <= 1
            with np.errstate(divide="ignore"):
                shape = series.chebval(t[inside], charge) / np.sqrt(1 - t[inside] ** 2)
            value[inside] = shape / patches.half_width[i] * self.scales.stress
        return value

    def displacement(self, x: ArrayLike) -> FloatArray:
        """Return the mean-free interface displacement u - u_m in m at positions in m, shape of x."""
        position = np.asarray(x, dtype=np.float64)
        contact = self.profile.height(position) - self.profile.max_height + self.penetration
        patches, period = self.evaluation.patches, 2 * np.pi
        start = patches.left[0]
        scaled = start + (position.ravel() / self.scales.length - start) % period
        owner = np.searchsorted(patches.left, scaled, side="right") - 1
        outside = scaled > patches.right[owner]
        value = contact.ravel().copy()
        if np.any(outside):
            free = gap_field(self._elastic, self.evaluation).displacement(scaled[outside], owner[outside])
            value[outside] = free * self.scales.height
        return value.reshape(position.shape)

    @cached_property
    def _law(self) -> UniformLaw | None:
        """Dimensionless law of adhesion; None without adhesion."""
        if self._adhesion is None:
            return None
        from bem.adhesive.adhesion import dimensionless_law

        return dimensionless_law(self._adhesion, self._elastic.profile, self.scales)

    @property
    def _positions(self) -> FloatArray:
        patches = self.evaluation.patches
        return np.concatenate([patches.left, patches.right])

    def _by_edge(self, values: FloatArray) -> FloatArray:
        """Return (2 L,) values, all left edges first, as (L, 2)."""
        return np.asarray(values.reshape(2, -1).T)

    def _in_patch(self, x: FloatArray, index: int) -> FloatArray:
        """Return positions in units of patch `index`, [-1, 1] inside, of the nearest periodic image."""
        patches = self.evaluation.patches
        distance = x / self.scales.length - patches.center[index]
        nearest = distance - 2 * np.pi * np.rint(distance / (2 * np.pi))
        return np.asarray(nearest / patches.half_width[index])
