"""Opening, pressure and load of given gaps: the mirror of collocation.py, in which only the gaps carry unknowns.

Complete contact has the pressure p_0 + q(x).  A gap g >= 0 adds Lambda g, Lambda: stiffness of the modes (m for the
half-space, m / ratio_m for a layer, 0 for the mean), and inside the gaps nothing is left: Lambda g = -(p_0 + q).  With
x = c + a t and g = sqrt(1 - t^2) sum g_n U_n(t), a gap alone on a line has

    Lambda g = sum (n + 1) g_n U_n(t) / a,   outside  -sum (n + 1) g_n zeta^(n+1) / (a sgn(t) sqrt(t^2 - 1)),
    K = sqrt(pi / a) k,   k = sum (n + 1) (+-1)^n g_n,   dK/d(end out of the gap) = -3/2 sqrt(pi) a^(-3/2) f at K = 0,
    s = sum a g_0 / 4 (mean gap),   U_el = U_complete - int g Lambda g dx / 2 - 2 pi p_0 s,

zeta = t - sgn(t) sqrt(t^2 - 1), f = -sum n (n + 1) (n + 2) / 3 (+-1)^n g_n the inward slope of sum g_n U_n.  Other
gaps, the period and a layer are smooth and take Gauss's rule for the weight sqrt(1 - t^2).  Thus narrow gaps are the
well-conditioned ones.  The mean pressure is counted from that of complete contact, by the deficit tau = -min q - p_0,
and q from its value at an anchor in each gap (completed_body.py), so that nothing small is a difference of large
numbers; only q at one anchor less q at the lowest is.

Source: Mason and Handscomb, Chebyshev Polynomials (2003), theorem 9.1; Tada, Paris, Irwin, The Stress Analysis of
Cracks Handbook, 3rd ed. (2000), part II.  Dimensionless (scaling.py).  Limits: a patch much narrower than the gap
beside it costs as much here as a narrow gap does there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from bem.elastic.hierarchical import IllConditionedSystemError
from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches, PatchPressure
from bem.nonadhesive.completed_body import CompletedBody
from bem.nonadhesive.gaps import Gaps

COUPLING = 1e-15  # derived: accuracy of the coupling of gaps
MOST_UNKNOWNS = 6000  # limit: of all gaps
SERIES_REACH, SERIES_TERMS = 1.0, 14  # derived: of the periodic rest of the kernel; (1 / (2 pi))^28 = 5e-23
DECAYED, LONGEST_SERIES = 1e-14, 1 << 16  # derived: of the series of the pressure on a patch


@dataclass(frozen=True, eq=False)
class GapEvaluation:
    """State of given gaps at a given deficit, dimensionless; arrays of ends list left ends of gaps, then right ones.

    Attributes
    ----------
    gaps : Gaps
    deficit : float
        tau, what the mean pressure lacks to that of complete contact.
    opening, opening_rate : tuples of (n_i,) arrays
        g_n of each gap, and its derivative by tau.
    separation, separation_rate : float
        Mean gap, and its derivative by tau.
    work : float
        int g Lambda g dx.
    """

    body: CompletedBody
    gaps: Gaps
    deficit: float
    opening: tuple[FloatArray, ...]
    opening_rate: tuple[FloatArray, ...]
    separation: float
    separation_rate: float
    work: float

    @property
    def unknowns(self) -> int:
        """Coefficients of all gaps."""
        return sum(series.size for series in self.opening)

    @cached_property
    def patches(self) -> Patches:
        """The contact."""
        return self.gaps.patches()

    @property
    def mean_pressure(self) -> float:
        """p_0."""
        return self.body.lowest - self.deficit

    @property
    def load(self) -> float:
        """int sigma dx."""
        return TWO_PI * self.mean_pressure

    @property
    def load_rate(self) -> float:
        """d(load)/dDelta at fixed ends, and along K = 0."""
        return TWO_PI / self.separation_rate

    @property
    def penetration(self) -> float:
        """Delta."""
        return self.body.max_height - self.separation

    @property
    def elastic_energy(self) -> float:
        """U_el."""
        return self.body.complete.elastic_energy - self.work / 2 - TWO_PI * self.mean_pressure * self.separation

    @cached_property
    def end_values(self) -> FloatArray:
        """k, (2 G,)."""
        return end_values(self.opening)

    @property
    def stress_intensity(self) -> FloatArray:
        """K, (2 G,)."""
        return np.asarray(self.end_values * np.sqrt(np.pi / np.tile(self.gaps.half_width, 2)))

    @cached_property
    def end_slopes(self) -> FloatArray:
        """Inward derivative by t of sum g_n U_n at the ends, (2 G,)."""
        slopes = []
        for sign in (-1.0, 1.0):
            for series in self.opening:
                n = np.arange(series.size)
                slopes.append(-float(np.sum(sign**n * n * (n + 1) * (n + 2) / 3 * series)))
        return np.array(slopes)

    def shifted(self, amount: float) -> GapEvaluation:
        """Return the state of the same gaps at a deficit larger by an amount."""
        work = self.work + amount * (4 * np.pi * self.separation + TWO_PI * amount * self.separation_rate)
        return replace(
            self,
            deficit=self.deficit + amount,
            opening=tuple(g + amount * rate for g, rate in zip(self.opening, self.opening_rate, strict=True)),
            separation=self.separation + amount * self.separation_rate,
            work=work,
        )

    def pressure_at(self, x: FloatArray, beside: IntArray, beyond: FloatArray) -> FloatArray:
        """Pressure at points x of contact, (n,).

        Parameters
        ----------
        x : (n,) array
        beside : (n,) int array
            A gap next to which each lies.
        beyond : (n,) array
            Its distance from the nearer end of that gap.
        """
        total = self.mean_pressure + self.body.pressure.height(x)
        return np.asarray(total + self.pressure_of_opening(x, beside, beyond))

    def pressure_of_opening(self, x: FloatArray, beside: IntArray, beyond: FloatArray) -> FloatArray:
        """Lambda g at points of contact, (n,): the arguments of `pressure_at`."""
        total = np.zeros(x.size)
        for i, series in enumerate(self.opening):
            a = self.gaps.half_width[i]
            away = _wrapped(x - self.gaps.center[i])
            excess = np.where(beside == i, beyond, np.abs(away) - a) / a
            odd = np.where(away < 0, -1.0, 1.0)
            total += _line_pressure(series, excess, odd) / a
            t, weight = _nodes(series.size)
            charge = a * weight * _second_kind(series, t)
            total -= _periodic_rest(away[:, None] - a * t) @ charge / np.pi
        m = np.arange(1, self.body.stiffening.size + 1)
        if m.size:
            total += (np.exp(1j * np.multiply.outer(x, m)) @ (self.body.stiffening * self._gap_modes(m))).real
        return total

    def _gap_modes(self, m: IntArray) -> NDArray[np.complex128]:
        """(1/pi) int g exp(-i m x) dx, (n,)."""
        modes = np.zeros(m.size, dtype=np.complex128)
        for i, series in enumerate(self.opening):
            a = self.gaps.half_width[i]
            t, weight = _nodes(series.size + int(a * m[-1]) + 20)
            charge = a * weight * _second_kind(series, t)
            modes += np.exp(-1j * np.multiply.outer(m, self.gaps.center[i] + a * t)) @ charge
        return modes / np.pi

    def pressure(self) -> PatchPressure:
        """Return the pressure as Chebyshev series on the patches, to rounding of its largest coefficient."""
        gaps, charges = self.gaps, []
        start = gaps.center + gaps.half_width
        middle, r = start + gaps.patch_after / 2, gaps.patch_after / 2
        for i in range(gaps.count):
            size = int(chebyshev.profile_nodes(2 * r[i : i + 1], self.body.pressure.max_order)[0])
            while True:
                angle = (np.arange(size) + 0.5) * (np.pi / size)
                from_right, from_left = 2 * r[i] * np.sin(angle / 2) ** 2, 2 * r[i] * np.cos(angle / 2) ** 2
                nearer_right = from_right < from_left
                beside = np.where(nearer_right, (i + 1) % gaps.count, i)
                values = self.pressure_at(
                    middle[i] + r[i] * np.cos(angle), beside, np.where(nearer_right, from_right, from_left)
                )
                charge = chebyshev.coefficients(values * r[i] * np.sin(angle))
                if np.max(np.abs(charge[-3:])) <= DECAYED * np.max(np.abs(charge)) or size > LONGEST_SERIES:
                    break
                size *= 2
            charges.append(charge)
        turned = np.floor(start / TWO_PI)
        order = np.argsort(start - TWO_PI * turned)
        patches = self.patches
        return PatchPressure(patches.left, patches.right, tuple(charges[k] for k in order))


def evaluate_gaps(body: CompletedBody, gaps: Gaps, deficit: float, extra: float = 1.0) -> GapEvaluation:
    """Solve for the opening of given gaps at a given deficit.

    Parameters
    ----------
    body : CompletedBody
    gaps : Gaps
        In order, disjoint, at least one.
    deficit : float
        tau.
    extra : float
        Factor on the number of nodes, for error estimates.

    Raises
    ------
    IllConditionedSystemError
        More unknowns than fit, or a matrix that is not positive definite.
    """
    sizes = np.ceil(extra * _sizes(body, gaps)).astype(np.int64)
    if not np.sum(sizes) <= MOST_UNKNOWNS:
        raise IllConditionedSystemError(f"{np.sum(sizes)} unknowns needed in gaps, at most {MOST_UNKNOWNS} fit")
    starts = np.concatenate([[0], np.cumsum(sizes)])
    owner = np.repeat(np.arange(gaps.count), sizes)
    a = gaps.half_width[owner]
    tables = [_nodes(int(size)) for size in sizes]
    t = np.concatenate([table[0] for table in tables])
    x = gaps.center[owner] + a * t
    relative = body.at_anchor(gaps.anchor) + body.lowest
    drive = np.empty((x.size, 2))
    for i, (first, last) in enumerate(pairwise(starts.tolist())):
        offset = gaps.shift[i] + gaps.half_width[i] * t[first:last]
        change = body.change_from_anchor(gaps.anchor[i : i + 1], offset[None, :])[0]
        drive[first:last, 0] = deficit - (relative[i] + change)
    drive[:, 1] = 1.0
    drive *= a[:, None]
    factor, info = lapack.dpotrf(_stiffness(body, x, a, starts, tables), lower=1, overwrite_a=1)
    if info != 0:
        raise IllConditionedSystemError("the stiffness matrix of the gaps is not positive definite")
    charge, _ = lapack.dpotrs(factor, drive, lower=1)
    series, rates = [], []
    for i, (first, last) in enumerate(pairwise(starts.tolist())):
        coefficients = _second_kind_table(int(sizes[i])).T @ charge[first:last] * (2 / np.pi)
        series.append(coefficients[:, 0])
        rates.append(coefficients[:, 1])
    volume = np.sum(a[:, None] * charge, axis=0)
    return GapEvaluation(
        body=body,
        gaps=gaps,
        deficit=deficit,
        opening=tuple(series),
        opening_rate=tuple(rates),
        separation=float(volume[0]) / TWO_PI,
        separation_rate=float(volume[1]) / TWO_PI,
        work=float(charge[:, 0] @ drive[:, 0]),
    )


def _sizes(body: CompletedBody, gaps: Gaps) -> FloatArray:
    """Nodes of each gap, (G,)."""
    width = 2 * gaps.half_width
    wanted = chebyshev.coupling_modes(width, np.minimum(gaps.patch_before, gaps.patch_after), COUPLING)
    wanted = np.maximum(wanted, chebyshev.profile_nodes(width, body.pressure.max_order))
    if body.stiffening.size:
        wanted = np.maximum(wanted, chebyshev.profile_nodes(width, body.stiffening.size))
    return np.asarray(wanted)


def _stiffness(
    body: CompletedBody,
    x: FloatArray,
    a: FloatArray,
    starts: IntArray,
    tables: list[tuple[FloatArray, FloatArray]],
) -> FloatArray:
    """Symmetric matrix from charges (weight times sum g_n U_n) to a Lambda g at the nodes, (n, n)."""
    matrix: FloatArray = np.subtract.outer(x, x)
    with np.errstate(divide="ignore"):
        matrix = -1 / (4 * np.pi * np.sin(matrix / 2) ** 2)
    for i, (first, last) in enumerate(pairwise(starts.tolist())):
        t = tables[i][0]
        matrix[first:last, first:last] = -_periodic_rest(a[first] * np.subtract.outer(t, t)) / np.pi
    m = np.arange(1, body.stiffening.size + 1)
    if m.size:
        wave = np.exp(1j * np.multiply.outer(x, m))
        matrix += ((wave * body.stiffening) @ wave.conj().T).real / np.pi
    matrix *= np.multiply.outer(a, a)
    for first, last in pairwise(starts.tolist()):
        table = _second_kind_table(last - first)
        order = np.arange(1.0, last - first + 1)
        matrix[first:last, first:last] += (table * (order * (2 / np.pi))) @ table.T
    return matrix


@lru_cache(maxsize=256)
def _nodes(size: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of Gauss's rule for the weight sqrt(1 - t^2), (n,) each."""
    angle = np.arange(1, size + 1) * (np.pi / (size + 1))
    return np.cos(angle), np.sin(angle) ** 2 * (np.pi / (size + 1))


@lru_cache(maxsize=64)
def _second_kind_table(size: int) -> FloatArray:
    """U_n at the nodes, (n, n)."""
    angle = np.arange(1, size + 1) * (np.pi / (size + 1))
    return np.asarray(np.sin(np.multiply.outer(angle, np.arange(1, size + 1))) / np.sin(angle)[:, None])


def _second_kind(series: FloatArray, t: FloatArray) -> FloatArray:
    """sum g_n U_n(t) by Clenshaw's rule, same shape as t."""
    now, before = np.zeros(t.shape), np.zeros(t.shape)
    for term in series[::-1]:
        now, before = term + 2 * t * now - before, now
    return now


def end_values(series: tuple[FloatArray, ...]) -> FloatArray:
    """sum (n + 1) (+-1)^n g_n of some series, all left ends first, (2 G,)."""
    left = [float(np.sum((-1.0) ** np.arange(g.size) * np.arange(1, g.size + 1) * g)) for g in series]
    right = [float(np.sum(np.arange(1, g.size + 1) * g)) for g in series]
    return np.array(left + right)


def _line_pressure(series: FloatArray, excess: FloatArray, side: FloatArray) -> FloatArray:
    """Return a Lambda g outside a gap alone on a line, (n,).

    `excess` is the distance from its end over its half width; `side` is 1 or -1.
    """
    root = np.sqrt(excess * (2 + excess))
    power = side / (1 + excess + root)
    total = np.zeros(excess.size)
    for n in range(series.size - 1, -1, -1):
        total = (total + (n + 1) * series[n]) * power
    return np.asarray(-side * total / root)


def _periodic_rest(y: FloatArray) -> FloatArray:
    """1 / (4 sin^2(y/2)) - 1/y^2, same shape."""
    square = y * y
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = 1 / (4 * np.sin(y / 2) ** 2) - 1 / square
    near = np.abs(y) < SERIES_REACH
    rest[near] = np.polynomial.polynomial.polyval(square[near], _rest_terms())
    return np.asarray(rest)


@lru_cache(maxsize=1)
def _rest_terms() -> FloatArray:
    """Taylor coefficients in y^2: 2 (2 j + 1) zeta(2 j + 2) / (2 pi)^(2 j + 2), (n,)."""
    from scipy.special import zeta  # of which the last gaps alone have need

    j = np.arange(SERIES_TERMS)
    return np.asarray(2 * (2 * j + 1) * zeta(2.0 * j + 2) / TWO_PI ** (2.0 * j + 2))


def _wrapped(distance: FloatArray) -> FloatArray:
    """Distances on the circle, in [-pi, pi]."""
    return np.asarray(distance - TWO_PI * np.rint(distance / TWO_PI))
