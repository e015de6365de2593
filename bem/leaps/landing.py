"""Where the leap of one window ends, in the far field of all others.  Dimensionless."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bem.adhesive.branch import tangent
from bem.adhesive.equilibrium import System
from bem.continuation.locating import Start
from bem.elastic.far_field import FarField
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.leaps.brackets import brackets
from bem.leaps.leap import leap, quiet_leap
from bem.loading.increments import Accuracy
from bem.loading.path_events import PathEvent


@dataclass(frozen=True)
class Goal:
    """Where a leap leads from a value of the control, how accurately, and the width of the bracket of its events.

    It may be asked that nothing happens in it.
    """

    start: float
    value: float
    accuracy: Accuracy
    width: float
    quiet: bool


@dataclass(frozen=True, eq=False)
class Departure:
    """A window before a leap: its field, its patches, the rate of their edges, if known, and their predicted motion.

    Rate and motion are outward, (2 n,) arrays.
    """

    far: FarField
    patches: Patches
    rate: FloatArray
    motion: FloatArray
    goal: Goal


@dataclass(frozen=True, eq=False)
class Landing:
    """Where a window ended: its patches and the motion of their edges by the control, (2 n,) arrays, and events."""

    patches: Patches
    rate: FloatArray
    bend: FloatArray
    events: tuple[PathEvent, ...]


def inside(system: System, far: FarField) -> System:
    """The system of a window, with an account of its own."""
    return System(replace(system.elastic, far=far), system.law, system.control)


def landed(system: System, departure: Departure) -> tuple[Landing | None, int]:
    """Where the leap of a window ends, None where that was not found, and how many evaluations it took."""
    own = inside(system, departure.far)
    landing = _landing(own, departure)
    return landing, own.effort.evaluations + own.effort.local_evaluations


def _landing(system: System, departure: Departure) -> Landing | None:
    goal, change = departure.goal, departure.goal.value - departure.goal.start
    start = Start(departure.patches, goal.start, goal.start)
    how = quiet_leap if goal.quiet else leap
    found = if_solvable(how, system, start, departure.motion, goal.value, goal.accuracy)
    if found is None or found.relaxed.balance is None or found.relaxed.status != "converged":
        return None
    there = found.relaxed.balance
    rate = tangent(system, there)
    smooth = change != 0 and found.before is None and np.any(departure.rate)
    bend = (rate - departure.rate) / change if smooth else np.zeros(rate.size)
    return Landing(there.state.patches, rate, bend, brackets(system, found, goal.start, goal.width))
