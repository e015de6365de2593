"""What speaks against the result of any scene: vocabulary, targets, numbers, certificates, identities, energy balance.

Nothing here knows what a scene should give; it knows what any result must obey.  A check takes the scene and its
result and returns findings, each of a kind that studies count; an empty list means that nothing was found.

Energy balance.  Between two stored states of a path the potential Pi of its control changes by the work of the
conjugate force f less what events release,

    penetration, separation:   Pi = U,                 tau = Delta,              f = p,
    total displacement:        Pi = U + c(0) p^2 / 2,  tau = Delta + c(0) p,     f = p,
    mean pressure:             Pi = U - p Delta,       tau = p,                  f = -Delta,

because jumps happen at fixed tau.  The work is the integral of f over tau by Hermite's rule on values and slopes
(the contact stiffness) at the stored states; its quadrature error is taken as the difference from the rule of the next
lower order, and an interval that its states do not resolve is not judged.  Energies per nominal area, SI units.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np

from bem.geometry.scaling import Scales, Solid
from bem.scene.result import FINAL_STATUSES, STATUSES, Event, Result, State
from bem.scene.scene import Scene
from validation.corpus.hard.hard_case_run import Answered, Finding
from validation.corpus.hard.hard_case_scenes import mean_compliance

EVENT_KINDS = ("first_touch", "new_contact", "coalescence", "detachment", "pull_off", "complete_contact", "opening",
               "bifurcation")  # fmt: skip

EPS = float(np.finfo(float).eps)
ROUNDINGS = 24.0  # of the height of the profile, seen through the stiffness of the state
TARGET = 1e-11  # of the unit of the controlled quantity
IDENTITY = 1e-12  # of the unit of the quantity
RELEASED = 1e-12  # of E* a^2 / period: rounding of the energy that an event releases
SAFETY = 7.5  # times the difference of two rules; measured 3.0, and 5.6 where events lie between
RESOLVED = 0.01  # of the energies of an interval: its quadrature error, above which it is not judged
BALANCE = 1e-6  # of the energies of an interval


@dataclass(frozen=True)
class Units:
    """Natural units of a scene: rms height (of a flat profile: period), pressure, energy per area; its constants."""

    period: float
    height: float
    pressure: float
    energy: float
    highest: float
    compliance: float

    @classmethod
    def of(cls, scene: Scene) -> Units:
        """The units of a scene."""
        surface = scene.surface()
        solid = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio)
        highest = 0.0 if surface.is_flat else surface.max_height
        height = surface.rms_height or surface.period
        scales = Scales(surface.period, height, solid.plane_strain_modulus)
        compliance = mean_compliance(scene.resolved())
        return cls(surface.period, height, scales.stress, scales.energy_per_area, highest, compliance)

    def scales(self, state: State) -> dict[str, float]:
        """What differences of the numbers of a state are measured against."""
        return {
            "mean_pressure": max(self.pressure, abs(state.mean_pressure)),
            "contact_fraction": 1.0,
            "penetration": max(self.height, self.highest),
            "elastic_energy": max(self.energy, abs(state.elastic_energy)),
            "adhesion_energy": max(self.energy, abs(state.adhesion_energy)),
        }

    def soft(self, state: State) -> float:
        """Pressure by which rounding of the height of the profile is seen through the stiffness of a state."""
        return ROUNDINGS * EPS * self.highest * abs(state.contact_stiffness or 0.0)

    def unit(self, scene: Scene) -> float:
        """Of the controlled quantity."""
        if scene.loading.control == "mean_pressure":
            return self.pressure
        height = max(self.height, self.highest)
        if scene.loading.control == "total_displacement":
            return max(height, self.compliance * self.pressure)
        return height


@dataclass(frozen=True)
class Solved(Answered):
    """A scene and its result, as copies and checks take them; the folder holds its files."""

    result: Result
    scene: Scene
    folder: Path

    @cached_property
    def units(self) -> Units:
        """Of the scene."""
        return Units.of(self.scene)

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - nu^2), of its own."""
        return self.scene.solid.youngs_modulus / (1 - self.scene.solid.poisson_ratio**2)

    @property
    def pressure(self) -> float:
        """h'_rms E* / 2, against which errors of hard cases are measured."""
        return 0.5 * self.scene.surface().rms_slope * self.plane_strain_modulus

    @property
    def touching(self) -> list[State]:
        """Target states that have patches and gaps."""
        return [state for state in self.result.targets if state.edges]

    @property
    def closest(self) -> State:
        """The one of largest contact."""
        return max(self.touching, key=lambda state: state.contact_fraction)


def findings_of(found: Solved) -> list[Finding]:
    """All that a result itself says against it."""
    checks = (vocabulary, targets, numbers, identities, released, energy_balance)
    return [finding for check in checks for finding in check(found)]


def vocabulary(found: Solved) -> Iterator[Finding]:
    """Names of statuses, branches and events; and certificates, which every state kept must have."""
    result = found.result
    names: list[tuple[str, tuple[str, ...]]] = [(result.status, STATUSES)]
    names += [(state.status, STATUSES) for state in result.states]
    names += [(state.branch, ("loading", "unloading")) for state in result.states]
    names += [(event.kind, EVENT_KINDS) for event in result.events]
    for name in dict.fromkeys(name for name, known in names if name not in known):
        yield Finding("vocabulary", f"{name!r} is no name of the contract")
    for k, state in enumerate(result.states):
        if state.status in FINAL_STATUSES and not state.certificate.ok:
            yield Finding("certificate", f"not ok in state {k}: {asdict(state.certificate)}")
    counts = [0, *(state.events or 0 for state in result.states)]
    if np.any(np.diff(counts) < 0) or (result.status == "converged" and counts[-1] != len(result.events)):
        yield Finding("vocabulary", f"{len(result.events)} events, counted {counts}")


def targets(found: Solved) -> Iterator[Finding]:
    """Every target met in order, or a path that ends by name at one that may be out of reach."""
    result, units, loading = found.result, found.units, found.scene.loading
    goals = list(loading.targets)
    stop = loading.stop_at_mean_pressure
    asked = [*loading.at_mean_pressures, *(() if stop is None else (stop,))]
    met, unit = 0, units.unit(found.scene)
    for state in result.targets:
        if state.status not in FINAL_STATUSES:
            break
        controlled = getattr(state, loading.control)
        value = math.nan if controlled is None else float(controlled)
        digit = units.soft(state)  # in narrow gaps
        goal = goals[met] if met < len(goals) else math.nan
        if abs(value - goal) <= TARGET * unit + 8 * EPS * abs(goal):
            met += 1
            if loading.control == "separation" and goal == 0 and state.status != "complete_contact":
                reported = f"{state.status}, contact fraction {state.contact_fraction:.9g}"
                yield Finding("targets", f"separation 0 is complete contact, not {reported}")
        elif any(abs(state.mean_pressure - p) <= TARGET * max(units.pressure, abs(p)) + digit for p in asked):
            if result.status == "converged" and state.mean_pressure == result.states[-1].mean_pressure and stop:
                close = TARGET * max(units.pressure, stop) + digit
                goals = goals[:met] if abs(state.mean_pressure - stop) <= close else goals
        else:
            yield Finding("targets", f"{loading.control} {value:.17g} where {goal:.17g} is the target")
            return
    if result.status == "converged" and met < len(goals):
        yield Finding("targets", f"converged with {met} of {len(goals)} targets met")
    if result.status == "unreachable" and not (met < len(goals) and _may_be_unreachable(found, goals[met])):
        yield Finding("unreachable", f"target {met} of {goals} can be reached")
    if result.status in ("separated", "complete_contact", "interrupted"):
        yield Finding("targets", f"the path ends {result.status}")


def _may_be_unreachable(found: Solved, goal: float) -> bool:
    """Whether a target may lie beyond every equilibrium: tension, and penetration beyond complete contact."""
    control, units = found.scene.loading.control, found.units
    if control == "mean_pressure":
        return goal < 0
    limited = control == "penetration" or (control == "total_displacement" and units.compliance == 0)
    return limited and goal > units.highest


def numbers(found: Solved) -> Iterator[Finding]:
    """No NaN and no infinity, but for the load of complete contact where the control leaves it open.

    That includes the events at its ends: with adhesion the last gap closes, and opens, under a tension without bound.
    """
    scene, result, control = found.scene, found.result, found.scene.loading.control
    free = control in ("separation", "penetration") or (control == "total_displacement" and found.units.compliance == 0)
    for k, state in enumerate(result.states):
        if state.status not in FINAL_STATUSES:
            continue
        values = {f"error_estimate.{name}": value for name, value in vars(state.error_estimate).items()}
        if not (free and state.status == "complete_contact"):
            values["mean_pressure"] = state.mean_pressure
        wrong = [name for name, value in values.items() if value is not None and not math.isfinite(value)]
        if wrong:
            yield Finding("not finite", f"{', '.join(wrong)} of state {k} ({state.status})")
    for k, event in enumerate(result.events):
        unbounded = (
            free and scene.adhesion is not None and event.kind in ("complete_contact", "opening")
        )  # the tension on the last gap
        names = ("penetration", "position") if unbounded else ("penetration", "mean_pressure", "position")
        values = {name: getattr(event, name) for name in names}
        known = vars(event.error_estimate)
        values |= {f"error_estimate.{name}": known[name] for name in names if name in known}
        if any(value is not None and not math.isfinite(value) for value in values.values()):
            yield Finding("not finite", f"event {k} ({event.kind}): {values}")
    for name, array in result.fields.items():
        outside = name.startswith("pressure_")
        if np.any(np.isinf(array)) or (not outside and np.any(np.isnan(array))):
            yield Finding("fields", f"{name} holds values that are not numbers")


def identities(found: Solved) -> Iterator[Finding]:
    """What the numbers of one state have to do with one another."""
    units = found.units
    height = max(units.height, units.highest)
    for k, state in enumerate(found.result.states):
        if state.status not in FINAL_STATUSES:
            continue
        edges = np.array(state.edges).reshape(-1, 2)
        width = float(np.sum(edges[:, 1] - edges[:, 0])) / units.period
        joined = state.status == "complete_contact"
        energy = max(units.energy, abs(state.elastic_energy), abs(state.adhesion_energy))
        wrong = {
            "separation + penetration": abs(state.separation + state.penetration - units.highest)
            / max(height, abs(state.penetration)),
            "patches": float(state.n_patches != len(edges)),
            "contact fraction": abs(state.contact_fraction - (1.0 if joined else width)),
            "order of the edges": float(
                np.any(np.diff(edges.ravel()) <= 0) or np.any((edges[:, 0] < 0) | (edges[:, 0] >= units.period))
            ),
            "total energy": abs(state.elastic_energy + state.adhesion_energy - state.total_energy) / energy,
            "edges": float((state.status == "converged") != bool(len(edges))),
            "elastic energy below 0": float(state.elastic_energy < -IDENTITY * energy),
        }
        reported = [f"{name} ({value:.1e})" for name, value in wrong.items() if value > IDENTITY]
        if reported:
            yield Finding("identity", f"{', '.join(reported)} of state {k} ({state.status})")


def released(found: Solved) -> Iterator[Finding]:
    """No event takes energy up, beyond its own error: one that opens or closes continuously releases none."""
    for k, event in enumerate(found.result.events):
        error = RELEASED * found.units.energy + (event.error_estimate.energy_released or 0.0)
        if event.energy_released is not None and event.energy_released < -error:
            yield Finding("energy released", f"event {k} ({event.kind}) releases {event.energy_released:.2e} J/m^2")


@dataclass(frozen=True)
class Mark:
    """A place on the path: control value, force, its slope (nan: unknown), potential."""

    value: float
    force: float
    slope: float
    potential: float


@dataclass(frozen=True)
class Balance:
    """Energy of the interval before a state: what is missing, the quadrature error, and the energies it is made of."""

    state: int
    missing: float
    quadrature: float
    energies: float
    events: int


def energy_balance(found: Solved) -> Iterator[Finding]:
    """Work of the load = change of energy + released, between the stored states that resolve it.

    Flat profiles have exact answers and no events.
    """
    if found.scene.surface().is_flat:
        return
    for part in balances(found):
        if part.quadrature > RESOLVED * part.energies:
            continue
        if not abs(part.missing) <= SAFETY * part.quadrature + BALANCE * part.energies + EPS * found.units.energy:
            share, bar = part.missing / part.energies, part.quadrature / part.energies
            reported = f"{share:.1e} of the energies missing before state {part.state}, quadrature {bar:.1e}"
            yield Finding("energy balance", f"{reported}, {part.events} events")


def balances(found: Solved) -> Iterator[Balance]:
    """The balance of every interval with finite numbers, from first touch on."""
    scene, result, units = found.scene, found.result, found.units
    apart = None  # without adhesion the compliance at first touch has no bound, and no rule for the integral holds
    if scene.loading.initial == "separated" and scene.adhesion is not None:
        apart = Mark(0.0, 0.0, 0.0, 0.0)
    marks = [mark(scene, state, units) for state in result.states]
    counts = [0, *(state.events or 0 for state in result.states)]
    groups = [result.events[first:last] for first, last in pairwise(counts)]
    for k, (before, after, events) in enumerate(zip([apart, *marks], marks, groups, strict=False)):
        flawed = scene.loading.flaw is not None and any(event.kind == "opening" for event in events)
        unknown = any(None in (event.energy_released, event.error_estimate.energy_released) for event in events)
        if before is None or flawed or unknown:
            continue  # energies of complete contact know nothing of a flaw (bem/path/opening.py)
        freed = math.fsum(float(event.energy_released or 0.0) for event in events)
        work, error = _work(scene, units, before, after, events)
        change = after.potential - before.potential
        energies = abs(before.potential) + abs(after.potential) + abs(work) + abs(freed)
        if math.isfinite(change + work + freed) and energies > 0:
            yield Balance(k, change + freed - work, error, energies, len(events))


def mark(scene: Scene, state: State, units: Units) -> Mark:
    """A state as place on the path; not finite where it has no energy or load, or was not reached."""
    stiffness, p = state.contact_stiffness or 0.0, state.mean_pressure
    energy = state.total_energy if state.status in FINAL_STATUSES else math.nan
    if scene.loading.control == "mean_pressure":
        slope = -1 / stiffness if stiffness else 0.0
        return Mark(*place(scene, state, units), slope, energy - p * state.penetration)
    c = units.compliance if scene.loading.control == "total_displacement" else 0.0
    slope = stiffness / (1 + c * stiffness)
    if state.status == "complete_contact":
        slope = 1 / c if c else math.nan
    return Mark(*place(scene, state, units), slope, energy + c * p**2 / 2)


def place(scene: Scene, at: State | Event, units: Units) -> tuple[float, float]:
    """Control value and force of a state, or at the end of the branch from which an event jumps."""
    if scene.loading.control == "mean_pressure":
        return at.mean_pressure, -at.penetration
    c = units.compliance if scene.loading.control == "total_displacement" else 0.0
    return at.penetration + (c * at.mean_pressure if c else 0.0), at.mean_pressure


def _work(scene: Scene, units: Units, before: Mark, after: Mark, events: tuple[Event, ...]) -> tuple[float, float]:
    """Integral of the force over the control value from one state to the next, and its quadrature error."""
    places = [place(scene, event, units) for event in events]
    if not places:
        step = after.value - before.value
        plain = step * (before.force + after.force) / 2
        if scene.adhesion is None and min(before.value, after.value) < 0 < max(before.value, after.value):
            places = [(0.0, 0.0)]  # without adhesion the surfaces part where they met
        else:
            secant = (after.force - before.force) / step if step else before.slope
            bends = (before.slope - after.slope, before.slope - secant, after.slope - secant)
            return plain + step**2 * bends[0] / 12, step**2 * max(map(abs, bends)) / 12
    first, last = places[0], places[-1]
    step = first[0] - before.value
    plain = step * (before.force + first[1]) / 2
    work = step * (2 * before.force + first[1]) / 3 + step**2 * before.slope / 6
    error = abs(work - plain)
    for here, there in pairwise(places):
        step = there[0] - here[0]
        work += step * there[1]  # the force behind a jump is not stored
        error += abs(step * (there[1] - here[1]))
    step = after.value - last[0]
    return work + step * after.force - step**2 * after.slope / 2, error + abs(step**2 * after.slope) / 2
