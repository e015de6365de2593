"""Many patches: leaps of windows, joined, and equilibria of all without matrices of all.

A leap of all patches is one of every window, in a far field that is linear in the penetration: that of the charges
where the leap begins and of those at predicted edges where it ends.  What the windows find is joined at seams and
evaluated as a whole; a window that finds nothing is made wider.  States that are kept come to rest as one
(settling.py).  Penetration control, half-space.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from bem.adhesive.equilibrium import System, edge_positions
from bem.elastic.collocation import Evaluation
from bem.elastic.far_field import far_fields
from bem.elastic.gap import gap_field, low_minima
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import TWO_PI, Patches, ordered
from bem.leaps.landing import Departure, Goal, Landing, landed
from bem.leaps.leap import PREDICTED
from bem.leaps.settling import Jacobians, Settling, charges_of, moved_in
from bem.leaps.windows import Window, in_core, seams, wider, windows_of
from bem.loading.assessment import Assessment
from bem.loading.crew import Crew
from bem.loading.increments import Accuracy
from bem.loading.path_events import PathEvent, PathStatus
from bem.loading.points_without_edges import PathPoint

WIDER = 3, 7  # limit: patches of buffer more, for a window that finds nothing
JOINED = 0.5  # limit: residual of windows that were joined, beyond which they did not fit
FINER = 1e-2  # derived: of the accuracy of targets: that of their assessment
STEPS = 8  # limit: of Newton to a load
ROUNDS = 5  # limit: of windows that follow one another's events, and of what only the accuracy of targets shows


@dataclass(frozen=True, eq=False)
class Spread(PathPoint):
    """An equilibrium of many patches.

    Attributes
    ----------
    state : Evaluation
        Without the compliance of the edges; at the edges or, while it is not settled, next to equilibrium.
    rate, bend : (2 L,) arrays
        Derivatives of the outward motions of the edges by the control; zero where they are not known.
    jacobians : Jacobians or None
        Of an equilibrium at the accuracy of targets.
    """

    state: Evaluation
    rate: FloatArray
    bend: FloatArray
    jacobians: Jacobians | None = None
    status: ClassVar[PathStatus] = "converged"

    @property
    def patches(self) -> Patches:
        """The contact patches, whose ends are the edges."""
        return self.state.patches

    @property
    def load(self) -> float:
        """The load of the state."""
        return self.state.load


@dataclass(frozen=True, eq=False)
class Spreading:
    """Leads many patches from equilibrium to equilibrium.

    Parameters
    ----------
    system : System
    fine : Accuracy
        Of states that are kept.
    crew : Crew
        Processes in which windows leap.
    """

    system: System
    fine: Accuracy
    crew: Crew

    @cached_property
    def settling(self) -> Settling:
        """What brings all patches to rest."""
        return Settling(self.system)

    def restarted(self, patches: Patches, value: float) -> Spread | None:
        """The state at equilibrium edges."""
        found = self.settling.settled(patches, value, self.fine)
        return None if found is None else self._at_rest(value, *found)

    def settled(self, point: Spread, width: float) -> Spread | None:
        """A state at the accuracy of targets, with events that only this shows, in a bracket of this width."""
        events: tuple[PathEvent, ...] = ()
        for _ in range(ROUNDS):
            found = self.settling.settled(point.patches, point.value, self.fine)
            if found is not None:
                low = low_minima(gap_field(self.system.elastic, found[0])).depth
                if not np.any(low < -self.fine.allowed):
                    return replace(self._at_rest(point.value, *found), events=events)
                point = replace(point, state=found[0])
            behind = self.leapt(point, point.value, self.fine, width)
            if behind is None:
                break
            point, events = behind, (*events, *behind.events)
        return None

    def at_load(self, point: Spread, other: float, load: float) -> Spread | None:
        """The state at a load on the branch of a point, on its way to another value; None where it is not there."""
        low, high = sorted((point.value, other))
        at: Spread | None = self.restarted(point.patches, point.value)
        for _ in range(STEPS):
            if at is None or abs(at.load - load) <= self.fine.residual:
                break
            change = (load - at.load) / self.settling.stiffness(at.state, at.rate)
            value = at.value + change
            if not low <= value <= high:
                return None
            at = self.restarted(at.patches.moved(change * at.rate), value)
        closed = at is not None and low_minima(gap_field(self.system.elastic, at.state)).depth < -self.fine.allowed
        return None if np.any(closed) else at

    def assess(self, point: Spread) -> Assessment:
        """Stability, stiffness and estimated errors of a settled state, from finer evaluations."""
        if point.jacobians is None:
            raise ValueError("only a settled state can be assessed")
        return self.settling.assess(point.state, point.jacobians, FINER * self.fine.tolerance)

    def _at_rest(self, value: float, state: Evaluation, jacobians: Jacobians) -> Spread:
        rate = jacobians.rate()
        return Spread(value, state, rate, np.zeros(rate.size), jacobians)

    def leapt(
        self, point: Spread, value: float, accuracy: Accuracy, width: float | None = None, quiet: bool = False
    ) -> Spread | None:
        """The state behind a leap to a value of the control; None where windows find none, or do not fit.

        Where an event in one window reaches into the next, what was joined is no equilibrium: windows follow from there
        at the same value until it is (Schwarz's alternating method).  Its events lie in a bracket of this width before
        it, by default in the leap.  It may be asked that nothing happens in it.
        """
        events: tuple[PathEvent, ...] = ()
        goal = Goal(point.value, value, accuracy, value - point.value if width is None else width, quiet)
        for _ in range(1 if quiet else ROUNDS):
            behind = self._once(point, replace(goal, start=point.value))
            if behind is None:
                break
            events = (*events, *behind.events)
            if np.max(np.abs(self.settling.missing(behind.state))) <= JOINED:
                return replace(behind, events=events)
            point = behind
        return None

    def _once(self, point: Spread, goal: Goal) -> Spread | None:
        """What all windows find, each in the far field of the state before, joined."""
        change = goal.value - point.value
        here, most = charges_of(point.state), PREDICTED * point.patches.edge_scale
        motion = np.clip(change * point.rate + change**2 / 2 * point.bend, -most, most)
        evaluated = self.settling.evaluated
        there = evaluated(point.patches.moved(motion), goal.value, goal.accuracy.tolerance) if change else None
        ahead = moved_in(point.state) if there is None else charges_of(there)

        def departures(windows: Sequence[Window]) -> list[Departure]:
            return [
                Departure(far, window.of(point.patches), window.edges(point.rate), window.edges(motion), goal)
                for window, far in zip(
                    windows, far_fields([window.arc for window in windows], here, ahead), strict=True
                )
            ]

        windows, found = windows_of(point.patches), []
        for k, landing in enumerate(self._landings(departures(windows))):
            for more in WIDER if landing is None and not goal.quiet else ():
                again = wider(point.patches, k, more)
                if again is None:
                    break
                (landing,) = self._landings(departures([again]))
                if landing is not None:
                    windows[k] = again
                    break
            if landing is None:
                return None
            found.append(landing)
        return self._joined(windows, found, goal.value, goal.accuracy.tolerance)

    def _landings(self, departures: Sequence[Departure]) -> Iterator[Landing | None]:
        """Where the leaps of windows end."""
        for landing, evaluations in self.crew.each(landed, self.system, departures):
            self.system.effort.local_evaluations += evaluations
            self.system.effort.cpu_elsewhere = self.crew.cpu_seconds
            yield landing

    def _joined(
        self, windows: Sequence[Window], found: Sequence[Landing], value: float, tolerance: float
    ) -> Spread | None:
        """What windows found, each of its core, as one state."""
        places = seams(windows, [landing.patches for landing in found])
        if places is None:
            return None
        parts: list[FloatArray] = []
        events: tuple[PathEvent, ...] = ()
        for landing, seam, following in zip(found, places, [*places[1:], places[0]], strict=True):
            own = in_core(landing.patches.left, seam, following)
            edges = np.stack([edge_positions(landing.patches), landing.rate, landing.bend])
            parts.append(edges.reshape(3, 2, -1)[:, :, own])
            events += tuple(e for e in landing.events if in_core(np.array(e.position), seam, following))
        (left, right), rate, bend = np.concatenate(parts, axis=2)
        patches = ordered(left, right)
        order = np.argsort(left % TWO_PI)
        if not patches.is_ordered:
            return None
        state = self.settling.evaluated(patches, value, tolerance)
        if state is None:
            return None
        return Spread(value, state, rate[:, order].ravel(), bend[:, order].ravel(), events=events)
