"""States that the page of a run shows one after the other, each with its deformed surface and pressure.

A path is the sequence of its stored states, with both ends of every jump between them.  Displacement u and pressure
p of a state follow from its edges and its penetration by one linear solution (bem.ContactState); complete contact has
a closed form, and surfaces apart have none of either.  Nothing of the path is solved again.

Limits: the ends of a jump of more than 100 patches are not stored, so the states beside it stand for them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import chebyshev

import bem
from bem.geometry.scaling import Scales
from bem.loading.complete_contact import complete_contact
from bem.scene.result import Event, JumpEnd, Result
from bem.scene.state import ErrorEstimate, State
from bem.scene.surface import surface_of
from validation.harness.arrays import FloatArray

MOST, FEWEST = 60, 12  # states on a page, and at least so many of a large contact
UNKNOWNS = 60_000  # of all states on a page: about 20 s
ALONG, FINEST = 600, 4000  # points along the period: at least, and at most
PER_WAVE = 12  # points along the shortest wave
ON_PATCHES, LEAST, LARGEST = 1200, 6, 48  # points on all patches, and the least and most on a patch

SAME = 1e-4  # of the contact fraction and the penetration: an end of a jump and the stored state behind it
ALIKE = 0.1  # difference of contact fractions of states that a line joins


@dataclass(frozen=True)
class PathState:
    """State of a path, with the events since the state before it.

    Attributes
    ----------
    state : State
        A stored state, or an end of a jump as a state without energies.
    events : tuple of Event
    jump : {"", "before", "after"}
        End of a jump; the state before "after" is the "before" of the jump.
    """

    state: State
    events: tuple[Event, ...] = ()
    jump: str = ""

    @property
    def jumped(self) -> bool:
        """True if energy beyond its error was released since the state before."""
        return self.jump == "after" or any(
            (event.energy_released or 0.0) > (event.error_estimate.energy_released or 0.0) for event in self.events
        )


@dataclass(frozen=True, eq=False)
class Fields:
    """Displacement (m) at equidistant positions along the period, and pressure (Pa) on each patch.

    The positions on a patch from a to b are a + (b - a) (1 - cos theta) / 2, theta = (k + 1/2) pi / n.
    """

    displacement: FloatArray
    pressure: tuple[FloatArray, ...]


def profile_of(result: Result) -> bem.Profile:
    """Return the profile of a result, from its scene or, of a scan, from its stored harmonics."""
    profile, fields = result.scene["profile"], result.fields
    if profile["kind"] != "samples":
        return surface_of(profile, None)
    period = profile["period"]
    orders = np.rint(fields["profile_q"] * period / (2 * np.pi)).astype(np.int64)
    return bem.Profile.from_harmonics(period, orders, fields["profile_amplitude"], fields["profile_phase"])


def path_of(result: Result) -> list[PathState]:
    """Return all states of the path that were found, with the ends of jumps between them."""
    period, happened = result.scene["profile"]["period"], 0
    path: list[PathState] = []
    landed = False  # the last state of the path is the end of a jump, which the next stored state may be
    for state in result.states:
        if not state.found:
            continue
        ahead: tuple[Event, ...] = ()
        for event in result.events[happened : state.events]:
            if event.before is not None and event.after is not None:
                before, after = (_end(end, event, state, period) for end in (event.before, event.after))
                path += [PathState(before, ahead, "before"), PathState(after, (event,), "after")]
                ahead, landed = (), True
            elif path and path[-1].jump == "after" and path[-1].events[0].penetration == event.penetration:
                path[-1] = replace(path[-1], events=(*path[-1].events, event))  # of the same avalanche
            else:
                ahead += (event,)
        happened = state.events
        if landed and not ahead and _equal(path[-1].state, state):
            path[-1] = replace(path[-1], state=state)
        else:
            path.append(PathState(state, ahead))
        landed = False
    return path


def _equal(end: State, state: State) -> bool:
    """Return whether a stored state is the end of a jump."""
    same = (end.status, end.n_patches) == (state.status, state.n_patches)
    near = abs(end.contact_fraction - state.contact_fraction) <= SAME
    if state.status == "complete_contact" and not math.isnan(state.mean_pressure):  # alike but for the pressure
        near = math.isclose(end.mean_pressure, state.mean_pressure, rel_tol=SAME)
    return same and near and math.isclose(end.penetration, state.penetration, rel_tol=SAME)


def _end(end: JumpEnd, event: Event, near: State, period: float) -> State:
    """Return an end of a jump as a state; `near` is the stored state behind it."""
    error = event.error_estimate
    highest = near.penetration + near.separation
    share = sum(b - a for a, b in end.edges) / period
    return State(
        branch=near.branch,
        status=end.status,
        penetration=end.penetration,
        separation=0.0 if end.status == "complete_contact" else highest - end.penetration,
        mean_pressure=end.mean_pressure,
        contact_fraction=float(end.status == "complete_contact") if not end.edges else share,
        n_patches=len(end.edges),
        edges=end.edges,
        error_estimate=ErrorEstimate(
            mean_pressure=error.mean_pressure, separation=error.penetration, penetration=error.penetration
        ),
    )


def joins_of(path: list[PathState]) -> str:
    """Return a letter for each state: l or u if joined to the state before by loading or unloading, j by a jump.

    States between which nothing is known are not joined, n: complete contact and another state, contact fractions
    that differ by more than `ALIKE`, and surfaces that a held tension parts, which move apart without end.
    """
    letters = "n"
    for before, point in itertools.pairwise(path):
        former, state = before.state, point.state
        complete = (former.status == "complete_contact") != (state.status == "complete_contact")
        unlike = abs(former.contact_fraction - state.contact_fraction) > ALIKE
        lost = any(event.kind == "pull_off" and event.energy_released is None for event in point.events)
        letters += "n" if lost else "j" if point.jumped else "n" if complete or unlike else state.branch[0]
    return letters


def shown_of(path: list[PathState]) -> list[int]:
    """Return the indices of the states on the page: the largest jumps, the targets, and others evenly between them."""
    if not path:
        return []
    unknowns = max(point.state.unknowns for point in path)
    most = min(max(UNKNOWNS // max(unknowns, 1), FEWEST), MOST)
    states = [point.state for point in path]
    chosen = {0, len(path) - 1, max(range(len(path)), key=lambda k: states[k].contact_fraction)}
    jumps = [k for k, point in enumerate(path) if point.jump == "after"]
    for k in sorted(jumps, key=lambda k: _released(path[k]), reverse=True):
        if len(chosen) + 2 <= 2 * most // 3 + 1:
            chosen |= {k - 1, k}
    targets = [k for k, state in enumerate(states) if state.target]
    chosen |= set(_evenly(targets, max(most - len(chosen), 0) // 2))
    rest = [k for k in range(len(path)) if k not in chosen and not path[k].jump]
    return sorted(chosen | set(_evenly(rest, most - len(chosen))))


def _released(point: PathState) -> float:
    """Return the energy released on the way to a state, infinite where a held load parts the surfaces."""
    return sum(math.inf if event.energy_released is None else event.energy_released for event in point.events)


def _evenly(indices: list[int], count: int) -> list[int]:
    """Return at most `count` of some indices, evenly spread."""
    if count <= 0 or not indices:
        return []
    places = np.linspace(0, len(indices) - 1, min(count, len(indices))).round().astype(int)
    return [indices[k] for k in places]


def with_events(path: list[PathState], shown: list[int]) -> Iterator[PathState]:
    """Yield the states at some indices, each with all events since the state before it on the page."""
    last = -1
    for k in shown:
        events = tuple(event for point in path[last + 1 : k + 1] for event in point.events)
        yield replace(path[k], events=events)
        last = k


def positions(profile: bem.Profile) -> FloatArray:
    """Return equidistant positions along the period, m."""
    count = min(max(ALONG, PER_WAVE * profile.max_order), FINEST)
    return np.asarray(np.arange(count) * (profile.period / count))


def fields_of(result: Result, profile: bem.Profile, state: State) -> Fields:
    """Return the fields of a state; the pressure of complete contact is about zero where its mean is undetermined."""
    x = positions(profile)
    if state.status == "complete_contact":
        return Fields(profile.height(x), (_complete_pressure(result, profile, state, x.size),))
    if not state.edges:
        return Fields(np.zeros(x.size), ())
    layer = _layer(result)
    contact = bem.ContactState(profile, bem.Solid(**result.scene["solid"]), state.edges, state.penetration, layer)
    return Fields(contact.displacement(x), tuple(_on_patches(contact)))


def _layer(result: Result) -> bem.Layer | None:
    """Return the layer of a scene; None for a half-space."""
    layer = result.scene["layer"]
    return None if layer is None else bem.Layer(**layer)


def _complete_pressure(result: Result, profile: bem.Profile, state: State, count: int) -> FloatArray:
    """Return the pressure of complete contact on the period, taken as one patch."""
    mean = 0.0 if math.isnan(state.mean_pressure) else state.mean_pressure
    if profile.is_flat:
        return np.full(count, mean)
    solid, layer, compliance = bem.Solid(**result.scene["solid"]), _layer(result), None
    if layer is not None:
        from bem.elastic.compliance import Compliance

        compliance = Compliance(layer.kernel(solid, profile.period, 1e-12))
    wave = complete_contact(profile.scaled(), None, compliance).pressure
    stress = Scales(profile.period, profile.rms_height, solid.plane_strain_modulus).stress
    return np.asarray(mean + stress * wave.height(2 * np.pi * _shares(count)))


def _on_patches(contact: bem.ContactState) -> Iterator[FloatArray]:
    """Yield the pressure on each patch at the positions of `Fields`, Pa."""
    carried = contact.evaluation.pressure()
    widths = (carried.right - carried.left) / 2
    for charge, half_width in zip(carried.charges, widths, strict=True):
        part = half_width / np.sum(widths)
        count = min(max(math.ceil(ON_PATCHES * part), LEAST), max(LARGEST, 4 * charge.size))
        t = 2 * _shares(count) - 1
        density = chebyshev.chebval(t, charge) / (half_width * np.sqrt(1 - t**2))
        yield np.asarray(density * contact.scales.stress)


def _shares(count: int) -> FloatArray:
    """Return (1 - cos theta) / 2 at theta = (k + 1/2) pi / n, (n,)."""
    return np.asarray(np.sin((np.arange(count) + 0.5) * (np.pi / (2 * count))) ** 2)
