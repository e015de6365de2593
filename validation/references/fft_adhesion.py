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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validation.harness.arrays import FloatArray
from validation.references.posed_contacts import Found, MethodError, Posed

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


def solve_fft(posed: Posed, points: int, spacings: int) -> Found:
    """The contact of a half-space on a grid: from the geometric overlap, or along a path where it depends on it."""
    begun = time.perf_counter()
    x = np.arange(points) * (posed.period / points)
    spacing, modulus = posed.period / points, posed.youngs_modulus / (1 - posed.poisson_ratio**2)
    height, slope = _profile(posed, x)
    rho = cohesive_range(posed, points, spacings)
    work = posed.work_of_adhesion * (np.sqrt(1 + slope**2) if posed.slope_term else np.ones(points))
    line = import_module("SurfaceTopography").UniformLineScan(height, posed.period, periodic=True)
    half_space = import_module("ContactMechanics").PeriodicFFTElasticHalfSpace((points,), modulus, (posed.period,))
    cohesion = import_module("Adhesion.Interactions").Exponential(work, rho)
    system = import_module("Adhesion.System").BoundedSmoothContactSystem(half_space, cohesion, line)
    minimise = import_module("NuMPI.Optimization").constrained_conjugate_gradients
    top = posed.surface().highest * posed.surface().unit_height
    steps = STEPS if posed.id == "rough" else 1
    ready = time.perf_counter()
    gap, iterations = np.zeros(0), 0
    for depth in np.linspace(0.0, posed.penetration, steps + 1)[1:]:
        start = gap if gap.size else np.maximum(top - depth - height, 0.0)
        with redirect_stdout(io.StringIO()):  # it reports every direction of negative curvature
            found = minimise(
                system.primal_objective(0.0, gradient=True),
                system.primal_hessian_product,
                start,
                mean_val=top - depth,
                gtol=TOLERANCE * posed.work_of_adhesion / rho * spacing,
                maxiter=ITERATIONS,
            )
        if not found.success:
            raise MethodError(f"{points} points, penetration {depth:.3e} m: {found.message}")
        gap, iterations = np.asarray(found.x, dtype=np.float64).ravel(), iterations + int(found.nit)
    solved = time.perf_counter()
    _, force = system.primal_evaluate(gap + height, gap, pot=True, forces=True)
    uniform = float(np.mean(half_space.force))  # the package's spring of the mean displacement, which we have not
    answer = {
        "contact_fraction": float(np.mean(gap <= 0)),
        "mean_pressure": (float(np.mean(np.asarray(force).ravel()[gap > 0])) - uniform) / spacing,
        "elastic_energy": (float(half_space.energy) + uniform * float(np.sum(gap + height)) / 2) / posed.period,
        "gap": float(np.interp(posed.trough, x, gap, period=posed.period)),
    }
    post = time.perf_counter() - solved
    extra = {"cohesive range / m": rho}
    return Found(answer, points, {"iterations": iterations}, ready - begun, solved - ready, post, extra)


def _profile(posed: Posed, x: NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    """Heights in m and slopes at x."""
    height, slope = np.zeros(x.size), np.zeros(x.size)
    for order, amplitude, phase in zip(posed.orders, posed.amplitudes, posed.phases, strict=True):
        q = 2 * np.pi * order / posed.period
        height += amplitude * np.cos(q * x + phase)
        slope -= q * amplitude * np.sin(q * x + phase)
    return height, slope
