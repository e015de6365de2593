"""Two unit states of a layer in contact on given patches, whose combination is the state under any load.

State A carries no load: u_y = h - h_max + u_tot,A on the contact, its nodal reactions summing to zero. State B
carries a unit load per period under a flat face: u_y = u_tot,B on the contact. At load P the state is A + P B.
Working with the load instead of the displacement keeps an incompressible layer in full contact regular: there B is
the uniform pressure and its displacement is zero.

Penetration and total displacement (both computed here, from the finite element field alone): u_tot is the
displacement of the plate, Delta = u_tot - mean(u_y over the face). The mean equals c(0) P / lambda by Betti's
theorem, which is a check, not the definition.

Reactions r_i are nodal forces of the discrete body on its contact values; the load is their sum. The pressure is their
projection: the field t of the trace space on the contact with int t v = sum r_i v_i for every v.

Units: as in `problem` (dimensionless).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from fem_reference.elasticity import (
    Constraints,
    Spaces,
    Stiffness,
    assemble,
    constrain,
    taylor_hood,
)
from fem_reference.face import face_nodes, interpolate, newton_cotes, nodal_profile
from fem_reference.factors import factorise
from fem_reference.mesh import LayerMesh
from fem_reference.problem import BoolArray, FloatArray, Problem

ON_EDGE = 1e-12  # periods: nodal values this close to an edge belong to the contact
NEARLY = 1e-3  # change of a patch or gap up to which factors serve: each refinement gains about as much


@dataclass(frozen=True)
class UnitStates:
    """States A (no load) and B (unit load) on one mesh.

    Parameters
    ----------
    problem : Problem
    mesh : LayerMesh
    spaces : Spaces
    stiffness : Stiffness
    constraints : Constraints
    fields : FloatArray, shape (2, 2 n + m)
        Nodal values (u_x, u_y, p) of A and B.
    reactions : FloatArray, shape (2, n_contact)
        Nodal contact forces of A and B, positive in compression.
    displacement_of_plate : FloatArray, shape (2,)
        u_tot of A and B.
    mean_displacement : FloatArray, shape (2,)
        Mean of u_y over the face of A and B.
    energy : FloatArray, shape (2, 2)
        Bilinear strain energy: U = e[0, 0] + 2 P e[0, 1] + P^2 e[1, 1].
    """

    problem: Problem
    mesh: LayerMesh
    spaces: Spaces
    stiffness: Stiffness
    constraints: Constraints
    fields: FloatArray
    reactions: FloatArray
    displacement_of_plate: FloatArray
    mean_displacement: FloatArray
    energy: FloatArray

    @property
    def penetration(self) -> FloatArray:
        """Delta of A and B, shape (2,)."""
        return self.displacement_of_plate - self.mean_displacement

    @property
    def unknowns(self) -> int:
        """Number of free unknowns."""
        return int(self.constraints.matrix.shape[1])


@dataclass(frozen=True)
class ContactIndicator:
    """Indicator of contact at local coordinates; edges are (n_patches, 2), empty where all is in contact."""

    edges: FloatArray

    def __call__(self, x: FloatArray) -> BoolArray:
        """Return booleans of the shape of x: true where x lies in a patch or on its edge."""
        if self.edges.size == 0:
            return np.ones(np.shape(x), dtype=bool)
        inside = np.zeros(np.shape(x), dtype=bool)
        for a, b in self.edges:
            after, before = x >= a - ON_EDGE, x <= b + ON_EDGE
            inside |= (after & before) if a < b else (after | before)
        return inside


def contact_indicator(mesh: LayerMesh) -> ContactIndicator:
    """Return the membership of local positions X in the contact of a mesh."""
    return ContactIndicator(mesh.local_edges)


@dataclass
class KeptFactors:
    """Factors of the last mesh factorised; they also serve meshes of its topology whose edges are nearly equal."""

    mesh: LayerMesh | None = None
    factors: Any = None

    def near(self, mesh: LayerMesh) -> Any:
        """Return the factors where no patch or gap differs by more than `NEARLY` of itself; else None."""
        if self.mesh is None or self.mesh.reference is not mesh.reference or mesh.edges.size == 0:
            return None
        old, new = (np.diff(np.append(m.edges.ravel(), m.edges[0, 0] + 1.0)) for m in (self.mesh, mesh))
        return self.factors if np.max(np.abs(new / old - 1.0)) < NEARLY else None


def solve_unit_states(problem: Problem, mesh: LayerMesh, order: int, kept: KeptFactors | None = None) -> UnitStates:
    """Assemble, factorise once, and solve for states A and B.

    Parameters
    ----------
    problem : Problem
    mesh : LayerMesh
    order : int
        2 (P2/P1) or 4 (P4/P3).
    kept : Factors, optional
        Of the last mesh of this order; used where they are near, else replaced by those of this one.

    Raises
    ------
    SingularSystemError
        When the linear solver misses its residual.
    """
    spaces = taylor_hood(mesh.triangles, order, quadrature_order=0)  # integrals are those of the reference triangle
    stiffness = assemble(spaces, problem.shear_modulus, problem.inverse_bulk_modulus)
    constraints = constrain(spaces, mesh.depth, contact_indicator(mesh))
    near = None if kept is None else kept.near(mesh)
    system = factorise(stiffness, constraints, problem.inverse_bulk_modulus, near)
    if kept is not None and near is None:
        kept.mesh, kept.factors = mesh, system.factors
    n, m = spaces.sizes
    lift = np.zeros(2 * n + m)
    nodes = face_nodes(spaces)
    on_face = np.zeros(n)
    on_face[nodes.index] = nodal_profile(nodes, lambda x: problem.height(mesh.seam + x) - problem.highest)
    lift[n + constraints.contact_values] = on_face[constraints.contact_values]
    T = constraints.matrix
    rhs = np.zeros((T.shape[1], 2))
    rhs[:, 0] = -(T.T @ stiffness.times(lift[None])[0])
    rhs[-1, 1] = 1.0
    free = system.solve(rhs)
    fields = np.asarray((T @ free).T)
    fields[0] += lift
    reactions = _reactions(spaces, stiffness, constraints, fields)
    given = np.stack([lift[n + constraints.contact], np.zeros(len(constraints.contact))])
    given = given + free[-1][:, None]
    energy = 0.5 * reactions @ given.T
    energy = 0.5 * (energy + energy.T)
    mean = np.array([_mean_on_face(spaces, field) for field in fields])
    return UnitStates(problem, mesh, spaces, stiffness, constraints, fields, reactions, free[-1], mean, energy)


def _reactions(spaces: Spaces, stiffness: Stiffness, constraints: Constraints, fields: FloatArray) -> FloatArray:
    """Return the nodal forces (2, n_contact) on the contact values, both sides of the seam added."""
    n, _ = spaces.sizes
    force = stiffness.times(fields)[:, n : 2 * n]
    summed = np.zeros((len(fields), n))
    for i in range(len(fields)):
        np.add.at(summed[i], constraints.same, force[i])
    return summed[:, constraints.contact]


def _mean_on_face(spaces: Spaces, field: FloatArray) -> float:
    """Return the mean of u_y over the face."""
    n, _ = spaces.sizes
    nodes = face_nodes(spaces)
    value = field[n + nodes.index]
    p = nodes.order
    lengths = np.diff(nodes.x[::p])
    parts = sum(weight * value[k : len(value) - p + k : p] for k, weight in enumerate(newton_cotes(p)))
    return float(np.sum(lengths * parts))


def projected_pressure(states: UnitStates, load: float) -> FloatArray:
    """Return the pressure at the sorted face nodes (n_face,), zero outside the contact.

    At an edge it is the one-sided value of the projection; the exact pressure is singular there, so pointwise values
    within a few of the smallest triangles of an edge mean little.
    """
    nodes = face_nodes(states.spaces)
    n, _ = states.spaces.sizes
    p = nodes.order
    constraints = states.constraints
    force = np.zeros(n)
    force[constraints.contact] = states.reactions[0] + load * states.reactions[1]
    inside = contact_indicator(states.mesh)
    middle = 0.5 * (nodes.x[:-1:p] + nodes.x[p::p])
    facets = np.flatnonzero(inside(middle))
    local = facets[:, None] * p + np.arange(p + 1)
    lengths = np.diff(nodes.x[::p])[facets]
    shared = constraints.same[nodes.index]
    gauss, weights = np.polynomial.legendre.leggauss(p + 1)
    t = 0.5 * (gauss + 1.0)
    unit = np.array([interpolate(t, np.linspace(0, 1, p + 1), row, p) for row in np.eye(p + 1)])
    mass = 0.5 * (unit * weights) @ unit.T
    columns, member = np.unique(shared[local], return_inverse=True)
    member = member.reshape(local.shape)
    entries = lengths[:, None, None] * mass
    row = np.broadcast_to(member[:, :, None], entries.shape)
    col = np.broadcast_to(member[:, None, :], entries.shape)
    matrix = coo_matrix((entries.ravel(), (row.ravel(), col.ravel())), shape=(len(columns),) * 2).tocsc()
    scale = np.sqrt(matrix.diagonal())
    scaled = matrix.multiply(1.0 / scale[:, None]).multiply(1.0 / scale[None, :]).tocsc()
    values = spsolve(scaled, force[columns] / scale) / scale
    pressure = np.zeros(len(nodes.x))
    pressure[local] = values[member]
    return pressure
