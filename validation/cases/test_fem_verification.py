"""Code verification of the finite elements: manufactured solutions, Richardson and GCI.

- A plane wave u = A sin(k x + c), p = p0 cos(k x + c) with the body force it needs, on uniform crisscross meshes of the
  unit square: errors in L2 fall as h^(m+1) for displacements of order m and h^m for pressures, any nu.
- Johnson's state at given edges on three meshes graded to the edges, each halved: the load is an energy and falls as
  h^2m.  With the observed order p, or 2 m where that is less, Roache (1998, ch. 5) has

      q_R = q_3 + (q_3 - q_2) / (2^p - 1),   GCI = 1.25 |q_3 - q_2| / (2^p - 1).
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from fem_reference import Resolution
from fem_reference.elasticity import assemble, taylor_hood
from fem_reference.mesh import crisscross
from fem_reference.result import spread
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.fem_scenes import on_meshes

PERIOD, AMPLITUDE, E = 0.01, 50e-6, 1e6
WAVE_VECTOR, SHIFT = np.array([2.0, 3.0]), 0.3
CELLS = {2: (8, 16), 4: (3, 6)}
LADDERS = {  # halved, tips keeping pace
    2: (Resolution(2, 6, 6), Resolution(2, 12, 10), Resolution(2, 24, 14)),
    4: (Resolution(4, 4, 6), Resolution(4, 8, 14), Resolution(4, 16, 22)),
}


def manufactured_errors(order, nu, cells):
    """Return errors in L2 of displacement and pressure on the unit square, E = 1."""
    mu, softness = 1 / (2 * (1 + nu)), 3 * (1 - 2 * nu)
    k = WAVE_VECTOR
    amplitude = np.array([1.0, 0.5]) if softness > 0 else np.array([3.0, -2.0])  # no change of volume
    p0 = -float(amplitude @ k) / softness if softness > 0 else 1.7

    def phase(x):
        return k[0] * x[0] + k[1] * x[1] + SHIFT

    grid = np.linspace(0, 1, cells + 1)
    spaces = taylor_hood(crisscross(grid, grid), order, quadrature_order=2 * order + 2)
    V, Q = spaces.displacement, spaces.pressure
    n, m = spaces.sizes
    force = mu * ((k @ k) * amplitude + (amplitude @ k) * k / 3) - p0 * k  # times the sine: - div sigma
    sine = np.sin(phase(np.asarray(V.global_coordinates())))
    rhs = np.zeros(2 * n + m)
    for shape, (function, *_) in enumerate(V.basis):
        moments = np.sum(sine * np.asarray(function) * V.dx, axis=1)
        for component in range(2):
            np.add.at(rhs, component * n + V.element_dofs[shape], force[component] * moments)
    u, p = np.sin(phase(V.doflocs)), p0 * np.cos(phase(Q.doflocs))
    solution = np.concatenate([amplitude[0] * u, amplitude[1] * u, p])
    edge = V.get_dofs().flatten()
    pinned = np.array([2 * n] if softness == 0 else [], dtype=edge.dtype)
    held = np.concatenate([edge, n + edge, pinned])  # one pressure where p is up to a constant
    free = np.setdiff1d(np.arange(2 * n + m), held)
    matrix = assemble(spaces, mu, softness).matrix
    solution[free] = spsolve(matrix[free][:, free].tocsc(), (rhs - matrix[:, held] @ solution[held])[free])
    square = 0.0
    for component in range(2):
        off = np.asarray(V.interpolate(solution[component * n : (component + 1) * n])) - amplitude[component] * sine
        square += float(np.sum(off**2 * V.dx))
    off = np.asarray(Q.interpolate(solution[2 * n :])) - p0 * np.cos(phase(np.asarray(Q.global_coordinates())))
    off -= np.sum(off * Q.dx) if softness == 0 else 0.0
    return float(np.sqrt(square)), float(np.sqrt(np.sum(off**2 * Q.dx)))


@pytest.mark.quick
@pytest.mark.parametrize("order", [2, 4])
def test_manufactured_solution(rows, order):
    """Do elements converge at their order on a manufactured plane wave, for any Poisson's ratio?"""
    ratios = (-0.5, 0.3, 0.499999, 0.5)
    errors = np.array([[manufactured_errors(order, nu, count) for count in CELLS[order]] for nu in ratios])
    observed = np.log2(errors[:, 0] / errors[:, 1])  # (nu, displacement and pressure): cells double
    for place, name in enumerate(("displacement", "pressure")):
        rows.compare(f"order of the {name} in L2, nu = -0.5, 0.3, 0.499999, 0.5", observed[:, place],
                     order + 1.0 - place, of=Code.FEM, by=Code.RATE, quantity=Quantity.RATE, uncertainty=0.1,
                     required=0.25, because="a quarter of an order on two meshes; an error of one costs one",
                     source="m + 1 and m on a smooth solution")


def arguments(wave, fraction):
    """Return Johnson's state at given edges, on a layer of two periods, as `fem_reference.solve` takes it."""
    half = 0.5 * fraction * PERIOD
    return {"youngs_modulus": E, "poisson_ratio": wave.poisson_ratio, "thickness": 2 * PERIOD, "period": PERIOD,
            "harmonics": ([1], [AMPLITUDE], [0.0]), "work_of_adhesion": wave.work_of_adhesion,
            "control": "penetration", "value": float(wave.penetration(fraction * np.pi / 2)),
            "edges": [[-half, half]]}


@pytest.mark.parametrize("order", [pytest.param(2, marks=pytest.mark.quick),
                                   pytest.param(4, marks=pytest.mark.standard)])
def test_richardson(rows, order):
    """Are graded meshes in the asymptotic range, and do GCI and stated uncertainty hold the true error?"""
    wave, fraction, predicted = Sinusoid(AMPLITUDE, PERIOD, E, 0.3, 0.3), 0.4, 2 * order
    exact, scale = float(wave.mean_pressure(fraction * np.pi / 2)), wave.full_contact_pressure
    values = [float(each["mean_pressure"]) for each in on_meshes(LADDERS[order], **arguments(wave, fraction))]
    cells = [resolution.cells for resolution in LADDERS[order]]
    steps = [abs(b - a) for a, b in pairwise(values)]
    observed = float(np.log2(steps[0] / steps[1]))  # cells double
    refined = 2 ** min(observed, predicted) - 1
    richardson, index = values[-1] + (values[-1] - values[-2]) / refined, 1.25 * steps[-1] / refined
    rate = rows.between(Code.FEM, Code.RATE, "energy norm of order m: 2 m of the load on graded meshes")
    by_errors = np.log2(abs(values[1] - exact) / abs(values[2] - exact))
    rate.compare("observed order of the load", observed, predicted, quantity=Quantity.RATE,
                 uncertainty=abs(observed - by_errors), required=0.1 * predicted,
                 because="a tenth: bounded on both sides")
    rate.compare("ratio of differences over 2^2m", steps[0] / steps[1] / 2**predicted, 1.0, quantity=Quantity.RATE,
                 uncertainty=0.1, required=0.1, because="a tenth: the asymptotic range")
    johnson = rows.between(Code.FEM, Code.EXACT, "Johnson 1995; a layer of two periods: 1e-8", unit="Pa")
    stated = float(spread(np.array(values), LADDERS[order]))
    for name, value, u in (("load on the finest mesh, U its GCI", values[-1], index),
                           ("load on the finest mesh, U as stated", values[-1], stated),
                           ("Richardson's value, U its GCI", richardson, index)):
        johnson.compare(name, value, exact, quantity=Quantity.PRESSURE, uncertainty=(u, 1e-8 * scale))
    rows.curves("Error of the load at given edges", "cells per period", "error / p*",
                {f"P{order}, graded": (cells, [abs(value - exact) / scale for value in values])}, log="xy")
