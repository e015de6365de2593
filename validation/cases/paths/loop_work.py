"""First law along a path with jumps: work between events, what events release, and the growth of the potential.

With F the force conjugate to the controlled v, and Phi the energy that an equilibrium minimises,

    penetration, separation: v = Delta, F = p, Phi = U;        mean pressure: v = p, F = -Delta, Phi = U - p Delta;
    total displacement: v = Delta + c(0) p, F = p, Phi = U + c(0) p^2 / 2,

dPhi = F dv on branches, and a jump at constant v lowers Phi by what it releases: int F dv is the growth of Phi and the
energies of the events.  Where events lie is taken from the path itself; it is followed again through the nodes of
Gauss's rule on every branch between them and the targets.  v = (a + b)/2 - (b - a)/2 cos(theta) makes F smooth in
theta also at a fold, where it ends with the root of the distance: what is missing in the balance is then the error of
the events, not of the quadrature.  Energies per nominal area, SI units.

The case: a rough profile on a layer is loaded and unloaded under every control; there are targets where the load turns
sharply, patches nearly detaching, since nodes are dense at the ends of a branch.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

import bem
from bem.scene.result import Event, Result, State
from bem.scene.scene import Scene
from validation.cases.shared.checks import Against, Found, case, posed
from validation.corpus.random.random_checks import Units, mark, place
from validation.harness.schema import Cells, Table

NODES = 14  # of Gauss's rule on a branch
SHORTEST = 1e-12  # of the way between two targets: a branch
SEPARATIONS = (40e-6, 50e-6, 58e-6, 63.66e-6, 70e-6, 40e-6)  # m; patches nearly detach at the fourth
PLATE = (40e-6, 46e-6, 52e-6, 64.53e-6, 70e-6, 40e-6)  # m, above first touch of the highest crest; as above
LOADS = (1.2e4, 2000.0, -450.0, 2000.0)  # Pa
INCREMENTS = {"mean_pressure": 0.4}


class Account(NamedTuple):
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


def accounts(scene: Scene, nodes: int = NODES, approach: bool = False) -> tuple[Result, list[Account]]:
    """A path that begins apart, with adhesion, and the account of every way between its targets.

    `nodes` are those of Gauss's rule on every branch; with `approach` the way from first touch to the first target
    comes first. ValueError where the path does not converge, or has other events when it is followed again.
    """
    result, units, highest = bem.solve(scene), Units.of(scene), scene.surface().max_height
    theta, weight = np.polynomial.legendre.leggauss(nodes)
    theta, weight = np.pi / 2 * (theta + 1), np.pi / 2 * weight
    targets: list[float] = []
    weights: list[float] = []
    ends: list[int] = []
    for (states, events), target in zip(legs(result), scene.loading.targets, strict=True):
        places = [place(scene, event, units)[0] for event in events]
        if ends:
            places = [place(scene, states[0], units)[0], *places]
        places.append(place(scene, states[-1], units)[0])
        for a, b in pairwise(places if ends or approach else []):
            if abs(b - a) <= SHORTEST * max(map(abs, places)):
                continue
            at = (a + b) / 2 - (b - a) / 2 * np.cos(theta)
            targets += (highest - at if scene.loading.control == "separation" else at).tolist()
            weights += ((b - a) / 2 * np.sin(theta) * weight).tolist()
        targets.append(target)
        weights.append(0.0)
        ends.append(len(targets))
    again = bem.solve(replace(scene, loading=scene.loading.model_copy(update={"targets": tuple(targets)})))
    if again.status != "converged" or [e.kind for e in again.events] != [e.kind for e in result.events]:
        raise ValueError(f"path: {again.status}, {len(again.events)} events where there were {len(result.events)}")
    states = again.targets
    work = [w * place(scene, state, units)[1] for w, state in zip(weights, states, strict=True)]
    found = []
    for first, last in pairwise([0, *ends]):
        before = states[first - 1] if first else None
        count = 0 if before is None else before.events or 0
        met = again.events[count : states[last - 1].events]
        growth = mark(scene, states[last - 1], units).potential
        growth -= 0.0 if before is None else mark(scene, before, units).potential
        freed = sum(event.energy_released or 0.0 for event in met)
        found.append(Account(float(sum(work[first:last])), growth, freed, len(met)))
    return result, found if approach else found[1:]


def closed(ways: Sequence[Account]) -> Account:
    """The account of several ways together."""
    return Account._make(map(sum, zip(*ways, strict=True)))


def _loops() -> Found:
    highest = posed("thin_layer").surface().max_height
    targets = {
        "separation": list(SEPARATIONS),
        "mean_pressure": list(LOADS),
        "total_displacement": [highest - place for place in PLATE],
    }
    found, events, table = list[float](), 0, list[Cells]()
    for control, ways in targets.items():
        scene = posed("thin_layer", solid={"poisson_ratio": 0.3}, layer={"thickness": 1e-3},
                      adhesion={"work_of_adhesion": 0.1}, loading={"control": control, "targets": ways},
                      accuracy={"max_increment": INCREMENTS.get(control), "tolerance": None})  # fmt: skip
        result, accounted = accounts(scene)
        loop = closed(accounted)
        found.append(loop.released / (loop.work - loop.growth))
        events += loop.events
        values = (loop.work, loop.growth, loop.released)
        table.append([control, len(result.states), loop.events, *(float(f"{v:.5g}") for v in values)])
    # the quadrature where the load turns sharply: 3.8e-9 under a load
    yield Against("exact", "first law under every control").row(
        f"energy released over a loop, over what its work leaves: {', '.join(targets)}", "", [1.0] * 3, found,
        1.43e-7)  # fmt: skip
    yield Table(caption="Unloading and loading again; energies in J/m^2 of nominal area.",
                columns=["control", "states", "events", "work", "growth of the potential", "energy released"],
                rows=table)  # fmt: skip
    yield {"events": events}


CASES = (
    case("loop-work", "path", _loops,
         "Is what the work of a loop leaves the energy that its events release, whatever is controlled?",
         r"$\int F \, dv = \Phi_2 - \Phi_1$ + energy released, $v$ and $F$ of the control",
         "carbone2009 carbone2008", "layer adhesion slope_term load_control unloading", scene="thin_layer"),
)  # fmt: skip
