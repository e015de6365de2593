"""Beginnings and ends of an adhesive path, where there are no edges: surfaces apart, and complete contact.

Surfaces touch at the highest crests, whatever the control.  Complete contact opens at a flaw, or where the separation
begins (opening.py); it is reached where the separation vanishes.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bem.adhesive.relaxation import fall, first_contact, interpenetration
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.geometry.profile import EQUAL_HEIGHTS
from bem.loading.complete_contact import closing_place
from bem.loading.path_events import FIRST_TOUCH, NO_ERROR, EventNumbers, path_events
from bem.loading.points_without_edges import Complete, Failed, Separated
from bem.path.jump import Jumps
from bem.path.opening import (
    Flaw,
    complete_potential,
    first_gap,
    flawed_potential,
    lowest_pressure,
    opened_gap,
    opening_load,
    opening_rounding,
)
from bem.path.points_with_edges import Equilibrium, Point


@dataclass(frozen=True, eq=False)
class BareStates(Jumps):
    """Jumps of a path from states without edges to states with edges, and into complete contact.

    Parameters
    ----------
    system, increments, complete
        As of all jumps.
    crests : (n,) array
        Positions of the highest crests, where first touch happens.
    flaw : Flaw or None
        Flaw from which complete contact opens when the load falls; without a flaw complete contact never opens.
    """

    crests: FloatArray
    flaw: Flaw | None

    @property
    def closing_value(self) -> float:
        """Penetration at which contact is complete; infinite when the load takes part in the control."""
        if self.system.control.load_weight > 0:
            return np.inf
        return self.system.elastic.profile.max_height * (1 - EQUAL_HEIGHTS)

    def advance(self, point: Separated | Complete | Failed, goal: float) -> Point:
        """Return the next point: first touch (at value 0), the opening of complete contact, or the goal."""
        if isinstance(point, Complete):
            return self._opened(point, goal)
        if isinstance(point, Separated):
            return Separated(goal) if goal < 0 else self._touched(max(point.value, 0.0))
        return Failed(goal, point.status if isinstance(point, Failed) else "not_converged")

    def closed(self, patches: Patches, value: float) -> Complete:
        """Return complete contact after the last gap closes, where the separation vanishes.

        The branch ends continuously, and no energy is released.
        """
        last = int(np.argmax(patches.gap_after))  # gaps that close earlier release energy
        near = float(patches.right[last] + patches.gap_after[last] / 2)
        place = closing_place(self.complete, self.system.elastic.profile, self.system.law, near)
        events = path_events((("complete_contact", place),), self._fully_joined(value), NO_ERROR, 0.0, 0.0)
        return Complete(value, events=events)

    def _touched(self, value: float) -> Point:
        """Return the state into which the highest crests jump where they touch."""
        landed = self.landed(first_contact(self.system, self.crests), value, value)
        changes = (*(("first_touch", float(crest)) for crest in self.crests), *landed.changes)
        return self.behind(FIRST_TOUCH, NO_ERROR, landed, changes)

    def _opened(self, point: Complete, goal: float) -> Point:
        """Return complete contact at the goal, or the equilibrium into which it opens on the way to the goal."""
        if self.system.control.load_weight > 0:
            return self._opened_at_flaw(point, goal)
        if goal >= self.closing_value:
            return Complete(goal)
        system, highest = self.system, self.system.elastic.profile.max_height
        separation, gap = first_gap(system, self.complete, min(highest - goal, self.increments.smallest))
        value = goal if separation == highest - goal else highest - separation
        accuracy = self.increments.way
        fallen = fall(system, gap, value, value, accuracy)
        if fallen.balance is None or fallen.changes:
            return Failed(value, "not_converged")
        if interpenetration(system, fallen.balance.state, accuracy.allowed).position.size:
            return Failed(value, "not_converged")
        opening = ("opening", lowest_pressure(self.complete))
        events = path_events((opening,), self._fully_joined(value), NO_ERROR, 0.0, 0.0)
        return replace(Equilibrium.of(value, fallen.balance), events=events)

    def _opened_at_flaw(self, point: Complete, goal: float) -> Point:
        """Return complete contact at the goal or the state into which its flaw opens, if the load is in the control.

        Without a flaw complete contact stays.
        """
        flaw, system, complete, fine = self.flaw, self.system, self.complete, self.increments.fine
        if flaw is None:
            return Complete(goal)
        highest = system.elastic.profile.max_height
        load = opening_load(system, complete, flaw, fine.tolerance)
        value = min(point.value, system.control.value(highest, load))
        if goal > value:
            return Complete(goal)
        joined = self._fully_joined(value)
        landed = self.landed(opened_gap(system, complete, flaw, joined.load), highest, value)
        joined = replace(joined, potential=flawed_potential(system, complete, flaw, value, fine.tolerance))
        rounding = opening_rounding(system, flaw, fine.tolerance)
        error = replace(NO_ERROR, value=system.control.load_weight * rounding, load=rounding)
        return self.behind(joined, error, landed, (("opening", flaw.center), *landed.changes))

    def _fully_joined(self, value: float) -> EventNumbers:
        """Return the numbers of complete contact at a value of the control.

        The tension under which the last gap closes has no bound.
        """
        control, highest = self.system.control, self.system.elastic.profile.max_height
        value = value if control.load_weight else highest
        potential = complete_potential(self.system, self.complete, value)
        return EventNumbers(value, highest, control.load(highest, value), potential)
