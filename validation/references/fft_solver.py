"""An independent FFT solver on the same profile: ContactMechanics (extra `peers`), constrained conjugate gradients.

Polonsky and Keer, Wear 231 (1999) 206: pressures on a uniform grid of n points, p >= 0, gap >= 0, prescribed mean
pressure; the half-space acts mode by mode.  It shares nothing with boundary elements but the raw numbers.

A grid counts contact to whole points, so that its area is too large by about one point a patch and falls as 1/n: the
area compared is the extrapolation 2 A(2n) - A(n) from the two finest grids, its uncertainty the difference between that
and the one before.  The separation, the mean gap, has no such error.
"""

from dataclasses import dataclass
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from validation.harness import route
from validation.harness.arrays import FloatArray
from validation.harness.route import Problem

PACKAGES = ("ContactMechanics", "SurfaceTopography")
LARGEST_OVERLAP = 1e-12  # m
ITERATIONS = 50_000


class NotConvergedError(ArithmeticError):
    """Failure of the FFT solver to converge."""


@dataclass(frozen=True)
class GridContact:
    """Contact on one grid at one pressure: separation in m, contact fraction, iterations."""

    points: int
    separation: float
    contact_fraction: float
    iterations: int


@dataclass(frozen=True)
class Extrapolated:
    """Limit of a sequence of grids: separation in m and contact fraction, with uncertainties."""

    separation: float
    separation_error: float
    contact_fraction: float
    contact_fraction_error: float


def missing() -> str:
    """Return why the solver cannot run; empty when it can."""
    return route.missing("peers", *PACKAGES)


def grid_contact(problem: Problem, mean_pressure: float, points: int) -> GridContact:
    """Return the contact of a profile without adhesion at a mean pressure in Pa on a half-space.

    NotConvergedError after `ITERATIONS` iterations, NotImplementedError where the points do not resolve the profile.
    """
    modulus = problem.youngs_modulus / (1 - problem.poisson_ratio**2)
    height, _ = on_grid(problem, points)
    gap, contact, iterations = pressed(height, problem.period, modulus, mean_pressure)
    return GridContact(points, float(np.mean(gap)), float(np.mean(contact)), iterations)


def pressed(
    height: FloatArray, period: float, modulus: float, mean_pressure: float
) -> tuple[FloatArray, NDArray[np.bool_], int]:
    """Return gaps in m, where contact is, (n,) each, and iterations, of heights (n,) in m under a mean pressure in Pa.

    NotConvergedError after `ITERATIONS` iterations.
    """
    substrates, systems = import_module("ContactMechanics"), import_module("ContactMechanics.Systems")
    line = import_module("SurfaceTopography").UniformLineScan(height, period, periodic=True)
    half_space = substrates.PeriodicFFTElasticHalfSpace(height.shape, modulus, (period,))
    solution = systems.NonSmoothContactSystem(substrate=half_space, surface=line).minimize_proxy(
        external_force=mean_pressure * period, pentol=LARGEST_OVERLAP, maxiter=ITERATIONS
    )
    if not solution.success:
        raise NotConvergedError(f"{height.size} points at {mean_pressure:g} Pa: {solution.message}")
    return solution.x - height - solution.offset, solution.jac > 0, int(solution.nit)


def extrapolated(grids: list[GridContact]) -> Extrapolated:
    """Return the limit of three or more grids, each twice as fine as the one before.

    Examples
    --------
    >>> grids = [GridContact(n, 1.0, 0.5 + 1 / n, 1) for n in (4, 8, 16)]
    >>> extrapolated(grids).contact_fraction
    0.5
    """
    coarse, middle, fine = grids[-3:]
    area = 2 * fine.contact_fraction - middle.contact_fraction
    before = 2 * middle.contact_fraction - coarse.contact_fraction
    return Extrapolated(
        separation=fine.separation,
        separation_error=abs(fine.separation - middle.separation),
        contact_fraction=area,
        contact_fraction_error=abs(area - before),
    )


def on_grid(problem: Problem, points: int) -> tuple[FloatArray, FloatArray]:
    """Return heights in m and slopes of a profile at x = k period / points, (points,) each.

    NotImplementedError where the points do not resolve them.
    """
    orders, amplitudes, phases = problem.harmonics
    if points <= 2 * int(orders.max()):
        raise NotImplementedError(f"{points} points do not resolve {int(orders.max())} harmonics")
    modes = np.zeros(points // 2 + 1, dtype=np.complex128)
    modes[orders] = amplitudes * np.exp(1j * phases) * points / 2
    slopes = 1j * 2 * np.pi / problem.period * np.arange(modes.size) * modes
    return np.fft.irfft(modes, points), np.fft.irfft(slopes, points)
