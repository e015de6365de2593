"""Energy release rate at every contact edge by a domain integral, and the signed stress intensity from it.

With theta the velocity (in x) of a motion of the body that carries one edge along, the derivative of the discrete
elastic energy at fixed plate displacement is, exactly (Destuynder, Djaoua, Lescure, J. Mec. Theor. Appl. 2 (1983)
113; Shih, Moran, Nakamura, Int. J. Fract. 30 (1986) 79, doi:10.1007/BF00034019, with the rigid profile added),

    dU = int [ W theta,x - sigma_ij u_i,x theta,j ] dA + sum_i r_i (h' theta)_i,
    W = mu (eps : eps - tr(eps)^2 / 3) - p div u - p^2 / (2 k),

theta piecewise linear on the mesh, r_i the nodal reactions on the contact, (h' theta)_i the nodal values that carry
h' theta as those of the displacement carry h (see `face`). The integral comes from the derivatives of the matrices of
the elements. The last sum is what a curved profile adds: the prescribed displacement changes as its points move.
G = dU for an edge moving outwards (+ at a right end, - at a left end).

G is quadratic in the state, G = G_AA + 2 P G_AB + P^2 G_BB (states A and B of `contact`), and by Irwin a perfect
square, G = K^2 / (2 E*) with K linear in the load. A unit load under a flat face closes the edge, which fixes the
sign:

    k_B = -sqrt(2 E* G_BB),   k_A = 2 E* G_AB / k_B,   K = k_A + P k_B;     sigma -> -K / sqrt(2 pi rho).

How far the quadratic form is from a square, the rank-one defect, is an error indicator that needs no second mesh.

Units: as in `problem`; G in E a^2 / lambda, K in E a / sqrt(lambda).
"""

from dataclasses import dataclass

import numpy as np

from fem_reference.contact import UnitStates
from fem_reference.elasticity import moved_elements
from fem_reference.face import face_nodes, nodal_profile
from fem_reference.factors import SingularSystemError
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
        """Return the values at a load per period."""
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
    """Return the velocity theta (n_vertices,) that carries the tip and dies out at a distance.

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
    """Return the bilinear derivative (2, 2) of the energy of states A and B under a motion of the vertices in x.

    Parameters
    ----------
    states : UnitStates
    motion : FloatArray, shape (n_vertices,)
        theta at the vertices; equal on both sides of the seam, zero on the plate or constant in x there.
    """
    corners = motion[states.mesh.triangles.t]
    moving = np.flatnonzero(np.any(corners != corners[0], axis=0))
    return _profile_term(states, motion) + (_volume_term(states, moving, motion) if moving.size else 0.0)


def _volume_term(states: UnitStates, elements: IntArray, motion: FloatArray) -> FloatArray:
    """Return the energy of the elements in which theta changes, by derivatives of their matrices."""
    mu, softness = states.problem.shear_modulus, states.problem.inverse_bulk_modulus
    matrices = moved_elements(states.spaces, mu, softness, elements, motion)
    nodal = states.fields.T[states.stiffness.dofs[elements]]
    return np.asarray(0.5 * np.sum(nodal.swapaxes(1, 2) @ (matrices @ nodal), axis=0))


def _profile_term(states: UnitStates, motion: FloatArray) -> FloatArray:
    """Return the sum over contact values of r_i (h' theta)_i; only state A follows the profile."""
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
    """Return the energy release rate and signed stress intensity of the unit states at every edge.

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
