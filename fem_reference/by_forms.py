"""A layer in contact on given edges, by scikit-fem's forms and bases from top to bottom: the method to read first.

One period of an elastic layer, 0 < y < d, is bonded to a rigid plate at y = d. Its lower face is free but on the
contact, where without friction

    u_y = h(x) - h_max + u_tot       (h the rigid profile, u_tot the displacement of the plate from first touch).

With mu the shear modulus, k the bulk modulus and p = -k div u, displacement u and pressure p satisfy for all v, q

    int 2 mu (eps(u) : eps(v) - tr eps(u) tr eps(v) / 3) - p div v = 0,       int -q div u - p q / k = 0,

on Taylor-Hood elements, P4/P3 or P2/P1, for every Poisson's ratio up to 1/2 (Hughes, The Finite Element Method, 1987,
sec. 4.4). The load is the sum of the nodal reactions r_i on the contact. With theta the velocity of a motion of the
mesh in x that carries one edge along, W the density of the energy and sigma the stress, the energy released is

    G = +- { int W theta,x - sigma_ij u_i,x theta,j  +  sum r_i (h' theta)_i },

exactly the derivative of the discrete energy by that edge (Destuynder, Djaoua and Lescure 1983); K^2 = 2 E* G.

`fem_reference.solve` computes all this faster, from sums of matrices of the reference triangle and with the load as an
unknown, on meshes of its own. This file works on any triangle mesh of a period, with vertices at the edges and equal
ones on both sides. Any consistent units.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import bmat, coo_matrix
from skfem import (
    Basis,
    BilinearForm,
    ElementLineP2,
    ElementLinePp,
    ElementTriP1,
    ElementTriP2,
    ElementTriP3,
    ElementTriP4,
    ElementVector,
    Functional,
    LinearForm,
    MeshLine,
    condense,
    solve,
)
from skfem.helpers import ddot, div, grad, sym_grad, trace

from fem_reference.problem import BoolArray, FloatArray, IntArray

Function = Callable[[FloatArray], FloatArray]
ELEMENTS = {2: (ElementTriP2, ElementTriP1), 4: (ElementTriP4, ElementTriP3)}
ON_LINE = 1e-9  # of the period: how far a node of a boundary may be off its line


@dataclass(frozen=True)
class LayerState:
    """Load per period, strain energy per period, G (n_patches, 2), and fields on their bases."""

    load: float
    strain_energy: float
    release_rate: FloatArray
    displacement: FloatArray
    pressure: FloatArray
    displacement_basis: Any
    pressure_basis: Any


@BilinearForm
def deviatoric(u: Any, v: Any, w: Any) -> Any:
    """2 mu (eps(u) : eps(v) - tr eps(u) tr eps(v) / 3)."""
    return 2.0 * w.mu * (ddot(sym_grad(u), sym_grad(v)) - div(u) * div(v) / 3.0)


@BilinearForm
def volumetric(u: Any, q: Any, w: Any) -> Any:
    """- q div u."""
    return -q * div(u)


@BilinearForm
def compressible(p: Any, q: Any, w: Any) -> Any:
    """- p q / k."""
    return -w.softness * p * q


@Functional
def energy_released(w: Any) -> Any:
    """W theta,x - sigma_ij u_i,x theta,j of u, p and theta."""
    strain, pressure, theta = sym_grad(w.u), w.p, grad(w.theta)
    volume = trace(strain)
    density = w.mu * (ddot(strain, strain) - volume**2 / 3.0) - pressure * volume - 0.5 * w.softness * pressure**2
    identity = np.eye(2)[:, :, None, None]
    stress = 2.0 * w.mu * (strain - identity * volume / 3.0) - identity * pressure
    return density * theta[0] - np.einsum("ij...,i...,j...", stress, grad(w.u)[:, 0], theta)


def layer_state(
    mesh: Any,
    youngs_modulus: float,
    poisson_ratio: float,
    profile: tuple[Function, Function, Function],
    edges: FloatArray,
    approach: float,
    order: int = 4,
) -> LayerState:
    """Solve the layer for contact between edges.

    Parameters
    ----------
    mesh : skfem.MeshTri1
        0 <= x <= period, 0 <= y <= d, vertices at the edges, equal ones at both sides.
    youngs_modulus, poisson_ratio : float
    profile : three callables
        h, h' and h'' at positions x.
    edges : FloatArray, shape (n_patches, 2)
        Contact between a and b; b may exceed the period.
    approach : float
        u_tot - h_max.
    order : int
        Of the displacement, 4 or 2.
    """
    height, slope, curvature = profile
    mu, softness = youngs_modulus / (2.0 * (1.0 + poisson_ratio)), 3.0 * (1.0 - 2.0 * poisson_ratio) / youngs_modulus
    moduli = {"mu": mu, "softness": softness}
    of_displacement, of_pressure = ELEMENTS[order]
    V = Basis(mesh, ElementVector(of_displacement()), intorder=2 * order)
    Q = V.with_element(of_pressure())
    A, B, C = deviatoric.assemble(V, **moduli), volumetric.assemble(V, Q), compressible.assemble(Q, **moduli)
    K = bmat([[A, B.T], [B, C]], format="csr")

    period, depth = mesh.p.max(axis=1)
    near = ON_LINE * period
    x, y = np.hstack([V.doflocs, Q.doflocs])
    kind = np.full(len(x), 2)  # 0 of u_x, 1 of u_y, 2 of p
    for component, indices in enumerate(V.split_indices()):
        kind[indices] = component
    inside = np.any((x[:, None] - edges[:, 0] + near) % period <= np.diff(edges)[:, 0] + 2.0 * near, axis=1)
    contact = (kind == 1) & (np.abs(y) < near) & inside
    plate = (kind < 2) & (np.abs(y - depth) < near)
    same = np.arange(len(x))  # nodal value that stands for each one: on the right side one of the left side
    left, right = (_in_order(np.abs(x - side) < near, kind, y) for side in (0.0, period))
    same[right] = left
    T = coo_matrix((np.ones(len(x)), (np.arange(len(x)), same)), shape=K.shape).tocsr()

    bottom = np.flatnonzero(np.abs(mesh.p[1]) < near)
    bottom = bottom[np.argsort(mesh.p[0, bottom])]
    vertices = mesh.p[0, bottom]
    given = np.zeros(len(x))
    given[contact] = carried(vertices, height, slope, x[contact], order) + approach
    held = np.flatnonzero(plate | contact | (same != np.arange(len(x))))
    z = T @ solve(*condense(T.T @ K @ T, x=given, D=held))
    reactions = np.where(contact, K @ z, 0.0)

    released, P1 = np.zeros(edges.shape), V.with_element(ElementTriP1())
    fields = {"u": V.interpolate(z[: V.N]), "p": Q.interpolate(z[V.N :])} | moduli
    for place in np.ndindex(*edges.shape):
        theta = motion(mesh, edges, place)
        rise = np.diff(theta[bottom]) / np.diff(vertices)

        def moved(at: FloatArray, theta: FloatArray = theta) -> FloatArray:
            """Return h' theta, the rate of the prescribed height where nodes move along x at the velocity theta."""
            return np.asarray(slope(at) * np.interp(at, vertices, theta[bottom]))

        def bent(at: FloatArray, theta: FloatArray = theta, rise: FloatArray = rise) -> FloatArray:
            """Return the derivative of h' theta."""
            facet = np.clip(np.searchsorted(vertices, at) - 1, 0, len(rise) - 1)
            return np.asarray(curvature(at) * np.interp(at, vertices, theta[bottom]) + slope(at) * rise[facet])

        volume = energy_released.assemble(V, theta=P1.interpolate(theta), **fields)
        surface = float(reactions[contact] @ carried(vertices, moved, bent, x[contact], order))
        released[place] = (volume + surface) * (1.0 if place[1] else -1.0)
    return LayerState(float(reactions.sum()), 0.5 * float(z @ (K @ z)), released, z[: V.N], z[V.N :], V, Q)


def carried(vertices: FloatArray, function: Function, derivative: Function, x: FloatArray, order: int) -> FloatArray:
    """Return values at nodes x that carry a function: exact at vertices, and with its moments up to order - 2 between.

    They are those of the polynomials nearest to it in the derivative: int f_h' v' = int f' v' for all v.
    """
    line = Basis(MeshLine(vertices), ElementLinePp(order) if order > 2 else ElementLineP2(), intorder=16)
    stiffness = BilinearForm(lambda u, v, w: grad(u)[0] * grad(v)[0]).assemble(line)
    moments = LinearForm(lambda v, w: derivative(w.x[0]) * grad(v)[0]).assemble(line)
    at_vertices, fixed = np.zeros(line.N), line.nodal_dofs[0]
    at_vertices[fixed] = function(line.mesh.p[0])
    return np.asarray(line.probes(x[None]) @ solve(*condense(stiffness, moments, x=at_vertices, D=fixed)))


def motion(mesh: Any, edges: FloatArray, place: tuple[int, ...]) -> FloatArray:
    """Return theta at the vertices: one near an edge, falling to zero at 0.8 of the way to what is next to it."""
    period, depth = mesh.p.max(axis=1)
    knots = np.sort(np.concatenate([[0.0, period], (edges % period).ravel()]))
    tip = edges[place] % period
    k = int(np.argmin(np.abs(knots - tip)))
    radius = 0.8 * min(tip - knots[k - 1], knots[k + 1] - tip, depth)
    return np.asarray(np.clip((1.0 - np.hypot(mesh.p[0] - tip, mesh.p[1]) / radius) / 0.6, 0.0, 1.0))


def _in_order(chosen: BoolArray, kind: IntArray, y: FloatArray) -> IntArray:
    """Return nodal values of one side, by kind and height."""
    values = np.flatnonzero(chosen)
    return np.asarray(values[np.lexsort((np.round(y[values] / np.max(y), 9), kind[values]))])
