"""The path of a contact without adhesion: one solution for each target, no history.

The problem is convex, so the state depends on the target alone, and so does the way to it: each target is solved from
its own solution on a grid (grid_contact.py), whatever came before, to the same digits.  Where gaps are so narrow that
unknowns on patches cannot resolve them, as the last ones before complete contact are, they carry the unknowns
themselves (last_gaps.py), from where lone cracks would be.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem.elastic.collocation import Elastic, Evaluation
from bem.loading.assessment import Assessment
from bem.loading.control import Control, LoadControl
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import FIRST_TOUCH, NO_ERROR, Exact, PathEvent, PathStatus, path_events
from bem.nonadhesive.completed_body import CompletedBody
from bem.nonadhesive.contact_assessment import assess_contact
from bem.nonadhesive.gap_series import GapEvaluation
from bem.nonadhesive.gaps import Gaps, gaps_of
from bem.nonadhesive.grid_contact import GridProblem, grid_problem
from bem.nonadhesive.last_gaps import Condition, assess_gaps, condition_of, lone_cracks, solve_gaps
from bem.nonadhesive.nonadhesive import solve_contact

FloatArray = NDArray[np.float64]

LOAD_CONTROL = LoadControl()
ROUNDED = 4 * float(np.finfo(float).eps)  # of penetrations: nearer to first touch and complete contact is there
NARROW = 1e-3  # lone cracks narrower than this part of the contact beside them carry the unknowns from the start
LONE = 0.3  # largest half width of a gap, over the shortest wavelength / 2 pi, that a lone crack is an estimate of


@dataclass(frozen=True, eq=False)
class ContactPoint:
    """A state on the path; no evaluation where the surfaces are apart or fully joined.

    `separation` is what was asked for where that is more than its difference to `value`, which is rounded.
    """

    status: PathStatus
    value: float
    state: Evaluation | GapEvaluation | None = None
    events: tuple[PathEvent, ...] = ()
    separation: float | None = None


@dataclass
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
    """

    elastic: Elastic
    control: Control
    increments: Increments
    body: CompletedBody
    crests: FloatArray
    effort: Effort = field(default_factory=Effort)

    def advance(self, point: ContactPoint, goal: float, separation: float | None = None) -> Iterator[ContactPoint]:
        """Yield the point at the goal, at this separation where that is what is controlled."""
        if point.value == goal and point.separation == separation:
            return
        ahead = self.at(goal, separation)
        if ahead.status in ("not_converged", "ill_conditioned"):
            self.effort.rejected += 1
        else:
            self.effort.accepted += 1
        yield replace(ahead, events=self._events(point, ahead))

    def _events(self, before: ContactPoint, after: ContactPoint) -> tuple[PathEvent, ...]:
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
    def _joined(self) -> Exact:
        """Where the last gap closes: where the pressure of complete contact is lowest, which vanishes there."""
        highest, load = self.body.max_height, self.body.complete.least_load
        value = self.control.value(highest, load)
        return Exact(value, highest, load, self.control.potential(highest, load, self.body.complete.elastic_energy))

    def at(self, value: float, separation: float | None = None) -> ContactPoint:
        """The point at a value of the control, at this separation where that is what is controlled."""
        return replace(self._solved(self.control, value, separation), separation=separation)

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
        if isinstance(point.state, GapEvaluation):
            return assess_gaps(point.state, condition_of(self.body, self.control, point.value, point.separation))
        tolerance = 1e-2 * self.increments.fine_tolerance
        return assess_contact(self.elastic, self.control, point.state, point.value, tolerance)

    def _solved(self, control: Control, value: float, separation: float | None = None) -> ContactPoint:
        """The state at a value of a control: by its patches, or by its gaps where these are narrow."""
        if value <= ROUNDED * control.penetration_weight * self.body.max_height:
            return ContactPoint("separated", value)
        joined = control.value(self.body.max_height, self.body.complete.least_load)
        if separation <= 0 if separation is not None else value >= joined * (1 - ROUNDED):
            return ContactPoint("complete_contact", value)
        condition = condition_of(self.body, control, value, separation)
        gaps, deficit = lone_cracks(self.body, condition)
        if self._are_narrow(gaps):
            return self._by_gaps(condition, value, gaps, deficit)
        inc, start = self.increments, self._grid.patches(control, value)
        solved = solve_contact(
            self.elastic,
            control,
            start,
            self.body.max_height / 2,
            value,
            inc.fine_tolerance,
            inc.fine_closure,
            inc.allowed,
        )
        self.effort.evaluations += solved.evaluations
        if solved.status != "converged":  # there is contact, and a gap, at any value between
            known = gaps if solved.patches is None else gaps_of(solved.patches)
            found = self._by_gaps(condition, value, known, deficit)
            if found.state is not None or solved.state is None:
                return found
        assert solved.state is not None  # also where that gap is too much for unknowns in gaps, and taken for contact
        self.effort.unknowns = max(self.effort.unknowns, solved.state.unknowns)
        return ContactPoint("converged", value, solved.state)

    def _by_gaps(self, condition: Condition, value: float, gaps: Gaps, deficit: float) -> ContactPoint:
        """The state found from these gaps."""
        solved = solve_gaps(self.body, condition, gaps, deficit)
        self.effort.evaluations += solved.evaluations
        if solved.status == "closed":
            return ContactPoint("complete_contact", value)
        if solved.state is None or solved.status != "converged":
            return ContactPoint("ill_conditioned" if solved.status == "ill_conditioned" else "not_converged", value)
        self.effort.unknowns = max(self.effort.unknowns, solved.state.unknowns)
        return ContactPoint("converged", value, solved.state)

    def _are_narrow(self, gaps: Gaps) -> bool:
        """Whether gaps are so narrow, one of them at least, that lone cracks are a start and patches none."""
        lone = np.all(gaps.half_width * self.body.pressure.max_order <= LONE)
        narrowest = np.min(2 * gaps.half_width / np.minimum(gaps.patch_before, gaps.patch_after), initial=0.0)
        return bool(lone and narrowest < NARROW)

    @cached_property
    def _grid(self) -> GridProblem:
        return grid_problem(self.elastic)
