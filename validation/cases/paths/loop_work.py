"""First law along a path with jumps: work between events, what events release, and the growth of the potential.

With F the force conjugate to the controlled v, and Phi the energy that an equilibrium minimises,

    penetration, separation: v = Delta, F = p, Phi = U;        mean pressure: v = p, F = -Delta, Phi = U - p Delta;
    total displacement: v = Delta + c(0) p, F = p, Phi = U + c(0) p^2 / 2,

dPhi = F dv on branches, and a jump at constant v lowers Phi by what it releases: int F dv is the growth of Phi and the
energies of the events.  Where events lie is taken from the path itself; it is followed again through the nodes of
Gauss's rule on every branch between them and the targets.  v = (a + b)/2 - (b - a)/2 cos(theta) makes F smooth in
theta also at a fold, where it ends with the root of the distance: what is missing in the balance is then the error of
the events, not of the quadrature.  Energies per nominal area, SI units.

A rough profile on a layer is loaded and unloaded under every control; there are targets where the load turns sharply,
patches nearly detaching, since nodes are dense at the ends of a branch.  A loop of separation is told event by event.
Seven equal waves in equal contact stay equal while the smallest eigenvalue is positive; the bifurcation is an event,
and no wave alone has one.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

import bem
from bem.scene.result import Event, Result, State
from bem.scene.scene import Scene
from validation.cases.shared.checks import OVER_STATES, Against, Found, case, column, posed, solved, touching, work
from validation.corpus.hard.any_result import Units, mark, place
from validation.harness.figure_data import axes, digits, drawn, marks, table, trace
from validation.references.closed_forms import Sinusoid

NODES = 14  # of Gauss's rule on a branch
SHORTEST = 1e-12  # of the way between two targets: a branch
SEPARATIONS = (40e-6, 50e-6, 58e-6, 63.66e-6, 70e-6, 40e-6)  # m; patches nearly detach at the fourth
PLATE = (40e-6, 46e-6, 52e-6, 64.53e-6, 70e-6, 40e-6)  # m, above first touch of the highest crest; as above
LOADS = (1.2e4, 2000.0, -450.0, 2000.0)  # Pa
INCREMENTS = {"mean_pressure": 0.4}
WAYS = {"loading": "line", "unloading to 70 um": "dashed", "loading again": "line", "unloading": "dashed"}


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
    targets = [index for index, state in enumerate(result.states) if state.target]
    first_states: tuple[State, ...] = (result.states[targets[0]],)
    found = [(first_states, result.events[: first_states[0].events])]
    for first, last in pairwise(targets):
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
    again = bem.solve(replace(scene, loading=replace(scene.loading, targets=tuple(targets))))
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
    loops: dict[str, tuple[Result, Account]] = {}
    for control, ways in targets.items():
        scene = posed("thin_layer", solid={"poisson_ratio": 0.3}, layer={"thickness": 1e-3},
                      adhesion={"work_of_adhesion": 0.1}, loading={"control": control, "targets": ways},
                      accuracy={"max_increment": INCREMENTS.get(control), "tolerance": None})  # fmt: skip
        result, accounted = accounts(scene)
        loops[control] = result, closed(accounted)
    found = [loop for _, loop in loops.values()]
    # the quadrature where the load turns sharply: 3.8e-9 under a load
    yield Against("exact", "first law under every control").row(
        f"energy released over a loop, over what its work leaves: {', '.join(targets)}", "", [1.0] * 3,
        [loop.released / (loop.work - loop.growth) for loop in found], 1.43e-7)  # fmt: skip
    yield table("Unloading and loading again; energies in J/m^2 of nominal area.",
                {"control": loops, "states": [len(result.states) for result, _ in loops.values()],
                 "events": column(found, "events"), "work": digits(column(found, "work"), 5),
                 "growth of the potential": digits(column(found, "growth"), 5),
                 "energy released": digits(column(found, "released"), 5)})  # fmt: skip
    yield {"events": sum(column(found, "events"))}


def _history() -> Found:
    result, ways = accounts(posed("hysteresis", accuracy={"max_increment": None}))  # nodes suffice
    apart, least = result.states[-1], min(event.energy_released or 0.0 for event in result.events)
    loops = [closed(ways[:2]), closed(ways)]  # 30 um, 70 um, 30 um; and on to 160 um, apart
    yield Against("exact", "first law: work = growth of U + energy released").row(
        "work of a loop (30, 70, 30 um) and of the way apart, over the largest", "J/m^2",
        [loop.growth + loop.released for loop in loops], column(loops, "work"), 1.2e-10, OVER_STATES,
        max(abs(loop.work) for loop in loops))  # fmt: skip
    yield Against("exact", "second law").count("least energy released by an event is not negative (1: yes)", 1.0,
                                               least >= 0)  # fmt: skip
    yield Against("exact", "nothing touches, nothing is stored").row(
        "energy once the surfaces are apart", "J/m^2", [0.0, 0.0], [apart.total_energy, apart.contact_fraction], 0.0,
        "absolute", required=1e-15, pinned="exact")  # fmt: skip
    # seven waves lose their symmetry on loading, on Johnson's stable branch, and one wave never does
    psi = np.linspace(_wave(7).fold(), 0.97 * np.pi / 2, 20001)
    lost = [float(np.interp(event.penetration, _wave(7).penetration(psi), psi) * 2 / np.pi)
            for event in _bifurcations(7)]  # fmt: skip
    yield Against("dense algebra", "a prototype, two digits: unstable above 0.76", 0.005).row(
        "contact fraction at which seven equal contacts lose their symmetry on loading", "", 0.76, lost[:1] or None,
        (0.01, 0.006), "absolute")  # fmt: skip
    yield Against("exact", "Johnson 1995: one branch up to complete contact").count(
        "bifurcations of one wave alone on loading", 0.0, len(_bifurcations(1)))  # fmt: skip
    events, height = result.events, result.states[0].separation + result.states[0].penetration
    yield drawn("hysteresis",
                "Mean pressure along two loops of separation: the area between the branches is what events release.",
                axes("separation / um", "mean pressure / kPa",
                     *(trace(word, column(there, "separation", 1e-6), column(there, "mean_pressure", 1e3), style)
                       for (word, style), (states, _) in zip(WAYS.items(), legs(result)[:4], strict=True)
                       for there in [touching(states)]),
                     marks("events", [(height - event.penetration) * 1e6 for event in events],
                           column(events, "mean_pressure", 1e3))))  # fmt: skip
    yield table("Events of the path in order.",
                {"event": column(events, "kind"),
                 "position / um": [None if event.position is None else round(event.position * 1e6, 2)
                                   for event in events],
                 "penetration / um": [round(event.penetration * 1e6, 4) for event in events],
                 "mean pressure / kPa": [round(event.mean_pressure / 1e3, 4) for event in events],
                 "energy released / (uJ/m^2)": [None if event.energy_released is None
                                                else float(f"{event.energy_released * 1e6:.4g}")
                                                for event in events]})  # fmt: skip
    yield table("Dissipation in J/m^2 of nominal area.",
                {"way": ("loop 30, 70, 30 um", "30 um and apart"), "events": column(loops, "events"),
                 "work": digits(column(loops, "work"), 5), "growth of U": digits(column(loops, "growth"), 5),
                 "energy released by events": digits(column(loops, "released"), 5)})  # fmt: skip
    yield work("events evaluations", result)


def _wave(order: int) -> Sinusoid:
    """One of so many equal waves, alpha = 0.3."""
    return Sinusoid(1e-4 / order, 0.01 / order, 1e6, 0.5, 0.3)


def _bifurcations(order: int) -> list[Event]:
    """Where the symmetric state of equal waves is lost on loading."""
    wave = _wave(order)
    deepest = float(wave.penetration(0.9 * np.pi / 2))
    result = solved("sinusoid", profile={"orders": [order], "amplitudes": [1e-4 / order]},
                    adhesion={"work_of_adhesion": wave.work_of_adhesion},
                    loading={"targets": [0.3 * deepest, deepest]}, accuracy={"tolerance": 1e-6})  # fmt: skip
    return [event for event in result.events if event.kind == "bifurcation"]


CASES = (
    case("loading-history", "path", _history,
         "Is what a loop dissipates the sum of what its events release, and is a lost symmetry an event?",
         r"$\int \sigma_0 \, d\Delta = U_2 - U_1$ + sum of energies released; energy released $\ge 0$",
         "carbone2009 johnson1995", "half_space adhesion slope_term unloading", scene="hysteresis"),
    case("loop-work", "path", _loops,
         "Is what the work of a loop leaves the energy that its events release, whatever is controlled?",
         r"$\int F \, dv = \Phi_2 - \Phi_1$ + energy released, $v$ and $F$ of the control",
         "carbone2009 carbone2008", "layer adhesion slope_term load_control unloading", scene="thin_layer"),
)  # fmt: skip
