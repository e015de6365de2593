"""Is a state correct?  A posteriori checks of one state, by another quadrature than the one that produced it.

Given are the edges, the Chebyshev series of the pressure and the penetration; the displacement is recomputed by
displacement.py, with nothing taken from the collocation, the gap search or the equilibrium.

The checks (bem/README.md, section 7; physics: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65):
closure G/w = 1 at every edge (without adhesion K = 0 and no tension), u = h - h_max + Delta on every patch up to its
edges, no interpenetration in any gap, decay of the series, mean gap = separation, and what the solver hands in:
stability and symmetry of the Hessian.  K is the series' at the edge, and what the misfit of u says that it lacks.

Dimensionless (scaling.py).  Limits: double precision; a patch on which the profile varies by less than
`SMALLEST_VARIATION`, or which carries less than `SMALLEST_CHARGE`, is judged against that instead.
Cost: 0.02 s for 112 patches with 2900 coefficients on a profile of 1000 harmonics.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from functools import partial
from typing import Any

import numpy as np

from bem.audit.displacement import ComplianceRatio, DisplacementField, regular_part
from bem.audit.gap_depths import gap_depths
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.minima import OFFSETS, refined
from bem.geometry.patches import CHARGE_ROUNDING, POSITION_ROUNDING, PatchPressure
from bem.geometry.profile import Profile

DISPLACEMENT_ROUNDING = 5e-14  # of u, rms heights or over the load, a sum of all patches; measured 2.6e-14
SMALLEST_VARIATION = 2 * DISPLACEMENT_ROUNDING / 1e-8  # rms heights, of which rounding is half of what is demanded
SMALLEST_CHARGE = 3 * CHARGE_ROUNDING / 1e-8  # per coefficient of a patch, of which rounding is a third of that
RESOLVED = 1e-12  # derived: rms heights; last Chebyshev coefficients of the displacement in a gap, charges of order 1
MISFIT_ROUNDING = 10 * DISPLACEMENT_ROUNDING  # of a contact residual, times the largest charge where that exceeds 1
AT_EDGE = "at an edge of patch"


@dataclass(frozen=True)
class Certificate:
    """A-posteriori checks of a state; `min_gap` and `mean_gap_error` in m, the rest dimensionless.

    Each figure is explained in `Demands`.  None: it has no meaning for the state.

    Attributes
    ----------
    closure : float
        The largest |G/w - 1|, without adhesion |K| over that of a flat punch, with K recomputed by the audit.
    min_gap : float
        Smallest at the points tried, which come close to the edges but exclude them (there it vanishes).
    min_eigenvalue, hessian_asymmetry : float or None
        Handed in by the solver; None without adhesion.
    truncation : float
        The last coefficients of a patch over its largest.
    contact_residual, mean_gap_error : float or None
        How far contact is from the profile, and the mean gap from the separation.
    ok : bool
        No reason against the state was found.
    reasons : tuple of str
        Each demand that is not met, with figure, limit and place.
    """

    closure: float | None = None
    min_gap: float | None = None
    min_eigenvalue: float | None = None
    truncation: float | None = None
    hessian_asymmetry: float | None = None
    ok: bool = True
    reasons: tuple[str, ...] = ()
    contact_residual: float | None = None
    mean_gap_error: float | None = None


@dataclass(frozen=True, kw_only=True)
class DimensionlessCertificate(Certificate):
    """The certificate of a dimensionless state: lengths in rms heights; `largest_gap` is that at the points tried."""

    min_gap: float
    mean_gap_error: float
    largest_gap: float

    def of_height(self, height: float) -> Certificate:
        """As a result keeps it, by the rms height in m."""
        lengths = {"min_gap": self.min_gap * height, "mean_gap_error": self.mean_gap_error * height}
        return Certificate(**{part.name: getattr(self, part.name) for part in fields(Certificate)} | lengths)


@dataclass(eq=False)
class Verdict:
    """Figures against their limits; the reasons against a state of some patches, figure by figure."""

    patches: int
    reasons: list[str] = field(default_factory=list)

    def judge(self, name: str, values: FloatArray | float, limit: FloatArray | float, place: str) -> float:
        """Return the figure farthest beyond its limit; note a reason where it exceeds the limit."""
        array = np.atleast_1d(values)
        limits = np.broadcast_to(limit, array.shape)
        worst = int(np.argmax(np.where(np.isnan(array), np.inf, array / limits)))
        if not array[worst] <= limits[worst]:  # also when it is not a number
            at = f" {place} {worst % self.patches}" if place else ""
            self.reasons.append(f"{name} {array[worst]:.2e} exceeds {limits[worst]:.0e}{at}")
        return float(array[worst])

    def certificate(self, **figures: Any) -> DimensionlessCertificate:
        """Return the certificate with these figures, ok if no reason was noted."""
        return DimensionlessCertificate(**figures, ok=not self.reasons, reasons=tuple(self.reasons))


@dataclass(frozen=True)
class Demands:
    """Limits that a state must meet to be ok.

    Derived from the default tolerance of a state, 1e-6: figures of the solved system have two digits to spare, and K by
    the displacement has none (of 200 random scenes 0.007 of its limit at most).
    """

    # max|G/w - 1| with K from the series handed in, or without adhesion max|K| over that of a flat punch with the load
    # of the patch: what the solver had to solve
    closure: float = 1e-8
    # the same with K as the displacement of the audit has it, or an error of K over that of the flat punch where that
    # is more: the error of its evaluation; certified_states.py asks for accuracy.tolerance
    intensity: float = 1e-6
    # largest depth, in rms heights; certified_states.py allows a thousandth of accuracy.tolerance where that is more
    interpenetration: float = 1e-10
    contact_residual: float = 1e-8  # max|u - (h - h_max + Delta)| on a patch, over the variation of h on that patch
    truncation: float = 1e-8  # last three coefficients of a patch over its largest
    hessian_asymmetry: float = 1e-8  # max|H - H^T| over max|H|
    # |mean gap - separation| in rms heights; what rounding leaves of displacements is allowed where that is more
    mean_gap_error: float = 1e-10
    # accuracy of K in double precision, (2 L,): an edge is not asked for more than three times that
    intensity_rounding: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class AdhesiveEdges:
    """Work of adhesion and stability of a state with adhesion, as the solver found them."""

    work: FloatArray  # w at all left edges, then all right ones, (2 L,)
    # of the Hessian of the potential under control, scaled; a state without it is not ok
    min_eigenvalue: float | None = None
    # of the Hessian of the energy at fixed penetration; a state without it is not ok
    hessian_asymmetry: float | None = None

    def objections(self, asymmetry: float) -> Iterator[str]:
        """Reasons against the stability of the state, and the symmetry of its Hessian."""
        if self.min_eigenvalue is None or not self.min_eigenvalue > 0:
            yield f"smallest eigenvalue of the Hessian is {self.min_eigenvalue}, must be > 0"
        if self.hessian_asymmetry is None or not self.hessian_asymmetry <= asymmetry:
            yield f"asymmetry of the Hessian is {self.hessian_asymmetry}, limit {asymmetry:.0e}"


def certify(
    profile: Profile,
    pressure: PatchPressure,
    penetration: float,
    adhesion: AdhesiveEdges | None,
    *,
    compliance_ratio: ComplianceRatio | None = None,
    demands: Demands | None = None,
) -> DimensionlessCertificate:
    """Check a dimensionless state with at least one patch and one gap, by its edges and its series of the pressure.

    The ratio is that of the compliance of a layer to that of the half-space for orders m >= 1, (n,) to (n,), tending
    to 1.  ValueError where there is no patch, or patches overlap.

    Examples
    --------
    Half a period of a sinusoid in contact (Westergaard), and the same pressure with a wrong penetration:

    >>> from scipy.fft import dct
    >>> from bem.geometry.profile import Profile
    >>> wave = Profile.from_harmonics(2 * np.pi, [1], [1.0])
    >>> t = np.cos((np.arange(40) + 0.5) * np.pi / 40)
    >>> x = np.pi / 2 * t
    >>> q = np.pi * np.cos(x / 2) * np.sqrt((0.5 - np.sin(x / 2) ** 2) * (1 - t * t))
    >>> series = dct(q, type=2) / 40 / np.where(np.arange(40) == 0, 2, 1)
    >>> pressure = PatchPressure(np.array([-np.pi / 2]), np.array([np.pi / 2]), (series,))
    >>> certify(wave, pressure, 0.5 * (1 + np.log(2)), None).ok
    True
    >>> certify(wave, pressure, 0.85, None).reasons[0]
    'contact residual 3.43e-03 exceeds 1e-08 on patch 0'
    """
    demands = Demands() if demands is None else demands
    left, right = pressure.left, pressure.right
    behind = np.append(left[1:], left[:1] + 2 * np.pi) - right
    if left.size == 0 or not (np.all(right > left) and np.all(behind > 0)):
        raise ValueError("pressure: at least one patch, positive widths and gaps, in order on the circle")
    displacement, verdict = DisplacementField(pressure, compliance_ratio), Verdict(left.size)
    eigenvalue, asymmetry = None, None
    misfit, work = _Misfit.of(profile, displacement, penetration), None if adhesion is None else adhesion.work
    series, own, punch = _closures(pressure, misfit.lacking(displacement), work)
    reached = _attainable(pressure, demands.intensity_rounding, work)
    solved, evaluated = np.maximum(reached, demands.closure), np.maximum(reached, demands.intensity)
    least = np.maximum(demands.intensity, np.tile(misfit.rounded * misfit.nodes / _least_charges(pressure), 2))
    verdict.judge("closure of the series", series, solved, AT_EDGE)
    closure = verdict.judge("closure", own, np.maximum(evaluated, least * punch), AT_EDGE)
    if adhesion is None:
        verdict.judge("tension without adhesion", _tension(pressure), solved.reshape(2, -1).max(axis=0), "on patch")
    else:
        verdict.reasons.extend(adhesion.objections(demands.hessian_asymmetry))
        eigenvalue, asymmetry = adhesion.min_eigenvalue, adhesion.hessian_asymmetry
    truncation = verdict.judge("truncation", _truncation(pressure), demands.truncation, "on patch")
    magnitude = max(1.0, float(np.max(np.abs(np.concatenate(pressure.charges)))))
    allowed = np.maximum(max(demands.contact_residual, MISFIT_ROUNDING * magnitude), misfit.rounded / misfit.variation)
    residual = verdict.judge("contact residual", misfit.largest / misfit.variation, allowed, "on patch")
    gaps = gap_depths(profile, displacement, penetration, behind, RESOLVED * magnitude)
    depth, highest, gap_integrals, unresolved = gaps
    min_gap = -verdict.judge("interpenetration", depth, demands.interpenetration, "in the gap behind patch")
    verdict.reasons.extend(f"displacement not resolved in the gap behind patch {i}" for i in unresolved)
    error = abs(float(np.sum(gap_integrals)) / (2 * np.pi) - (profile.max_height - penetration))
    summed = max(demands.mean_gap_error, DISPLACEMENT_ROUNDING * abs(pressure.load))
    mean_gap_error = verdict.judge("mean gap less separation", error, summed, "")
    return verdict.certificate(
        closure=closure,
        min_gap=min_gap,
        min_eigenvalue=eigenvalue,
        truncation=truncation,
        hessian_asymmetry=asymmetry,
        contact_residual=residual,
        mean_gap_error=mean_gap_error,
        largest_gap=float(np.max(highest)),
    )


@dataclass(frozen=True, eq=False)
class _Misfit:
    """Displacement less h - h_max + Delta, at the extrema between the nodes and at the edges of patches.

    Patch after patch, `first` being where each begins, (L,).
    """

    excess: FloatArray
    first: IntArray
    nodes: IntArray  # of each patch, (L,)
    largest: FloatArray  # of each patch, (L,)
    variation: FloatArray  # of h on each patch, (L,)
    rounded: FloatArray  # what rounding leaves: of positions where the patch is steep, of all that is summed, (L,)

    @classmethod
    def of(cls, profile: Profile, field: DisplacementField, penetration: float) -> _Misfit:
        """Measure how far a displacement penetrates the profile."""
        sizes = np.array([charge.size for charge in field.pressure.charges])
        owner = np.repeat(np.arange(field.count), sizes + 1)
        first = np.cumsum(sizes + 1) - (sizes + 1)
        angle = (np.arange(owner.size) - first[owner]) * (np.pi / sizes)[owner]
        x = field.center[owner] + field.radius[owner] * np.cos(angle)
        height, slope, _ = profile.height_slope_curvature(x)
        excess = field.in_contact(x, owner) - (height - profile.max_height + penetration)
        variation = np.maximum.reduceat(height, first) - np.minimum.reduceat(height, first)
        rounded = POSITION_ROUNDING * np.maximum.reduceat(np.abs(slope), first)
        rounded += DISPLACEMENT_ROUNDING * abs(field.pressure.load)
        largest = np.maximum.reduceat(np.abs(excess), first)
        return cls(excess, first, sizes, largest, np.maximum(variation, SMALLEST_VARIATION), rounded)

    def lacking(self, field: DisplacementField) -> FloatArray:
        """Return the change of q at the edges, (2 L,), with which the displacement would meet the contact.

        By the logarithm of the patch itself: q = k cos(k theta) moves it by cos(k theta).  What other patches and a
        layer add is smooth, and leaves out some percent of this small change; a mean excess is an error of Delta, which
        the mean gap shows.
        """
        lacking = np.empty((2, field.count))
        for who, rows in _by_size(field.pressure.charges):
            n = rows.shape[1]
            excess = self.excess[self.first[who, None] + np.arange(n + 1)]
            per_unit = np.append(np.arange(n), n / 2)  # the ends of a cosine series count half
            lacked = -per_unit * np.fft.rfft(np.concatenate([excess, excess[:, -2:0:-1]], axis=1)).real / n
            even, odd = lacked[:, ::2].sum(axis=1), lacked[:, 1::2].sum(axis=1)
            lacking[:, who] = even - odd, even + odd
        return lacking.ravel()


def _closures(
    pressure: PatchPressure, lacking: FloatArray, work: FloatArray | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """|G/w - 1| by the series handed in, and with what they lack; K of a flat punch of equal load over 2 sqrt(w).

    All (2 L,).  Without adhesion |K| over that of the punch, and 1.  The series are summed without rounding.
    """
    even, odd = np.array([(math.fsum(q[0::2].tolist()), math.fsum(q[1::2].tolist())) for q in pressure.charges]).T
    handed = np.concatenate([even - odd, even + odd])  # q, which is -K sqrt(r/pi)
    loads = np.tile(_least_charges(pressure), 2)
    if work is None:
        return np.abs(handed) / loads, np.abs(handed + lacking) / loads, np.ones(handed.size)
    critical = 2 * np.sqrt(work * np.tile((pressure.right - pressure.left) / 2, 2) / np.pi)
    series, own = (np.abs(-q * np.abs(q) / critical**2 - 1) for q in (handed, handed + lacking))
    return series, own, loads / critical


def _attainable(pressure: PatchPressure, rounding: FloatArray | None, work: FloatArray | None) -> FloatArray:
    """Return the closure that three roundings of K allow, with adhesion or (work None) without, (2 L,)."""
    if rounding is None:
        return np.zeros(2 * pressure.left.size)
    if work is not None:
        return np.asarray(3 * rounding / np.sqrt(work))
    regular = rounding * np.tile(np.sqrt((pressure.right - pressure.left) / (2 * np.pi)), 2)
    return np.asarray(3 * regular / np.tile(_least_charges(pressure), 2))


def _least_charges(pressure: PatchPressure) -> FloatArray:
    """|Q_0| of the patches, or what is the least that is told from rounding, (L,)."""
    return np.array([max(abs(q[0]), SMALLEST_CHARGE * q.size) for q in pressure.charges])


def _tension(pressure: PatchPressure) -> FloatArray:
    """Largest tension of each patch (its regular part q) over the mean of q, (L,).

    Half a wave of the last coefficient takes two points; where q may be tensile between them its minimum is refined.
    """
    tension = np.empty(pressure.left.size)
    for who, rows in _by_size(pressure.charges):
        points = 2 * rows.shape[1]
        q = regular_part(rows, points)
        lowest = np.min(q, axis=1)
        before, middle, after = q[:, :-2], q[:, 1:-1], q[:, 2:]
        sag = before + after - 2 * middle  # more than what a minimum between the points may lie lower
        row, k = np.nonzero((middle <= before) & (middle < after) & (middle < sag))
        dips = refined(partial(_cosines, rows[row]), (k + 1 + OFFSETS) * (np.pi / points))
        np.minimum.at(lowest, row, dips.value)
        tension[who] = -lowest / np.maximum(np.abs(rows[:, 0]), SMALLEST_CHARGE * rows.shape[1])
    return tension


def _cosines(series: FloatArray, angle: FloatArray) -> FloatArray:
    """Return sum Q_k cos(k theta) of n series, (n, terms), each at its column of angles, (3, n)."""
    return np.asarray(np.einsum("ijk,jk->ij", np.cos(np.multiply.outer(angle, np.arange(series.shape[1]))), series))


def _truncation(pressure: PatchPressure) -> FloatArray:
    """Largest of the last three coefficients of each patch over its largest, (L,)."""
    share = np.empty(pressure.left.size)
    for who, rows in _by_size(pressure.charges):
        size = np.abs(rows)
        share[who] = size[:, -3:].max(axis=1) / np.maximum(size.max(axis=1), SMALLEST_CHARGE * rows.shape[1])
    return share


def _by_size(charges: tuple[FloatArray, ...]) -> list[tuple[IntArray, FloatArray]]:
    """Patches with series of equal length, and these series by rows."""
    sizes = np.array([charge.size for charge in charges])
    members = [np.flatnonzero(sizes == size) for size in np.unique(sizes)]
    return [(who, np.stack([charges[i] for i in who])) for who in members]
