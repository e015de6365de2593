"""The path of a contact without adhesion: one solution for each target, no history.

The problem is convex, so the state depends on the target alone, and so does the way to it: each target is solved from
its own solution on a grid (grid_contact.py), whatever came before, to the same digits.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem.assessment import Assessment, assess_contact
from bem.collocation import Elastic, Evaluation
from bem.complete_contact import CompleteContact
from bem.control import Control, LinearControl
from bem.grid_contact import GridProblem, grid_problem
from bem.increments import Effort, Increments
from bem.nonadhesive import solve_contact
from bem.path_events import FIRST_TOUCH, NO_ERROR, PathEvent, PathStatus, path_events

FloatArray = NDArray[np.float64]

LOAD_CONTROL = LinearControl(0.0, 1.0)


@dataclass(frozen=True, eq=False)
class ContactPoint:
    """A state on the path; no evaluation where the surfaces are apart or fully joined."""

    status: PathStatus
    value: float
    state: Evaluation | None = None
    events: tuple[PathEvent, ...] = ()


@dataclass
class ConvexPath:
    """Solves the contact problem without adhesion at one target after the other.

    Parameters
    ----------
    elastic, control
        As for `solve_contact`.
    increments : Increments
        Only the fine tolerances are used.
    complete : CompleteContact
        Closed form of complete contact, where load control ends.
    crests : (n,) array
        Positions of the highest crests (more than one when equally high).
    """

    elastic: Elastic
    control: Control
    increments: Increments
    complete: CompleteContact
    crests: FloatArray
    effort: Effort = field(default_factory=Effort)

    def advance(self, point: ContactPoint, goal: float) -> Iterator[ContactPoint]:
        """Yield the point at the goal."""
        if point.value == goal:
            return
        ahead = self.at(goal)
        if ahead.status in ("not_converged", "ill_conditioned"):
            self.effort.rejected += 1
        else:
            self.effort.accepted += 1
        if ahead.status == "converged" and point.status == "separated":
            changes = tuple(("first_touch", float(crest)) for crest in self.crests)
            ahead = replace(ahead, events=path_events(changes, FIRST_TOUCH, NO_ERROR, 0.0, 0.0))
        yield ahead

    def at(self, value: float) -> ContactPoint:
        """The point at a value of the control."""
        return self._solved(self.control, value)

    def at_load(self, load: float) -> ContactPoint:
        """The point at a load, whatever the control: where the path crosses it."""
        found = self._solved(LOAD_CONTROL, load)
        penetration = self.elastic.profile.max_height if found.state is None else found.state.penetration
        return replace(found, value=self.control.value(penetration, load))

    def polish(self, point: ContactPoint) -> ContactPoint:
        """The point itself: every one is solved to the accuracy of a target."""
        return point

    def assess(self, point: ContactPoint) -> Assessment:
        """Stiffness and estimated errors, from a finer evaluation."""
        assert point.state is not None
        self.effort.evaluations += 1
        tolerance = 1e-2 * self.increments.fine_tolerance
        return assess_contact(self.elastic, self.control, point.state, point.value, tolerance)

    def _solved(self, control: Control, value: float) -> ContactPoint:
        """The state at a value of a control."""
        if value <= 0:
            return ContactPoint("separated", value)
        if value >= control.value(self.elastic.profile.max_height, self.complete.least_load):
            return ContactPoint("complete_contact", value)
        inc, start = self.increments, self._grid.patches(control, value)
        penetration = self.elastic.profile.max_height / 2
        solved = solve_contact(
            self.elastic, control, start, penetration, value, inc.fine_tolerance, inc.fine_closure, inc.allowed
        )
        self.effort.evaluations += solved.evaluations
        if solved.state is None or solved.status != "converged":  # there is contact, and a gap, at any value between
            return ContactPoint("ill_conditioned" if solved.status == "ill_conditioned" else "not_converged", value)
        self.effort.unknowns = max(self.effort.unknowns, solved.state.unknowns)
        return ContactPoint("converged", value, solved.state)

    @cached_property
    def _grid(self) -> GridProblem:
        return grid_problem(self.elastic)
