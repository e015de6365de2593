"""Many patches: windows of them followed side by side over a step of the penetration, and joined.

In a step every window follows its own path, in a far field that is linear in the penetration: the field of the charges
at the start of the step, and of the charges at predicted edges at its end.  The windows' states are joined at seams and
evaluated as one state.  If an event in one window reaches into others, the joined state is no equilibrium there: these
windows are followed again over the step, in the field of the joined charges at its end, until the joined state is one
(waveform relaxation by Schwarz's alternating method).  Penetration control, half-space.  Dimensionless.

Events.  A window knows its events in its far field.  The imbalance of K at the joined edges, as a penetration, tells
how far off the field was at the end of the step: it is the error of the place of the events.  Of windows followed again
the largest imbalance counts: the field of a jump reaches them at once, but they were followed as if it grew over the
step.  By reciprocity a jump changes the load of the whole contact by as much as the generalised load of the window;
between jumps the load of the whole is interpolated, by its rates at both ends of the step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.polynomial import polynomial

from bem.adhesive.equilibrium import edge_positions
from bem.adhesive.relaxation import NEIGHBOURS
from bem.elastic.collocation import Evaluation, evaluate
from bem.elastic.far_field import Charges, far_fields
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import TWO_PI, Patches, ordered
from bem.loading.crew import Crew
from bem.loading.path_events import EventNumbers, PathEvent, PathStatus
from bem.loading.points_without_edges import PathPoint
from bem.path.path import Path
from bem.path.stand import LONGEST_MOTION
from bem.windows.landing import Departure, Landing, Release, landed
from bem.windows.windows import Window, in_core, seams, wider, windows_of

WIDER = 3, 7  # limit: patches of buffer more, for a window whose path fails
ALIKE = 0.1  # residual of joined windows, beyond which a window felt events of another too late: it is followed again
ROUNDS = 5  # limit: of windows that follow one another's events in a step
BESIDE = 2 * NEIGHBOURS  # edges next to an event, by which the far field of its window is judged


@dataclass(frozen=True, eq=False)
class Spread(PathPoint):
    """Joined windows, next to an equilibrium of many patches.

    Attributes
    ----------
    state : Evaluation
        Evaluation without the compliance of the edges.
    rate : (2 L,) array
        Derivatives of the outward motions of the edges by the penetration.
    """

    state: Evaluation
    rate: FloatArray
    status: ClassVar[PathStatus] = "converged"

    @property
    def patches(self) -> Patches:
        """The contact patches, whose ends are the edges."""
        return self.state.patches

    @property
    def load(self) -> float:
        """Load of the state."""
        return self.state.load

    @property
    def stiffness(self) -> float:
        """Derivative of the load by the penetration, the edges following."""
        state = self.state
        return state.load_rate + float(state.stress_intensity * state.stress_intensity_rate / 2 @ self.rate)


@dataclass(frozen=True, eq=False)
class Spreading:
    """Path of many patches from penetration to penetration.

    Parameters
    ----------
    path : Path
        Path of the whole contact.
    crew : Crew
        Processes in which windows are followed.
    """

    path: Path
    crew: Crew

    def at(self, value: float, patches: Patches, rate: FloatArray) -> Spread | None:
        """Return the point at edges with their rates; None where it cannot be evaluated."""
        state = self._evaluated(patches, value)
        return None if state is None else Spread(value, state, rate)

    def stepped(self, point: Spread, value: float) -> Spread | None:
        """Return the point at another penetration; None where a window fails, or windows do not fit.

        Windows that are off in the joined state are followed again, in the field of its charges.
        """
        change, most = value - point.value, LONGEST_MOTION * point.patches.edge_scale
        predicted = self._evaluated(point.patches.moved(np.clip(change * point.rate, -most, most)), value)
        ahead = charges_moved_in(point.state) if predicted is None else charges_of(predicted)
        off, rounds = dict(enumerate(windows_of(point.patches))), list[tuple[Evaluation, FloatArray]]()
        followed: dict[int, tuple[Window, Landing]] = {}
        most_missed = np.inf
        for _ in range(ROUNDS):
            again = self._followed(off, point, value, ahead)
            joined = None if again is None else joined_at_seams(list((followed := followed | again).values()))
            state = None if joined is None else self._evaluated(joined.patches, value)
            if joined is None or state is None:
                return None
            missed = self._missed(state)
            largest = float(np.max(np.abs(missed)))
            if not largest < most_missed:
                return None
            most_missed = largest
            rounds.append((state, missed))
            late = np.abs(missed) > ALIKE
            if not late.any():
                spread = Spread(value, state, joined.rate)
                releases = [(r, max(self._error(r, *evaluated) for evaluated in rounds)) for r in joined.releases]
                return replace(spread, events=events_of(point, spread, releases))
            places, ahead = edge_positions(state.patches)[late], charges_of(state)
            off = {k: window for k, (window, _) in followed.items() if window.arc.holds(places).any()}
        return None

    def _followed(
        self, windows: dict[int, Window], point: Spread, value: float, ahead: Charges
    ) -> dict[int, tuple[Window, Landing]] | None:
        """Return windows at another penetration by their indices; None where the path of a window fails.

        The field in a window is linear from the charges at the point to the charges ahead.  A window whose path fails
        is followed with wider buffers.
        """
        charges = charges_of(point.state)

        def departures(some: Sequence[Window]) -> list[Departure]:
            fields = far_fields([window.arc for window in some], charges, ahead)
            return [
                Departure(far, window.of(point.patches), point.value, value)
                for window, far in zip(some, fields, strict=True)
            ]

        followed: dict[int, tuple[Window, Landing]] = {}
        for k, landing in zip(windows, self._landings(departures(list(windows.values()))), strict=True):
            window = windows[k]
            for more in WIDER if landing is None else ():
                wide = wider(point.patches, k, more)
                if landing is None and wide is not None:
                    window, (landing,) = wide, self._landings(departures([wide]))
            if landing is None:
                return None
            followed[k] = window, landing
        return followed

    def _landings(self, departures: Sequence[Departure]) -> Iterator[Landing | None]:
        """Yield the ends of the paths of windows."""
        effort = self.path.system.effort
        for landing, evaluations in self.crew.each(landed, self.path, departures):
            effort.local_evaluations += evaluations
            effort.cpu_elsewhere = self.crew.cpu_seconds
            yield landing

    def _evaluated(self, patches: Patches, value: float) -> Evaluation | None:
        """Return all patches at a penetration, without the compliance of their edges; None where that fails."""
        if not patches.is_ordered:
            return None
        system = self.path.system
        system.effort.evaluations += 1
        tolerance = self.path.increments.way.tolerance
        return if_solvable(evaluate, system.elastic, patches, value, tolerance, None, False)

    def _missed(self, state: Evaluation) -> FloatArray:
        """Return 2 - K / sqrt(w), (2 L,): zero in equilibrium."""
        work = self.path.system.law.work_and_gradient(edge_positions(state.patches))[0]
        return np.asarray(2 - state.stress_intensity / np.sqrt(work))

    def _error(self, release: Release, state: Evaluation, missed: FloatArray) -> float:
        """Return the imbalance of K at edges near an event, as a penetration."""
        apart = np.abs((edge_positions(state.patches) - release.event.position + np.pi) % TWO_PI - np.pi)
        near = np.argsort(apart)[:BESIDE]
        shift = missed[near] * state.stress_intensity[near] / (2 - missed[near]) / state.stress_intensity_rate[near]
        return float(np.max(np.abs(shift)))


def joined_at_seams(followed: Sequence[tuple[Window, Landing]]) -> Landing | None:
    """Return the cores of windows as one contact; None where they do not fit."""
    landings = [landing for _, landing in followed]
    places = seams([window for window, _ in followed], [landing.patches for landing in landings])
    if places is None:
        return None
    parts: list[FloatArray] = []
    releases: tuple[Release, ...] = ()
    for landing, seam, following in zip(landings, places, [*places[1:], places[0]], strict=True):
        own = in_core(landing.patches.left, seam, following)
        edges = np.stack([edge_positions(landing.patches), landing.rate])
        parts.append(edges.reshape(2, 2, -1)[:, :, own])
        releases += tuple(r for r in landing.releases if in_core(np.array(r.event.position), seam, following))
    (left, right), rate = np.concatenate(parts, axis=2)
    patches, order = ordered(left, right), np.argsort(left % TWO_PI)
    return Landing(patches, rate[:, order].ravel(), releases) if patches.is_ordered else None


def events_of(first: Spread, last: Spread, releases: Sequence[tuple[Release, float]]) -> tuple[PathEvent, ...]:
    """Return the events of a step in their order, with the load of the whole contact.

    Parameters
    ----------
    first, last : Spread
        States at the start and the end of the step.
    releases : sequence of (Release, float)
        Releases in the windows, each with the error of its penetration by the far field.
    """
    change = last.value - first.value
    direction = np.sign(change)
    in_order = sorted(releases, key=lambda entry: direction * entry[0].event.at.value)
    value = np.array([release.event.at.value for release, _ in in_order])
    width = np.array([release.event.error.value + shift for release, shift in in_order])
    jump = np.array([release.load_change for release, _ in in_order])
    rise, a, b = last.load - first.load - jump.sum(), change * first.stiffness, change * last.stiffness
    smooth = np.array([first.load, a, 3 * rise - 2 * a - b, a + b - 2 * rise])
    part = (value - first.value) / change
    load = polynomial.polyval(part, smooth) + np.cumsum(jump) - jump
    bent = float(np.max(np.abs(polynomial.polyval(np.linspace(0, 1, 9), smooth - [first.load, rise, 0, 0]))))
    steepness = max(abs(first.stiffness), abs(last.stiffness))
    tied = np.abs(value[:, None] - value) <= width[:, None] + width  # any of these may come before the other
    doubt = bent + steepness * width + tied @ np.abs(jump) - np.abs(jump)
    events = []
    for k, (release, shift) in enumerate(in_order):
        event, off = release.event, release.event.error
        error = EventNumbers(off.value + shift, off.penetration + shift, off.load + float(doubt[k]), off.potential)
        energy_error = event.energy_error + shift * abs(release.load_change)
        at = replace(event.at, load=float(load[k]))
        events.append(replace(event, at=at, error=error, energy_error=energy_error))
    return tuple(events)


def charges_of(state: Evaluation) -> Charges:
    """Return the charges of a state."""
    return Charges(state.skeleton_nodes(), state.skeleton, state.penetration)


def charges_moved_in(state: Evaluation) -> Charges:
    """Return the charges of a state after a unit of penetration more, at fixed edges."""
    return Charges(state.skeleton_nodes(), state.skeleton + state.skeleton_rate, state.penetration + 1)
