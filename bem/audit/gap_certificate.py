"""Is a state given by its gaps correct?  Checks of contact next to complete contact, where pressures hide its gaps.

At a relative distance d from complete contact the last gap holds back tensions d times the pressure, over a width of
the order of the root of d: what a certificate of pressures sees of it drowns in rounding.  So middle all is measured
against the tension that a gap holds back.  Given are the gaps, the series g = sqrt(1 - t^2) sum g_n U_n(t) of their
openings, the mean pressure and what it lacks to complete contact.  The pressure is recomputed from the dislocations g',
of which the series is -sum (n + 1) g_n T_{n+1} / sqrt(1 - t^2),

    sigma = p_0 + q + (1/2 pi) int cot((x - x')/2) g'(x') dx'  (+ the Fourier series that a layer adds),

with the cotangent split into 1/y (Mason and Handscomb, Chebyshev Polynomials (2003), theorem 9.1) and a smooth rest by
the midpoint rule in the angle: nothing is taken from gap_series.py.  Checked are

- K = 0 at every end over that of a uniformly loaded crack of the same volume, and the decay of the series,
- no pressure in the gaps between the nodes, no tension in contact however narrow (minima are refined),
- gaps that are open all along, the mean gap against the separation, the deficit against the lowest pressure.

The demands are those of `Demands` (certificate.py): `interpenetration` is that of a gap over its largest opening, and
of tension in contact over the largest that a gap holds back.  Dimensionless (scaling.py).  Limits: pressures are known
to `PRESSURE_ROUNDING`, so that 1e-12 from complete contact nothing below some 1e-2 of the tension is seen.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from bem.audit.certificate import Demands, DimensionlessCertificate, Verdict
from bem.audit.displacement import ComplianceRatio
from bem.geometry.arrays import ComplexArray, FloatArray
from bem.geometry.gaps import Gaps, sines
from bem.geometry.minima import OFFSETS, TO_ROUNDING, refined
from bem.geometry.profile import POINTS_PER_WAVELENGTH, Profile

PRESSURE_ROUNDING = 5e-15  # of pressures, over mean plus rms pressure of complete contact; measured 1e-15
NEAR_IMAGE = 0.03  # derived: where cot(y/2)/2 - 1/y is a series; its term of y^7, left out, is 2e-17 there
HIGHEST = 1 << 16  # limit: modes of a layer

Openings = tuple[FloatArray, ...]


def certify_gaps(
    profile: Profile,
    gaps: Gaps,
    opening: Openings,
    *,
    deficit: float,
    mean_pressure: float,
    separation: float,
    penetration: float,
    compliance_ratio: ComplianceRatio | None = None,
) -> DimensionlessCertificate:
    """Check a dimensionless state without adhesion that has at least one gap and one patch.

    Parameters
    ----------
    profile : Profile
    gaps : Gaps
    opening : tuple of (n_i,) arrays
        Series g_n of each gap.
    deficit : float
        What the mean pressure lacks to that of complete contact without tension.
    mean_pressure, separation, penetration : float
    compliance_ratio : callable, optional
        As of `certify`.

    Raises
    ------
    ValueError
        There is no gap, or gaps overlap.
    """
    if gaps.count == 0 or not (np.all(gaps.half_width > 0) and np.all(gaps.patch_after > 0)):
        raise ValueError("gaps: at least one, of positive width, in order on the circle, with contact between them")
    demands, field = Demands(), _Pressure(profile, gaps, opening, deficit, compliance_ratio)
    verdict, gap = Verdict(gaps.count), "in gap" * (gaps.count > 1)
    noise = PRESSURE_ROUNDING * field.scale
    noisy = noise * gaps.half_width / np.array([np.max(np.abs(g)) for g in opening])
    ends = np.array([_end_value(g) for g in opening])
    closure = verdict.judge("closure", ends, np.maximum(demands.closure, noisy), gap)
    tails = np.array([np.max(np.abs(g[-3:])) / np.max(np.abs(g)) for g in opening])
    truncation = verdict.judge("truncation", tails, np.maximum(demands.truncation, noisy), gap)
    held, left = field.in_gaps()
    verdict.judge("pressure in a gap", left, np.maximum(demands.contact_residual * held, noise), gap)
    tension = max(demands.interpenetration * held.max(), noise)
    verdict.judge("tension without adhesion", -field.lowest_in_contact(), tension, "")
    openings = [sines(g, _midpoints(8 * g.size)) for g in opening]
    overlap = np.array([-g.min() / np.max(np.abs(g)) for g in openings])
    verdict.judge("interpenetration", overlap, np.maximum(demands.interpenetration, noisy), gap)
    volume = math.fsum(a * g[0] / 4 for a, g in zip(gaps.half_width, opening, strict=True))
    verdict.judge("mean gap over separation", abs(volume / separation - 1), demands.closure, "")
    error = abs(profile.max_height - penetration - volume)
    mean_gap_error = verdict.judge("mean gap less separation", error, demands.mean_gap_error, "")
    verdict.judge("deficit", abs(field.least_mean - deficit - mean_pressure), noise, "")
    return verdict.certificate(
        closure=closure,
        min_gap=min(float(g.min()) for g in openings),
        truncation=truncation,
        contact_residual=float(np.max(left / np.maximum(held, noise))),
        mean_gap_error=mean_gap_error,
        largest_gap=max(float(g.max()) for g in openings),
    )


def _midpoints(n: int) -> FloatArray:
    """Return theta = (k + 1/2) pi / n, (n,)."""
    return np.asarray((np.arange(n) + 0.5) * (np.pi / n), dtype=np.float64)


def _end_value(series: FloatArray) -> float:
    """Return |K| at the worse end over that of the first term alone."""
    terms = series * np.arange(1, series.size + 1)
    even, odd = math.fsum(terms[0::2]), math.fsum(terms[1::2])
    return (abs(even) + abs(odd)) / max(abs(float(series[0])), 1e-300)


class _Pressure:
    """Pressure that goes with openings, everywhere."""

    def __init__(
        self, profile: Profile, gaps: Gaps, opening: Openings, deficit: float, ratio: ComplianceRatio | None
    ) -> None:
        self.gaps, self.opening, self.orders = gaps, opening, profile.orders.astype(np.float64)
        self.amplitude = self.orders * profile.amplitudes / (1.0 if ratio is None else ratio(self.orders))
        self.table = Profile(profile.period, profile.orders, self.amplitude, profile.phases)
        x, q = self.table.grid
        before, after = np.roll(q, 1), np.roll(q, -1)
        deep = np.flatnonzero((q <= before) & (q < after) & (3 * q - before - after <= q.min()))
        self.least_mean = -float(refined(self._wave, x[deep] + x[1] * OFFSETS, refinements=TO_ROUNDING).value.min())
        self.above_lowest = self.least_mean - deficit  # p_0 + q is this plus q
        self.scale = abs(self.least_mean) + float(np.sqrt(np.sum(self.amplitude**2) / 2))
        self.layer = np.empty(0, dtype=np.complex128) if ratio is None else self._layer_modes(ratio)

    def in_gaps(self) -> tuple[FloatArray, FloatArray]:
        """Return the largest tension that each gap holds back, and the largest pressure left in it, (G,) each."""
        gaps = self.gaps
        held, left = np.empty(gaps.count), np.empty(gaps.count)
        base, phases = self._wave(gaps.anchor), self._factor(gaps.anchor) * self.amplitude
        for i, (a, series) in enumerate(zip(gaps.half_width, self.opening, strict=True)):
            angle = _midpoints(series.size + 5)
            inside = a * np.cos(angle)
            turning = np.expm1(1j * np.multiply.outer(gaps.shift[i] + inside, self.orders))
            complete = self.above_lowest + base[i] + (turning @ phases[i]).real
            alone = sines(np.arange(1, series.size + 1) * series, angle) / (a * np.sin(angle))
            opened = alone + self._opened(gaps.center[i] + inside, [(i, inside)])
            held[i], left[i] = -complete.min(), np.max(np.abs(complete + opened))
        return held, left

    def lowest_in_contact(self) -> float:
        """Return the lowest pressure of all patches, from minima refined between points.

        The points are dense at both ends: four for each term of the gaps beside, besides those of the profile.
        """
        lowest = math.inf
        for i, width in enumerate(self.gaps.patch_after):
            terms = self.opening[i].size + self.opening[(i + 1) % self.gaps.count].size
            n = 4 * terms + int(POINTS_PER_WAVELENGTH * width * self.table.max_order / 4)
            values = self._behind(i, _midpoints(n), exact=False)
            before, middle, after = values[:-2], values[1:-1], values[2:]
            may_be_lower = (3 * middle <= before + after) | (middle == middle.min())
            low = np.flatnonzero((middle <= before) & (middle < after) & may_be_lower)
            three = (low + 1.5 + OFFSETS) * (np.pi / n)
            minima = refined(partial(self._behind, i), three, refinements=TO_ROUNDING)
            ends = self._behind(i, _midpoints(n)[[0, -1]])
            lowest = min(lowest, float(ends.min()), float(minima.value.min(initial=math.inf)))
        return lowest

    def _behind(self, i: int, theta: FloatArray, exact: bool = True) -> FloatArray:
        """Return the pressure behind gap i, (1 - cos theta)/2 of the contact from its end, shape of theta."""
        gaps, following = self.gaps, (i + 1) % self.gaps.count
        behind, ahead = (gaps.patch_after[i] * np.square(part(theta / 2)) for part in (np.sin, np.cos))
        x = gaps.center[i] + gaps.half_width[i] + behind
        images = [(i, x - gaps.center[i]), (following, x - gaps.center[following] - 2 * np.pi * (following <= i))]
        total = self._wave(x) if exact else self.table.height(x)
        total += self.above_lowest + self._opened(x, images)
        for (k, distance), beyond in zip(images, (behind, ahead), strict=True):
            a = gaps.half_width[k]
            total += _line(self.opening[k], np.copysign(1.0, distance), beyond / a) / a
        return total

    def _factor(self, x: FloatArray) -> ComplexArray:
        """Return exp(i (m x + phi_m)), (n, n_harmonics): single precision times an integer is exact."""
        coarse = x.astype(np.float32).astype(np.float64)
        rest = np.multiply.outer(x - coarse, self.orders) + self.table.phases
        return np.asarray(np.exp(1j * np.multiply.outer(coarse, self.orders)) * np.exp(1j * rest))

    def _wave(self, x: FloatArray) -> FloatArray:
        """Return q, shape of x."""
        flat, block = x.ravel(), max(1, (1 << 20) // self.orders.size)
        parts = [(self._factor(flat[k : k + block]) @ self.amplitude).real for k in range(0, flat.size, block)]
        return np.concatenate([np.empty(0), *parts]).reshape(x.shape)

    def _opened(self, x: FloatArray, images: list[tuple[int, FloatArray]]) -> FloatArray:
        """Return the pressure of the openings, and of a layer, less that of images of gaps on a line, shape of x.

        It is (1/2 pi) int cot(y/2) g' dx' less 1/(pi y) of the images, each given with the distance of x from its
        center.
        """
        m, total = np.arange(1, self.layer.size + 1), np.zeros(x.shape)
        if m.size:
            total += (np.exp(1j * np.multiply.outer(x, m)) @ self.layer).real
        for i, series in enumerate(self.opening):
            angle, order = _midpoints(4 * series.size), np.arange(1, series.size + 1)
            density = -(np.cos(np.multiply.outer(angle, order)) @ (order * series)) * (np.pi / angle.size)
            t = self.gaps.half_width[i] * np.cos(angle)
            own = [distance[..., None] - t for k, distance in images if k == i]
            total += _cotangent((x - self.gaps.center[i])[..., None] - t, own) @ density / np.pi
        return total

    def _layer_modes(self, ratio: ComplianceRatio) -> ComplexArray:
        """Return 2 (1/ratio_m - 1) m g_m for m = 1.. up to where the ratio is 1 to rounding."""
        highest = 16
        while abs(float(ratio(np.array([float(highest)]))[0]) - 1) > 1e-17 and highest < HIGHEST:
            highest *= 2
        m = np.arange(1, highest + 1)
        modes = np.zeros(highest, dtype=np.complex128)
        for center, a, series in zip(self.gaps.center, self.gaps.half_width, self.opening, strict=True):
            angle = _midpoints(4 * series.size + int(a * highest))
            g = sines(series, angle) * np.sin(angle) * (np.pi / angle.size) * a
            for first in range(0, highest, 64):  # all at once are gigabytes on a thin layer
                few = slice(first, first + 64)
                modes[few] += np.exp(-1j * np.multiply.outer(m[few], center + a * np.cos(angle))) @ g
        return np.asarray(modes * (1 / ratio(m.astype(np.float64)) - 1) * m / np.pi)


def _line(series: FloatArray, side: FloatArray, beyond: FloatArray) -> FloatArray:
    """Return a sigma outside a gap on a line: -sum (n+1) g_n zeta^(n+1) / (side sqrt(z^2 - 1)), shape of beyond."""
    root = np.sqrt(beyond * (2 + beyond))
    zeta = side / (1 + beyond + root)
    terms = np.concatenate([[0.0], series * np.arange(1, series.size + 1)])
    return np.asarray(-side * np.polynomial.polynomial.polyval(zeta, terms) / root)


def _cotangent(y: FloatArray, left_out: list[FloatArray]) -> FloatArray:
    """Return cot(y/2)/2 less 1/y of the images left out; around an image by the series of the cotangent."""
    nearest = y - 2 * np.pi * np.rint(y / (2 * np.pi))
    square, near, lines = nearest * nearest, np.zeros(y.shape, dtype=bool), np.zeros(y.shape)
    with np.errstate(divide="ignore"):
        for image in left_out:
            close = np.abs(image) < NEAR_IMAGE
            near |= close
            lines += np.where(close, 0.0, 1 / image)
        rest = -nearest / 12 * (1 + square / 60 * (1 + square / 42))
        return np.asarray(np.where(near, rest, 0.5 / np.tan(nearest / 2)) - lines)
