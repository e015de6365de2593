"""Result of a solution: SI values, each with its uncertainty.

Energies and loads are per period of the profile and unit length in the third direction. u_tot is the displacement of
the plate from first touch of the undeformed layer; Delta = u_tot - mean(u_y over the face) is the penetration, its
mean part computed from the finite element field itself (for the exact solution it is c(0) times the mean pressure).
`strain_energy` is the whole elastic energy of the layer; `elastic_energy` excludes the mean compression,

    elastic_energy = strain_energy - load * mean(u_y) / 2.

Uncertainties are those of `uncertainty`, on meshes of sizes h = 1 / cells. The theoretical order of every number is
2 m, m that of the displacement elements: each is a linear or quadratic functional of the solution, and the levels at
the edges keep pace. Displacements and gaps at a point have the order m + 1, pressures m.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from fem_reference.closure import Evaluation
from fem_reference.contact import projected_pressure
from fem_reference.face import face_nodes, interpolate, nodal_profile
from fem_reference.mesh import Resolution
from fem_reference.problem import FloatArray, IntArray, Problem
from fem_reference.uncertainty import ROUNDING, uncertainty

Status = Literal[
    "converged",
    "complete_contact",
    "interpenetration",
    "negative_stress_intensity",
    "no_equilibrium",
    "not_converged",
]
Quantity = float | FloatArray

WINDOW = 0.8  # of a patch: what its middle pressure is averaged over


@dataclass(frozen=True)
class Interface:
    """Fields along the lower face at its nodes, x increasing from the seam over one period.

    Parameters
    ----------
    x : FloatArray, shape (n_face,)
        Positions in m; may run past the period.
    displacement : FloatArray, shape (n_face,)
        u_y in the plate's frame, m, positive into the layer, its mean included.
    gap : FloatArray, shape (n_face,)
        u_y - (h - h_max + u_tot), m; the interpolation error of h on the contact.
    pressure : FloatArray, shape (n_face,)
        Projection of the nodal reactions, Pa; zero outside the contact, where the face is free.
    """

    x: FloatArray
    displacement: FloatArray
    gap: FloatArray
    pressure: FloatArray


@dataclass(frozen=True, repr=False)
class Result:
    """A state of the layer with the uncertainty of every quantity, SI units.

    Parameters
    ----------
    status : str
        `converged`; `complete_contact`; `negative_stress_intensity` (an edge with K < 0: the faces overlap beside it);
        `interpenetration` (an uncovered part of the profile enters the layer); `no_equilibrium` (the closure ran into a
        vanishing patch or gap, or a limit point); `not_converged`. Numbers of the last two are those of the last
        iterate, their uncertainties infinite.
    message : str
        What happened, when not converged.
    edges : FloatArray, shape (n_patches, 2)
        Contact edges in m, a in [0, period) increasing, b may exceed it; empty in complete contact.
    contact_fraction : float
        Projected, 0 to 1.
    load, mean_pressure : float
        N/m per period and Pa, positive in compression.
    penetration, total_displacement : float
        Delta and u_tot, m (module docstring).
    strain_energy, elastic_energy, adhesion_energy, total_energy : float
        J/m per period; total = elastic + adhesion.
    middle_pressure : FloatArray, shape (n_patches,)
        Mean pressure of each patch away from its edges, Pa: under the weight (1 - (t / 0.8)^2)^4, |t| < 0.8, t from -1
        to 1 across the patch.
    stress_intensity, energy_release_rate, rank_one_defect : FloatArray, shape (n_patches, 2)
        K in Pa sqrt(m), signed, positive when it opens; G in J/m^2; the relative defect, dimensionless.
    interface : Interface
    closure_residual : float or None
        Largest relative |K - K_c|; None for prescribed edges.
    min_eigenvalue : float or None
        Smallest eigenvalue of the Hessian of the energy at the given control, J/m^3; None for prescribed edges or
        without adhesion.
    uncertainty : mapping
        From the names above (and `displacement`, `gap`, `pressure`: those of `interface`, at every node) to numbers of
        the same shape and unit.
    """

    status: Status
    message: str
    problem: Problem
    edges: FloatArray
    contact_fraction: float
    load: float
    mean_pressure: float
    penetration: float
    total_displacement: float
    strain_energy: float
    elastic_energy: float
    adhesion_energy: float
    total_energy: float
    middle_pressure: FloatArray
    stress_intensity: FloatArray
    energy_release_rate: FloatArray
    rank_one_defect: FloatArray
    interface: Interface
    closure_residual: float | None
    min_eigenvalue: float | None
    uncertainty: Mapping[str, Quantity]
    resolution: Resolution
    unknowns: int
    evaluation: Evaluation

    def __repr__(self) -> str:
        numbers = [("mean pressure", self.mean_pressure, "mean_pressure", " Pa")]
        numbers += [("contact fraction", self.contact_fraction, "contact_fraction", "")]
        told = [f"{name} {value:.6g} +- {self.uncertainty[key]:.1g}{unit}" for name, value, key, unit in numbers]
        return f"<Result {self.status}: {', '.join(told)}, patches {len(self.edges)}, unknowns {self.unknowns}>"

    @property
    def separation(self) -> float:
        """Distance of the mean planes of face and profile, h_max - Delta, m; as uncertain as the penetration."""
        return self.problem.highest * self.problem.unit_height - self.penetration

    @cached_property
    def stable(self) -> bool | None:
        """True if the equilibrium is a minimum of the energy at the given control; None when not asked."""
        return None if self.min_eigenvalue is None else self.min_eigenvalue > 0.0

    def displacement(self, x: ArrayLike) -> FloatArray:
        """Return u_y of the face at positions x in m (any shape), evaluated in the elements."""
        local = (np.asarray(x, dtype=float) / self.problem.period - self.evaluation.states.mesh.seam) % 1.0
        return face_displacement(self.evaluation, local) * self.problem.unit_height

    def gap(self, x: ArrayLike) -> FloatArray:
        """Return the gap u_y - (h - h_max + u_tot) at positions x in m (any shape)."""
        at = np.asarray(x, dtype=float)
        rigid = (self.problem.height(at / self.problem.period) - self.problem.highest) * self.problem.unit_height
        return np.asarray(self.displacement(at) - rigid - self.total_displacement)

    def uncertainty_at(self, field: Literal["displacement", "gap", "pressure"], x: ArrayLike) -> FloatArray:
        """Return the uncertainty of a field at positions x in m: the larger of the two nodes beside x."""
        nodes = self.interface.x
        local = nodes[0] + (np.asarray(x, dtype=float) - nodes[0]) % self.problem.period
        after = np.clip(np.searchsorted(nodes, local), 1, len(nodes) - 1)
        values = np.asarray(self.uncertainty[field])
        return np.asarray(np.maximum(values[after - 1], values[after]))


def _combined(evaluation: Evaluation) -> FloatArray:
    fields = evaluation.states.fields
    return np.asarray(fields[0] + evaluation.load * fields[1])


def face_displacement(evaluation: Evaluation, local: FloatArray) -> FloatArray:
    """Return u_y of the face at local coordinates in [0, 1), rms heights."""
    nodes = face_nodes(evaluation.states.spaces)
    values = _combined(evaluation)[evaluation.states.spaces.sizes[0] + nodes.index]
    return interpolate(local, nodes.x, values, nodes.order)


def patch_order(evaluation: Evaluation) -> IntArray:
    """Return the order (n_patches,) of the patches by a in [0, period), as results list them."""
    return np.asarray(np.argsort(evaluation.edges[:, 0] % 1.0)) if evaluation.edges.size else np.zeros(0, dtype=int)


def contact_edges(evaluation: Evaluation) -> FloatArray:
    """Return the edges (n_patches, 2) in periods with every a in [0, 1), in the order of the computation."""
    edges = evaluation.edges
    return edges - np.floor(edges[:, :1]) if edges.size else edges


def adhesion_energy(problem: Problem, edges: FloatArray) -> float:
    """Return - int gamma sqrt(1 + h'^2) over the patches (n_patches, 2), E a^2; a full period without edges.

    Composite Gauss rule with 16 points on pieces of 1/8 of the shortest wavelength: exact to rounding.
    """
    spans = edges if edges.size else np.array([[0.0, 1.0]])
    gauss, weights = np.polynomial.legendre.leggauss(16)
    total = 0.0
    for a, b in spans:
        pieces = np.linspace(a, b, int(np.ceil((b - a) * 8 * problem.highest_order)) + 1)
        half = 0.5 * np.diff(pieces)[:, None]
        x = 0.5 * (pieces[1:] + pieces[:-1])[:, None] + half * gauss
        total -= float(np.sum(half * weights * problem.work_of_opening(x)))
    return total


def middle_pressure(evaluation: Evaluation) -> FloatArray:
    """Return the weighted mean pressure (n_patches,) of the middle of each patch, E a / lambda.

    The weight is carried by nodal values as the profile is, so that no pressure is projected and none interpolated.
    """
    states = evaluation.states
    nodes = face_nodes(states.spaces)
    reactions = states.reactions[0] + evaluation.load * states.reactions[1]
    means = []
    for (left, _), width in zip(states.mesh.local_edges, np.diff(evaluation.edges, axis=1)[:, 0], strict=True):

        def weight(x: FloatArray, left: float = left, width: float = width) -> FloatArray:
            t = 2.0 * ((x - left) % 1.0) / width - 1.0
            return np.asarray(np.maximum(1.0 - (t / WINDOW) ** 2, 0.0) ** 4)

        carried = np.zeros(states.spaces.sizes[0])
        carried[nodes.index] = nodal_profile(nodes, weight)
        integral = 128.0 / 315.0 * WINDOW * width
        means.append(float(reactions @ carried[states.constraints.contact]) / integral)
    return np.array(means)


def strain_energy(evaluation: Evaluation) -> float:
    """Return the whole elastic energy of the layer, E a^2."""
    energy, load = evaluation.states.energy, evaluation.load
    return float(energy[0, 0] + 2.0 * load * energy[0, 1] + load**2 * energy[1, 1])


def quantities(evaluation: Evaluation, order: IntArray | None = None) -> dict[str, Quantity]:
    """Return every scalar and edge quantity of one mesh in SI units, by the names of `Result`.

    Patches are listed by `patch_order`, or in a given order. Meshes that are compared need one order: an edge near the
    end of the period may fall on either side of it.
    """
    listed = patch_order(evaluation) if order is None else order
    states, load = evaluation.states, evaluation.load
    problem, values = states.problem, evaluation.values
    strain = strain_energy(evaluation)
    mean = float(states.mean_displacement[0] + load * states.mean_displacement[1])
    plate = float(states.displacement_of_plate[0] + load * states.displacement_of_plate[1])
    edges = contact_edges(evaluation)
    adhesion = adhesion_energy(problem, edges)
    elastic = strain - 0.5 * load * mean
    return {
        "edges": edges[listed] * problem.unit_length,
        "contact_fraction": float(np.sum(np.diff(edges, axis=1))) if edges.size else 1.0,
        "load": load * problem.unit_load,
        "mean_pressure": load * problem.unit_stress,
        "penetration": (plate - mean) * problem.unit_height,
        "total_displacement": plate * problem.unit_height,
        "strain_energy": strain * problem.unit_energy,
        "elastic_energy": elastic * problem.unit_energy,
        "adhesion_energy": adhesion * problem.unit_energy,
        "total_energy": (elastic + adhesion) * problem.unit_energy,
        "middle_pressure": middle_pressure(evaluation)[listed] * problem.unit_stress,
        "stress_intensity": values.stress_intensity[listed] * problem.unit_stress_intensity,
        "energy_release_rate": values.release_rate[listed] * problem.unit_release_rate,
    }


def interface_fields(evaluation: Evaluation) -> Interface:
    """Return the fields along the face of one mesh, SI units."""
    states, problem = evaluation.states, evaluation.states.problem
    nodes = face_nodes(states.spaces)
    x = states.mesh.seam + nodes.x
    displacement = face_displacement(evaluation, nodes.x)
    plate = float(states.displacement_of_plate[0] + evaluation.load * states.displacement_of_plate[1])
    gap = displacement - (problem.height(x) - problem.highest + plate)
    return Interface(
        x * problem.unit_length,
        displacement * problem.unit_height,
        gap * problem.unit_height,
        projected_pressure(states, evaluation.load) * problem.unit_stress,
    )


def sizes_of(resolutions: Sequence[Resolution]) -> list[float]:
    """Return the size of each mesh, periods."""
    return [1.0 / resolution.cells for resolution in resolutions]


def spread(values: Sequence[FloatArray], resolutions: Sequence[Resolution]) -> FloatArray:
    """Return the uncertainty of the last of two or more values of one quantity, coarsest mesh first."""
    return uncertainty(values, sizes_of(resolutions), 2 * resolutions[-1].order)


def aligned_values(name: str, evaluations: Sequence[Evaluation]) -> list[FloatArray]:
    """Return the values of one quantity on every mesh, edges taken to the period of the last."""
    order = patch_order(evaluations[-1])
    values = [np.asarray(quantities(e, order)[name], dtype=float) for e in evaluations]
    if name == "edges" and values[-1].size:
        period = evaluations[-1].states.problem.period
        values = [values[-1] + nearest_period(v - values[-1], period) for v in values]
    return values


def uncertainties(evaluations: Sequence[Evaluation]) -> dict[str, Quantity]:
    """Return the uncertainty of every quantity of the last evaluation, from two or more meshes, coarsest first."""
    resolutions = [evaluation.resolution for evaluation in evaluations]
    result: dict[str, Quantity] = {}
    for name in quantities(evaluations[-1]):
        total = spread(aligned_values(name, evaluations), resolutions)
        result[name] = total if total.ndim else float(total)
    return result | _field_uncertainties(evaluations)


def _field_uncertainties(evaluations: Sequence[Evaluation]) -> dict[str, Quantity]:
    """Return the uncertainty of displacement, gap and pressure at the face nodes of the last evaluation, SI units.

    A node has the largest uncertainty of its facets, because two meshes may agree at a point by chance.
    """
    fine = evaluations[-1]
    problem, at = fine.states.problem, interface_fields(fine).x / fine.states.problem.period
    values: dict[str, list[FloatArray]] = {"displacement": [], "gap": [], "pressure": []}
    for evaluation in evaluations:
        nodes, face = face_nodes(evaluation.states.spaces), interface_fields(evaluation)
        local = at - fine.states.mesh.seam if evaluation is fine else (at - evaluation.states.mesh.seam) % 1.0
        displacement = interpolate(local, nodes.x, face.displacement, nodes.order)
        values["displacement"].append(displacement)
        values["gap"].append(displacement - float(quantities(evaluation)["total_displacement"]))
        values["pressure"].append(interpolate(local, nodes.x, face.pressure, nodes.order))
    units = (problem.unit_height, problem.unit_height, problem.unit_stress)
    m, sizes = fine.resolution.order, sizes_of([evaluation.resolution for evaluation in evaluations])
    return {
        name: _largest_beside(uncertainty(values[name], sizes, m + (name != "pressure")), m) + ROUNDING * unit
        for name, unit in zip(values, units, strict=True)
    }


def _largest_beside(values: FloatArray, order: int) -> FloatArray:
    """Return the largest of (n_facets * order + 1,) nodal values in the facets a node belongs to."""
    inner = np.lib.stride_tricks.sliding_window_view(values, order + 1)[::order].max(axis=1)
    result = np.repeat(inner, order)
    result[order::order] = np.maximum(inner[1:], inner[:-1])
    return np.append(result, inner[-1])


def nearest_period(difference: FloatArray, period: float) -> FloatArray:
    """Return differences of positions with whole periods taken off."""
    return np.asarray(difference - period * np.round(difference / period))
