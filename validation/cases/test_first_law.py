"""First law along paths with jumps: work between events, energy that events release, growth of the potential.

With F conjugate to the controlled v and Phi the energy that an equilibrium minimises,

    penetration, separation: v = Delta, F = p, Phi = U;      mean pressure: v = p, F = -Delta, Phi = U - p Delta;
    total displacement: v = Delta + c(0) p, F = p, Phi = U + c(0) p^2 / 2,

dPhi = F dv on branches, and a jump at constant v lowers Phi by the energy it releases: int F dv is the growth of Phi
and the energies of the events.  The path is followed again through the nodes of Gauss's rule on every branch between
its events and targets; v = (a + b)/2 - (b - a)/2 cos(theta) makes F smooth in theta also at a fold.  Energies per
nominal area.  Rough profiles of 20 harmonics, h_rms = 50 um, period 10 mm, E = 1 MPa, gamma = 0.1 J/m^2 with the slope
term.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import uniform_compliance
from validation.routes.scenes import posed, touching, values

NODES = 14  # of Gauss's rule on a branch
SHORTEST = 1e-12  # branch, over its place
SEPARATIONS = (40e-6, 50e-6, 58e-6, 63.66e-6, 70e-6, 40e-6)  # m; patches nearly detach at the fourth
PLATE = (40e-6, 46e-6, 52e-6, 64.53e-6, 70e-6, 40e-6)  # m above first touch of the highest crest
LOADS = (1.2e4, 2000.0, -450.0, 2000.0)  # Pa


@dataclass(frozen=True)
class Way:
    """Way between two targets, J/m^2: work of the load, growth of the potential, energy released, events."""

    work: float
    growth: float
    released: float
    events: int

    def __add__(self, other):
        return Way(*(a + b for a, b in zip(vars(self).values(), vars(other).values(), strict=True)))


def conjugate(scene, state):
    """Return v, F and Phi of a state or event (Phi of an event: 0)."""
    penetration, pressure, energy = state.penetration, state.mean_pressure, getattr(state, "total_energy", 0.0)
    if scene.loading.control == "mean_pressure":
        return pressure, -penetration, energy - pressure * penetration
    if scene.loading.control == "total_displacement":
        uniform = uniform_compliance(scene.layer.thickness, scene.solid.youngs_modulus, scene.solid.poisson_ratio)
        return penetration + uniform * pressure, pressure, energy + uniform * pressure**2 / 2
    return penetration, pressure, energy


def ways(scene):
    """Return the path of a scene and what it does between its targets, but for the way to the first."""
    result = bem.solve(scene)
    assert result.status == "converged"
    theta, weight = np.polynomial.legendre.leggauss(NODES)
    theta, weight = np.pi / 2 * (theta + 1), np.pi / 2 * weight
    targets, weights, ends = [scene.loading.targets[0]], [0.0], [0]
    for (first, last), target in zip(pairwise(result.targets), scene.loading.targets[1:], strict=True):
        events = result.events[first.events : last.events]
        places = [conjugate(scene, at)[0] for at in (first, *events, last)]
        for a, b in pairwise(places):
            if abs(b - a) > SHORTEST * max(map(abs, places)):
                at = (a + b) / 2 - (b - a) / 2 * np.cos(theta)
                if scene.loading.control == "separation":
                    at = scene.surface().max_height - at
                targets += at.tolist()
                weights += ((b - a) / 2 * np.sin(theta) * weight).tolist()
        targets.append(target)
        weights.append(0.0)
        ends.append(len(targets) - 1)
    again = bem.solve(replace(scene, loading=replace(scene.loading, targets=tuple(targets))))
    assert again.status == "converged"
    assert [event.kind for event in again.events] == [event.kind for event in result.events]
    legs = []
    for start, end in pairwise(ends):
        states = again.targets[start : end + 1]
        work = sum(w * conjugate(scene, s)[1] for w, s in zip(weights[start : end + 1], states, strict=True))
        growth = conjugate(scene, states[-1])[2] - conjugate(scene, states[0])[2]
        events = again.events[states[0].events : states[-1].events]
        legs.append(Way(float(work), growth, sum(event.energy_released or 0.0 for event in events), len(events)))
    return result, legs


@pytest.mark.parametrize("control", [pytest.param("separation", marks=pytest.mark.standard),
                                     pytest.param("mean_pressure", marks=pytest.mark.quick),
                                     pytest.param("total_displacement", marks=pytest.mark.quick)])
def test_loop_on_a_layer(rows, control):
    """Is what the work of a loop leaves the energy that its events release, whatever is controlled?"""
    highest = posed("thin_layer").surface().max_height
    targets = {"separation": SEPARATIONS, "mean_pressure": LOADS,
               "total_displacement": [highest - place for place in PLATE]}[control]
    scene = posed("thin_layer", solid={"poisson_ratio": 0.3}, layer={"thickness": 1e-3},
                  adhesion={"work_of_adhesion": 0.1}, loading={"control": control, "targets": list(targets)},
                  accuracy={"max_increment": 0.4 if control == "mean_pressure" else None,
                            "tolerance": None})
    result, legs = ways(scene)
    loop = sum(legs[1:], legs[0])
    assert loop.events > 0
    rows.compare("energy released over the work less the growth of the potential",
                 loop.released / (loop.work - loop.growth), 1.0, of=Code.BEM, by=Code.IDENTITY,
                 quantity=Quantity.ENERGY, kind="construction", required=1e-6,
                 because="14 nodes on branches where the load turns sharply", source="first law")
    rows.count("events", loop.events, within=0.0, of=Code.BEM)
    rows.count("evaluations", sum(state.evaluations for state in result.states), within=0.1, of=Code.BEM)


@pytest.mark.quick
def test_loop_and_separation_of_a_rough_profile(rows):
    """Is what a loop of separation dissipates the sum of what its events release, and is nothing stored once apart?"""
    result, legs = ways(posed("hysteresis", accuracy={"max_increment": None}))
    apart = result.targets[-1]
    assert (apart.status, apart.contact_fraction, apart.total_energy) == ("separated", 0.0, 0.0)
    assert min(event.energy_released or 0.0 for event in result.events) >= 0
    loops = [legs[0] + legs[1], sum(legs[1:], legs[0])]  # 30, 70, 30 um; and on to 160 um, apart
    rows.compare("work of the loop and of the whole way", [loop.work for loop in loops],
                 [loop.growth + loop.released for loop in loops], of=Code.BEM, by=Code.IDENTITY,
                 quantity=Quantity.ENERGY, unit="J/m^2", kind="construction",
                 required=1e-9 * max(abs(loop.work) for loop in loops), because="nine digits of 14 nodes",
                 source="growth of U and energy released")
    rows.count("events", len(result.events), within=0.0, of=Code.BEM)
    rows.count("evaluations", sum(state.evaluations for state in result.states), within=0.1, of=Code.BEM)
    height = posed("hysteresis").surface().max_height
    shown = {way: touching(state for state in result.states if state.branch == way) for way in ("loading", "unloading")}
    rows.curves("The area between the branches of a loop is the energy that its events release", "separation / um",
                "mean pressure / kPa",
                {way: (values(states, "separation") * 1e6, values(states, "mean_pressure") / 1e3)
                 for way, states in shown.items()}
                | {"events": ((height - values(result.events, "penetration")) * 1e6,
                              values(result.events, "mean_pressure") / 1e3)})
    rows.table("Events in order", ["event", "penetration / um", "mean pressure / kPa", "released / (uJ/m^2)"],
               [[event.kind, event.penetration * 1e6, event.mean_pressure / 1e3, (event.energy_released or 0.0) * 1e6]
                for event in result.events])
