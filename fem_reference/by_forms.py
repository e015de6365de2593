"""A layer in contact on given edges, by scikit-fem's forms and bases from top to bottom: the method to read first.

One period of an elastic layer, 0 < y < d, is bonded to a rigid plate at y = d. Its lower face is free but on the
contact, where u_y = h(x) - h_max + u_tot without friction (h the rigid profile, u_tot the displacement of the plate
from first touch). With mu the shear modulus, k the bulk modulus and p = -k div u, displacement u and pressure p satisfy

    int 2 mu (eps(u) : eps(v) - tr eps(u) tr eps(v) / 3) - p div v = 0,       int -q div u - p q / k = 0

for all v, q, on Taylor-Hood elements, P4/P3 or P2/P1, for every Poisson's ratio up to 1/2 (Hughes, The Finite Element
Method, 1987, sec. 4.4). The load is the sum of the nodal reactions r_i on the contact. With theta the velocity of a
motion of the mesh in x that carries one edge along, W the density of the energy and sigma the stress,

    G = +- { int W theta,x - sigma_ij u_i,x theta,j  +  sum r_i (h' theta)_i },

is exactly the derivative of the discrete energy by that edge (Destuynder, Djaoua and Lescure 1983); K^2 = 2 E* G. Any
triangle mesh of a period will do, with vertices at the edges and equal ones on both sides. Any consistent units.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import skfem
from scipy.sparse import bmat, coo_matrix
from skfem.helpers import ddot, div, grad, sym_grad, trace

from fem_reference.elasticity import ELEMENTS
from fem_reference.problem import FloatArray

Function = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class LayerState:
    """Load and strain energy per period, G (n_patches, 2), nodal values of the displacement and their basis."""

    load: float
    strain_energy: float
    release_rate: FloatArray
    displacement: FloatArray
    basis: Any


@skfem.BilinearForm
def deviatoric(u: Any, v: Any, w: Any) -> Any:
    """2 mu (eps(u) : eps(v) - tr eps(u) tr eps(v) / 3)."""
    return 2.0 * w.mu * (ddot(sym_grad(u), sym_grad(v)) - div(u) * div(v) / 3.0)


@skfem.BilinearForm
def volumetric(u: Any, q: Any, w: Any) -> Any:
    """- q div u."""
    return -q * div(u)


@skfem.BilinearForm
def compressible(p: Any, q: Any, w: Any) -> Any:
    """- p q / k."""
    return -w.softness * p * q


@skfem.Functional
def energy_released(w: Any) -> Any:
    """W theta,x - sigma_ij u_i,x theta,j of u, p and theta."""
    strain, pressure, theta = sym_grad(w.u), w.p, grad(w.theta)
    volume, identity = trace(strain), np.eye(2)[:, :, None, None]
    density = w.mu * (ddot(strain, strain) - volume**2 / 3.0) - pressure * volume - 0.5 * w.softness * pressure**2
    stress = 2.0 * w.mu * (strain - identity * volume / 3.0) - identity * pressure
    return density * theta[0] - np.einsum("ij...,i...,j...", stress, grad(w.u)[:, 0], theta)


def layer_state(
    mesh: Any,
    youngs_modulus: float,
    poisson_ratio: float,
    profile: tuple[Function, Function],
    edges: FloatArray,
    approach: float,
    order: int = 4,
) -> LayerState:
    """Solve the layer on a mesh of 0 <= x <= period, 0 <= y <= d for contact between edges.

    `profile` is h and h' at positions x, `edges` are (n_patches, 2), of which the right one may exceed the period,
    `approach` is u_tot - h_max, `order` that of the displacement, 2 or 4.
    """
    height, slope = profile
    mu, softness = 0.5 * youngs_modulus / (1.0 + poisson_ratio), 3.0 * (1.0 - 2.0 * poisson_ratio) / youngs_modulus
    moduli, (of_u, of_p) = {"mu": mu, "softness": softness}, ELEMENTS[order]
    V = skfem.Basis(mesh, skfem.ElementVector(of_u()), intorder=2 * order)
    Q = V.with_element(of_p())
    A, B, C = deviatoric.assemble(V, **moduli), volumetric.assemble(V, Q), compressible.assemble(Q, **moduli)
    K = bmat([[A, B.T], [B, C]], format="csr")

    period, depth = mesh.p.max(axis=1)
    near = 1e-9 * period  # how far a node of a boundary may be off its line
    x, y = np.hstack([V.doflocs, Q.doflocs])
    kind = np.full(len(x), 2)  # 0 of u_x, 1 of u_y, 2 of p
    for component, indices in enumerate(V.split_indices()):
        kind[indices] = component
    inside = np.any((x[:, None] - edges[:, 0] + near) % period <= np.diff(edges)[:, 0] + 2.0 * near, axis=1)
    contact = (kind == 1) & (np.abs(y) < near) & inside
    plate = (kind < 2) & (np.abs(y - depth) < near)
    left, right = (np.flatnonzero(np.abs(x - side) < near) for side in (0.0, period))
    left, right = (side[np.lexsort((np.round(y[side] / depth, 9), kind[side]))] for side in (left, right))
    same = np.arange(len(x))
    same[right] = left  # nodal value that stands for each one
    T = coo_matrix((np.ones(len(x)), (np.arange(len(x)), same)), shape=K.shape).tocsr()
    face = np.flatnonzero(np.abs(mesh.p[1]) < near)
    face = face[np.argsort(mesh.p[0, face])]
    vertices, given = mesh.p[0, face], np.zeros(len(x))
    given[contact] = carried(vertices, height, x[contact], order) + approach
    held = np.flatnonzero(plate | contact | (same != np.arange(len(x))))
    z = T @ skfem.solve(*skfem.condense(T.T @ K @ T, x=given, D=held))
    reactions = (K @ z)[contact]

    released, P1 = np.zeros(edges.shape), V.with_element(skfem.ElementTriP1())
    fields = {"u": V.interpolate(z[: V.N]), "p": Q.interpolate(z[V.N :])} | moduli
    for place in np.ndindex(*edges.shape):
        theta = motion(mesh, edges, place)
        volume = energy_released.assemble(V, theta=P1.interpolate(theta), **fields)

        def rate(at: FloatArray, on_face: FloatArray = theta[face]) -> FloatArray:
            return np.asarray(slope(at) * np.interp(at, vertices, on_face))

        surface = reactions @ carried(vertices, rate, x[contact], order)
        released[place] = volume + surface if place[1] else -volume - surface
    return LayerState(float(reactions.sum()), 0.5 * float(z @ (K @ z)), released, z[: V.N], V)


def carried(vertices: FloatArray, function: Function, x: FloatArray, order: int) -> FloatArray:
    """Return values at nodes x that interpolate a function: at vertices itself, between them its lower moments."""
    line = skfem.Basis(skfem.MeshLine(vertices), skfem.ElementLinePp(order), intorder=16)
    tests = line.with_element(skfem.ElementLineP0() if order == 2 else skfem.ElementDG(skfem.ElementLineP2()))
    mass = skfem.BilinearForm(lambda u, q, w: u * q).assemble(line, tests)
    moments = skfem.LinearForm(lambda q, w: function(w.x[0]) * q).assemble(tests)
    values, between = np.zeros(line.N), line.complement_dofs(line.nodal_dofs[0])
    values[line.nodal_dofs[0]] = function(line.mesh.p[0])
    values[between] = skfem.solve(mass[:, between].tocsc(), moments - mass @ values)
    return np.asarray(line.probes(x[None]) @ values)


def motion(mesh: Any, edges: FloatArray, place: tuple[int, ...]) -> FloatArray:
    """Return theta at the vertices: 1 near an edge, 0 from 0.8 of the way to the next edge, seam or plate on."""
    period, depth = mesh.p.max(axis=1)
    knots = np.sort(np.concatenate([[0.0, period], (edges % period).ravel()]))
    tip = edges[place] % period
    k = int(np.argmin(np.abs(knots - tip)))
    radius = 0.8 * min(tip - knots[k - 1], knots[k + 1] - tip, depth)
    return np.asarray(np.clip((1.0 - np.hypot(mesh.p[0] - tip, mesh.p[1]) / radius) / 0.6, 0.0, 1.0))
