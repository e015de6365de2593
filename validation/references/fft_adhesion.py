"""The peers of the study of accuracy: contact with adhesion on a uniform grid (extra `peers`: Adhesion, NuMPI).

The gap g >= 0 on n points minimises

    U_el(u) - sum over points of gamma sqrt(1 + h'^2) exp(-g / rho) dx,  u = g + h,  at a given mean of g (separation),

mode by mode in U_el (Polonsky and Keer 1999), by the constrained conjugate gradients of Bugnicourt, Sainsot, Lesaffre
and Lubrecht, J. Tribol. 140 (2018) 011411, doi:10.1115/1.4037226.  JKR is the limit of a cohesive range rho of zero.
On a grid rho cannot go there: cohesion acts along E* rho^2 / gamma beside an edge, and unless some c of the spacings
fit into it, edges are held by the lattice.  Hence the one knob, n, with rho = sqrt(c dx gamma / E*), c = 8 or 16: it
falls like n^-1/2.  Contact is what the package counts: points without a gap.  The mean pressure is what the constraint
of the mean gap exerts.  SI units.
"""

from __future__ import annotations

import io
import time
from contextlib import redirect_stdout
from importlib import import_module
from importlib.util import find_spec

import numpy as np
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray
from validation.references.fft_solver import on_grid
from validation.references.posed_contacts import Found, MethodError, Posed, answer_of

PACKAGES = ("Adhesion", "ContactMechanics", "NuMPI", "SurfaceTopography")
TOLERANCE = 1e-4  # of the gradient, in the largest cohesive force on a point; 1e-6 changes no error on the sinusoid
ITERATIONS = 30_000
STEPS = 20  # of the path from first touch


def missing() -> str:
    """Why the peers cannot run here; empty when they can."""
    absent = [name for name in PACKAGES if find_spec(name) is None]
    return f'{", ".join(absent)} not installed: pip install ".[peers]"' if absent else ""


def cohesive_range(posed: Posed, points: int, spacings: int) -> float:
    """rho in m by which cohesion acts along this many spacings of the grid.

    Examples
    --------
    >>> from validation.references.posed_contacts import scenes
    >>> round(cohesive_range(scenes()["sinusoid"], 2**14, 8) * 1e6, 4)
    1.4726
    """
    modulus = posed.youngs_modulus / (1 - posed.poisson_ratio**2)
    return float(np.sqrt(spacings * posed.period / points * posed.work_of_adhesion / modulus))


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
        """Gaps (n,) of this mean in m, from others, and the iterations taken; MethodError after so many."""
        with redirect_stdout(io.StringIO()):  # it reports every direction of negative curvature
            found = import_module("NuMPI.Optimization").constrained_conjugate_gradients(
                self.system.primal_objective(0.0, gradient=True), self.system.primal_hessian_product, start,
                mean_val=separation, gtol=self.tolerance, maxiter=iterations,
            )  # fmt: skip
        if not found.success:
            raise MethodError(f"{self.height.size} points, separation {separation:.3e} m: {found.message}")
        return np.asarray(found.x, dtype=np.float64).ravel(), int(found.nit)

    def load(self, gap: FloatArray) -> tuple[float, float]:
        """Mean pressure in Pa that holds these gaps, and elastic energy in J/m per period."""
        _, force = self.system.primal_evaluate(gap + self.height, gap, pot=True, forces=True)
        uniform = float(np.mean(self.half_space.force))  # the package's spring of the mean displacement, not ours
        pressure = (float(np.mean(np.asarray(force).ravel()[gap > 0])) - uniform) / self.spacing
        return pressure, float(self.half_space.energy) + uniform * float(np.sum(gap + self.height)) / 2


def solve_fft(posed: Posed, points: int, spacings: int) -> Found:
    """The contact of a half-space on a grid: from the geometric overlap, or along a path where it depends on it."""
    begun = time.perf_counter()
    modulus = posed.youngs_modulus / (1 - posed.poisson_ratio**2)
    height, slope = on_grid(posed.period, (posed.orders, posed.amplitudes, posed.phases), points)
    rho = cohesive_range(posed, points, spacings)
    cohesion = posed.work_of_adhesion, rho
    grid = CohesiveGrid(height, slope if posed.slope_term else 0.0, posed.period, modulus, cohesion)
    top = posed.surface().highest * posed.surface().unit_height
    steps = STEPS if posed.id == "rough" else 1
    ready = time.perf_counter()
    gap, iterations = np.zeros(0), 0
    for depth in np.linspace(0.0, posed.penetration, steps + 1)[1:]:
        start = gap if gap.size else np.maximum(top - depth - height, 0.0)
        gap, taken = grid.relaxed(start, top - depth, ITERATIONS)
        iterations += taken
    solved = time.perf_counter()
    pressure, energy = grid.load(gap)
    at_trough = np.interp(posed.trough, np.arange(points) * (posed.period / points), gap, period=posed.period)
    answer = answer_of(float(np.mean(gap <= 0)), pressure, energy / posed.period, float(at_trough))
    post = time.perf_counter() - solved
    extra = {"cohesive range / m": rho}
    return Found(answer, points, {"iterations": iterations}, ready - begun, solved - ready, post, extra)
