"""Faults of paths and states: crests, leaps, vanishing patches, crossings, restarts, flags, certificates, scans.

Each leaves states that look converged.  Constants are faults of the functions that read them: they are put back after
every call.
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from bem.loading.path_events import Exact
from validation.studies.faults.fault_injection import Fault, Function, scaled


def _with_constant(module: str, name: str, excess: float) -> Any:
    """A fault by which a constant is larger by a factor of 1 + size times the excess during a call."""

    def wrong(original: Function, size: float) -> Function:
        space = import_module(module)

        def called(*given: Any, **named: Any) -> Any:
            right = getattr(space, name)
            setattr(space, name, right * (1 + size * excess))
            try:
                return original(*given, **named)
            finally:
                setattr(space, name, right)

        return called

    return wrong


def _scan_at_zero(original: Function, size: float) -> Function:
    """Samples are taken for those of a scan that begins nearer to zero."""

    def wrong(cls: Any, x: Any, *given: Any, **named: Any) -> Any:
        position = np.asarray(x, dtype=np.float64)
        return original(cls, position - size * position[0], *given, **named)

    return wrong


def _no_crests(original: Function, size: float) -> Function:
    """Edges run into crests that have touched long before."""
    return lambda ahead, seen, after: (None, original(ahead, seen, after)[1])


def _last_crossing(original: Function, size: float) -> Function:
    """A load that the end of a branch lowers is taken where it is met again, behind the jump."""

    def wrong(path: Any, before: Any, after: Any, load: float, refinements: int) -> Any:
        return None if after.last else original(path, before, after, load, refinements)

    return wrong


def _tension_left(original: Function, size: float) -> Function:
    """Tension of a percent of the pressure is rounding, and no gap opens."""

    def wrong(charge: Any, *given: Any) -> Any:
        at, value, bend = original(charge, *given)
        return at, value + size * 1e-2 * float(np.abs(charge).max()), bend

    return wrong


def _spring_without_half(original: Function, size: float) -> Function:
    """The energy of the spring of a total displacement 1e-5 too large; with more the path crawls, as energy misses."""

    def wrong(control: Any, penetration: float, load: float, energy: float) -> Any:
        return original(control, penetration, load, energy) + 1e-5 * size * control.load_weight * load**2 / 2

    return wrong


def _accepts(original: Function, size: float) -> Function:
    """Every certificate is ok."""
    return lambda *given, **named: replace(original(*given, **named), ok=True)


def _inverted(original: Function, size: float) -> Function:
    """Stable where it is not."""
    return lambda balance: not original(balance)


def _not_afresh(original: Function, size: float) -> Function:
    """A path goes on from a target with what it knows from before, which no stored state holds."""

    def wrong(run: Any, state: Any, goal: float | None = None) -> Any:
        here: Any = getattr(run, "point", None)
        return here if goal is not None and here.state is not None else original(run, state, goal)

    return wrong


def _not_turned(original: Function, size: float) -> Function:
    """A pressure that was met while the load grew is not met again while it falls."""

    def wrong(run: Any, branch: str) -> None:
        met = set(run.met)
        original(run, branch)
        run.met |= met

    return wrong


def _located_late(original: Function, size: float) -> Function:
    """The end of a branch is taken for a ten-thousandth of the rms height, or of the pressure unit, farther on."""

    def wrong(system: Any, *given: Any) -> Any:
        found = original(system, *given)
        if found is None:
            return None
        late, stiffness = size * 1e-4, found.balance.stiffness
        deeper = late / (system.control.penetration_weight + system.control.load_weight * stiffness)
        at = found.exact
        moved = (at.value + late, at.penetration + deeper, at.load + deeper * stiffness)
        return replace(found, exact=Exact(*moved, at.potential + late * system.control.force(found.balance.state)))

    return wrong


def _wrong_way(original: Function, size: float) -> Function:
    """Contact leaves the end of its branch against the forces."""

    def wrong(*given: Any) -> Any:
        outward, leads_on, evaluations = original(*given)
        return -outward, leads_on, evaluations

    return wrong


def _coarse_behind(original: Function, size: float) -> Function:
    """The energy behind a jump is that of the coarse evaluation."""

    def wrong(system: Any, here: Any, value: float, *given: Any) -> Any:
        found = original(system, here, value, *given)
        coarse = Exact(value, here.state.penetration, here.state.load, here.potential)
        return None if found is None else (found[0], coarse, found[2])

    return wrong


def _no_error(original: Function, size: float) -> Function:
    """What the last refinement changed is taken for a ten-thousandth of it."""

    def wrong(at: Any, *given: Any) -> Any:
        error = original(at, *given)
        return Exact(*((1 - size * (1 - 1e-4)) * value for value in vars(error).values()))

    return wrong


PATH_FAULTS: tuple[Fault, ...] = (
    Fault(
        "bem-fold-late",
        "folds and bifurcations are located late",
        "bem.continuation.limit_points:locate_limit_point",
        _located_late,
        "a ten-thousandth of the rms height or the pressure unit",
    ),
    Fault(
        "bem-touch-late",
        "touches are located late",
        "bem.continuation.touch_points:locate_touch",
        _located_late,
        "a ten-thousandth of the rms height or the pressure unit",
    ),
    Fault(
        "bem-departs-backwards",
        "contact leaves a limit point backwards",
        "bem.continuation.departure:departure",
        _wrong_way,
    ),
    Fault(
        "bem-released-coarse",
        "the energy behind a jump is not that of its equilibrium",
        "bem.continuation.limit_points:at_rest",
        _coarse_behind,
    ),
    Fault(
        "bem-event-error",
        "errors of events are estimated too small",
        "bem.loading.path_events:Exact.apart",
        _no_error,
        "a ten-thousandth of them",
    ),
    Fault(
        "bem-scan-at-zero",
        "a scan that does not begin at zero is shifted",
        "bem.geometry.profile:Profile.from_samples",
        _scan_at_zero,
        "by where it begins",
    ),
    Fault(
        "bem-no-crests-ahead",
        "crests ahead of an edge are not looked at",
        "bem.adhesive.touching:CrestsAhead.__call__",
        _no_crests,
    ),
    Fault(
        "bem-edges-leap",
        "edges leap over barriers",
        "bem.adhesive.descent:_room",
        _with_constant("bem.adhesive.descent", "LARGEST_ROOM", 99.0),
        "by a hundred times what they may",
    ),
    Fault(
        "bem-patches-vanish",
        "patches vanish that could still stand",
        "bem.adhesive.descent:_vanishing",
        _with_constant("bem.adhesive.descent", "VANISHED_WIDTH", 49.0),
        "at the width of a lone contact at pull-off",
    ),
    Fault(
        "bem-last-crossing",
        "of several states at one load the last is taken",
        "bem.continuation.crossing:_first",
        _last_crossing,
    ),
    Fault(
        "bem-tension-left",
        "tension without adhesion is left in contact",
        "bem.nonadhesive.tension:minimum",
        _tension_left,
        "a percent of the pressure",
    ),
    Fault(
        "bem-spring-energy",
        "wrong energy of a total displacement",
        "bem.loading.control:DisplacementControl.potential",
        _spring_without_half,
        "a hundred-thousandth of that of the spring",
    ),
    Fault("bem-certificate-accepts", "every certificate is ok", "bem.audit.certificate:certify", _accepts),
    Fault(
        "bem-stable-inverted",
        "stable at fixed load where it is not",
        "bem.adhesive.equilibrium:Balance.stable_at_fixed_load",
        _inverted,
    ),
    Fault(
        "bem-not-afresh",
        "a stored state does not hold all that its path depends on",
        "bem.solver:_Run._point_of",
        _not_afresh,
    ),
    Fault(
        "bem-work-gradient-dropped",
        "the work of adhesion does not grow along a slope as an edge moves",
        "bem.adhesive.adhesion:SlopeLaw.work_gradient",
        scaled(-1.0),
        "gradient absent",
    ),
    Fault(
        "bem-met-once",
        "a mean pressure asked for is met on the way there only",
        "bem.solver:_Run._take_branch",
        _not_turned,
    ),
)
