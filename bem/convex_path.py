"""The path of a contact without adhesion: one solution for each target, no history.

The problem is convex, so the state depends on the target alone; the last solution only serves as a start.  Where
the iteration does not converge from there, the way is halved, and the halves are counted as rejected increments.
Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bem.assessment import Assessment, assess_contact
from bem.collocation import Elastic, Evaluation
from bem.complete_contact import CompleteContact
from bem.control import Control
from bem.nonadhesive import Contact, bearing_patches, solve_contact
from bem.patches import Patches
from bem.path import Effort, Increments, PathEvent, PathStatus

FloatArray = NDArray[np.float64]

HALVINGS = 8


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
        """Yield the points on the way to the goal: as a rule just the one at the goal."""
        value, halvings = goal, 0
        while point.value != goal:
            ahead = self._solved(point, value)
            if ahead.status in ("not_converged", "ill_conditioned"):
                self.effort.rejected += 1
                halvings += 1
                if halvings > HALVINGS:
                    yield ahead
                    return
                value = (max(point.value, 0.0) + value) / 2
                continue
            self.effort.accepted += 1
            yield ahead
            point, value = ahead, goal

    def polish(self, point: ContactPoint) -> ContactPoint:
        """The point itself: every one is solved to the accuracy of a target."""
        return point

    def assess(self, point: ContactPoint) -> Assessment:
        """Stiffness and estimated errors, from finer evaluations."""
        assert point.state is not None
        self.effort.evaluations += 2
        tolerance = 1e-2 * self.increments.fine_tolerance
        return assess_contact(self.elastic, self.control, point.state, point.value, tolerance)

    def _solved(self, point: ContactPoint, value: float) -> ContactPoint:
        """The state at a control value."""
        if value <= 0:
            return ContactPoint("separated", value)
        if value >= self.control.value(self.elastic.profile.max_height, self.complete.least_load):
            return ContactPoint("complete_contact", value)
        if point.state is not None:
            solved = self._solved_from(point.state.patches, point.state.penetration, value)
        else:
            solved = self._solved_from(self._start(value), 1.0, value)
        if solved.status == "separated" and point.state is not None:  # far above the plane all of it is in tension
            solved = self._solved_from(self._start(value), 1.0, value)
        if solved.status == "separated":
            return ContactPoint("not_converged", value)  # there is contact at any value above zero
        if solved.state is None or solved.status != "converged":
            return ContactPoint(solved.status, value)
        self.effort.unknowns = max(self.effort.unknowns, solved.state.unknowns)
        events: tuple[PathEvent, ...] = ()
        if point.status == "separated":
            events = tuple(PathEvent("first_touch", 0.0, 0.0, 0.0, float(crest), 0.0) for crest in self.crests)
        return ContactPoint("converged", value, solved.state, events)

    def _solved_from(self, start: Patches, penetration: float, value: float) -> Contact:
        """The contact problem at a control value, from these patches; the solution is unique."""
        inc = self.increments
        solved = solve_contact(
            self.elastic, self.control, start, penetration, value, inc.fine_tolerance, inc.fine_closure, inc.allowed
        )
        self.effort.evaluations += solved.evaluations
        return solved

    def _start(self, value: float) -> Patches:
        """Patches to start from when there are none: the bearing area at about the right contact fraction."""
        if self.control.penetration_weight > 0:
            return bearing_patches(self.elastic, value)
        profile = self.elastic.profile
        share = float(np.clip(0.8 * value / (2 * np.pi * profile.rms_slope), 1e-3, 0.9))
        return bearing_patches(self.elastic, profile.max_height - float(np.quantile(profile.grid[1], 1 - share)))
