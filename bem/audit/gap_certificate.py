"""Is a state given by its gaps correct?  Checks of contact next to complete contact, where pressures hide its gaps.

At a relative distance d from complete contact the last gap holds back tensions d times the pressure, over a width of
the order of the root of d: what a certificate of pressures sees of it drowns in rounding.  So here all is measured
against the tension that a gap holds back.  Given are the gaps, the series g = sqrt(1 - t^2) sum g_n U_n(t) of their
openings, the mean pressure and what it lacks to complete contact.  The pressure is recomputed from the dislocations g',
of which the series is -sum (n + 1) g_n T_{n+1} / sqrt(1 - t^2),

    sigma = p_0 + q + (1/2 pi) int cot((x - x')/2) g'(x') dx'  (+ the Fourier series that a layer adds),

with the cotangent split into 1/y (Mason and Handscomb, Chebyshev Polynomials (2003), theorem 9.1) and a smooth rest by
the midpoint rule in the angle: nothing is taken from gap_series.py.  Checked are

- K = 0 at every end over that of a uniformly loaded crack of the same volume, and the decay of the series,
- no pressure in the gaps between the nodes, no tension in contact however narrow (minima are bracketed and followed),
- gaps that are open all along, the mean gap against the separation, the deficit against the lowest pressure.

Dimensionless (scaling.py).  Limits: pressures are known to `ROUNDING`, so that 1e-12 from complete contact nothing
below some 1e-2 of the tension is seen.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bem.audit.certificate import Demands, DimensionlessCertificate, Verdict
from bem.audit.displacement import ComplianceRatio
from bem.audit.gap_depths import POINTS_PER_WAVELENGTH
from bem.geometry.arrays import ComplexArray, FloatArray
from bem.geometry.profile import Profile

ROUNDING = 5e-15  # of pressures, over the sum of the mean and the rms pressure of complete contact; measured 1e-15
SUMMED = 4.0  # of that, in sums over the terms of a series; measured 1
RELATIVE = 1e-8  # of the mean gap over the separation
TENSION = 1e-10  # in contact, over the largest tension held back
LEAST_POINTS = 48  # on a patch, where tension is looked for, and `POINTS_PER_WAVELENGTH` of the profile at least
ZOOMS, ZOOM_POINTS = 14, 9  # derived: each narrows the bracket of a minimum to a quarter
CLOSE = 0.03  # derived: distance at which cot(y/2)/2 - 1/y is a series; terms of y^9 are 1e-16 there, the first 1e-3
ANGLES = 24  # beyond those of the series
HIGHEST = 1 << 16  # limit: modes of a layer


@dataclass(frozen=True, eq=False)
class OpenGaps:
    """Gaps in order on the circle and what opens in them, dimensionless."""

    anchor: FloatArray  # a point near each gap, (G,)
    shift: FloatArray  # its center less that point, (G,)
    half_width: FloatArray  # half its width, (G,)
    opening: tuple[FloatArray, ...]  # g_n, (n_i,) for each

    @property
    def center(self) -> FloatArray:
        """Middles, (G,)."""
        return self.anchor + self.shift

    @property
    def contact_after(self) -> FloatArray:
        """Width of the contact behind each gap, (G,)."""
        following = np.append(self.center[1:], self.center[:1] + 2 * np.pi)
        return np.asarray(following - np.roll(self.half_width, -1) - self.center - self.half_width)


@dataclass(frozen=True)
class Levels:
    """The numbers of a state besides its gaps, dimensionless."""

    deficit: float  # what the mean pressure lacks to that of complete contact without tension
    mean_pressure: float
    separation: float  # s
    penetration: float  # Delta


def certify_gaps(
    profile: Profile,
    gaps: OpenGaps,
    levels: Levels,
    *,
    compliance_ratio: ComplianceRatio | None = None,
    demands: Demands | None = None,
) -> DimensionlessCertificate:
    """Check a dimensionless state without adhesion that has at least one gap and one patch.

    The ratio is as of `certify`. Of the demands, `interpenetration` is taken relative to the largest opening of a gap,
    `contact_residual` to the largest tension that it holds back. ValueError where there is no gap, or gaps overlap.
    """
    demands = Demands() if demands is None else demands
    if gaps.anchor.size == 0 or not (np.all(gaps.half_width > 0) and np.all(gaps.contact_after > 0)):
        raise ValueError("gaps: at least one, of positive width, in order on the circle, with contact between them")
    field = _Pressure(profile, gaps, levels.deficit, compliance_ratio)
    verdict, gap = Verdict(gaps.anchor.size), "in gap" * (gaps.anchor.size > 1)
    noise = ROUNDING * field.scale
    first = np.array([np.max(np.abs(g)) for g in gaps.opening])
    noisy = SUMMED * noise * gaps.half_width / first
    ends = np.array([_end_value(g) for g in gaps.opening])
    closure = verdict.judge("closure", ends, np.maximum(demands.closure, noisy), gap)
    tails = np.array([np.max(np.abs(g[-3:])) for g in gaps.opening]) / first
    truncation = verdict.judge("truncation", tails, np.maximum(demands.truncation, noisy), gap)
    held, left = field.in_gaps()
    verdict.judge("pressure in a gap", left, np.maximum(demands.contact_residual * held, noise), gap)
    verdict.judge("tension without adhesion", -field.lowest_in_contact(), max(TENSION * held.max(), noise), "")
    overlap, lowest, highest = _overlap(gaps.opening)
    verdict.judge("interpenetration", overlap, np.maximum(demands.interpenetration, noisy), gap)
    volume = math.fsum(a * g[0] / 4 for a, g in zip(gaps.half_width, gaps.opening, strict=True))
    verdict.judge("mean gap over separation", abs(volume / levels.separation - 1), RELATIVE, "")
    error = abs(profile.max_height - levels.penetration - volume)
    mean_gap_error = verdict.judge("mean gap less separation", error, demands.mean_gap_error, "")
    verdict.judge("deficit", abs(field.least_mean - levels.deficit - levels.mean_pressure), noise, "")
    return DimensionlessCertificate(
        closure=closure,
        min_gap=lowest,
        min_eigenvalue=None,
        truncation=truncation,
        hessian_asymmetry=None,
        contact_residual=float(np.max(left / np.maximum(held, noise))),
        mean_gap_error=mean_gap_error,
        ok=not verdict.reasons,
        reasons=tuple(verdict.reasons),
        largest_gap=highest,
    )


def _end_value(series: FloatArray) -> float:
    """|K| at the worse end over that of the first term alone."""
    terms = series * np.arange(1, series.size + 1)
    even, odd = math.fsum(terms[0::2]), math.fsum(terms[1::2])
    return (abs(even) + abs(odd)) / max(abs(float(series[0])), 1e-300)


def _overlap(opening: tuple[FloatArray, ...]) -> tuple[FloatArray, float, float]:
    """Depth of interpenetration over the largest opening of each gap, (G,), the smallest gap and the largest."""
    depth, lowest, highest = np.empty(len(opening)), math.inf, 0.0
    for i, series in enumerate(opening):
        angle = (np.arange(8 * series.size) + 0.5) * (np.pi / (8 * series.size))
        g = np.sin(np.multiply.outer(angle, np.arange(1, series.size + 1))) @ series
        depth[i], lowest = -g.min() / np.max(np.abs(g)), min(lowest, float(g.min()))
        highest = max(highest, float(g.max()))
    return depth, lowest, highest


class _Pressure:
    """The pressure that goes with openings, everywhere."""

    def __init__(
        self, profile: Profile, gaps: OpenGaps, deficit: float, compliance_ratio: ComplianceRatio | None
    ) -> None:
        self.gaps, self.orders = gaps, profile.orders.astype(np.float64)
        ratio = np.ones(self.orders.size) if compliance_ratio is None else compliance_ratio(self.orders)
        self.amplitude = self.orders * profile.amplitudes / ratio
        self.phases, self.max_order = profile.phases, profile.max_order
        self.table = Profile(profile.period, profile.orders, self.amplitude, profile.phases)
        x = np.arange(32 * self.max_order) * (np.pi / (16 * self.max_order))
        spectrum = np.zeros(x.size // 2 + 1, dtype=np.complex128)
        spectrum[profile.orders] = self.amplitude * np.exp(1j * profile.phases) * (x.size / 2)
        on_grid = np.fft.irfft(spectrum, x.size)
        inner = np.flatnonzero((on_grid <= np.roll(on_grid, 1)) & (on_grid < np.roll(on_grid, -1)))
        sag = np.roll(on_grid, 1)[inner] + np.roll(on_grid, -1)[inner] - 2 * on_grid[inner]
        deep = inner[on_grid[inner] - sag <= on_grid.min()]
        lowest = float(self._followed(x[deep], x[1], self._wave).min())
        self.least_mean = -lowest
        self.above_lowest = -deficit - lowest  # p_0 + q is this plus q
        self.scale = abs(self.least_mean) + float(np.sqrt(np.sum(self.amplitude**2) / 2))
        self.layer = np.empty(0, dtype=np.complex128)
        if compliance_ratio is not None:
            self.layer = self._layer_modes(compliance_ratio)

    def in_gaps(self) -> tuple[FloatArray, FloatArray]:
        """Largest tension that each gap holds back, and the largest pressure left between the nodes, (G,) each."""
        gaps = self.gaps
        held, left = np.empty(gaps.anchor.size), np.empty(gaps.anchor.size)
        base = self._wave(gaps.anchor)
        for i, series in enumerate(gaps.opening):
            a, n = gaps.half_width[i], series.size + 5
            angle = (np.arange(n) + 0.5) * (np.pi / n)
            offset = gaps.shift[i] + a * np.cos(angle)
            turning = np.expm1(1j * np.multiply.outer(offset, self.orders))
            there = self._factor(gaps.anchor[i : i + 1])[0] * self.amplitude
            complete = self.above_lowest + base[i] + (turning @ there).real
            order = np.arange(1, series.size + 1)
            own = np.sin(np.multiply.outer(angle, order)) @ (order * series) / (a * np.sin(angle))
            x = gaps.center[i] + a * np.cos(angle)
            opened = own + self._others(x, a * np.cos(angle), i) + self._of_layer(x)
            held[i], left[i] = -complete.min(), np.max(np.abs(complete + opened))
        return held, left

    def lowest_in_contact(self) -> float:
        """Return the lowest pressure of all patches, from bracketed minima."""
        gaps, lowest = self.gaps, math.inf
        for i, width in enumerate(gaps.contact_after):
            start = gaps.center[i] + gaps.half_width[i]
            n = LEAST_POINTS + int(POINTS_PER_WAVELENGTH * width * self.max_order / 4)
            theta = (np.arange(n) + 0.5) * (np.pi / n)

            def pressure(
                theta: FloatArray, i: int = i, width: float = float(width), start: float = start, exact: bool = True
            ) -> FloatArray:
                behind, ahead = width * np.sin(theta / 2) ** 2, width * np.cos(theta / 2) ** 2
                complete = self._wave(start + behind) if exact else self.table.height(start + behind)
                return complete + self._besides(start + behind, i, behind, ahead)

            values = pressure(np.asarray(theta), exact=False)
            before, here, after = values[:-2], values[1:-1], values[2:]
            low = (here <= before) & (here < after)
            low &= (3 * here <= before + after) | (here == here.min())
            minima = self._followed(np.asarray(theta[1:-1][low]), np.pi / n, pressure)
            ends = pressure(np.asarray(theta[[0, -1]]))
            lowest = min(lowest, float(ends.min()), float(minima.min(initial=math.inf)))
        return lowest

    def _followed(self, at: FloatArray, reach: float, function: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Values of minima bracketed by at -+ reach, (n,): ever narrower brackets."""
        steps = np.linspace(-1.0, 1.0, ZOOM_POINTS)
        values = np.full(at.size, np.inf)
        for _ in range(ZOOMS if at.size else 0):
            points = at[:, None] + reach * steps
            samples = function(points.ravel()).reshape(points.shape)
            best = np.argmin(samples, axis=1)
            at, values = points[np.arange(at.size), best], samples.min(axis=1)
            reach = reach / 4
        return values

    def _factor(self, x: FloatArray) -> ComplexArray:
        """exp(i (m x + phi_m)), (n, n_harmonics): single precision times an integer is exact."""
        coarse = x.astype(np.float32).astype(np.float64)
        rest = np.multiply.outer(x - coarse, self.orders) + self.phases
        return np.asarray(np.exp(1j * np.multiply.outer(coarse, self.orders)) * np.exp(1j * rest))

    def _wave(self, x: FloatArray) -> FloatArray:
        """q, (n,)."""
        block = max(1, (1 << 20) // self.orders.size)
        parts = [(self._factor(x[k : k + block]) @ self.amplitude).real for k in range(0, x.size, block)]
        return np.concatenate(parts) if parts else np.empty(0)

    def _besides(self, x: FloatArray, gap: int, behind: FloatArray, ahead: FloatArray) -> FloatArray:
        """Pressure less q at points of the contact behind a gap, at distances from that gap and the next one, (n,)."""
        gaps, following = self.gaps, (gap + 1) % self.gaps.anchor.size
        total = self.above_lowest + self._of_layer(x)
        middle = x - gaps.center[gap]
        for i, series in enumerate(gaps.opening):
            a = gaps.half_width[i]
            images = []
            if i == gap:
                images.append((middle, behind))
            if i == following:
                turn = 2 * np.pi if following <= gap else 0.0
                images.append((x - gaps.center[i] - turn, ahead))
            total += self._dislocations(x - gaps.center[i], series, a, [distance for distance, _ in images])
            for distance, beyond in images:
                total += _line(series, np.copysign(1.0, distance), beyond / a) / a
        return total

    def _others(self, x: FloatArray, inside: FloatArray, own: int) -> FloatArray:
        """Return the pressure that other gaps and the images of a gap cause at points of it, (n,)."""
        total = np.zeros(x.size)
        for i, series in enumerate(self.gaps.opening):
            distance = inside if i == own else x - self.gaps.center[i]
            total += self._dislocations(distance, series, self.gaps.half_width[i], [inside] if i == own else [])
        return total

    def _dislocations(
        self, distance: FloatArray, series: FloatArray, a: float, left_out: list[FloatArray]
    ) -> FloatArray:
        """(1/2 pi) int cot(y/2) g' dx' less the lines 1/(pi y) of the images at some distances, (n,)."""
        n = 2 * series.size + ANGLES
        angle = (np.arange(n) + 0.5) * (np.pi / n)
        order = np.arange(1, series.size + 1)
        density = -(np.cos(np.multiply.outer(angle, order)) @ (order * series)) * (np.pi / n)
        t = a * np.cos(angle)
        kernel = _cotangent(distance[:, None] - t, [image[:, None] - t for image in left_out])
        return np.asarray(kernel @ density / np.pi)

    def _layer_modes(self, compliance_ratio: ComplianceRatio) -> ComplexArray:
        """2 (1/ratio_m - 1) m g_m for m = 1.. up to where the ratio is 1 to rounding."""
        highest = 16
        while abs(float(compliance_ratio(np.array([float(highest)]))[0]) - 1) > 1e-17 and highest < HIGHEST:
            highest *= 2
        m = np.arange(1, highest + 1)
        modes = np.zeros(highest, dtype=np.complex128)
        for center, a, series in zip(self.gaps.center, self.gaps.half_width, self.gaps.opening, strict=True):
            n = 2 * series.size + int(a * highest) + ANGLES
            angle = (np.arange(n) + 0.5) * (np.pi / n)
            order = np.arange(1, series.size + 1)
            g = np.sin(np.multiply.outer(angle, order)) @ series * np.sin(angle) * (np.pi / n) * a
            for first in range(0, highest, 64):  # all at once are gigabytes on a thin layer
                few = slice(first, first + 64)
                modes[few] += np.exp(-1j * np.multiply.outer(m[few], center + a * np.cos(angle))) @ g
        return np.asarray(modes * (1 / compliance_ratio(m.astype(np.float64)) - 1) * m / np.pi)

    def _of_layer(self, x: FloatArray) -> FloatArray:
        """Return the pressure that a layer adds at points x, (n,)."""
        m = np.arange(1, self.layer.size + 1)
        return np.asarray((np.exp(1j * np.multiply.outer(x, m)) @ self.layer).real)


def _line(series: FloatArray, side: FloatArray, beyond: FloatArray) -> FloatArray:
    """Return a sigma outside a gap on a line, by its dislocations: -sum (n+1) g_n zeta^(n+1) / (side sqrt(z^2 - 1))."""
    root = np.sqrt(beyond * (2 + beyond))
    zeta = side / (1 + beyond + root)
    terms = np.concatenate([[0.0], series * np.arange(1, series.size + 1)])
    return np.asarray(-side * np.polynomial.polynomial.polyval(zeta, terms) / root)


def _cotangent(y: FloatArray, left_out: list[FloatArray]) -> FloatArray:
    """cot(y/2)/2 less 1/y of the images left out, same shape; around an image by the series of the cotangent."""
    nearest = y - 2 * np.pi * np.rint(y / (2 * np.pi))
    square, near = nearest * nearest, np.zeros(y.shape, dtype=bool)
    lines = np.zeros(y.shape)
    with np.errstate(divide="ignore"):
        for image in left_out:
            close = np.abs(image) < CLOSE
            near |= close
            lines += np.where(close, 0.0, 1 / image)
        rest = -nearest / 12 * (1 + square / 60 * (1 + square / 42 * (1 + square / 40 * (1 + square * 5 / 198))))
        return np.asarray(np.where(near, rest, 0.5 / np.tan(nearest / 2)) - lines)
