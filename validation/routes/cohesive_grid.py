"""Contact fraction by Adhesion and ContactMechanics (extra `peers`) on a uniform grid, as their documentation says.

The gap g >= 0 on n points minimises

    U_el(u) - sum over points of gamma exp(-g / rho) dx,  u = g + h,  at a given mean of g (separation),

mode by mode in U_el, by the constrained conjugate gradients of Bugnicourt, Sainsot, Lesaffre and Lubrecht, J. Tribol.
140 (2018) 011411, doi:10.1115/1.4037226, along the path of separations.  JKR is the limit of a cohesive range rho of
zero.  On a grid rho cannot go there: cohesion acts along E* rho^2 / gamma beside an edge, and unless some c of the
spacings fit into it, edges are held by the lattice.  So n is the only parameter, with
rho = sqrt(c dx gamma / E*), c = 8: rho falls like n^-1/2.  Contact is what the package counts: points without a gap.
SI units.  Limits: half-space, targets of penetration, no slope term.
"""

import io
from contextlib import redirect_stdout
from importlib import import_module

import numpy as np

from validation.harness.route import Problem
from validation.references.fft_solver import on_grid
from validation.references.waves import Waves

TOLERANCE = 1e-4  # of the gradient, in the largest cohesive force on a point; 1e-6 changes no error on the sinusoid
ITERATIONS = 50_000
SPACINGS = 8


def contact_fraction(problem: Problem, points: int) -> float:
    """Return the contact fraction at the last target of a problem; ArithmeticError if the iteration does not end."""
    modulus, gamma = problem.youngs_modulus / (1 - problem.poisson_ratio**2), problem.work_of_adhesion or 0.0
    height = on_grid(problem, points)
    spacing = problem.period / points
    rho = float(np.sqrt(SPACINGS * spacing * gamma / modulus))
    line = import_module("SurfaceTopography").UniformLineScan(height, problem.period, periodic=True)
    half_space = import_module("ContactMechanics").PeriodicFFTElasticHalfSpace((points,), modulus, (problem.period,))
    law = import_module("Adhesion.Interactions").Exponential(np.full(points, gamma), rho)
    system = import_module("Adhesion.System").BoundedSmoothContactSystem(half_space, law, line)
    gap = height.max() - height
    for penetration in problem.targets:
        separation = Waves(problem.period, *problem.harmonics).highest - penetration
        with redirect_stdout(io.StringIO()):  # the package reports every direction of negative curvature
            minimum = import_module("NuMPI.Optimization").constrained_conjugate_gradients(
                system.primal_objective(0.0, gradient=True),
                system.primal_hessian_product,
                np.maximum(gap + separation - gap.mean(), 0.0),
                mean_val=separation,
                gtol=TOLERANCE * gamma / rho * spacing,
                maxiter=ITERATIONS,
            )
        if not minimum.success:
            raise ArithmeticError(f"{points} points, separation {separation:.3e} m: {minimum.message}")
        gap = np.asarray(minimum.x, dtype=np.float64).ravel()
    return float(np.mean(gap <= 0))
