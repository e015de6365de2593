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

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from scipy.linalg import lapack

from bem.elastic.hierarchical import IllConditionedSystemError
from bem.geometry import chebyshev
from bem.geometry.arrays import ComplexArray, FloatArray, IntArray
from bem.geometry.gaps import Gaps, sines
from bem.geometry.patches import TWO_PI, Patches, PatchPressure
from bem.nonadhesive.completed_body import CompletedBody, LinearControl

COUPLING = 1e-15  # derived: accuracy of the coupling of gaps
MOST_IN_GAPS = 6000  # limit: of all gaps
SERIES_REACH, SERIES_TERMS = 1.0, 14  # derived: of the periodic rest of the kernel; (1 / (2 pi))^28 = 5e-23
DECAYED, LONGEST_SERIES = 1e-14, 1 << 16  # derived: of the series of the pressure on a patch


@dataclass(frozen=True, eq=False)
class GapEvaluation:
    """State of given gaps, dimensionless; arrays of ends list left ends of gaps, then right ones.

    Attributes
    ----------
    deficit : float
        tau, what the mean pressure lacks to that of complete contact.
    opening : tuple of (n_i,) arrays
        Coefficients g_n of each gap in g = sqrt(1 - t^2) sum g_n U_n(t), with t from -1 to 1 across the gap.
    separation, separation_rate : float
        Mean gap, and its derivative by tau.
    work : float
        int g Lambda g dx; Lambda is the elastic operator from a gap g to the pressure that it adds.
    """

    body: CompletedBody
    gaps: Gaps
    deficit: float
    opening: tuple[FloatArray, ...]
    separation: float
    separation_rate: float
    work: float

    @property
    def unknowns(self) -> int:
        """Coefficients of all gaps."""
        return sum(series.size for series in self.opening)

    @cached_property
    def patches(self) -> Patches:
        """Contact between the gaps."""
        return self.gaps.patches()

    @property
    def mean_pressure(self) -> float:
        """Mean pressure p_0."""
        return self.body.lowest - self.deficit

    @property
    def load(self) -> float:
        """Load int sigma dx."""
        return TWO_PI * self.mean_pressure

    @property
    def load_rate(self) -> float:
        """Derivative of the load by Delta at fixed ends, and along K = 0."""
        return TWO_PI / self.separation_rate

    @property
    def penetration(self) -> float:
        """Penetration Delta."""
        return self.body.max_height - self.separation

    @property
    def released_energy(self) -> float:
        """Elastic energy of complete contact less that of the state."""
        return self.work / 2 + TWO_PI * self.mean_pressure * self.separation

    @property
    def elastic_energy(self) -> float:
        """Elastic energy U_el."""
        return self.body.complete.elastic_energy - self.released_energy

    @cached_property
    def end_values(self) -> FloatArray:
        """Values k of the ends, (2 G,)."""
        return self._at_ends([np.arange(1.0, g.size + 1) for g in self.opening])

    @property
    def stress_intensity(self) -> FloatArray:
        """Stress intensities K, (2 G,)."""
        return np.asarray(self.end_values * np.sqrt(np.pi / np.tile(self.gaps.half_width, 2)))

    @cached_property
    def end_slopes(self) -> FloatArray:
        """Inward derivative by t of sum g_n U_n at the ends, (2 G,)."""
        weights = [(n := np.arange(series.size)) * (n + 1) * (n + 2) / 3 for series in self.opening]
        return -self._at_ends(weights)

    def _at_ends(self, weights: list[FloatArray]) -> FloatArray:
        """Return sum (+-1)^n w_n g_n, (2 G,)."""
        terms = [w * g for w, g in zip(weights, self.opening, strict=True)]
        left = [float(np.sum((-1.0) ** np.arange(each.size) * each)) for each in terms]
        return np.array(left + [float(np.sum(each)) for each in terms])

    def added(self, gap: int, angle: FloatArray) -> FloatArray:
        """Return the pressure that the openings add in the contact behind a gap, (n,).

        The points lie (1 - cos(angle)) / 2 of the width of the contact behind the gap.
        """
        gaps, following = self.gaps, (gap + 1) % self.gaps.count
        behind, ahead = (gaps.patch_after[gap] * part(angle / 2) ** 2 for part in (np.sin, np.cos))
        x = gaps.center[gap] + gaps.half_width[gap] + behind
        beside, beyond = np.where(behind < ahead, gap, following), np.minimum(behind, ahead)
        total = np.zeros(x.size)
        for i, (series, a) in enumerate(zip(self.opening, gaps.half_width, strict=True)):
            away = (x - gaps.center[i] + np.pi) % TWO_PI - np.pi
            excess = np.where(beside == i, beyond, np.abs(away) - a) / a
            total += _line_pressure(series, excess, np.where(away < 0, -1.0, 1.0)) / a
            t, charge = _charges(series, a, series.size)
            total -= _periodic_rest(away[:, None] - t) @ charge / np.pi
        m = np.arange(1, self.body.stiffening.size + 1)
        if m.size:
            total += (np.exp(1j * np.multiply.outer(x, m)) @ self._stiffened).real
        return total

    @cached_property
    def _stiffened(self) -> ComplexArray:
        """Pressure that a layer adds to the modes m = 1.., (n,): its stiffness times (1/pi) int g exp(-i m x) dx."""
        m = np.arange(1, self.body.stiffening.size + 1)
        modes = np.zeros(m.size, dtype=np.complex128)
        for center, a, series in zip(self.gaps.center, self.gaps.half_width, self.opening, strict=True):
            t, charge = _charges(series, a, series.size + int(a * m[-1]) + 20)
            modes += np.exp(-1j * np.multiply.outer(m, center + t)) @ charge
        return np.asarray(self.body.stiffening * modes / np.pi)

    @cached_property
    def gap_before(self) -> IntArray:
        """Index of the gap before each patch, (G,)."""
        return np.argsort((self.gaps.center + self.gaps.half_width) % TWO_PI)

    def pressure(self) -> PatchPressure:
        """Return the pressure as Chebyshev series on the patches, to rounding of its largest coefficient."""
        return self._pressure

    @cached_property
    def _pressure(self) -> PatchPressure:
        charges = [self._charge_behind(int(gap)) for gap in self.gap_before]
        return PatchPressure(self.patches.left, self.patches.right, tuple(charges))

    def _charge_behind(self, gap: int) -> FloatArray:
        """Return the Chebyshev series of the pressure on the patch behind a gap."""
        r, start = self.gaps.patch_after[gap] / 2, self.gaps.center[gap] + self.gaps.half_width[gap]
        size = int(chebyshev.profile_nodes(np.array([2 * r]), self.body.pressure.max_order)[0])
        while True:
            angle = np.asarray((np.arange(size) + 0.5) * (np.pi / size), dtype=np.float64)
            x = start + r + r * np.cos(angle)
            values = self.mean_pressure + self.body.pressure.height(x) + self.added(gap, np.pi - angle)
            charge = chebyshev.coefficients(values * r * np.sin(angle))
            if np.max(np.abs(charge[-3:])) <= DECAYED * np.max(np.abs(charge)) or size > LONGEST_SERIES:
                return charge
            size *= 2


def evaluate_gaps(body: CompletedBody, gaps: Gaps, condition: LinearControl, finer: bool = False) -> GapEvaluation:
    """Solve for the opening of given gaps, and for the deficit that meets a condition.

    Parameters
    ----------
    body : CompletedBody
    gaps : Gaps
        In order, disjoint, at least one.
    condition : LinearControl
    finer : bool
        Whether there are a third more nodes, for error estimates.

    Raises
    ------
    IllConditionedSystemError
        More unknowns than fit, or a matrix that is not positive definite.
    """
    wanted = np.ceil(_sizes(body, gaps))
    if not np.sum(wanted) <= MOST_IN_GAPS:
        raise IllConditionedSystemError(f"{np.sum(wanted):.0f} unknowns needed in gaps, at most {MOST_IN_GAPS} fit")
    sizes = np.ceil(wanted * (4 / 3 if finer else 1)).astype(np.int64)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    owner = np.repeat(np.arange(gaps.count), sizes)
    a = gaps.half_width[owner]
    t = np.concatenate([np.cos(_angles(int(size))) for size in sizes])
    x = gaps.center[owner] + a * t
    relative = body.at_anchor(gaps.anchor) + body.lowest
    drive = np.ones((x.size, 2))
    for i, (first, last) in enumerate(pairwise(starts.tolist())):
        offset = gaps.shift[i] + gaps.half_width[i] * t[first:last]
        drive[first:last, 0] = -relative[i] - body.change_from_anchor(gaps.anchor[i], offset)
    drive *= a[:, None]
    factor, info = lapack.dpotrf(_stiffness(body, x, a, starts), lower=1, overwrite_a=1)
    if info != 0:
        raise IllConditionedSystemError("the stiffness matrix of the gaps is not positive definite")
    charge, _ = lapack.dpotrs(factor, drive, lower=1)
    deficit = condition.deficit(*(a @ charge / TWO_PI).tolist())
    charge[:, 0] += deficit * charge[:, 1]
    drive[:, 0] += deficit * drive[:, 1]
    opening = [_second_kind(last - first).T @ charge[first:last, 0] for first, last in pairwise(starts.tolist())]
    separation, separation_rate = (a @ charge / TWO_PI).tolist()
    return GapEvaluation(
        body=body,
        gaps=gaps,
        deficit=deficit,
        opening=tuple(series * (2 / np.pi) for series in opening),
        separation=separation,
        separation_rate=separation_rate,
        work=float(charge[:, 0] @ drive[:, 0]),
    )


def _sizes(body: CompletedBody, gaps: Gaps) -> FloatArray:
    """Return the number of nodes of each gap, (G,)."""
    width = 2 * gaps.half_width
    coupled = chebyshev.coupling_modes(width, np.minimum(gaps.patch_before, gaps.patch_after), COUPLING)
    order = max(body.pressure.max_order, body.stiffening.size)
    return np.asarray(np.maximum(coupled, chebyshev.profile_nodes(width, order)))


def _stiffness(body: CompletedBody, x: FloatArray, a: FloatArray, starts: IntArray) -> FloatArray:
    """Return the symmetric matrix from charges (weight times sum g_n U_n) to a Lambda g at the nodes, (n, n)."""
    matrix: FloatArray = np.subtract.outer(x, x)
    with np.errstate(divide="ignore"):
        matrix = -1 / (4 * np.pi * np.sin(matrix / 2) ** 2)
    m = np.arange(1, body.stiffening.size + 1)
    wave = np.exp(1j * np.multiply.outer(x, m))
    layer = ((wave * body.stiffening) @ wave.conj().T).real / np.pi if m.size else 0.0
    for first, last in pairwise(starts.tolist()):
        t = np.cos(_angles(last - first))
        matrix[first:last, first:last] = -_periodic_rest(a[first] * np.subtract.outer(t, t)) / np.pi
    matrix += layer
    matrix *= np.multiply.outer(a, a)
    for first, last in pairwise(starts.tolist()):
        table, order = _second_kind(last - first), np.arange(1.0, last - first + 1)
        matrix[first:last, first:last] += (table * (order * (2 / np.pi))) @ table.T
    return matrix


def _angles(size: int) -> FloatArray:
    """Return the angles of the nodes of Gauss's rule for the weight sqrt(1 - t^2), (n,)."""
    return np.asarray(np.arange(1, size + 1) * (np.pi / (size + 1)))


@lru_cache(maxsize=64)
def _second_kind(size: int) -> FloatArray:
    """Return U_n at the nodes, (n, n)."""
    angle = _angles(size)
    return np.asarray(np.sin(np.multiply.outer(angle, np.arange(1, size + 1))) / np.sin(angle)[:, None])


def _charges(series: FloatArray, a: float, size: int) -> tuple[FloatArray, FloatArray]:
    """Return distances from the center of a gap, and its volumes there by Gauss's rule, (n,) each."""
    angle = _angles(size)
    return a * np.cos(angle), a * np.pi / (size + 1) * np.sin(angle) * sines(series, angle)


def _line_pressure(series: FloatArray, excess: FloatArray, side: FloatArray) -> FloatArray:
    """Return a Lambda g outside a gap alone on a line, (n,).

    `excess` is the distance from its end over its half width; `side` is 1 or -1.
    """
    root = np.sqrt(excess * (2 + excess))
    terms = np.concatenate([[0.0], np.arange(1, series.size + 1) * series])
    return np.asarray(-side * np.polynomial.polynomial.polyval(side / (1 + excess + root), terms) / root)


def _periodic_rest(y: FloatArray) -> FloatArray:
    """Return 1 / (4 sin^2(y/2)) - 1/y^2, shape of y."""
    square = y * y
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = 1 / (4 * np.sin(y / 2) ** 2) - 1 / square
    return np.where(np.abs(y) < SERIES_REACH, np.polynomial.polynomial.polyval(square, _rest_terms()), rest)


@lru_cache(maxsize=1)
def _rest_terms() -> FloatArray:
    """Return the Taylor coefficients in y^2: 2 (2 j + 1) zeta(2 j + 2) / (2 pi)^(2 j + 2), (n,)."""
    from scipy.special import zeta  # loaded by the last gaps alone

    j = np.arange(SERIES_TERMS)
    return np.asarray(2 * (2 * j + 1) * zeta(2.0 * j + 2) / TWO_PI ** (2.0 * j + 2))
