"""Solve the contact problem without adhesion on a grid, roughly: the Newton iteration starts from its patches.

With S the spectral compliance, the pressure p >= 0 at equidistant points minimises p S p / 2 - p (h - h_max + Delta),
and the gap g >= 0 minimises g S^-1 g / 2 + g p_c, where p_c is the pressure of complete contact: the same problem
twice, in the mirror of load and separation.  The first takes few iterations where contact is rare, the second where
gaps are.  Conjugate gradients live where the unknown is positive or should be, and are cut off at zero.  They are
preconditioned by the inverse of the operator on the whole circle, S^-1 or S, which leaves tens of iterations of three
pairs of Fourier transforms each, so that hundreds of contacts that come and go are sorted out here.  Only patches are
handed over, to a fraction of a grid cell: what is computed from them does not depend on this grid.

Source: Vollebregt, J. Optim. Theory Appl. 162 (2014) 931, doi:10.1007/s10957-013-0499-x, the method of truncation.
Dimensionless.  Limits: contacts and gaps narrower than a cell (an eighth of the shortest wavelength) are missed; the
search for interpenetration and tension finds them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.elastic.collocation import Elastic
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches, ordered
from bem.loading.control import Control

ITERATIONS = 40  # speed: more take longer than the steps of Newton that they save (measured)
CONVERGED = 5e-3  # speed: what the preconditioner would still change of the unknown, relative; work +5 % if doubled
EVERY_POINT = 4096  # speed: points of the grid of a profile above which every second one is enough for Newton
NESTED, EVERY_FOURTH = 1024, 4  # speed: points of grids on which the start is found on every fourth point
DENSE = 0.5  # speed: contact fraction above which gaps are the unknown
LAYER = 1e-4  # speed: accuracy of the series of a layer on the grid
POINTS_PER_MODE = 2  # speed: of that series
MOST_POINTS = 1 << 17  # limit: of a grid
OFF_POINT = 0.45  # speed: cells between a point and the highest place about it, at most
WITHIN_CELL = 0.05, 0.95  # speed: where an edge may lie between the last grid point inside and the first one outside


@dataclass(frozen=True, eq=False)
class GridProblem:
    """Contact of a profile on its grid.

    Attributes
    ----------
    height : (n,) array
        h - h_max.
    compliance : (n/2 + 1,) array
        Displacement over pressure, mode by mode; zero for the mean.
    """

    height: FloatArray
    compliance: FloatArray

    def patches(self, control: Control, target: float) -> Patches:
        """Patches at the target of the control, at least one, with at least one gap.

        Parameters
        ----------
        control : Control
        target : float
            Of a contact that is neither apart nor complete.
        """
        pressure = self._pressure(control, target)
        if np.mean(pressure > 0) < DENSE:
            return _intervals(pressure, self.height, 2.0)
        gap = self._gap(control, target, TWO_PI * float(pressure.mean()))
        gaps = _intervals(gap, -self._complete, 2 / 3)
        return ordered(gaps.right, np.append(gaps.left[1:], gaps.left[:1] + TWO_PI))

    def _pressure(self, control: Control, target: float) -> FloatArray:
        """Pressure at the grid points, (n,)."""
        if control.penetration_weight == 0:
            level, mean = self.height, target / (TWO_PI * control.load_weight)
            return _minimiser(self.compliance, level, mean)
        compliance = self.compliance.copy()
        compliance[0] = TWO_PI * control.load_weight / control.penetration_weight
        return _minimiser(compliance, self.height + target / control.penetration_weight, None)

    def _gap(self, control: Control, target: float, load: float) -> FloatArray:
        """Gap at the grid points, (n,); a load that hardly moves the penetration is taken from the pressure."""
        alpha, beta = control.penetration_weight, control.load_weight
        separation = -float(self.height.mean())  # at no penetration: h_max
        mean = separation - (target - beta * load) / alpha if alpha > TWO_PI * beta else 0.0
        if mean > 0:
            return _minimiser(self._stiffness, -self._complete, mean)
        stiffness = self._stiffness.copy()
        stiffness[0] = alpha / (TWO_PI * beta)
        pressed = (target - alpha * separation) / (TWO_PI * beta)
        return _minimiser(stiffness, -self._complete - pressed, None)

    @property
    def _stiffness(self) -> FloatArray:
        """Pressure over displacement, mode by mode, zero for the mean, (n/2 + 1,)."""
        stiffness = np.zeros(self.compliance.size)
        stiffness[1:] = 1 / self.compliance[1:]
        return stiffness

    @property
    def _complete(self) -> FloatArray:
        """Pressure of complete contact less its mean, (n,)."""
        return _filtered(self.height, self._stiffness)


def grid_problem(elastic: Elastic) -> GridProblem:
    """Return the contact problem of an elastic body on the grid of its profile."""
    step = 2 if elastic.profile.grid[0].size > EVERY_POINT else 1
    x, height = (values[::step] for values in elastic.profile.grid)
    modes = 0.0 if elastic.kernel is None else float(elastic.kernel.modes_of_kernel(np.array([TWO_PI]), LAYER)[0])
    finest = min(POINTS_PER_MODE * modes, MOST_POINTS)
    if x.size < finest:
        size = 1 << int(np.ceil(np.log2(finest)))
        x = np.linspace(0.0, TWO_PI, size, endpoint=False)
        height = elastic.profile.height(x)
    compliance = np.zeros(x.size // 2 + 1)
    orders = np.arange(1, compliance.size)
    compliance[1:] = (1.0 if elastic.kernel is None else elastic.kernel.ratio(orders)) / orders
    return GridProblem(height - elastic.profile.max_height, compliance)


def _filtered(values: FloatArray, factor: FloatArray) -> FloatArray:
    """Values with every mode multiplied, (n,)."""
    return np.asarray(np.fft.irfft(np.fft.rfft(values) * factor, values.size))


def _minimiser(operator: FloatArray, drive: FloatArray, mean: float | None) -> FloatArray:
    """z >= 0 that minimises z A z / 2 - z drive, of a prescribed mean unless that is None, (n,).

    Parameters
    ----------
    operator : (n/2 + 1,) array
        A, mode by mode; zero only for the mean, where that is prescribed.
    drive : (n,) array
    mean : float, optional
    """
    if drive.size < NESTED:
        return _descent(operator, drive, mean, _highest(drive, mean))
    few, modes = drive[::EVERY_FOURTH], drive.size // (2 * EVERY_FOURTH) + 1
    coarse = _minimiser(operator[:modes], few, mean)
    z = np.interp(np.arange(drive.size) / EVERY_FOURTH, np.arange(coarse.size + 1), np.append(coarse, coarse[0]))
    return _descent(operator, drive, mean, z if np.any(z) else _highest(drive, mean))


def _highest(drive: FloatArray, mean: float | None) -> FloatArray:
    """Return 1 where the unknown is expected to be positive, else 0, (n,)."""
    z = np.where(drive > (0.0 if mean is None else np.quantile(drive, 0.9)), 1.0, 0.0)
    z[np.argmax(drive)] = 1.0
    return z


def _descent(operator: FloatArray, drive: FloatArray, mean: float | None, z: FloatArray) -> FloatArray:
    """Return the minimiser by preconditioned conjugate gradients, starting from a multiple of z >= 0, (n,)."""
    z = z * (max(float(z @ drive), 0.0) / float(z @ _filtered(z, operator)) if mean is None else mean / z.mean())
    inverse = 1 / np.where(operator > 0, operator, operator[1])
    direction, force, last = np.zeros(z.size), np.zeros(z.size), np.inf
    for _ in range(ITERATIONS):
        positive = z > 0
        slope = _filtered(z, operator)
        slope -= drive
        if mean is not None:
            slope -= _mean(slope[positive])
        free = np.flatnonzero(positive | (slope < 0))  # z, force and direction are zero elsewhere
        now = slope[free]
        before, force = force[free], _spread(now, free, z.size)
        miss = _less_mean(_filtered(force, inverse)[free], mean)
        if float(np.abs(miss).sum()) <= CONVERGED * float(z.sum()):
            break
        size = float(now @ miss)
        ahead = direction[free] * max(0.0, (size - float(before @ miss)) / last) + miss
        direction = _spread(ahead, free, z.size)
        last = size
        response = _less_mean(_filtered(direction, operator)[free], mean)
        bend = float(response @ ahead)
        if bend <= 0:
            break
        reached = np.maximum(z[free] - float(now @ ahead) / bend * ahead, 0.0)
        z = _spread(reached if mean is None else reached * (mean * z.size / float(reached.sum())), free, z.size)
    return z


def _spread(values: FloatArray, at: IntArray, size: int) -> FloatArray:
    """Values at some points of the grid, zero at the others, (size,)."""
    spread = np.zeros(size)
    spread[at] = values
    return spread


def _mean(values: FloatArray) -> float:
    return float(values.sum()) / values.size


def _less_mean(values: FloatArray, mean: float | None) -> FloatArray:
    """Values less their mean where that of the unknown is prescribed."""
    return values if mean is None else values - _mean(values)


def _intervals(values: FloatArray, drive: FloatArray, power: float) -> Patches:
    """Intervals of the circle where `values` are positive; to this power they vanish linearly at the edges.

    One or two points make an interval about the highest place of `drive`; so does the highest point where none is.
    """
    n, cell = values.size, TWO_PI / values.size
    inside = values > 0
    inside[np.argmax(drive)] |= not np.any(inside)
    start = np.flatnonzero(inside & ~np.roll(inside, 1))
    stop = np.flatnonzero(inside & ~np.roll(inside, -1))
    if stop[0] < start[0]:
        stop = np.roll(stop, -1)
    points = (stop - start) % n + 1
    linear = np.maximum(values, 0.0) ** power
    left = start - _reach(linear, start, 1)
    right = start + points - 1 + _reach(linear, stop, -1)
    highest = start + (drive[stop] > drive[start])
    before, middle, after = drive[highest - 1], drive[highest % n], drive[(highest + 1) % n]
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = highest + np.clip(0.5 * (after - before) / (2 * middle - before - after), -OFF_POINT, OFF_POINT)
    narrow = (points <= 2) & (2 * middle > before + after)
    left = np.where(narrow, np.maximum(vertex - points / 2, start - WITHIN_CELL[1]), left)
    right = np.where(narrow, np.minimum(vertex + points / 2, start + points - 1 + WITHIN_CELL[1]), right)
    return ordered(cell * left, cell * right)


def _reach(linear: FloatArray, edge: IntArray, inward: int) -> FloatArray:
    """Distance of the edges outside the last points inside, in cells: a straight line through two points, or half."""
    last, second = linear[edge], linear[(edge + inward) % linear.size]
    with np.errstate(divide="ignore", invalid="ignore"):
        straight = last / (second - last)
    return np.where(second > last, np.clip(straight, *WITHIN_CELL), 0.5)
