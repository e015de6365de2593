"""Measure overlap in the gaps of a state, and the mean gap: u - (h - h_max + Delta) between the patches.

The displacement is that of displacement.py, sampled until its series in every gap has decayed; minima between
samples are refined (minima.py).  Integrals of u and of h term by term.  Dimensionless
(scaling.py).  Limits: at most `MAX_GAP_SAMPLES` samples of u in a gap; gaps that need more are reported.
"""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache

import numpy as np

from bem.audit.displacement import DisplacementField, GapPoints, half_steps, series_and_twice_the_mean
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.minima import OFFSETS, refined
from bem.geometry.profile import POINTS_PER_WAVELENGTH, Profile

MAX_GAP_SAMPLES = 8192  # limit: of u in a gap; more is a reason against the state
WAVE_TERMS = 30  # derived: of half a wave of the cosine: below 1e-20


def gap_depths(
    profile: Profile, field: DisplacementField, penetration: float, width: FloatArray, resolved: float
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Depth of interpenetration (minus the smallest gap), height and integral of each gap, (L,), and gaps not resolved.

    Near an edge u is a power series in the root of the distance, so with x = b + g (1 - cos theta)/2 it is analytic
    in theta on [0, pi], though not even.  Its Chebyshev series in theta, sampled until it has decayed, gives it on a
    grid that resolves the profile.  The height is the largest on that grid.

    Parameters
    ----------
    profile : Profile
    field : DisplacementField
    penetration : float
        Delta.
    width : (L,) array
        Of the gap behind each patch.
    resolved : float
        What the last coefficients of u in a gap may be.
    """
    contact_level = penetration - profile.max_height
    waves = width * (profile.max_order / (2 * np.pi))
    series, lengths, unresolved = _displacement_series(field, width, _rounded(8 + 20 * waves**0.3), resolved)
    grid = _rounded(np.maximum(waves * (POINTS_PER_WAVELENGTH * np.pi**2 / 4), 4 * lengths))
    integrals = width * (series @ _moments(series.shape[1]) - contact_level)
    lowest_at, highest = np.empty(field.count), np.empty(field.count)
    suspects = [(np.empty(0, dtype=np.int64), np.empty(0), np.empty(0))]
    for size in np.unique(grid):
        who = np.flatnonzero(grid == size)
        longest = int(lengths[who].max())
        padded = np.zeros((who.size, size + 1))
        padded[:, :longest] = series[who, :longest] * size
        u = np.fft.irfft(padded * half_steps(int(size)), 2 * size)[:, :size]
        x = field.pressure.right[who, None] + width[who, None] * _over_a_gap(int(size)).from_left
        gap = u - profile.height(x) - contact_level
        lowest, highest[who] = gap.min(axis=1), gap.max(axis=1)
        lowest_at[who] = (gap.argmin(axis=1) + 0.5) * (np.pi / size)
        before, inner, after = gap[:, :-2], gap[:, 1:-1], gap[:, 2:]
        bend = before - 2 * inner + after  # more than what a minimum between the points may lie lower
        row, column = np.nonzero((inner <= before) & (inner < after) & (inner - bend < lowest[:, None]))
        suspects.append((who[row], (column + 1.5) * (np.pi / size), np.full(row.size, np.pi / size)))
    integrals -= _height_integrals(profile, field.pressure.right, field.pressure.right + width)

    def gap_at(gap: IntArray, angle: FloatArray) -> FloatArray:
        points = _at_angles(width, gap, angle)
        return field.in_gaps(points) - profile.height(field.positions(points)) - contact_level

    depth = -gap_at(np.arange(field.count), lowest_at)
    owner, angle, step = (np.concatenate(parts) for parts in zip(*suspects, strict=True))
    three = np.tile(owner, 3)
    minima = refined(lambda at: gap_at(three, at.ravel()).reshape(at.shape), angle + step * OFFSETS)
    np.maximum.at(depth, owner, -minima.value)
    return depth, highest, integrals, unresolved


def _displacement_series(
    field: DisplacementField, width: FloatArray, samples: IntArray, resolved: float
) -> tuple[FloatArray, IntArray, IntArray]:
    """Chebyshev coefficients of u in every gap, filled up with zeros, (L, most), and how many there are, (L,).

    They are doubled in number until they have decayed; also gaps that need too many.
    """
    series = np.zeros((field.count, int(samples.max())))
    pending, too_many = np.arange(field.count), []
    while pending.size:
        classes = [(int(size), pending[samples[pending] == size]) for size in np.unique(samples[pending])]
        points = [_clustered(width, who, size) for size, who in classes]
        u = field.in_gaps(GapPoints(*(np.concatenate([getattr(p, f.name) for p in points]) for f in fields(GapPoints))))
        unresolved = []
        for (size, who), part in zip(classes, np.split(u, np.cumsum([p.gap.size for p in points])[:-1]), strict=True):
            rows = series_and_twice_the_mean(part.reshape(who.size, size))
            if size > series.shape[1]:
                series = np.pad(series, ((0, 0), (0, size - series.shape[1])))
            series[who, :size] = rows
            last = np.abs(rows[:, -3:]).max(axis=1)
            again = (last > resolved) & (2 * size <= MAX_GAP_SAMPLES)
            unresolved.append(who[again])
            too_many.append(who[~again & ~(last <= resolved)])  # or no numbers
        pending = np.sort(np.concatenate(unresolved))
        samples[pending] *= 2
    return series, samples, np.sort(np.concatenate(too_many))


def _rounded(number: FloatArray) -> IntArray:
    """Sizes rounded up in steps of at most a quarter, so that equal ones can be treated together."""
    step = 2 ** np.maximum(np.ceil(np.log2(number)).astype(np.int64) - 3, 0)
    return np.asarray(np.ceil(number / step) * step, dtype=np.int64)


def _clustered(width: FloatArray, gaps: IntArray, number: int) -> GapPoints:
    """Return the points phi = (k + 1/2) pi / n of `_at_angles` for some gaps, joined."""
    whole = _over_a_gap(number)
    left, right = (np.outer(width[gaps], part).ravel() for part in (whole.from_left, whole.from_right))
    return GapPoints(np.repeat(gaps, number), left, right)


@lru_cache(maxsize=256)
def _over_a_gap(number: int) -> GapPoints:
    """Return the points phi = (k + 1/2) pi / n of a gap of width 1."""
    angle = np.asarray((np.arange(number) + 0.5) * (np.pi / number), dtype=np.float64)
    return _at_angles(np.array([1.0]), np.zeros(number, dtype=np.int64), angle)


def _at_angles(width: FloatArray, gap: IntArray, angle: FloatArray) -> GapPoints:
    """Points b + g (1 - cos theta)/2, theta = pi (1 - cos phi)/2, phi in (0, pi): dense at both edges."""
    from_left = np.sin(np.pi / 2 * np.sin(angle / 2) ** 2)
    from_right = np.sin(np.pi / 2 * np.cos(angle / 2) ** 2)
    return GapPoints(gap, width[gap] * from_left**2, width[gap] * from_right**2)


@lru_cache(maxsize=256)
def _moments(size: int) -> FloatArray:
    """int T_k(cos phi) dx over a gap of width 1 for k < size, (size,), the first halved as it is twice in a series.

    With t = cos phi it is pi/4 int T_k(t) cos(pi t/2) dt, the cosine in Chebyshev polynomials and int T_j dt =
    2/(1 - j^2) for even j.
    """
    wave = series_and_twice_the_mean(np.cos(np.pi / 2 * np.cos((np.arange(WAVE_TERMS) + 0.5) * (np.pi / WAVE_TERMS))))[
        ::2
    ]
    wave[0] /= 2
    even, order = 2 * np.arange(wave.size), np.arange(0, size, 2)[:, None]
    moments = np.zeros(size)
    moments[::2] = np.pi / 4 * ((1 / (1 - (order + even) ** 2) + 1 / (1 - (order - even) ** 2)) @ wave)
    moments[0] /= 2
    return moments


def _height_integrals(profile: Profile, start: FloatArray, stop: FloatArray) -> FloatArray:
    """int h dx from start to stop, term by term, (L,): exp(imx) is a product from two tables with sqrt(M) entries."""
    size = int(np.sqrt(profile.max_order)) + 1
    antiderivative = np.zeros(size * size, dtype=np.complex128)
    antiderivative[profile.orders] = profile.amplitudes / profile.orders * np.exp(1j * profile.phases)
    x, order = np.concatenate([stop, start]), np.arange(size)
    fine, coarse = np.exp(1j * np.multiply.outer(x, order)), np.exp(1j * np.multiply.outer(x, size * order))
    sums = np.einsum("ij,ij->i", fine @ antiderivative.reshape(size, size).T, coarse).imag
    return np.asarray(sums[: stop.size] - sums[stop.size :])
