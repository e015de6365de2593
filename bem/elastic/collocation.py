"""Pressure, load, stress intensities and elastic energy of given contact patches: the compressed evaluation.

The equation int log|2 sin((x - x')/2)| sigma(x') dx' = pi (h_max - Delta - h(x)) =: R(x) on the patches is solved in
Chebyshev series.  What other patches contribute is smooth, so only the lowest p_i modes of a patch couple to
the rest (a skeleton of p_i nodes); every higher mode obeys the diagonal Q_n = -n C_n / pi, where C_n are the
coefficients of R.  The negated skeleton matrix A is symmetric positive definite; with b = [R on the skeleton | 1 |
edge vectors] and G = b^T A^-1 b (hierarchical.py),

    q_e = -G_eR - sum_{n >= p} (n/pi) C_n (+-1)^n,   K_e = -q_e sqrt(pi/r),   dK_e/dDelta = -pi G_e1 sqrt(pi/r),
    load = -G_R1,   dload/dDelta = pi G_11,   U_el = (G_RR + 1/2 sum_{n >= p} n C_n^2) / (2 pi).

Method: bem/README.md, section 2.  Sources: Mason and Handscomb, Chebyshev Polynomials (2003), chapter 9, for the
logarithm; Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65 for the problem.  Dimensionless (scaling.py).
Limits: patches ordered and disjoint, contact not complete; resolution set by `tolerance` (relative error of K about
3e-2 times it).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bem.elastic.hierarchical import IllConditionedSystemError, solve
from bem.elastic.logarithmic_potential import LogarithmicPotential
from bem.elastic.skeleton import Skeleton
from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import CHARGE_ROUNDING, POSITION_ROUNDING, TWO_PI, Patches, PatchPressure
from bem.geometry.profile import Profile
from bem.kernels import patches as patch_kernels

if TYPE_CHECKING:
    from bem.elastic.compliance import Compliance
    from bem.elastic.far_field import FarField
    from bem.elastic.kernel_series import KernelSeries

Field = Callable[[FloatArray], FloatArray]

MODES_RATIO, NODES_RATIO = 1.15, 1.4  # speed: steps of the lists of sizes
MOST_UNKNOWNS = 12_000  # limit: of one factorisation: 2.3 GB for matrix and factor
MOST_MODES = 8000  # limit: of one patch: a gap of 1e-5 periods beside it; seconds an evaluation
FEW_WAVES = 0.3  # speed: of the unknowns: more of a layer are added to the matrix instead
FAR_SHARE = 1e-5  # accuracy of the kernel between clusters over the tolerance
FINEST_FAR = 1e-14  # derived: accuracy of the kernel between clusters, at least: rounding

ROUNDINGS = 3.0  # of K: what is within them is no residual, as the certificate allows; measured 1.8 at one edge of 3000


@dataclass(frozen=True, eq=False)
class Elastic:
    """Elastic body of a scene: the profile, and the effects that change the compliance of the half-space.

    Parameters
    ----------
    profile : Profile
        Dimensionless (period 2 pi, unit rms height).
    compliance : Compliance, optional
        None for a half-space.
    backgrounds : tuple of callables
        Smooth fields int log|2 sin| sigma dx' of pressure outside these patches, (n,) positions to (n,) values.
    probes : tuple of k floats
        Positions outside contact; the effect of a charge at each is evaluated besides.
    slopes : bool
        Whether the slopes that edges make at edges are evaluated, which second derivatives need.
    far : FarField, optional
        Field of patches outside the window; load and energy are then of the patches of the window in this field.
    """

    profile: Profile
    compliance: Compliance | None = None
    backgrounds: tuple[Field, ...] = ()
    probes: tuple[float, ...] = ()
    slopes: bool = False
    far: FarField | None = None

    @cached_property
    def kernel(self) -> KernelSeries | None:
        """Series added to log|2 sin|; None for a half-space, or a layer too thick to differ from one."""
        kernel = None if self.compliance is None else self.compliance.kernel
        return kernel if kernel is not None and kernel.columns else None

    def field_of_charges(self, position: FloatArray, charge: FloatArray) -> Field:
        """Return the field of charges outside contact, (n,) each, as a function of x: -pi times the displacement."""
        logarithmic, kernel = LogarithmicPotential(position, charge), self.kernel
        if kernel is None:
            return logarithmic
        return lambda x: logarithmic(x) + kernel.field(x, position, charge)

    @property
    def left_out(self) -> KernelSeries | None:
        """Series of effects too small to be in the equations; error estimates include them."""
        return None if self.compliance is None else self.compliance.left_out


@dataclass(frozen=True, eq=False)
class Resolution:
    """Nodes for the profile and coupled modes, per patch, (L,) each."""

    nodes: IntArray
    modes: IntArray


@dataclass(frozen=True, eq=False)
class Evaluation:
    """State of given patches at given penetration, dimensionless; edge arrays list left edges, then right ones.

    Attributes
    ----------
    stress_intensity, stress_intensity_rate : (2 L,) arrays
        K and dK/dDelta at the edges.
    load, load_rate, elastic_energy : float
        int sigma dx, its derivative by Delta, and U_el.
    edge_compliance : (2 L, 2 L) array
        G_ee of the skeleton, from which the edge sensitivities follow; (0, 0) where it was not asked for.
    slope_compliance : (2 L, 2 L) array
        G with sum n^2 (+-1)^n Q_n at an edge for q, by rows; (0, 2 L) where it was not asked for.
    edge_slope, edge_slope_rate : (2 L,) arrays
        Outward derivative by t of the regular factor f = q / r at the edges, and its derivative by Delta.
    resolution : Resolution
        Nodes and modes used.
    unknowns : int
        Coupled modes of all patches.
    series : (L, max N_i) array
        Chebyshev coefficients of R on the patches, filled up with zeros.
    skeleton, skeleton_rate : (unknowns,) arrays
        Nodal charges (pi/p) q of the coupled modes, and their derivative by Delta.
    rms_slope : float
        Of the dimensionless profile.
    intensity_by_probes, load_by_probes : (k, 2 L), (k,) arrays
        Change of K and of the load by a charge -1 at each of the probes, at given penetration.
    """

    patches: Patches
    penetration: float
    stress_intensity: FloatArray
    stress_intensity_rate: FloatArray
    load: float
    load_rate: float
    elastic_energy: float
    edge_compliance: FloatArray
    slope_compliance: FloatArray
    edge_slope: FloatArray
    edge_slope_rate: FloatArray
    resolution: Resolution
    unknowns: int
    series: FloatArray
    skeleton: FloatArray
    skeleton_rate: FloatArray
    rms_slope: float
    intensity_by_probes: FloatArray
    load_by_probes: FloatArray

    def rounding(self, penetration_rate: float) -> FloatArray:
        """Return the absolute accuracy of K in double precision, (2 L,), as charges, positions and heights leave it.

        An error of all heights acts like one of Delta, of which a control lets `penetration_rate` pass: 1 at
        fixed penetration, 0 at fixed load.  Displacements are sums over all charges, and lack what these do: near
        complete contact, where the load is large, a shift common to all edges.  What positions leave uncertain differs
        from node to node.
        """
        starts = np.concatenate([[0], np.cumsum(self.resolution.modes)[:-1]])
        largest = np.maximum.reduceat(np.abs(self.skeleton), starts) * self.resolution.modes / np.pi
        at_node = CHARGE_ROUNDING * np.maximum(largest, 1.0) + POSITION_ROUNDING * self.rms_slope
        charge = self.resolution.nodes * at_node
        displaced = max(1.0, abs(self.load) / (2 * np.pi))
        from_heights = CHARGE_ROUNDING * displaced * penetration_rate * np.abs(self.stress_intensity_rate)
        return np.asarray(np.tile(charge * np.sqrt(np.pi / self.patches.half_width), 2) + from_heights)

    def shifted(self, change: float) -> Evaluation:
        """Return the state at a penetration larger by `change`; patches stay, and the state is linear in it."""
        return replace(
            self,
            penetration=self.penetration + change,
            stress_intensity=self.stress_intensity + change * self.stress_intensity_rate,
            load=self.load + change * self.load_rate,
            elastic_energy=self.elastic_energy + change * (self.load + change * self.load_rate / 2),
            edge_slope=self.edge_slope + change * self.edge_slope_rate,
            skeleton=self.skeleton + change * self.skeleton_rate,
        )

    def skeleton_nodes(self) -> FloatArray:
        """Return the positions of the skeleton charges, (unknowns,)."""
        patches, modes = self.patches, self.resolution.modes
        node = chebyshev.nodes_of(modes)
        return np.asarray(np.repeat(patches.center, modes) + np.repeat(patches.half_width, modes) * node)

    def pressure(self) -> PatchPressure:
        """Return the pressure as Chebyshev series on the patches."""
        rows = zip(self.charges(), self.resolution.nodes.tolist(), strict=True)
        return PatchPressure(self.patches.left, self.patches.right, tuple(row[:nodes] for row, nodes in rows))

    def charges(self) -> FloatArray:
        """Return the Chebyshev coefficients Q_n of the pressure on the patches, (L, max N_i), filled up with zeros."""
        modes = self.resolution.modes
        return patch_kernels.all_charges(modes, *chebyshev.packed_bases(modes), self.series, self.skeleton)


def resolve(elastic: Elastic, patches: Patches, tolerance: float) -> Resolution:
    """Return nodes and modes per patch for a relative tolerance of the coupling."""
    kernel, order = elastic.kernel, elastic.profile.max_order
    least = np.zeros(patches.count) if kernel is None else kernel.coupled_modes(patches.width, tolerance, order)
    if elastic.far is not None:
        least = _coupled_outside(elastic.far, patches, tolerance)
    ladders = chebyshev.size_ladder(MODES_RATIO), chebyshev.size_ladder(NODES_RATIO)
    return Resolution(*patch_kernels.sizes(patches.left, patches.right, tolerance, order, least, *ladders))


def _coupled_outside(far: FarField, patches: Patches, tolerance: float) -> FloatArray:
    """Return the modes by which the first and last patch of a window feel the patches beyond its ends, (L,)."""
    last = far.arc.outer_gap(patches)
    first = (last + 1) % patches.count
    ahead = (far.arc.delta - patches.right[last]) % TWO_PI + far.arc.margins[1]
    behind = (patches.left[first] - far.arc.beta) % TWO_PI + far.arc.margins[0]
    least = np.zeros(patches.count)
    least[last] = chebyshev.coupling_modes(patches.width[last], ahead, tolerance)
    least[first] = max(least[first], float(chebyshev.coupling_modes(patches.width[first], behind, tolerance)))
    return least


def finer(elastic: Elastic, patches: Patches, resolution: Resolution, tolerance: float) -> Resolution:
    """Return the modes for a finer tolerance, at least three more than in `resolution`, and a third more nodes.

    The change by a tolerance a hundred times smaller is the error of an evaluation.
    """
    more = chebyshev.rounded_up(resolution.modes.astype(np.float64) + 3, MODES_RATIO)
    modes = np.maximum(resolve(elastic, patches, tolerance).modes, more)
    nodes = np.maximum(1.33 * resolution.nodes, modes.astype(np.float64)) + 8
    return Resolution(chebyshev.rounded_up(nodes, NODES_RATIO), modes)


def evaluate(
    elastic: Elastic,
    patches: Patches,
    penetration: float,
    tolerance: float,
    resolution: Resolution | None = None,
    with_compliance: bool = True,
) -> Evaluation:
    """Solve for the pressure of given patches at given penetration.

    Parameters
    ----------
    elastic : Elastic
        Dimensionless.
    patches : Patches
        Ordered, disjoint, not complete.
    penetration : float
        Delta, dimensionless.
    tolerance : float
        Of the coupling between patches.
    resolution : Resolution, optional
        Nodes and modes to use; by default as `tolerance` requires.
    with_compliance : bool
        Whether the compliance of the edges is wanted too, as it is where they carry stress intensity.

    Raises
    ------
    IllConditionedSystemError
        The skeleton matrix is not positive definite, or a factor of it has more than `MOST_UNKNOWNS`.
    """
    resolution = resolve(elastic, patches, tolerance) if resolution is None else resolution
    modes, kernel, profile = resolution.modes, elastic.kernel, elastic.profile
    few_waves = _has_few_waves(elastic, modes)
    level = profile.max_height - penetration
    series, x, columns, tail, tail_energy = right_hand_sides(profile, patches, level, resolution)
    columns, moving = _with_others(elastic, x, columns, penetration)
    edge_columns = 4 if elastic.slopes else 2 * with_compliance
    coupling = None if kernel is None else kernel.coupling(x, patches, modes, tolerance, few_waves)
    skeleton = Skeleton(patches, modes, x, columns, coupling, edge_columns)
    solution = solve(skeleton, max(FAR_SHARE * tolerance, FINEST_FAR))
    gram, charges = solution.gram, solution.charges
    radius = np.concatenate([patches.half_width, patches.half_width])
    to_intensity = np.sqrt(np.pi / radius)
    intensity, slope = solution.at_edges * to_intensity, solution.slopes / radius
    return Evaluation(
        patches=patches,
        penetration=penetration,
        stress_intensity=intensity[0] + tail[0] * to_intensity,
        stress_intensity_rate=-np.pi * intensity[moving],
        load=-float(gram[0, moving]),
        load_rate=np.pi * float(gram[moving, moving]),
        elastic_energy=(float(gram[0, 0]) + 0.5 * tail_energy) / (2 * np.pi),
        edge_compliance=solution.compliance,
        slope_compliance=solution.slope_compliance,
        edge_slope=tail[1] / radius - slope[0],
        edge_slope_rate=np.pi * slope[moving],
        resolution=resolution,
        unknowns=x.size,
        series=series,
        skeleton=-charges[0],
        skeleton_rate=np.pi * charges[moving],
        rms_slope=profile.rms_slope,
        intensity_by_probes=intensity[moving + 1 :],
        load_by_probes=-gram[moving + 1 :, moving],
    )


def _with_others(elastic: Elastic, x: FloatArray, columns: FloatArray, penetration: float) -> tuple[FloatArray, int]:
    """Add fields of other patches to the first column, and columns of the far field and the probes behind the second.

    Return the columns, and the index of the column that the penetration scales: 1, or 2 with a far field.
    """
    moving = 1
    for background in elastic.backgrounds:
        columns[0] -= background(x)
    if elastic.far is not None:
        value, rate = elastic.far.at(x, penetration)
        columns[0] -= value
        columns, moving = np.concatenate([columns, 1 + rate[None] / np.pi]), 2
    if elastic.probes:
        fields = [elastic.field_of_charges(np.array([probe]), np.ones(1))(x) for probe in elastic.probes]
        columns = np.concatenate([columns, fields])
    return columns, moving


def _has_few_waves(elastic: Elastic, modes: IntArray) -> bool:
    """Return whether a layer is solved by its waves, not by a matrix; refuse more unknowns than fit."""
    most, kernel = int(modes.max()), elastic.kernel
    few = kernel is not None and kernel.columns <= FEW_WAVES * int(modes.sum())
    largest = most if kernel is None or few else int(modes.sum())
    if largest > MOST_UNKNOWNS or most > MOST_MODES:
        raise IllConditionedSystemError(
            f"{largest} unknowns needed, more than fit: gaps too narrow, or a layer too thin"
        )
    return few


def right_hand_sides(
    profile: Profile, patches: Patches, level: float, resolution: Resolution
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, float]:
    """Return R = pi (level - h) on every patch, in the coupled modes and in the others.

    Returns
    -------
    series : (L, max N_i) array
        Chebyshev coefficients C_n, filled up with zeros.
    x : (n,) array
        Nodes of the coupled modes.
    columns : (2, n) array
        R of the coupled modes at their nodes, and 1.
    tail : (2, 2 L) array
        Sums over n >= p of (n/pi) C_n (+-1)^n and of -(n^3/pi) C_n (+-1)^n at the edges.
    energy : float
        Sum over n >= p of n C_n^2.
    """
    nodes, center, half_width = resolution.nodes.tolist(), patches.center, patches.half_width
    series = np.zeros((patches.count, max(nodes)))
    for i, size in enumerate(nodes):
        if size > chebyshev.SMALL_TRANSFORM:
            height = profile.height(center[i] + half_width[i] * chebyshev.basis_nodes(size))
            series[i, :size] = chebyshev.coefficients(-np.pi * height)
    return series, *patch_kernels.right_hand_sides(
        profile.table,
        center,
        half_width,
        level,
        resolution.nodes,
        *chebyshev.packed_nodes(resolution.nodes),
        resolution.modes,
        *chebyshev.packed_bases(resolution.modes),
        series,
        chebyshev.SMALL_TRANSFORM,
    )
