"""Distribution of the pressure without binning noise: the exact share of the period in every interval of pressure.

On a patch x = c + r cos(theta) the pressure is sigma = q(theta) / (r sin(theta)) with a cosine series q.  The patch is
cut where dsigma/dtheta = 0 into branches on which sigma is monotone; a level s is crossed where q - s r sin(theta) = 0,
smooth in theta although sigma is singular at the edges.  The lengths between crossings give the share of the period
F(s) = |{x: sigma(x) < s}| / period, and the density of a bin is the difference of F over its width,

    P(sigma) = sum over crossings 1 / (period |dsigma/dx|), averaged over the bin.

Only contact counts: the part of the period outside contact, a delta function at zero, is reported beside it.  With
adhesion sigma = -K_e / sqrt(2 pi rho) at an edge, hence P -> sum_e K_e^2 / (2 pi^2) |sigma|^-3 for sigma -> -infinity,
in SI (2 E* / (pi period)) sum_e w_e |sigma|^-3.  So <sigma^2> diverges with adhesion.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601; the tail is exact.  Dimensionless
(scaling.py; densities are per unit of stress).  Limits: q between its samples, 16 per half wave of the highest
coefficient, is a quintic Hermite polynomial, relative error 1e-9 of the highest coefficients.  Shares below 1e-12 at
left edges lose digits, theta near pi.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.fft import dct, dst

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile

SAMPLES_PER_COEFFICIENT = 16  # derived: quintic between samples: 1e-9 of the highest coefficients
LEAST_SAMPLES = 128  # derived: on short series: 1e-9 of the highest coefficients
SAMPLES_PER_WAVELENGTH = 64  # derived: complete contact
TAIL_REACH = 100.0  # format: lowest level with adhesion, in units of the largest |extremum|
NEGLIGIBLE_SHARE = 1e-12  # derived: of the period below minus that pressure: edges close to rounding only
LINEAR_SHARE = 0.1  # format: levels are equidistant up to this share of the highest pressure, geometric beyond


@dataclass(frozen=True, eq=False)
class PressureDistribution:
    """Density of the pressure on a grid of bins, per nominal length, dimensionless."""

    levels: FloatArray  # bounds of the bins, increasing, (n_bins + 1,)
    density: FloatArray  # mean P over each bin, (n_bins,)
    below: float  # share of the period in contact at pressures below the grid
    above: float  # share of the period in contact at pressures above the grid
    outside_contact: float  # share of the period outside contact, the weight of the delta function at zero
    tail_coefficient: float  # A of P -> A |sigma|^-3; zero without adhesion and in complete contact

    @property
    def pressures(self) -> FloatArray:
        """Centers of the bins, (n_bins,)."""
        return np.asarray((self.levels[1:] + self.levels[:-1]) / 2)


class Curve:
    """Pressure N / D on cells of a coordinate tau: N a quintic Hermite polynomial, D = r sin(tau), or 1 without r.

    Parameters
    ----------
    start, stop : (n,) arrays
        tau at the ends of the cells.
    samples : (6, n) array
        N, N', N'' at the start, then at the stop.
    radius : (n,) array or None
        r of the patch of each cell; None in complete contact, where tau is x.
    """

    def __init__(self, start: FloatArray, stop: FloatArray, samples: FloatArray, radius: FloatArray | None) -> None:
        self.start, self.stop, self.width, self.radius = start, stop, stop - start, radius
        h = self.width
        f0, f1, f2, g0, g1, g2 = samples
        d0, d1, c0, c1 = f1 * h, g1 * h, f2 * h * h / 2, g2 * h * h / 2
        rise = g0 - f0 - d0 - c0
        bend = d1 - d0 - 2 * c0
        turn = c1 - c0
        self.coefficients = np.stack(
            [f0, d0, c0, 10 * rise - 4 * bend + turn, -15 * rise + 7 * bend - 2 * turn, 6 * rise - 3 * bend + turn]
        )

    def numerator(self, tau: FloatArray, cell: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return N, N', N'' at tau in the given cells, (m,) each."""
        h = self.width[cell]
        z = (tau - self.start[cell]) / h
        a = self.coefficients[:, cell]
        value = a[0] + z * (a[1] + z * (a[2] + z * (a[3] + z * (a[4] + z * a[5]))))
        slope = a[1] + z * (2 * a[2] + z * (3 * a[3] + z * (4 * a[4] + z * 5 * a[5])))
        curvature = 2 * a[2] + z * (6 * a[3] + z * (12 * a[4] + z * 20 * a[5]))
        return value, slope / h, curvature / (h * h)

    def denominator(self, tau: FloatArray, cell: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return D, D', D'', (m,) each; D is exactly zero at both edges of a patch."""
        if self.radius is None:
            return np.ones(tau.size), np.zeros(tau.size), np.zeros(tau.size)
        r = self.radius[cell]
        sine = np.where(tau > np.pi / 2, np.sin(np.pi - tau), np.sin(tau))
        return r * sine, r * np.cos(tau), -r * sine

    def length(self, tau1: FloatArray, tau2: FloatArray, cell: IntArray) -> FloatArray:
        """Return the length between two places, r |cos tau1 - cos tau2| without cancellation, (m,)."""
        if self.radius is None:
            return np.abs(tau1 - tau2)
        return np.asarray(2 * self.radius[cell] * np.abs(np.sin((tau1 + tau2) / 2) * np.sin((tau1 - tau2) / 2)))

    def pressure(self, tau: FloatArray, cell: IntArray) -> FloatArray:
        """Return N / D, infinite with the sign of N where D = 0 (zero where both vanish)."""
        n, d = self.numerator(tau, cell)[0], self.denominator(tau, cell)[0]
        edge = d == 0
        return np.where(edge, np.where(n == 0, 0.0, np.copysign(np.inf, n)), n / np.where(edge, 1.0, d))


@dataclass(frozen=True, eq=False)
class Branches:
    """Pieces of the period on which the pressure is monotone, in the coordinate of a curve."""

    curve: Curve
    cell: IntArray  # cell of the curve with each branch, (n,)
    start: FloatArray  # tau of the ends, (n,), as `stop`
    stop: FloatArray
    first: FloatArray  # pressure at the ends, (n,), as `last`, possibly infinite
    last: FloatArray
    extrema: FloatArray  # local extrema of the pressure, (n_extrema,)


def pressure_distribution(
    pressure: PatchPressure, levels: FloatArray | None = None, bins: int = 400
) -> PressureDistribution:
    """Return the distribution of the pressure of a state; without patches all of the period is outside contact.

    The pressure is dimensionless; levels are bounds of the bins, increasing, (n_bins + 1,), by default
    `pressure_levels` with `bins` bins. ArithmeticError where a crossing was not located.

    Examples
    --------
    The load is the first moment:

    >>> half = np.array([1.0])
    >>> hertz = PatchPressure(-half, half, (np.array([0.5, 0.0, -0.5]),))         # sigma = sqrt(1 - x^2)
    >>> distribution = pressure_distribution(hertz, np.linspace(0, 1, 2001))
    >>> bool(abs(2 * np.pi * np.sum(distribution.density * distribution.pressures) / 2000 - hertz.load) < 1e-5)
    True
    """
    width = float(np.sum(pressure.right - pressure.left))
    tail = _tail_coefficient(pressure)
    branches = patch_branches(pressure)
    if levels is None:
        levels = pressure_levels(branches, bins, tail)
    return _distribution(branches, levels, width, tail)


def complete_contact_distribution(pressure: Profile, mean_pressure: float) -> PressureDistribution:
    """Return the distribution of sigma_0 + the zero-mean harmonics `pressure` of complete contact, dimensionless."""
    branches = profile_branches(pressure, mean_pressure)
    return _distribution(branches, pressure_levels(branches), 2 * np.pi, 0.0)


def pressure_levels(branches: Branches, bins: int = 400, tail_coefficient: float = 0.0) -> FloatArray:
    """Return levels from the lowest to the highest pressure, (bins + 1,): sinh-spaced, finest at zero.

    With a tail the lowest level is -100 times the largest extremum, far into |sigma|^-3; patches without one reach
    down to zero at their edges.  No patch at all: levels from 0 to 1.  ValueError for a constant pressure.
    """
    values = np.concatenate([branches.first, branches.last])
    finite = values[np.isfinite(values)]
    if values.size == 0:
        return np.linspace(0.0, 1.0, bins + 1)
    highest, lowest = float(np.max(finite)), float(np.min(finite))
    if highest == lowest:
        raise ValueError(f"pressure: constant ({highest:g}), it has no density")
    size = float(np.max(np.abs(branches.extrema if branches.extrema.size else finite)))
    if tail_coefficient / (2 * size * size) > NEGLIGIBLE_SHARE:
        lowest = -TAIL_REACH * size
    elif finite.size < values.size:
        lowest = min(lowest, 0.0)
    scale = LINEAR_SHARE * size
    levels = scale * np.sinh(np.linspace(np.arcsinh(lowest / scale), np.arcsinh(highest / scale), bins + 1))
    levels[[0, -1]] = lowest, np.nextafter(highest, np.inf)
    return levels


def share_below(branches: Branches, levels: FloatArray) -> FloatArray:
    """Return the share of the period at pressures below each level, in contact, (n_levels,)."""
    low, high = np.minimum(branches.first, branches.last), np.maximum(branches.first, branches.last)
    begin, end = np.searchsorted(levels, low, side="right"), np.searchsorted(levels, high, side="left")
    rows = np.arange(low.size)
    whole = branches.curve.length(branches.start, branches.stop, branches.cell)
    total = np.cumsum(np.bincount(end, weights=whole, minlength=levels.size + 1))[: levels.size]

    crossings = np.maximum(end - begin, 0)
    row = np.repeat(rows, crossings)
    level = np.arange(row.size) - np.repeat(np.cumsum(crossings) - crossings, crossings) + np.repeat(begin, crossings)
    tau = _crossings(branches, row, levels[level])
    from_low = np.where(branches.first[row] < branches.last[row], branches.start[row], branches.stop[row])
    part = branches.curve.length(from_low, tau, branches.cell[row])
    total += np.bincount(level, weights=part, minlength=levels.size)
    return np.asarray(total / (2 * np.pi))


def patch_branches(pressure: PatchPressure) -> Branches:
    """Return the branches of the pressure on patches; tau is theta, N = q, D = r sin(theta)."""
    starts, stops, samples, radii = [], [], [], []
    for left, right, charge in zip(pressure.left, pressure.right, pressure.charges, strict=True):
        cells = max(SAMPLES_PER_COEFFICIENT * charge.size, LEAST_SAMPLES)
        theta = np.linspace(0.0, np.pi, cells + 1)  # both ends exact
        starts.append(theta[:-1])
        stops.append(theta[1:])
        samples.append(_hermite_data(charge, cells))
        radii.append(np.full(cells, (right - left) / 2))
    if not starts:
        starts, stops, samples, radii = [np.empty(0)], [np.empty(0)], [np.empty((6, 0))], [np.empty(0)]
    start, stop, radius = np.concatenate(starts), np.concatenate(stops), np.concatenate(radii)
    return _cut(Curve(start, stop, np.concatenate(samples, axis=1), radius))


def profile_branches(pressure: Profile, mean_pressure: float) -> Branches:
    """Return the branches of sigma_0 + a zero-mean profile over the whole period; tau is x, N = sigma, D = 1."""
    edges = np.linspace(0.0, 2 * np.pi, SAMPLES_PER_WAVELENGTH * pressure.max_order + 1)
    start, stop = edges[:-1], edges[1:]
    value, slope, curvature = pressure.height_slope_curvature(start)
    left = np.stack([value + mean_pressure, slope, curvature])
    samples = np.concatenate([left, np.roll(left, -1, axis=1)])
    return _cut(Curve(start, stop, samples, None))


def _distribution(branches: Branches, levels: FloatArray, width: float, tail: float) -> PressureDistribution:
    share = share_below(branches, levels)
    contact = width / (2 * np.pi)
    return PressureDistribution(
        levels=levels,
        density=np.diff(share) / np.diff(levels),
        below=float(share[0]),
        above=contact - float(share[-1]),
        outside_contact=1 - contact,
        tail_coefficient=tail,
    )


def _tail_coefficient(pressure: PatchPressure) -> float:
    """Return sum K_e^2 / (2 pi^2) over tensile edges, K_e = -sqrt(pi/r) sum_n (+-1)^n Q_n > 0."""
    total = 0.0
    for left, right, charge in zip(pressure.left, pressure.right, pressure.charges, strict=True):
        even, odd = float(np.sum(charge[0::2])), float(np.sum(charge[1::2]))
        tensile = min(even + odd, 0.0) ** 2 + min(even - odd, 0.0) ** 2
        total += tensile * np.pi / ((right - left) / 2)
    return total / (2 * np.pi**2)


def _hermite_data(charge: FloatArray, cells: int) -> FloatArray:
    """Return q, q', q'' by theta at both ends of `cells` equal cells of [0, pi], (6, cells)."""
    order = np.arange(charge.size)
    padded = np.zeros(cells + 1)
    padded[: charge.size] = charge / 2
    padded[0] = charge[0]
    value = dct(padded, type=1)
    padded[: charge.size] *= -(order**2)
    curvature = dct(padded, type=1)
    slope = np.zeros(cells + 1)
    sine = np.zeros(cells - 1)
    sine[: charge.size - 1] = -order[1:] * charge[1:] / 2
    slope[1:-1] = dst(sine, type=1)
    ends = np.stack([value, slope, curvature])
    return np.concatenate([ends[:, :-1], ends[:, 1:]])


def _cut(curve: Curve) -> Branches:
    """Cut the cells of a curve at extrema of N / D, where W = N' D - N D' changes its sign."""
    start, stop, cell = curve.start, curve.stop, np.arange(curve.start.size)

    def wronskian(tau: FloatArray, cells: IntArray) -> tuple[FloatArray, FloatArray]:
        n, n1, n2 = curve.numerator(tau, cells)
        d, d1, d2 = curve.denominator(tau, cells)
        return n1 * d - n * d1, n2 * d - n * d2

    turning = np.flatnonzero(wronskian(start, cell)[0] * wronskian(stop, cell)[0] < 0)
    extremum = _bracketed(lambda tau, rows: wronskian(tau, turning[rows]), start[turning], stop[turning])
    cells = np.concatenate([cell, turning])
    first, last = np.concatenate([start, extremum]), np.concatenate([stop, stop[turning]])
    last[turning] = extremum
    ends = curve.pressure(first, cells), curve.pressure(last, cells)
    return Branches(curve, cells, first, last, *ends, curve.pressure(extremum, turning))


def _crossings(branches: Branches, row: IntArray, level: FloatArray) -> FloatArray:
    """Return tau at which branches cross levels, (m,)."""
    cell = branches.cell[row]

    def excess(tau: FloatArray, which: IntArray) -> tuple[FloatArray, FloatArray]:
        n, n1, _ = branches.curve.numerator(tau, cell[which])
        d, d1, _ = branches.curve.denominator(tau, cell[which])
        return n - level[which] * d, n1 - level[which] * d1

    return _bracketed(excess, branches.start[row], branches.stop[row])


def _bracketed(
    function: Callable[[FloatArray, IntArray], tuple[FloatArray, FloatArray]], low: FloatArray, high: FloatArray
) -> FloatArray:
    """Find roots of many functions between bounds of opposite sign, by Newton's method guarded by bisection, (m,).

    If steps shrink quadratically, the ratio of a step to the square of the step before is constant, so that the next
    step is known.  A step is the last one if the next step is below rounding.
    """
    low, high = low.copy(), high.copy()
    every = np.arange(low.size)
    resolution = 1e-13 * (high - low)
    falling = function(low, every)[0] > 0
    root, last = (low + high) / 2, np.zeros(low.size)  # size of the last Newton step; zero after a bisection
    active = every
    for _ in range(100):
        if active.size == 0:
            return root
        guess = root[active]
        value, slope = function(guess, active)
        beyond = (value > 0) != falling[active]
        high[active] = np.where(beyond, guess, high[active])
        low[active] = np.where(beyond, low[active], guess)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = value / slope
        newton, size, before = guess - step, np.abs(step), last[active]
        inside = (newton > low[active]) & (newton < high[active])
        root[active] = np.where(inside, newton, (low[active] + high[active]) / 2)
        last[active] = np.where(inside, size, 0.0)
        follows = inside & (2 * size < before) & (size**3 <= resolution[active] * before**2)
        converged = follows | (np.abs(root[active] - guess) <= resolution[active]) | (value == 0)
        root[active] = np.where(value == 0, guess, root[active])
        active = active[~converged]
    raise ArithmeticError(f"{active.size} crossings of the pressure were not located in 100 steps")
