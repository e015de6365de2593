"""First law along a path with jumps: work between events, what events release, and the growth of the potential.

With F the force conjugate to the controlled v, and Phi the energy that an equilibrium minimises,

    penetration, separation: v = Delta, F = p, Phi = U;        mean pressure: v = p, F = -Delta, Phi = U - p Delta;
    total displacement: v = Delta + c(0) p, F = p, Phi = U + c(0) p^2 / 2,

dPhi = F dv on branches, and a jump at constant v lowers Phi by what it releases: int F dv is the growth of Phi and the
energies of the events.  Where events lie is taken from the path itself; it is followed again through the nodes of
Gauss's rule on panels of every branch between them.  v = (a + b)/2 - (b - a)/2 cos(theta) makes F smooth in theta also
at a fold, where it ends with the root of the distance: what is missing in the balance is then the error of the events,
not of the quadrature.  Energies per nominal area, SI units.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

import bem
from bem.scene.result import Event, Result, State
from bem.scene.scene import Scene

NODES, PANELS = 12, 4  # of Gauss's rule on a panel; panels of the way between two targets
SHORTEST = 1e-12  # of the way between two targets: a branch


@dataclass(frozen=True)
class Account:
    """Of the way between two targets, J/m^2: work of the load, growth of the potential, energy released, events."""

    work: float
    growth: float
    released: float
    events: int

    @property
    def missing(self) -> float:
        """What the balance lacks."""
        return self.work - self.growth - self.released


def legs(result: Result) -> list[tuple[tuple[State, ...], tuple[Event, ...]]]:
    """States and events of the ways between targets; the first has only the first target, and what led there."""
    marks = [index for index, state in enumerate(result.states) if state.target]
    first_states: tuple[State, ...] = (result.states[marks[0]],)
    found = [(first_states, result.events[: first_states[0].events])]
    for first, last in pairwise(marks):
        states = result.states[first : last + 1]
        found.append((states, result.events[states[0].events : states[-1].events]))
    return found


def accounts(posed: Scene, nodes: int = NODES) -> tuple[Result, list[Account]]:
    """A path that begins apart, with adhesion, and the account of every way between its targets.

    `nodes` are those of Gauss's rule on every branch. ValueError where the path does not converge, or has other events
    when it is followed again.
    """
    result = bem.solve(posed)
    theta, weight = np.polynomial.legendre.leggauss(nodes)
    theta, weight = np.pi / 2 * (theta + 1), np.pi / 2 * weight
    targets: list[float] = []
    weights: list[float] = []
    ends: list[int] = []
    for (states, events), target in zip(legs(result), posed.loading.targets, strict=True):
        places = [_coordinate(posed, event)[0] for event in events]
        if ends:
            places = [_coordinate(posed, states[0])[0], *places]
        places.append(_coordinate(posed, states[-1])[0])
        for start, stop in pairwise(places):
            if abs(stop - start) <= SHORTEST * max(map(abs, places)):
                continue
            count = int(np.ceil(abs(stop - start) / abs(places[-1] - places[0]) * PANELS))
            for a, b in pairwise(np.linspace(start, stop, count + 1).tolist()):
                targets += [_target(posed, v) for v in (a + b) / 2 - (b - a) / 2 * np.cos(theta)]
                weights += ((b - a) / 2 * np.sin(theta) * weight).tolist()
        targets.append(target)
        weights.append(0.0)
        ends.append(len(targets))
    again = bem.solve(replace(posed, loading=posed.loading.model_copy(update={"targets": tuple(targets)})))
    if again.status != "converged" or [e.kind for e in again.events] != [e.kind for e in result.events]:
        raise ValueError(f"path: {again.status}, {len(again.events)} events where there were {len(result.events)}")
    states = again.targets
    work = [w * _coordinate(posed, state)[1] for w, state in zip(weights, states, strict=True)]
    found = []
    for first, last in pairwise([0, *ends]):
        before = states[first - 1] if first else None
        count = 0 if before is None else before.events or 0
        met = again.events[count : states[last - 1].events]
        growth = _potential(posed, states[last - 1]) - (0.0 if before is None else _potential(posed, before))
        freed = sum(event.energy_released or 0.0 for event in met)
        found.append(Account(float(sum(work[first:last])), growth, freed, len(met)))
    return result, found


def closed(ways: Sequence[Account]) -> Account:
    """The account of several ways together."""
    return Account(
        work=sum(way.work for way in ways),
        growth=sum(way.growth for way in ways),
        released=sum(way.released for way in ways),
        events=sum(way.events for way in ways),
    )


def _compliance(posed: Scene) -> float:
    """c(0) in m/Pa, where it takes part in the control."""
    if posed.loading.control != "total_displacement" or posed.layer is None:
        return 0.0
    nu = posed.solid.poisson_ratio
    return posed.layer.thickness * (1 - 2 * nu) * (1 + nu) / (posed.solid.youngs_modulus * (1 - nu))


def _coordinate(posed: Scene, at: State | Event) -> tuple[float, float]:
    """Controlled quantity and its force."""
    if posed.loading.control == "mean_pressure":
        return at.mean_pressure, -at.penetration
    return at.penetration + _compliance(posed) * at.mean_pressure, at.mean_pressure


def _target(posed: Scene, value: float) -> float:
    """The target that is met at a value of the controlled quantity."""
    return posed.surface().max_height - value if posed.loading.control == "separation" else value


def _potential(posed: Scene, state: State) -> float:
    pressure = state.mean_pressure
    if posed.loading.control == "mean_pressure":
        return state.total_energy - pressure * state.penetration
    return state.total_energy + _compliance(posed) * pressure**2 / 2
