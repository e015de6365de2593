"""Complete contact as an end of the adhesive path: its opening, and its energy.

Under the JKR model a gap of zero width needs infinite tension, so that complete contact opens only

- at a flaw: a gap of given width near the lowest pressure of complete contact, where both its edges open at one load
  (beside it one edge would open while the other heals).  Its K is a linear function of the load; it opens when K
  reaches the critical one, K = 2 sqrt(w).  The flaw itself carries no adhesion: the energy released is counted
  from the flawed state, which lies above complete contact by w g / 2 for a narrow flaw of width g.  The control does
  no work for that energy: a path through an opening gains it;
- or because the separation is prescribed: s > 0 is the mean gap, so that a gap exists.  The gap begins at the
  lowest pressure with zero width, and the branch is continuous there (Johnson, Int. J. Solids Struct. 32 (1995) 423).

A narrow gap of width g under the tension T opens by int gap dx = pi g^2 T / 8 and has K = T sqrt(pi g / 2), from
which the width at a given separation follows.

Patches all round the period but for a gap below 1e-4 of it take seconds and more (the ends of one patch that nearly
meet), so that the opening load of a narrower flaw is computed for a row of cracks, one per period, under the tension
T(x) that complete contact has there,

    K = sqrt(2 pi tan(g/4)) mean of T (1 -+ t) over Chebyshev nodes t = sin(x/2) / sin(g/4),

(H. Tada, P. C. Paris, G. R. Irwin, The Stress Analysis of Cracks Handbook, 2000, part II, uniform T; the weight of an
isolated crack for the varying part of T, off by (g/8)^2 of that part).  A layer changes K by a share that grows with
g^2, measured at a resolved gap.  Measured against evaluations of the gap itself down to 1e-5 of the period, half-space
and layers of 0.1 to 0.3 periods, 1 to 100 harmonics: 3e-9 of the load, the error of the evaluations.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

import numpy as np

from bem.adhesive.equilibrium import System, balance
from bem.elastic.collocation import Evaluation, evaluate
from bem.elastic.gap import gap_field, low_minima
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import TWO_PI, Patches, ordered
from bem.loading.complete_contact import CompleteContact
from bem.loading.control import LoadControl
from bem.path.locating import LAST, LOCATED

RESOLVED_GAP = 1e-4 * TWO_PI  # speed: evaluated as it is in a tenth of a second
FINEST_GAP = (
    RESOLVED_GAP / 10
)  # speed: evaluated as it is in seconds; narrower gaps feel a layer only by the square of their width


def with_gap(position: float, width: float) -> Patches:
    """Return one patch all round the period but for a gap.

    Examples
    --------
    >>> with_gap(1.0, 0.5).gap_after.round(12).tolist()
    [0.5]
    """
    return ordered(np.array([position + width / 2]), np.array([position - width / 2 + TWO_PI]))


def lowest_pressure(complete: CompleteContact) -> float:
    """Return the position where complete contact has its lowest pressure."""
    positions, pressures = complete.pressure.valleys
    return float(positions[int(np.argmin(pressures))])


@dataclass(frozen=True)
class Flaw:
    """Gap without adhesion in complete contact: its middle, and its width in radians."""

    center: float
    width: float


def flaw_of(system: System, complete: CompleteContact, width: float, tolerance: float) -> Flaw | None:
    """Return the flaw of a width, where it opens at both edges at once; None where the pressure shuts a part of it.

    Beside its place one edge would open while the other heals.  If work of adhesion that varies leaves no such place
    near the lowest pressure (narrow flaws, which open more easily the wider they are), the flaw is at the lowest
    pressure.  A flaw is shut at an edge, where K < 0, or on a crest in between.
    """
    lowest = lowest_pressure(complete)
    if width < FINEST_GAP / 10:
        return Flaw(lowest, width)

    def uneven(center: float) -> float:
        behind, before = _critical_loads(system, complete, Flaw(center, width), tolerance)
        return float(behind - before)

    ends, flaw = (lowest - width / 2, lowest + width / 2), Flaw(lowest, width)
    if uneven(ends[0]) * uneven(ends[1]) < 0:
        flaw = Flaw(float(import_module("scipy.optimize").brentq(uneven, *ends, xtol=LAST * width)), width)
    if width >= RESOLVED_GAP:
        load = opening_load(system, complete, flaw, tolerance)
        state = LoadControl().reach(_gap_at(system, flaw, tolerance), load)
        shut = low_minima(gap_field(system.elastic, state)).depth < -LOCATED
        if np.any(shut) or np.any(state.stress_intensity < 0):
            return None
    return flaw


def opening_load(system: System, complete: CompleteContact, flaw: Flaw, tolerance: float) -> float:
    """Return the load per period at which a flaw opens: above it K is below critical at both its edges."""
    return float(np.max(_critical_loads(system, complete, flaw, tolerance)))


def _critical_loads(system: System, complete: CompleteContact, flaw: Flaw, tolerance: float) -> FloatArray:
    """Return the loads per period at which K is critical at the edges behind and before a flaw, (2,)."""
    critical = _critical(system, flaw)
    if flaw.width >= RESOLVED_GAP:
        state = _gap_at(system, flaw, tolerance)
        slope = state.stress_intensity_rate / state.load_rate
        return np.asarray(state.load + (critical - state.stress_intensity) / slope)
    at_zero_load, slope = _crack(complete, flaw)
    stiffened = _layer_share(system, complete, flaw, tolerance)
    return np.asarray((critical / stiffened - at_zero_load) / slope)


def opening_rounding(system: System, flaw: Flaw, tolerance: float) -> float:
    """Return the rounding error of the load at which a flaw opens; 0 where the load is a closed form."""
    if flaw.width < RESOLVED_GAP:
        return 0.0
    state = _gap_at(system, flaw, tolerance)
    slope = state.stress_intensity_rate / state.load_rate
    return float(np.max(state.rounding(0.0) / np.abs(slope)))


def opened_gap(system: System, complete: CompleteContact, flaw: Flaw, load: float) -> Patches:
    """Return a gap a little wider than a flaw, or as wide as is resolved if K stays above critical.

    K is taken at `load`.  At the load at which a flaw opens, K grows with the width of the flaw as long as the
    tension is equal to the tension at its middle.
    """
    wider = Flaw(flaw.center, max(RESOLVED_GAP, 1.02 * flaw.width))
    while wider.width > 1.02 * flaw.width:
        at_zero_load, slope = _crack(complete, wider)
        if np.all(at_zero_load + slope * load > _critical(system, wider)):
            break
        wider = Flaw(flaw.center, max(wider.width / 2, 1.02 * flaw.width))
    return with_gap(wider.center, wider.width)


def flawed_potential(system: System, complete: CompleteContact, flaw: Flaw, value: float, tolerance: float) -> float:
    """Return the potential under control of complete contact with a flaw at the load at which it opens."""
    gap, highest = with_gap(flaw.center, flaw.width), system.elastic.profile.max_height
    if flaw.width >= RESOLVED_GAP:
        return balance(system, gap, highest, value, tolerance).potential
    work = system.law.energy(gap) - complete.adhesion_energy
    return complete_potential(system, complete, value) + work / 2


def _crack(complete: CompleteContact, flaw: Flaw) -> tuple[FloatArray, FloatArray]:
    """Return K at the edges behind and before a gap in complete contact of a half-space, (2,), and its rate, (2,).

    K is given at zero load, its rate by the load.
    """
    count = 16 + 2 * int(complete.pressure.max_order * flaw.width)
    t = np.cos((np.arange(count) + 0.5) * (np.pi / count))
    tension = -complete.pressure.height(flaw.center + 2 * np.arcsin(np.sin(flaw.width / 4) * t))
    factor = float(np.sqrt(2 * np.pi * np.tan(flaw.width / 4)))
    return factor * np.array([np.mean(tension * (1 + t)), np.mean(tension * (1 - t))]), np.full(2, -factor / TWO_PI)


def _layer_share(system: System, complete: CompleteContact, flaw: Flaw, tolerance: float) -> float:
    """Return K of a flaw on a layer over K on a half-space, from a wider gap that is resolved."""
    if system.elastic.kernel is None:
        return 1.0
    wider = Flaw(flaw.center, max(FINEST_GAP, flaw.width))
    state = _gap_at(system, wider, tolerance)
    share = float(np.mean(state.stress_intensity_rate / state.load_rate / _crack(complete, wider)[1]))
    return 1 + (share - 1) * (flaw.width / wider.width) ** 2


def _gap_at(system: System, flaw: Flaw, tolerance: float) -> Evaluation:
    """Evaluate complete contact with a gap in place of a flaw."""
    patches = with_gap(flaw.center, flaw.width)
    return evaluate(system.elastic, patches, system.elastic.profile.max_height, tolerance)


def _critical(system: System, flaw: Flaw) -> FloatArray:
    """Return the critical K at the edges behind and before a flaw, in the order of patches with the flaw, (2,)."""
    patches = with_gap(flaw.center, flaw.width)
    return np.asarray(2 * np.sqrt(system.law.work_of_adhesion(np.concatenate([patches.left, patches.right]))))


def first_gap(system: System, complete: CompleteContact, separation: float) -> tuple[float, Patches]:
    """Return the start of a path from complete contact: a separation, at most that given, and its narrow gap."""
    position = lowest_pressure(complete)
    critical = 2 * float(np.sqrt(system.law.work_of_adhesion(np.array([position]))[0]))
    per_width = critical * np.sqrt(np.pi / 32) / TWO_PI  # to the power of 3/2
    width, widest = (separation / per_width) ** (2 / 3), np.pi / system.elastic.profile.max_order
    if width > widest:
        width, separation = widest, per_width * widest**1.5
    return separation, with_gap(position, width)


def complete_potential(system: System, complete: CompleteContact, value: float) -> float:
    """Return the potential under control of complete contact."""
    energy = complete.elastic_energy + complete.adhesion_energy
    highest = system.elastic.profile.max_height
    return system.control.potential(highest, system.control.load(highest, value), energy)
