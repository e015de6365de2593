"""An independent FFT solver on the same profile: ContactMechanics (extra `peers`), constrained conjugate gradients.

Polonsky and Keer, Wear 231 (1999) 206: pressures on a uniform grid of n points, p >= 0, gap >= 0, prescribed mean
pressure; the half-space acts mode by mode.  It shares nothing with boundary elements but the raw numbers.

A grid counts contact to whole points, so that its area is too large by about one point a patch and falls as 1/n: the
area compared is the extrapolation 2 A(2n) - A(n) from the two finest grids.  The separation, the mean gap, has no such
error.
"""

from dataclasses import dataclass
from importlib import import_module

import numpy as np

from validation.harness.arrays import FloatArray
from validation.harness.route import Problem

PACKAGES = ("ContactMechanics", "SurfaceTopography")
LARGEST_OVERLAP = 1e-12  # m
ITERATIONS = 50_000


@dataclass(frozen=True)
class GridContact:
    """Contact on one grid at one pressure: separation in m, contact fraction, iterations."""

    points: int
    separation: float
    contact_fraction: float
    iterations: int


def grid_contact(problem: Problem, mean_pressure: float, points: int) -> GridContact:
    """Return the contact of a profile without adhesion at a mean pressure in Pa on a half-space.

    ArithmeticError after `ITERATIONS` iterations, NotImplementedError where the points do not resolve the profile.
    """
    modulus = problem.youngs_modulus / (1 - problem.poisson_ratio**2)
    height = on_grid(problem, points)
    substrates, systems = import_module("ContactMechanics"), import_module("ContactMechanics.Systems")
    line = import_module("SurfaceTopography").UniformLineScan(height, problem.period, periodic=True)
    half_space = substrates.PeriodicFFTElasticHalfSpace(height.shape, modulus, (problem.period,))
    solution = systems.NonSmoothContactSystem(substrate=half_space, surface=line).minimize_proxy(
        external_force=mean_pressure * problem.period, pentol=LARGEST_OVERLAP, maxiter=ITERATIONS
    )
    if not solution.success:
        raise ArithmeticError(f"{points} points at {mean_pressure:g} Pa: {solution.message}")
    gap = solution.x - height - solution.offset
    return GridContact(points, float(np.mean(gap)), float(np.mean(solution.jac > 0)), int(solution.nit))


def extrapolated(grids: list[GridContact]) -> float:
    """Return the limit of the contact fraction of grids, each twice as fine as the one before."""
    return 2 * grids[-1].contact_fraction - grids[-2].contact_fraction


def on_grid(problem: Problem, points: int) -> FloatArray:
    """Return heights in m of a profile at x = k period / points, (points,).

    NotImplementedError where the points do not resolve them.
    """
    orders, amplitudes, phases = problem.harmonics
    if points <= 2 * int(orders.max()):
        raise NotImplementedError(f"{points} points do not resolve {int(orders.max())} harmonics")
    modes = np.zeros(points // 2 + 1, dtype=np.complex128)
    modes[orders] = amplitudes * np.exp(1j * phases) * points / 2
    return np.fft.irfft(modes, points)
