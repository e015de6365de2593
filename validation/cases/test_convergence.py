"""Does every code converge at the rate that its theory predicts?  A rate is bounded on both sides.

- Dense algebra at Johnson's edges, nodes per patch: the pressure is analytic inside the Bernstein ellipse through the edge
  of the next patch, rho = z + sqrt(z^2 - 1), z = 1 + gap / half width.  K, by interpolation, falls like rho^-n, the load,
  by Gauss's quadrature, like rho^-2n (Trefethen, Approximation Theory and Approximation Practice, 2013, ch. 8 and 19).
- Finite elements at prescribed edges, cells per period: the load is an energy.  Elements of order m give 2 m on meshes
  graded so that the tips keep pace, and 1 on uniform ones, where displacements behave like r^(1/2) at an edge (Strang and
  Fix, An Analysis of the Finite Element Method, 1973, ch. 8).
- Persson's diffusion towards a barrier at rest, exact: 2 in the finite volumes, 3 in the steps of the variance.
- The paper's cells of uniform pressure: 2.  Means over n independent realisations scatter like n^(-1/2).
- The path has no rate: its events are located whatever the increments, so that targets agree to the tolerance.
"""

import numpy as np
import pytest
from scipy.special import erf

import bem
from fem_reference.closure import evaluate
from fem_reference.mesh import LayerMesh, Resolution, crisscross
from fem_reference.result import quantities
from fem_reference.solve import control_of, prescribed, problem_of
from persson.diffusion import march
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.references.dense import evaluate_dense
from validation.references.paper_method import Surface, solve
from validation.references.waves import Waves
from validation.routes.scenes import posed

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.3)
JOHNSON = "Johnson 1995, alpha = 0.3"
PLATEAU, START = 30.0, 0.01  # fitted are errors above this many plateaus and below this share
DEPTH = 0.02  # m, two periods: the half-space within 4e-9
TIP_LEVELS = {2: 8, 4: 14}  # halvings at the edges with 8 cells per period, by order of the elements


def factor(rows, name, sizes, errors, predicted, within, of):
    """Add rows of the factor by which errors fall per node, fitted above the plateau, and of the plateau."""
    sizes, errors = np.asarray(sizes, float), np.asarray(errors, float)
    rises = np.append((errors[:-1] < START) & (errors[1:] >= errors[:-1]), True)
    plateau = errors[np.argmax(rises) :].max()
    used = (errors > PLATEAU * plateau) & (errors < START)
    (slope, _), covariance = np.polyfit(sizes[used], np.log(errors[used]), 1, cov=used.sum() > 3 or "unscaled")
    spread = 2 * np.sqrt(covariance[0, 0]) * predicted
    rows.compare(f"factor per node, {name}", np.exp(-slope), predicted, of=of, by=Code.RATE, quantity=Quantity.RATE,
                 uncertainty=spread, required=within * predicted, source="Bernstein ellipse, Trefethen 2013",
                 because="the singularity at the next edge is integrable: faster by some per cent")  # fmt: skip
    rows.compare(f"plateau, {name}", plateau, 0.0, of=of, by=Code.EXACT, quantity=Quantity.POINTS, uncertainty=1e-13,
                 required=1e-12, because="double precision", source=JOHNSON)  # fmt: skip
    line = errors[used][-1] * predicted ** (sizes[used][-1] - sizes[used])
    rows.curves(f"Error of {name}", "nodes per patch", "error",
                {"measured": (sizes, errors), f"{predicted:.3f} per node": (sizes[used], line, "dashed")},
                log="y")  # fmt: skip


@pytest.mark.parametrize("fraction", [0.9, pytest.param(0.95, marks=pytest.mark.full)])
def test_dense_algebra(rows, fraction):
    """Does the dense evaluation of given patches converge geometrically, as its ellipse predicts?"""
    sizes, psi, q0 = range(4, 49 if fraction == 0.9 else 69, 4), fraction * np.pi / 2, 2 * np.pi / WAVE.wavelength
    wave, edge = Waves(2 * np.pi, np.array([1]), np.array([WAVE.amplitude]), np.array([0.0])), np.array([2 * psi])
    states = [evaluate_dense(wave, -edge, edge, float(WAVE.penetration(psi)), np.array([n])) for n in sizes]
    critical = np.sqrt(2 * WAVE.modulus * WAVE.work_of_adhesion)
    intensity = [np.max(np.abs(s.stress_intensity * WAVE.modulus * np.sqrt(q0) / 2 / critical - 1)) for s in states]
    exact, star = float(WAVE.mean_pressure(psi)), WAVE.full_contact_pressure
    load = [max(abs(s.load * WAVE.modulus / WAVE.wavelength / 2 - exact) / star, 2.0**-53) for s in states]
    reach = 1 + 2 * (1 - fraction) / fraction
    rho = reach + np.sqrt(reach**2 - 1)
    factor(rows, "stress intensity", sizes, intensity, rho, 0.08, Code.DENSE)
    factor(rows, "mean pressure", sizes, load, rho**2, 0.15, Code.DENSE)


FEM = {  # order of the elements, cells per period, graded; level, and share of the order that is allowed
    "P2, graded": (2, (4, 8, 16), True, "quick", 0.15),
    "P4, uniform": (4, (8, 16, 32), False, "quick", 0.1),
    "P2, graded to 32 cells": (2, (4, 8, 16, 32), True, "full", 0.15),
    "P4, graded": (4, (4, 6, 8, 12), True, "full", 0.15),
    "P2, uniform": (2, (16, 32, 64), False, "full", 0.15),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=getattr(pytest.mark, of[3])) for name, of in FEM.items()]
)  # fmt: skip
def test_finite_elements(rows, name):
    """Do finite elements converge with twice their order on graded meshes, and with order 1 on uniform ones?"""
    order, cells, graded, _, within = FEM[name]
    predicted = 2.0 * order if graded else 1.0
    exact, star = float(WAVE.mean_pressure(np.pi / 4)), WAVE.full_contact_pressure
    errors = [abs(fem_pressure(order, n, graded) - exact) / star for n in cells]
    rows.order(f"mean pressure, {name}", cells, errors, predicted, of=Code.FEM, required=within * predicted,
               because="bounds of the asymptotic range, on both sides", source=f"{JOHNSON}; Strang and Fix 1973")  # fmt: skip


def fem_pressure(order, cells, graded):
    """Return the mean pressure (Pa) of the layer at the edges of half a period, on one mesh."""
    problem = problem_of(WAVE.youngs_modulus, WAVE.poisson_ratio, DEPTH, WAVE.wavelength,
                         ([1], [WAVE.amplitude], [0.0]), WAVE.work_of_adhesion, False)  # fmt: skip
    control = control_of(problem, "penetration", float(WAVE.penetration(np.pi / 4)))
    if graded:
        levels = min(24, max(4, round(TIP_LEVELS[order] + 2 * order * np.log2(cells / 8))))
        resolution = Resolution(order, cells, levels)
        mesh = prescribed(problem, control, [[-WAVE.wavelength / 4, WAVE.wavelength / 4]], [resolution])[0][1]
    else:
        depth, resolution = DEPTH / WAVE.wavelength, Resolution(order, cells, 4)
        lines = int(np.ceil(0.35 * cells * np.log1p(depth / 0.35)))
        y = 0.35 * np.expm1(np.linspace(0.0, np.log1p(depth / 0.35), lines + 1))
        y[-1] = depth
        triangles = crisscross(np.linspace(0.0, 1.0, cells + 1), y)
        local, edges = np.array([[0.25, 0.75]]), np.array([[-0.25, 0.25]])
        mesh = LayerMesh(triangles, triangles.p, local, edges, seam=0.5, depth=depth)
    return float(quantities(evaluate(problem, mesh, resolution, control))["mean_pressure"])


def test_persson(rows):
    """Does the area of the theory converge with order 2 in stress and 3 in the variance?"""
    load, barrier = 1.0, 0.5  # in standard deviations of the last stress variance, 1
    exact = float(erf((load + barrier) / np.sqrt(2)))

    def error(cells, steps, first):
        nodes = np.concatenate([[0.0], np.geomspace(first, 1.0, steps + 1)])
        return abs(march(np.array([load]), nodes, np.full((1, nodes.size), barrier), cells).area[0, -1] - exact)

    source, floor = "erf((sigma_0 + a) / sqrt(2 V)), barrier at rest", error(1600, 1600, 1e-2)
    cells, steps = (25, 50, 100, 200, 400), (6, 12, 25, 50, 100)
    in_steps = [(n, e) for n in steps if (e := error(1600, n, 1e-2)) > PLATEAU * floor]
    rows.order("area against finite volumes", cells, [error(n, 400, 1e-3) for n in cells], 2.0, of=Code.THEORY,
               required=0.15, because="asymptotic range", source=source)  # fmt: skip
    rows.order("area against steps in the variance", *zip(*in_steps, strict=True), 3.0, of=Code.THEORY, required=0.3,
               because="asymptotic range", source=source)  # fmt: skip


def test_paper_method(rows):
    """Does the paper's own method converge with order 2 in its cells, edges included?"""
    surface = Surface(1e6, 0.5, WAVE.wavelength, [1], [WAVE.amplitude], [0.0], WAVE.work_of_adhesion)
    depth = float(WAVE.penetration(0.3 * np.pi))
    states = [solve(surface, depth, [[-0.0025, 0.0025]], n, allowed_residual=1e-8) for n in (8, 16, 32, 64)]
    rows.order("contact fraction", [s.unknowns for s in states], [abs(s.contact_fraction - 0.6) for s in states], 2.0,
               of=Code.PAPER, required=0.15, because="asymptotic range", source=JOHNSON)  # fmt: skip


@pytest.mark.standard
def test_ensemble(rows):
    """Does the mean area over realisations scatter like the inverse root of their number?"""
    count, sizes = 64, np.array([1, 2, 4, 8])
    areas = np.array([bem.solve(posed("rough_100", profile={"harmonics": 20, "seed": seed},
                                      loading={"targets": [40e-6]})).targets[-1].contact_fraction
                      for seed in range(count)])  # fmt: skip
    spread = [np.std(areas.reshape(-1, n).mean(axis=1), ddof=1) / areas.mean() for n in sizes]
    rows.order("mean contact fraction", sizes, spread, 0.5, of=Code.BEM, required=1.6 / np.sqrt(count),
               because="two standard deviations of the fit", source="central limit theorem", kind="construction")  # fmt: skip


@pytest.mark.standard
def test_increments(rows):
    """Are targets the same whatever the increments of the path?"""
    increments = (0.4, 0.1, 0.0125)
    paths = [[state.contact_fraction for state in bem.solve(posed(
        "rough_100", profile={"harmonics": 30}, accuracy={"max_increment": increment})).targets]
        for increment in increments]  # fmt: skip
    for increment, fractions in zip(increments[:-1], paths[:-1], strict=True):
        rows.compare(f"contact fractions, increments of {increment:g} rms heights", fractions, paths[-1], of=Code.BEM,
                     by=Code.IDENTITY, quantity=Quantity.AREA, kind="construction", required=1e-8,
                     because="tolerance of the scene", source="the finest increments")  # fmt: skip
