"""ContactMechanics and Adhesion (extra `peers`) on a uniform grid, driven as their documentation says.

Without adhesion: constrained conjugate gradients of Polonsky and Keer (1999) at a given load.  With it the gap g >= 0
on n points minimises

    U_el(u) - sum over points of gamma sqrt(1 + h'^2) exp(-g / rho) dx,  u = g + h,  at a given mean of g (separation),

mode by mode in U_el, by the constrained conjugate gradients of Bugnicourt, Sainsot, Lesaffre and Lubrecht, J. Tribol.
140 (2018) 011411, doi:10.1115/1.4037226, along the path of separations.  JKR is the limit of a cohesive range rho of
zero.  On a grid rho cannot go there: cohesion acts along E* rho^2 / gamma beside an edge, and unless some c of the
spacings fit into it, edges are held by the lattice.  Hence the one knob, n, with rho = sqrt(c dx gamma / E*), c = 8 or
16: it falls like n^-1/2.  Contact is what the package counts: points without a gap.  The mean pressure is what the
constraint of the mean gap exerts.  SI units.
"""

import io
from contextlib import redirect_stdout
from importlib import import_module

import numpy as np
from numpy.typing import ArrayLike

from validation.harness import route
from validation.harness.arrays import FloatArray
from validation.harness.route import Answer, Laps, Problem
from validation.references.fft_solver import pressed
from validation.references.waves import Waves
from validation.routes.uniform_grid import Grid, OnGrid, affordable, answers

PACKAGES = ("Adhesion", "ContactMechanics", "NuMPI", "SurfaceTopography")
TOLERANCE = 1e-4  # of the gradient, in the largest cohesive force on a point; 1e-6 changes no error on the sinusoid
ITERATIONS = 50_000
SPACINGS = 8
STEP = 0.1  # of the path, in the span of the separations


def missing() -> str:
    """Return the reason why the packages cannot run on this machine; empty if they can."""
    return route.missing("peers", *PACKAGES)


def cohesive_range(problem: Problem, points: int, spacings: int = SPACINGS) -> float:
    """Return rho in m by which cohesion acts along this many spacings of the grid."""
    modulus = problem.youngs_modulus / (1 - problem.poisson_ratio**2)
    return float(np.sqrt(spacings * problem.period / points * (problem.work_of_adhesion or 0.0) / modulus))


class CohesiveGrid:
    """Heights (n,) in m, on which cohesion of a range rho in m sets gamma free, J/m^2, sqrt(1 + slope^2) times.

    The slopes are (n,), or zero where they do not count.
    """

    def __init__(
        self, height: FloatArray, slope: ArrayLike, period: float, modulus: float, cohesion: tuple[float, float]
    ) -> None:
        gamma, rho = cohesion
        work = gamma * np.broadcast_to(np.sqrt(1 + np.asarray(slope) ** 2), height.shape)
        line = import_module("SurfaceTopography").UniformLineScan(height, period, periodic=True)
        half_space = import_module("ContactMechanics").PeriodicFFTElasticHalfSpace(height.shape, modulus, (period,))
        law = import_module("Adhesion.Interactions").Exponential(work, rho)
        self.height, self.half_space, self.spacing = height, half_space, period / height.size
        self.system = import_module("Adhesion.System").BoundedSmoothContactSystem(half_space, law, line)
        self.tolerance = TOLERANCE * gamma / rho * self.spacing

    def relaxed(self, start: FloatArray, separation: float, iterations: int) -> tuple[FloatArray, int]:
        """Relax gaps (n,) at a mean separation in m from `start`; return gaps and number of iterations.

        ArithmeticError if `iterations` do not suffice.
        """
        with redirect_stdout(io.StringIO()):  # it reports every direction of negative curvature
            minimum = import_module("NuMPI.Optimization").constrained_conjugate_gradients(
                self.system.primal_objective(0.0, gradient=True),
                self.system.primal_hessian_product,
                start,
                mean_val=separation,
                gtol=self.tolerance,
                maxiter=iterations,
            )
        if not minimum.success:
            raise ArithmeticError(f"{self.height.size} points, separation {separation:.3e} m: {minimum.message}")
        return np.asarray(minimum.x, dtype=np.float64).ravel(), int(minimum.nit)

    def load(self, gap: FloatArray) -> tuple[float, float]:
        """Return the mean pressure in Pa that holds given gaps, and the elastic energy in J/m per period."""
        _, force = self.system.primal_evaluate(gap + self.height, gap, pot=True, forces=True)
        uniform = float(np.mean(self.half_space.force))  # the package's spring of the mean displacement, not ours
        pressure = (float(np.mean(np.asarray(force).ravel()[gap > 0])) - uniform) / self.spacing
        return pressure, float(self.half_space.energy) + uniform * float(np.sum(gap + self.height)) / 2


def solve(problem: Problem, points: int, spacings: int = SPACINGS, steps: int | None = None) -> Answer:
    """Solve for the states at the targets; with adhesion in `steps` steps to each, by default from STEP."""
    if problem.thickness is not None:
        raise NotImplementedError("layers under lines")
    if problem.work_of_adhesion is not None and problem.control == "mean_pressure":
        raise NotImplementedError("adhesion at a given load")
    if absent := missing():
        raise ModuleNotFoundError(absent)
    grid, laps = Grid(problem, affordable(problem, points)), Laps()
    if problem.work_of_adhesion is None:
        height, _ = grid.profile()
        laps.end("setup")
        contacts = [pressed(height, grid.period, grid.modulus, load) for load in problem.targets]
        laps.end("solve")
        states = [OnGrid(gap, contact, load) for (gap, contact, _), load in zip(contacts, problem.targets, strict=True)]
        return Answer(values=answers(grid, states), unknowns=grid.points, parts=laps.parts)
    rho = cohesive_range(problem, grid.points, spacings)
    height, slope = grid.profile()
    counted = slope if problem.slope_term else 0.0
    system = CohesiveGrid(height, counted, grid.period, grid.modulus, (problem.work_of_adhesion, rho))
    targets = np.array(problem.targets)
    if problem.control == "penetration":
        targets = Waves(problem.period, *problem.harmonics).highest - targets
    laps.end("setup")
    gap, mean, iterations, gaps = height.max() - height, float(np.mean(height.max() - height)), 0, list[FloatArray]()
    for target in targets:
        some = steps or max(1, int(np.ceil(abs(mean - target) / (STEP * np.ptp([*targets, height.max()])))))
        for separation in np.linspace(mean, target, some + 1)[1:]:
            gap, taken = system.relaxed(np.maximum(gap + separation - mean, 0.0), float(separation), ITERATIONS)
            mean, iterations = float(separation), iterations + taken
        gaps.append(gap)
    laps.end("solve")
    values = answers(grid, [OnGrid(gap, gap <= 0, system.load(gap)[0]) for gap in gaps])
    laps.end("post")
    counts, details = {"iterations": iterations}, {"cohesive range / m": rho}
    return Answer(values=values, unknowns=grid.points, counts=counts, parts=laps.parts, details=details)
