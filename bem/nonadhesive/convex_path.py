"""The path of a contact without adhesion: one solution for each target, no history.

The problem is convex, so the state depends on the target alone, and so does the way to it: each target is solved from
its own solution on a grid (grid_contact.py), whatever came before, to the same digits.  Where gaps are so narrow that
unknowns on patches cannot resolve them, as the last ones before complete contact are, they carry the unknowns
themselves (last_gaps.py), from where isolated cracks would be.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from bem.elastic.collocation import Elastic, Evaluation
from bem.geometry.arrays import FloatArray
from bem.geometry.gaps import Gaps, gaps_of
from bem.geometry.patches import Patches
from bem.loading.assessment import Assessment
from bem.loading.control import Control, LoadControl
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import FIRST_TOUCH, NO_ERROR, EventNumbers, PathEvent, PathStatus, PathTension, path_events
from bem.loading.points_without_edges import Complete, Failed, PathPoint, Separated
from bem.nonadhesive.completed_body import CompletedBody, LinearControl, condition_of
from bem.nonadhesive.contact_assessment import assess_contact
from bem.nonadhesive.gap_series import GapEvaluation
from bem.nonadhesive.grid_contact import GridProblem, grid_problem
from bem.nonadhesive.last_gaps import assess_gaps, isolated_cracks, solve_gaps
from bem.nonadhesive.nonadhesive import solve_contact

LOAD_CONTROL = LoadControl()
DEPTH_ROUNDING = 4 * float(np.finfo(float).eps)  # of penetrations: nearer to first touch and complete contact is there
NARROW_GAP = 1e-3  # speed: isolated cracks below this part of the contact beside them carry the unknowns at once
ISOLATED = 0.3  # speed: largest half width of a gap, over the shortest wave, for which isolated cracks are a good start


@dataclass(frozen=True, eq=False)
class ContactPoint(PathPoint):
    """A state with edges."""

    state: Evaluation | GapEvaluation
    status: ClassVar[PathStatus] = "converged"


ConvexPoint = Separated | Complete | Failed | ContactPoint


@dataclass(frozen=True, eq=False)
class ConvexPath:
    """Solves the contact problem without adhesion at one target after the other.

    Parameters
    ----------
    elastic, control
        As for `solve_contact`.
    increments : Increments
        Only the fine tolerances are used.
    body : CompletedBody
        Complete contact, where load control ends, and what it takes to open gaps in it.
    crests : (n,) array
        Positions of the highest crests (more than one when equally high).
    stop : float, optional
        Load behind which nothing is asked for: goals that need more are not solved.
    """

    elastic: Elastic
    control: Control
    increments: Increments
    body: CompletedBody
    crests: FloatArray
    stop: float | None = None
    effort: Effort = field(default_factory=Effort)
    has_history: ClassVar[bool] = False
    largest_tension: ClassVar[PathTension | None] = None  # no adhesion, no tension

    def direction(self, point: ConvexPoint, goal: float, separation: float | None = None) -> float:
        """Sign of the motion from a point to a goal, which may be the same value but for a rounded separation."""
        if goal != point.value or separation is None:
            return float(np.sign(goal - point.value))
        return float(np.sign((point.separation or 0.0) - separation))

    def advance(self, point: ConvexPoint, goal: float, separation: float | None = None) -> Iterator[ConvexPoint]:
        """Yield the point at the goal, at this separation where that is what is controlled; or where the path stops."""
        if point.value == goal and point.separation == separation:
            return
        stop = self._stopped
        between = stop is not None and min(point.value, goal) < stop.value < max(point.value, goal)
        ahead = stop if stop is not None and between else self.at(goal, separation)
        if isinstance(ahead, Failed):
            self.effort.rejected += 1
        else:
            self.effort.accepted += 1
        yield replace(ahead, events=self._events(point, ahead))

    def refine(self, point: ConvexPoint, direction: float) -> ConvexPoint:
        """Return the point: every point is solved to the accuracy of a target."""
        return replace(point, events=())

    def restart(
        self, patches: Patches, penetration: float, value: float, separation: float | None = None
    ) -> ConvexPoint:
        """Solve for the point at a value of the control again; its evaluations were counted with the stored state."""
        return replace(self, effort=Effort()).at(value, separation)

    def _events(self, before: ConvexPoint, after: ConvexPoint) -> tuple[PathEvent, ...]:
        """First touch and complete contact between two points: continuous, where they happen at any increment."""
        events: tuple[PathEvent, ...] = ()
        if before.status == "separated" and after.status in ("converged", "complete_contact"):
            changes = tuple(("first_touch", float(crest)) for crest in self.crests)
            events += path_events(changes, FIRST_TOUCH, NO_ERROR, 0.0, 0.0)
        if before.status in ("separated", "converged") and after.status == "complete_contact":
            x, pressure = self.body.minima
            last = x[pressure <= -self.body.lowest + self.body.rounding]
            events += path_events(tuple(("complete_contact", float(x)) for x in last), self._joined, NO_ERROR, 0.0, 0.0)
        return events

    @cached_property
    def _joined(self) -> EventNumbers:
        """Position where the last gap closes: there the pressure of complete contact is lowest and vanishes."""
        highest, load = self.body.max_height, self.body.complete.least_load
        value = self.control.value(highest, load)
        return EventNumbers(
            value, highest, load, self.control.potential(highest, load, self.body.complete.elastic_energy)
        )

    def at(self, value: float, separation: float | None = None) -> ConvexPoint:
        """Solve for the point at a value of the control, at the given separation if the separation is controlled."""
        return replace(self._solved(self.control, value, separation), separation=separation)

    def load_of(self, point: ConvexPoint) -> float | None:
        """Load at a point: nothing apart, and in complete contact what the control says, or the least."""
        if isinstance(point, ContactPoint):
            return point.state.load
        if isinstance(point, Complete):
            fixed = self.control.load_weight == 0
            return self.body.complete.least_load if fixed else self.control.load(self.body.max_height, point.value)
        return 0.0 if isinstance(point, Separated) else None

    def may_meet(self, before: ConvexPoint, after: ConvexPoint, load: float) -> bool:
        """Return True if a load lies between the loads of two points: the load grows with the penetration."""
        if load == self.stop and self._stopped is not None and after.value == self._stopped.value:
            return True  # to the last digit
        start, end = self.load_of(before), self.load_of(after)
        return start is not None and end is not None and min(start, end) < load <= max(start, end)

    def at_load(self, before: ConvexPoint, after: ConvexPoint, load: float) -> ConvexPoint:
        """Solve for the point at a load, whatever the control."""
        return self._stopped if self._stopped is not None and load == self.stop else self._at_load(load)

    @cached_property
    def _stopped(self) -> ContactPoint | None:
        """The point with edges at the load behind which nothing is asked for."""
        point = None if self.stop is None else self._at_load(self.stop)
        return point if isinstance(point, ContactPoint) else None

    def _at_load(self, load: float) -> ConvexPoint:
        point = self._solved(LOAD_CONTROL, load)
        penetration = self.elastic.profile.max_height if point.state is None else point.state.penetration
        return replace(point, value=self.control.value(penetration, load))

    def assess(self, point: ContactPoint) -> Assessment:
        """Stiffness and estimated errors, from a finer evaluation."""
        self.effort.evaluations += 1
        if isinstance(point.state, GapEvaluation):
            return assess_gaps(point.state, condition_of(self.body, self.control, point.value, point.separation))
        tolerance = 1e-2 * self.increments.fine.tolerance
        return assess_contact(self.elastic, self.control, point.state, point.value, tolerance)

    def _solved(self, control: Control, value: float, separation: float | None = None) -> ConvexPoint:
        """Solve for the state at a value of a control: by its patches, or by its gaps where these are narrow."""
        if value <= DEPTH_ROUNDING * control.penetration_weight * self.body.max_height:
            return Separated(value)
        joined = control.value(self.body.max_height, self.body.complete.least_load)
        if separation <= 0 if separation is not None else value >= joined * (1 - DEPTH_ROUNDING):
            return Complete(value)
        condition = condition_of(self.body, control, value, separation)
        gaps = isolated_cracks(self.body, condition)
        if self._are_narrow(gaps):
            return self._by_gaps(condition, value, gaps)
        start, middle = self._grid.patches(control, value), self.body.max_height / 2
        solved = solve_contact(self.elastic, control, start, middle, value, self.increments.fine)
        self.effort.evaluations += solved.evaluations
        if solved.state is not None and solved.status == "converged":
            return ContactPoint(value, solved.state)
        known = gaps if solved.patches is None else gaps_of(solved.patches)
        point = self._by_gaps(condition, value, known)  # there is contact, and a gap, at any value between
        if solved.state is None or isinstance(point, ContactPoint):
            return point
        return ContactPoint(value, solved.state)  # that gap is too much for unknowns in gaps, and taken for contact

    def _by_gaps(self, condition: LinearControl, value: float, gaps: Gaps) -> ConvexPoint:
        """Solve for the state from the given gaps."""
        solved = solve_gaps(self.body, condition, gaps)
        self.effort.evaluations += solved.evaluations
        if solved.status == "closed":
            return Complete(value)
        if solved.state is None or solved.status != "converged":
            return Failed(value, "ill_conditioned" if solved.status == "ill_conditioned" else "not_converged")
        return ContactPoint(value, solved.state)

    def _are_narrow(self, gaps: Gaps) -> bool:
        """Return True if a gap is so narrow that isolated cracks are a good start and patches are not.

        The waves of the profile must be longer, and those that feel the thickness of a layer.
        """
        isolated = np.all(gaps.half_width * self.body.highest_order <= ISOLATED)
        narrowest = np.min(2 * gaps.half_width / np.minimum(gaps.patch_before, gaps.patch_after), initial=0.0)
        return bool(isolated and narrowest < NARROW_GAP)

    @cached_property
    def _grid(self) -> GridProblem:
        return grid_problem(self.elastic)
