"""Convergence of every code at the rate its theory predicts, bounded on both sides: too fast is as wrong as too slow.

- Dense algebra: K and load at Johnson's edges against nodes per patch.  The pressure is analytic inside the Bernstein
  ellipse through the nearest edge of the next patch, z = 1 + gap / half width, rho = z + sqrt(z^2 - 1): interpolation
  (K) falls as rho^-n, Gauss's quadrature (load) as rho^-2n (Trefethen, Approximation Theory and Practice, 2013).
- Finite elements: load at given edges against cells.  The energy norm falls as h^m on meshes graded so that the tip
  keeps pace and as h^(1/2) on uniform ones, whatever m (displacements are r^(1/2) at an edge); the load is an energy:
  twice.
- Persson's diffusion towards a barrier at rest: second order in the cells, third in the steps.

One wave, D = 100 um, period 10 mm, E = 1 MPa, nu = 0.5, Johnson's alpha 0.3.
"""

import numpy as np
import pytest
from scipy.special import erf

from fem_reference.closure import evaluate
from fem_reference.mesh import LayerMesh, Resolution, crisscross
from fem_reference.result import quantities
from fem_reference.solve import control_of, prescribed, problem_of
from persson.diffusion import march
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.references.dense import evaluate_dense
from validation.references.waves import Waves

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.3)
HALF_ORDER = "half an order tells the predicted order from its neighbours"
HALF_SPACE = 4e-9  # relative load: a layer of two periods for the half-space
PLATEAU = 30.0  # errors nearer to the plateau than this many times are not fitted


def geometric_rate(sizes, errors):
    """Return rho of errors C rho^-n above the plateau with twice its standard error, and the plateau."""
    size, error = np.asarray(sizes, float), np.asarray(errors)
    rises = (error[:-1] < 0.01) & (error[1:] >= error[:-1])
    plateau = float(np.max(error[np.argmax(np.append(rises, True)) :]))
    first_flat = int(np.argmax(error <= PLATEAU * plateau))
    falling = np.flatnonzero((error < 0.01)[:first_flat])
    slope, covariance = np.polyfit(size[falling], np.log(error[falling]), 1, cov=True)
    rho = float(np.exp(-slope[0]))
    return rho, 2 * rho * float(np.sqrt(covariance[0, 0])), plateau


@pytest.mark.quick
def test_nodes_of_dense_algebra(rows):
    """Do K and load of dense algebra fall geometrically in its nodes, down to rounding?"""
    fraction, sizes = 0.9, range(4, 49, 4)
    psi, half = fraction * np.pi / 2, np.array([fraction * np.pi])
    unit = WAVE.amplitude / np.sqrt(2)  # heights over the rms height
    profile = Waves(2 * np.pi, np.array([1]), np.array([np.sqrt(2)]), np.zeros(1))
    stress, depth = WAVE.modulus * np.pi / WAVE.wavelength * unit, float(WAVE.penetration(psi)) / unit
    gamma = WAVE.work_of_adhesion / (WAVE.modulus * unit**2 * np.pi / WAVE.wavelength)
    states = [evaluate_dense(profile, -half, half, depth, np.array([n])) for n in sizes]
    exact = float(WAVE.mean_pressure(psi))
    intensity = [float(np.max(np.abs(state.stress_intensity / (2 * np.sqrt(gamma)) - 1))) for state in states]
    load = [max(abs(state.load / (2 * np.pi) * stress - exact) / WAVE.full_contact_pressure, 2.0**-53)
            for state in states]
    z = 1 + 2 * (1 - fraction) / fraction
    rho = z + np.sqrt(z * z - 1)
    for name, errors, predicted in (("stress intensity", intensity, rho), ("load", load, rho**2)):
        observed, spread, plateau = geometric_rate(sizes, errors)
        rows.compare(f"factor per node: {name}", observed, predicted, of=Code.DENSE, by=Code.RATE,
                     quantity=Quantity.RATE, uncertainty=spread, required=0.15 * predicted,
                     because="the singularity at the next edge is integrable: a little faster than rho",
                     source=f"ellipse through the next edge, rho = {rho:.3f}")
        rows.compare(f"plateau of the {name}, relative", plateau, 0.0, of=Code.DENSE, by=Code.EXACT,
                     quantity=Quantity.INTENSITY if name != "load" else Quantity.PRESSURE, uncertainty=1e-14,
                     required=1e-12, because="rounding of 48 nodes", source="Johnson 1995")
    rows.curves("Errors of dense algebra at Johnson's edges, contact fraction 0.9", "nodes", "relative error",
                {"stress intensity": (sizes, intensity), "load": (sizes, load),
                 "rho^-n": (sizes, [intensity[2] * rho ** (sizes[2] - n) for n in sizes])}, log="y")


def load_by_elements(order, cells, graded):
    """Return the error of the load, over p*, at the edges of the contact fraction 0.5 on a layer of two periods."""
    psi, depth = np.pi / 4, 2.0
    problem = problem_of(WAVE.youngs_modulus, WAVE.poisson_ratio, depth * WAVE.wavelength, WAVE.wavelength,
                         ([1], [WAVE.amplitude], [0.0]), WAVE.work_of_adhesion, False)
    control, half = control_of(problem, "penetration", float(WAVE.penetration(psi))), WAVE.wavelength / 4
    resolution = Resolution(order, cells, 4)
    if graded:  # 8 or 14 halvings at the edges with 8 cells; the tip keeps pace
        levels = round({2: 8, 4: 14}[order] + 2 * order * np.log2(cells / 8))
        resolution = Resolution(order, cells, min(24, max(4, levels)))
        mesh = prescribed(problem, control, [[-half, half]], [resolution])[0][1]
    else:
        rows = int(np.ceil(0.35 * cells * np.log1p(depth / 0.35)))
        y = 0.35 * np.expm1(np.linspace(0.0, np.log1p(depth / 0.35), rows + 1))
        y[-1] = depth
        triangles = crisscross(np.linspace(0.0, 1.0, cells + 1), y)
        mesh = LayerMesh(triangles, triangles.p, np.array([[0.25, 0.75]]), np.array([[-0.25, 0.25]]), seam=0.5,
                         depth=depth)
    load = float(quantities(evaluate(problem, mesh, resolution, control))["mean_pressure"])
    return abs(load - float(WAVE.mean_pressure(psi))) / WAVE.full_contact_pressure


@pytest.mark.parametrize(
    ("order", "graded", "cells"),
    [pytest.param(2, True, (4, 8, 16), marks=pytest.mark.quick, id="P2 graded"),
     pytest.param(4, False, (8, 16, 32), marks=pytest.mark.quick, id="P4 uniform"),
     pytest.param(2, True, (4, 8, 16, 32), marks=pytest.mark.full, id="P2 graded, four meshes"),
     pytest.param(4, True, (4, 6, 8), marks=pytest.mark.standard, id="P4 graded"),
     pytest.param(2, False, (16, 32, 64), marks=pytest.mark.full, id="P2 uniform")],
)
def test_cells_of_finite_elements(rows, order, graded, cells):
    """Do graded meshes win back the order that the edges cost finite elements on uniform ones?"""
    errors = np.array([load_by_elements(order, count, graded) for count in cells])
    falling = errors > PLATEAU * HALF_SPACE
    required = 1.0 if graded else 0.1
    rows.order(f"load, P{order}, {'graded' if graded else 'uniform'} meshes", np.array(cells)[falling], errors[falling],
               2.0 * order if graded else 1.0, of=Code.FEM, required=required,
               because="the order is twice the elements' degree: one order tells them from the next degree"
               if graded else "a tenth: the order of the singularity, whatever the elements",
               source="energy norm h^m graded, h^(1/2) uniform (Strang and Fix 1973)")


@pytest.mark.quick
def test_diffusion_of_the_theory(rows):
    """Does the diffusion towards a barrier at rest converge with order 2 in stress and 3 in the variance?"""
    barrier, load = 0.5, 1.0  # standard deviations of the last stress variance, 1
    exact = float(erf((load + barrier) / np.sqrt(2)))

    def error(cells, steps, first):
        nodes = np.concatenate([[0.0], np.geomspace(first, 1.0, steps + 1)])
        area = march(np.array([load]), nodes, np.full((1, nodes.size), barrier), cells).area[0, -1]
        return abs(float(area) - exact)

    cells, steps = (25, 50, 100, 200, 400), (6, 12, 25, 50, 100)
    rows.order("area against cells in stress", cells, [error(n, 400, 1e-3) for n in cells], 2.0, of=Code.THEORY,
               required=0.5, because=HALF_ORDER, source="central differences")
    errors, floor = np.array([error(1600, n, 1e-2) for n in steps]), error(1600, 1600, 1e-2)
    falling = errors > PLATEAU * floor
    rows.order("area against steps in the variance", np.array(steps)[falling], errors[falling], 3.0, of=Code.THEORY,
               required=0.5, because=HALF_ORDER, source="Runge-Kutta of third order")
