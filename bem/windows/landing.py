"""Path of one window to another penetration, in the far field of all others, by the engine of the whole contact.

The window begins at edges that were joined with the edges of its neighbours, and comes to rest first.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bem.adhesive.branch import numbers_of, tangent
from bem.adhesive.equilibrium import Balance, System, balance
from bem.elastic.far_field import FarField
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.path_events import NO_ERROR, EventNumbers, PathEvent, PathTension, path_events
from bem.path.locating import Start
from bem.path.path import Path
from bem.path.points_with_edges import Equilibrium
from bem.path.rest import at_rest
from bem.path.tension import LeastLoad

WINDOW_STEP = 0.05  # rms heights: windows are joined after each
# A window's load is no load of the contact: its turns are not located, because none is less than this load.
NO_TURN_COUNTS = PathTension("turn", EventNumbers(np.nan, np.nan, -np.inf, np.nan), NO_ERROR)


@dataclass(frozen=True, eq=False)
class Departure:
    """A window before a step: its field and patches, and the penetrations where it begins and ends."""

    far: FarField
    patches: Patches
    start: float
    value: float


@dataclass(frozen=True, eq=False)
class Release:
    """An event in a window, and how much the load changes in its jump: zero but for the first of an avalanche."""

    event: PathEvent
    load_change: float


@dataclass(frozen=True, eq=False)
class Landing:
    """A window, or all windows joined, after a step: patches, the rate of their edges, (2 n,), and the releases."""

    patches: Patches
    rate: FloatArray
    releases: tuple[Release, ...]


def landed(path: Path, departure: Departure) -> tuple[Landing | None, int]:
    """Follow a window; None where its path fails or leaves no edges.  Also return the number of evaluations.

    `path` is the path of the whole contact.
    """
    elastic = replace(path.system.elastic, far=departure.far)
    own = System(elastic, path.system.law, path.system.control)
    increments = replace(path.increments, fine=path.increments.way)
    least_load = LeastLoad(NO_TURN_COUNTS)
    path = replace(path, system=own, increments=increments, asked_loads=(), least_load=least_load)
    return if_solvable(_landing, path, departure), own.effort.evaluations + own.effort.local_evaluations


def _landing(path: Path, departure: Departure) -> Landing | None:
    """Return the window at the end of its path, after it came to rest at the start."""
    way, start = path.increments.way, departure.start
    begun = Start(departure.patches, start, start)
    rested = at_rest(path.jumps, begun)
    if rested.balance is None or rested.status != "converged":
        return None
    releases: list[Release] = []
    if rested.changes:
        before = balance(path.system, departure.patches, start, start, way.tolerance)
        releases += _at_start(before, rested.balance, rested.changes, departure)
    equilibrium: Equilibrium = Equilibrium.of(start, rested.balance)
    for point in path.advance(equilibrium, departure.value):
        if not isinstance(point, Equilibrium):
            return None
        if point.events:
            releases += _jump(point.events, point.load - equilibrium.load)
        equilibrium = point
    if equilibrium.value != departure.value or equilibrium.balance.factor is None:
        return None
    return Landing(equilibrium.patches, tangent(path.system, equilibrium.balance), tuple(releases))


def _at_start(
    before: Balance, after: Balance, changes: tuple[tuple[str, float], ...], departure: Departure
) -> list[Release]:
    """Return the events of a window that was not at rest: they belong to somewhere in the step before."""
    released = before.potential - after.potential
    doubt = abs(released) + WINDOW_STEP * abs(before.state.load - after.state.load)
    load = abs(before.stiffness) * WINDOW_STEP
    error = EventNumbers(WINDOW_STEP, WINDOW_STEP, load, load * WINDOW_STEP)
    events = path_events(changes, numbers_of(before, departure.start), error, released, doubt)
    return _jump(events, after.state.load - before.state.load)


def _jump(events: tuple[PathEvent, ...], load_change: float) -> list[Release]:
    """Return the events of an avalanche, the first with the change of the load."""
    return [Release(event, 0.0 if k else load_change) for k, event in enumerate(events)]
