"""The boundary element solver of this project as a route: all answers, at a tolerance."""

from typing import Any

import numpy as np

import bem
from bem.scene.result import Event, Result
from bem.scene.state import State
from validation.harness.arrays import FloatArray
from validation.harness.route import Place, Problem
from validation.routes.scenes import contact_of

LEAST_RELEASED = 1e-3  # of the work of adhesion, by a jump that counts: what a fold of rounding size releases is less


def solve(problem: Problem, tolerance: float) -> dict[str, list[Any]]:
    """Solve a problem at a tolerance of the solver, and return all answers."""
    scene = scene_tables(problem) | {"accuracy": {"tolerance": tolerance}}
    if "displacement_amplitudes" in problem.asked:
        at = int(problem.asked["displacement_amplitudes"]["target"]) - 1
        scene["output"] = {"spectra": [problem.targets[at]]}
    return answers(problem, bem.solve(scene))


def scene_tables(problem: Problem) -> dict[str, Any]:
    """Return the tables of the scene file of a problem."""
    tables: dict[str, Any] = {
        "solid": {"youngs_modulus": problem.youngs_modulus, "poisson_ratio": problem.poisson_ratio},
        "profile": {
            "kind": "harmonics",
            "period": problem.period,
            "orders": list(problem.orders),
            "amplitudes": list(problem.amplitudes),
            "phases": list(problem.phases),
        },
        "loading": {"control": problem.control, "targets": list(problem.targets)},
    }
    if problem.work_of_adhesion is not None:
        tables["adhesion"] = {"work_of_adhesion": problem.work_of_adhesion, "slope_term": problem.slope_term}
    return tables if problem.thickness is None else tables | {"layer": {"thickness": problem.thickness}}


def answers(problem: Problem, result: Result) -> dict[str, list[Any]]:
    """Return the answers to a problem from a result; ArithmeticError if the path did not converge."""
    if result.status != "converged":
        raise ArithmeticError(f"{result.status}: {result.failure}")
    targets, values = result.targets, dict[str, Any]()
    for name, asked in problem.asked.items():
        if name == "gap_fraction":
            values[name] = [1 - state.contact_fraction for state in targets]
        elif name == "patches":
            values[name] = [state.n_patches for state in targets]
        elif hasattr(targets[0], name) and name != "edges":
            values[name] = [getattr(state, name) for state in targets]
        elif name == "displacement_amplitudes":
            values[name] = _amplitudes(problem, asked["orders"], result)
        elif "target" in asked:
            values[name] = _at_target(problem, name, asked, targets[int(asked["target"]) - 1])
        else:
            values[name] = _of_events(problem, name, result.events)
    return problem.answered(values)


def _at_target(problem: Problem, name: str, asked: Place, state: State) -> Any:
    """Return the edges, or a field of one state."""
    if name == "edges":
        return np.sort(np.array(state.edges), axis=0).ravel()
    contact = contact_of(problem, state.edges, state.penetration) if state.edges else None
    x = np.asarray(asked["points"])
    if name == "gap_at":
        rigid = problem.height(x) - state.separation
        return (rigid if contact is None else contact.displacement(x)) - rigid
    return _complete_pressure(problem, state, x) if contact is None else contact.pressure(x)


def _amplitudes(problem: Problem, orders: Any, result: Result) -> FloatArray:
    """Return 2 |u_m| = 2 sqrt(q0 C_u(m q0)), m, of the only state with a spectrum."""
    (power,) = (values for name, values in result.fields.items() if name.startswith("C_u_"))
    lines = np.rint(result.fields["q"] * problem.period / (2 * np.pi)).astype(int)
    place = [int(np.flatnonzero(lines == order)[0]) for order in orders]
    return np.asarray(2 * np.sqrt(power[place] * 2 * np.pi / problem.period))


def _complete_pressure(problem: Problem, state: State, x: FloatArray) -> FloatArray:
    """Return the pressure of complete contact: every wave of the profile with its amplitude over c(q)."""
    orders, amplitudes, phases = problem.harmonics
    q = 2 * np.pi / problem.period * orders
    solid = bem.Solid(problem.youngs_modulus, problem.poisson_ratio)
    half_space = 2 / (solid.plane_strain_modulus * q)
    compliance = half_space if problem.thickness is None else bem.Layer(problem.thickness).compliance(solid, q)
    waves = np.cos(np.multiply.outer(x, q) + phases) @ (amplitudes / compliance)
    return np.asarray(state.mean_pressure + waves)


def _of_events(problem: Problem, name: str, events: tuple[Event, ...]) -> Any:
    """Return a quantity of the events of the path: dissipated energy, jump pressures or pull-off."""
    if name == "dissipated_energy":
        return sum(event.energy_released or 0.0 for event in events)
    if name == "jump_mean_pressures":
        least = LEAST_RELEASED * (problem.work_of_adhesion or 0.0)
        first = [event.kind for event in events].index("first_touch") + 1
        return [event.mean_pressure for event in events[first:] if (event.energy_released or 0.0) > least]
    (last,) = (event for event in events if event.kind == "pull_off")
    return last.penetration if name == "pull_off_penetration" else last.mean_pressure
