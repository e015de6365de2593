"""The boundary element solver of this project on a problem of the challenge (challenge/README.md): all answers."""

from typing import Any

import numpy as np

import bem
from bem.scene.result import Event, Result
from bem.scene.state import State
from validation.harness.arrays import FloatArray

LEAST_RELEASED = 1e-3  # of the work of adhesion, by a jump that counts: what a fold of rounding size releases is less

Problem = dict[str, Any]  # tables of a problem.toml


def solve(problem: Problem, tolerance: float) -> dict[str, list[Any]]:
    """Solve a problem at a tolerance, and return all answers; ArithmeticError if the path does not converge."""
    profile = {key: problem["profile"][key] for key in ("period", "orders", "amplitudes", "phases")}
    scene: dict[str, Any] = {table: problem[table] for table in ("solid", "layer", "adhesion") if table in problem}
    scene |= {"profile": {"kind": "harmonics"} | profile, "loading": problem["path"]}
    scene["accuracy"] = {"tolerance": tolerance}
    if asked := problem["asked"].get("displacement_amplitudes"):
        scene["output"] = {"spectra": [problem["path"]["targets"][asked["target"] - 1]]}
    result = bem.solve(scene)
    if result.status != "converged":
        raise ArithmeticError(f"{result.status}: {result.failure}")
    values = {name: _answer(problem, name, place, result) for name, place in problem["asked"].items()}
    return {name: np.atleast_1d(value).tolist() for name, value in values.items()}


def _answer(problem: Problem, name: str, place: dict[str, Any], result: Result) -> Any:
    """Return one quantity: of all targets, of the target and points or orders of a place, or of the events."""
    targets = result.targets
    if name == "gap_fraction":
        return [1 - state.contact_fraction for state in targets]
    if name == "patches":
        return [state.n_patches for state in targets]
    if name == "displacement_amplitudes":
        return _amplitudes(problem["profile"]["period"], place["orders"], result)
    if "target" in place:
        return _at_target(problem, name, place, targets[place["target"] - 1])
    if hasattr(targets[0], name):
        return [getattr(state, name) for state in targets]
    return _of_events(problem, name, result.events)


def _at_target(problem: Problem, name: str, place: dict[str, Any], state: State) -> Any:
    """Return the edges, or a field of one state."""
    if name == "edges":
        return np.sort(np.array(state.edges), axis=0).ravel()
    given, x = problem["profile"], np.asarray(place["points"])
    profile = bem.Profile.from_harmonics(given["period"], given["orders"], given["amplitudes"], given["phases"])
    solid, layer = bem.Solid(**problem["solid"]), bem.Layer(**problem["layer"]) if "layer" in problem else None
    contact = bem.ContactState(profile, solid, state.edges, state.penetration, layer) if state.edges else None
    if name == "gap_at":
        rigid = profile.height(x) - state.separation
        return (rigid if contact is None else contact.displacement(x)) - rigid
    if contact is not None:
        return contact.pressure(x)
    q = 2 * np.pi / given["period"] * np.array(given["orders"])  # complete contact: every wave over its compliance
    compliance = 2 / (solid.plane_strain_modulus * q) if layer is None else layer.compliance(solid, q)
    waves = np.cos(np.multiply.outer(x, q) + given["phases"]) @ (given["amplitudes"] / compliance)
    return state.mean_pressure + waves


def _amplitudes(period: float, orders: Any, result: Result) -> FloatArray:
    """Return 2 |u_m| = 2 sqrt(q0 C_u(m q0)), m, of the only state with a spectrum."""
    (power,) = (values for name, values in result.fields.items() if name.startswith("C_u_"))
    lines = np.rint(result.fields["q"] * period / (2 * np.pi)).astype(int)
    place = [int(np.flatnonzero(lines == order)[0]) for order in orders]
    return np.asarray(2 * np.sqrt(power[place] * 2 * np.pi / period))


def _of_events(problem: Problem, name: str, events: tuple[Event, ...]) -> Any:
    """Return a quantity of the events of the path: dissipated energy, jump pressures or pull-off."""
    if name == "dissipated_energy":
        return sum(event.energy_released or 0.0 for event in events)
    if name == "jump_mean_pressures":
        least = LEAST_RELEASED * problem.get("adhesion", {}).get("work_of_adhesion", 0.0)
        first = [event.kind for event in events].index("first_touch") + 1
        return [event.mean_pressure for event in events[first:] if (event.energy_released or 0.0) > least]
    (last,) = (event for event in events if event.kind == "pull_off")
    return last.penetration if name == "pull_off_penetration" else last.mean_pressure
