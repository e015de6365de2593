"""Energy release rate at every contact edge by a domain integral, and the signed stress intensity from it.

With theta the velocity (in x) of a motion of the body that carries one edge along, the derivative of the discrete
elastic energy at fixed plate displacement is, exactly (Destuynder, Djaoua, Lescure, J. Mec. Theor. Appl. 2 (1983)
113; Shih, Moran, Nakamura, Int. J. Fract. 30 (1986) 79, doi:10.1007/BF00034019, with the rigid profile added),

    dU = int [ W theta,x - sigma_ij u_i,x theta,j ] dA + sum_i r_i (h' theta)_i,
    W = mu (eps : eps - tr(eps)^2 / 3) - p div u - p^2 / (2 k),

theta piecewise linear on the mesh, r_i the nodal reactions on the contact, (h' theta)_i the nodal values that carry
h' theta as those of the displacement carry h (see `face`). The last sum is what a curved profile adds: the prescribed
displacement changes as its points move. G = dU for an edge moving outwards (+ at a right end, - at a left end).

G is quadratic in the state, G = G_AA + 2 P G_AB + P^2 G_BB (states A and B of `contact`), and by Irwin a perfect
square, G = K^2 / (2 E*) with K linear in the load. A unit load under a flat face closes the edge, which fixes the
sign:

    k_B = -sqrt(2 E* G_BB),   k_A = 2 E* G_AB / k_B,   K = k_A + P k_B;     sigma -> -K / sqrt(2 pi rho).

How far the quadratic form is from a square, the rank-one defect, is an error indicator that needs no second mesh.

Units: as in `problem`; G in E a^2 / lambda, K in E a / sqrt(lambda).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_reference.contact import UnitStates
from fem_reference.elasticity import SingularSystemError
from fem_reference.face import face_nodes, nodal_profile
from fem_reference.problem import FloatArray, IntArray

PLATEAU = 0.4  # theta is one within this fraction of its radius
RADIUS = 0.8  # of the distance to the next edge, the seam or the plate


@dataclass(frozen=True)
class EdgeStates:
    """Energy release rate and stress intensity of the unit states at every edge.

    Parameters
    ----------
    release_rate : FloatArray, shape (n_patches, 2, 2, 2)
        Bilinear G of states (A, B) at each edge (patch, left or right).
    stress_intensity : FloatArray, shape (n_patches, 2, 2)
        k_A and k_B in the last axis.
    defect : FloatArray, shape (n_patches, 2)
        G_AA - k_A^2 / (2 E*), the part of G that is no square.
    """

    release_rate: FloatArray
    stress_intensity: FloatArray
    defect: FloatArray

    def at_load(self, load: float) -> "EdgeValues":
        """Values at a load per period."""
        form = self.release_rate
        rate = form[..., 0, 0] + 2.0 * load * form[..., 0, 1] + load**2 * form[..., 1, 1]
        signed = self.stress_intensity[..., 0] + load * self.stress_intensity[..., 1]
        scale = form[..., 0, 0] + load**2 * form[..., 1, 1]
        return EdgeValues(signed, rate, np.abs(self.defect) / np.where(scale > 0.0, scale, 1.0))


@dataclass(frozen=True)
class EdgeValues:
    """Stress intensity (signed), energy release rate and relative rank-one defect, each (n_patches, 2)."""

    stress_intensity: FloatArray
    release_rate: FloatArray
    defect: FloatArray


def motion_around(states: UnitStates, tip: float, radius: float) -> FloatArray:
    """Velocity theta (n_vertices,) that carries the tip and dies out at a distance.

    Parameters
    ----------
    states : UnitStates
    tip : float
        Local coordinate of the edge.
    radius : float
        Distance at which theta vanishes; it is one within `PLATEAU` of it.
    """
    x, y = states.mesh.triangles.p
    distance = np.hypot(x - tip, y) / radius
    return np.asarray(np.clip((1.0 - distance) / (1.0 - PLATEAU), 0.0, 1.0))


def energy_derivative(states: UnitStates, motion: FloatArray) -> FloatArray:
    """Bilinear derivative (2, 2) of the energy of states A and B under a motion of the vertices in x.

    Parameters
    ----------
    states : UnitStates
    motion : FloatArray, shape (n_vertices,)
        theta at the vertices; equal on both sides of the seam, zero on the plate or constant in x there.
    """
    triangles = states.mesh.triangles
    corner = triangles.p[:, triangles.t]
    edge1, edge2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    twice_area = edge1[0] * edge2[1] - edge1[1] * edge2[0]
    d1, d2 = (motion[triangles.t[i]] - motion[triangles.t[0]] for i in (1, 2))
    motion_x = (d1 * edge2[1] - d2 * edge1[1]) / twice_area
    motion_y = (d2 * edge1[0] - d1 * edge2[0]) / twice_area
    moving = np.flatnonzero((motion_x != 0.0) | (motion_y != 0.0))
    volume = _volume_term(states, moving, motion_x[moving], motion_y[moving])
    return volume + _profile_term(states, motion)


def _volume_term(states: UnitStates, elements: IntArray, motion_x: FloatArray, motion_y: FloatArray) -> FloatArray:
    V, Q = states.spaces.displacement, states.spaces.pressure
    n, _ = states.spaces.sizes
    mu, softness = states.problem.shear_modulus, states.problem.inverse_bulk_modulus
    gradients, pressures = [], []
    for field in states.fields:
        gradient = np.zeros((2, 2, len(elements), V.X.shape[-1]))
        for component in range(2):
            nodal = field[component * n : (component + 1) * n]
            for i in range(V.Nbfun):
                local = nodal[V.element_dofs[i, elements]][:, None]
                gradient[component] += local * V.basis[i][0].grad[:, elements]
        nodal = field[2 * n :]
        local_pressure = np.zeros(gradient.shape[2:])
        for i in range(Q.Nbfun):
            local_pressure += (
                nodal[Q.element_dofs[i, elements]][:, None] * np.asarray(Q.basis[i][0])[_rows(Q, i, elements)]
            )
        gradients.append(gradient)
        pressures.append(local_pressure)
    weights = V.dx[elements]
    strains = [0.5 * (g + g.transpose(1, 0, 2, 3)) for g in gradients]
    traces = [g[0, 0] + g[1, 1] for g in gradients]
    result = np.zeros((2, 2))
    for a in range(2):
        for b in range(a, 2):
            density = mu * (np.sum(strains[a] * strains[b], axis=(0, 1)) - traces[a] * traces[b] / 3.0)
            density -= 0.5 * (pressures[a] * traces[b] + pressures[b] * traces[a])
            density -= 0.5 * softness * pressures[a] * pressures[b]
            total = density * motion_x[:, None]
            for one, other in ((a, b), (b, a)):
                for i in range(2):
                    for j, theta in enumerate((motion_x, motion_y)):
                        stress = 2.0 * mu * strains[one][i, j]
                        if i == j:
                            stress = stress - 2.0 / 3.0 * mu * traces[one] - pressures[one]
                        total = total - 0.5 * stress * gradients[other][i, 0] * theta[:, None]
            result[a, b] = result[b, a] = float(np.sum(total * weights))
    return result


def _rows(basis: Any, i: int, elements: IntArray) -> Any:
    """Index of the given elements in the values of basis function i (kept once for all elements when they agree)."""
    value = np.asarray(basis.basis[i][0])
    return slice(None) if value.shape[0] == 1 else elements


def _profile_term(states: UnitStates, motion: FloatArray) -> FloatArray:
    """Sum over contact values of r_i (h' theta)_i; only state A follows the profile."""
    vertices = states.mesh.triangles.p
    face = np.flatnonzero(np.abs(vertices[1]) < 1e-14)
    face = face[np.argsort(vertices[0, face])]
    nodes = face_nodes(states.spaces)
    carried = np.zeros(states.spaces.sizes[0])
    carried[nodes.index] = nodal_profile(
        nodes,
        lambda x: states.problem.slope(states.mesh.seam + x) * np.interp(x, vertices[0, face], motion[face]),
    )
    to_a = states.reactions @ carried[states.constraints.contact]
    return np.array([[to_a[0], 0.5 * to_a[1]], [0.5 * to_a[1], 0.0]])


def edge_states(states: UnitStates, radius: float = RADIUS) -> EdgeStates:
    """Energy release rate and signed stress intensity of the unit states at every edge.

    Parameters
    ----------
    states : UnitStates
    radius : float
        Radius of the domain as a fraction of the distance to the next edge, the seam or the plate.

    Raises
    ------
    SingularSystemError
        When the release rate of state B is not positive, which only a hopelessly coarse mesh does.
    """
    tips, reach = states.mesh.local_edges, states.mesh.reach()
    form = np.zeros((*tips.shape, 2, 2))
    for patch in range(len(tips)):
        for side, outwards in enumerate((-1.0, 1.0)):
            motion = motion_around(states, tips[patch, side], radius * reach[patch, side])
            form[patch, side] = outwards * energy_derivative(states, motion)
    modulus = states.problem.plane_strain_modulus
    if np.any(form[..., 1, 1] <= 0.0):
        raise SingularSystemError(
            "the energy release rate of a flat punch is not positive: the mesh is too coarse there"
        )
    k_b = -np.sqrt(2.0 * modulus * form[..., 1, 1])
    k_a = 2.0 * modulus * form[..., 0, 1] / k_b
    defect = form[..., 0, 0] - k_a**2 / (2.0 * modulus)
    return EdgeStates(form, np.stack([k_a, k_b], axis=-1), defect)
