"""The boundary element solver of this project: everything that is asked, at a tolerance."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import bem
from bem.scene.result import Event, Result, State
from bem.solver import solve as solve_scene
from validation.harness.arrays import FloatArray

LEAST_RELEASED = 1e-3  # of the work of adhesion, by a jump that counts: what a fold of rounding size releases is less


def tables(problem: dict[str, Any], tolerance: float, increment: float = 1.0) -> dict[str, Any]:
    """The scene of a problem; `increment` multiplies the largest increment of its path."""
    scene: dict[str, Any] = {name: problem[name] for name in ("solid", "layer", "adhesion") if name in problem}
    names = ("period", "orders", "amplitudes", "phases")
    scene["profile"] = {"kind": "harmonics"} | {name: problem["profile"][name] for name in names}
    scene["loading"] = {name: problem["path"][name] for name in ("control", "targets")}
    scene["accuracy"] = {"tolerance": tolerance, "max_increment": 0.05 * increment}
    if "displacement_amplitudes" in problem["asked"]:
        at = int(problem["asked"]["displacement_amplitudes"]["target"]) - 1
        scene["output"] = {"spectra": [float(problem["path"]["targets"][at])]}
    return scene


def solve(problem: dict[str, Any], tolerance: float) -> dict[str, Any]:
    """All answers, at a tolerance of the solver."""
    return answers(problem, solve_scene(tables(problem, tolerance)))


def answers(problem: dict[str, Any], result: Result) -> dict[str, Any]:
    """What is asked, from a result; ArithmeticError where the path did not converge."""
    if result.status != "converged":
        raise ArithmeticError(f"{result.status}: {result.failure}")
    targets, found = result.targets, dict[str, Any]()
    for name, asked in problem["asked"].items():
        if name == "gap_fraction":
            found[name] = [1 - state.contact_fraction for state in targets]
        elif name == "patches":
            found[name] = [state.n_patches for state in targets]
        elif hasattr(targets[0], name) and name != "edges":
            found[name] = [getattr(state, name) for state in targets]
        elif name == "displacement_amplitudes":
            found[name] = _amplitudes(problem, asked["orders"], result)
        elif "target" in asked:
            found[name] = _at_target(problem, name, asked, targets[int(asked["target"]) - 1])
        else:
            found[name] = _of_events(problem, name, result.events)
    return found


def _at_target(problem: dict[str, Any], name: str, asked: dict[str, Any], state: State) -> Any:
    """Edges, or a field of one state."""
    if name == "edges":
        return np.sort(np.array(state.edges), axis=0).ravel()
    contact = contact_of(problem, state.edges, state.penetration) if state.edges else None
    x = np.asarray(asked["points"])
    if name == "gap_at":
        rigid = _rigid(problem, state, x)
        return (rigid if contact is None else contact.displacement(x)) - rigid
    return _complete_pressure(problem, state, x) if contact is None else contact.pressure(x)


def _amplitudes(problem: dict[str, Any], orders: Any, result: Result) -> FloatArray:
    """2 |u_m| = 2 sqrt(q0 C_u(m q0)), m, of the only state with a spectrum."""
    (power,) = (values for name, values in result.fields.items() if name.startswith("C_u_"))
    lines = np.rint(result.fields["q"] * problem["profile"]["period"] / (2 * np.pi)).astype(int)
    place = [int(np.flatnonzero(lines == order)[0]) for order in orders]
    return np.asarray(2 * np.sqrt(power[place] * 2 * np.pi / problem["profile"]["period"]))


def contact_of(problem: dict[str, Any], edges: Any, penetration: float) -> bem.ContactState:
    """The elastic state at edges and penetration."""
    raw = problem["profile"]
    profile = bem.Profile.from_harmonics(raw["period"], raw["orders"], raw["amplitudes"], raw["phases"])
    layer = bem.Layer(problem["layer"]["thickness"]) if "layer" in problem else None
    return bem.ContactState(profile, bem.Solid(**problem["solid"]), edges, penetration, layer)


def _rigid(problem: dict[str, Any], state: State, x: FloatArray) -> FloatArray:
    """Height of the profile over the undeformed face, m."""
    raw = problem["profile"]
    phase = 2 * np.pi / raw["period"] * np.multiply.outer(x, raw["orders"]) + raw["phases"]
    return np.asarray(np.cos(phase) @ raw["amplitudes"] - state.separation)


def _complete_pressure(problem: dict[str, Any], state: State, x: FloatArray) -> FloatArray:
    """In complete contact with a half-space."""
    if "layer" in problem:
        raise NotImplementedError("pressure of complete contact with a layer")
    raw, solid = problem["profile"], problem["solid"]
    q = 2 * np.pi / raw["period"] * raw["orders"]
    modulus = solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)
    waves = np.cos(np.multiply.outer(x, q) + raw["phases"]) @ (modulus * q * raw["amplitudes"] / 2)
    return np.asarray(state.mean_pressure + waves)


def _of_events(problem: dict[str, Any], name: str, events: tuple[Event, ...]) -> Any:
    """What the jumps of the path say."""
    if name == "dissipated_energy":
        return sum(event.energy_released or 0.0 for event in events)
    if name == "jump_mean_pressures":
        work = problem["adhesion"]["work_of_adhesion"]
        first = [event.kind for event in events].index("first_touch") + 1
        jumps = [event for event in events[first:] if (event.energy_released or 0.0) > LEAST_RELEASED * work]
        return [event.mean_pressure for event in jumps]
    (last,) = (event for event in events if event.kind == "pull_off")
    return last.penetration if name == "pull_off_penetration" else last.mean_pressure


tol_1e_3, tol_1e_6, tol_1e_9, tol_1e_12 = (partial(solve, tolerance=value) for value in (1e-3, 1e-6, 1e-9, 1e-12))
