"""The answers made anew: closed forms where there are, else the solver at its finest, beside the second routes.

Second routes, each a function of a problem and of the solver's result for it:

- dense algebra: Newton on the closure from each state of the solver, by the plain dense evaluation of
  dense_equilibrium.py; the spectrum by a Gauss-Chebyshev quadrature of the pressure on edges and penetration;
- finite elements: the quartic elements of `fem_reference`, with the uncertainty of its three meshes;
- the path at a tenth of the increment, which answers everything that depends on it.

Uncertainties: of closed forms FLOOR of the scale, rounding; of the solver the largest of its own estimate, of the
difference to each route as fine as itself (dense algebra, the path at a tenth of the increment) and of FLOOR.
Finite elements are coarser than the solver: their difference is shown beside their own uncertainty and adds nothing.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bem.scene.atomic_file import write_atomically
from bem.scene.result import Result
from bem.scene.scene import parse_scene
from bem.solver import solve as solve_scene
from fem_reference import Resolution
from validation.challenge.closed_answers import CLOSED
from validation.challenge.problem import ANSWERS_FILE, COUNTS, PROBLEM_FILE, Certified, Check, Shipped, scale_of
from validation.challenge.problem import problem as shipped
from validation.challenge.worker import with_arrays
from validation.harness.arrays import FloatArray
from validation.harness.route import Answer, Problem
from validation.routes import boundary_elements
from validation.routes.dense_algebra import reference
from validation.routes.finite_elements import finest
from validation.routes.scenes import contact_of

FLOOR = 1e-12  # of the scale; closed forms and solver differ by up to 4e-13
SOLVER = "boundary elements at tolerance 1e-12"
FEW_CONTACTS = ("two-crests-thick", "three-crests", "two-crests-thin")  # which finite elements can do
OF_PULL_OFF = {"pull_off_penetration": "penetration", "pull_off_mean_pressure": "mean_pressure"}
AS_FINE = ("dense algebra", "path at a tenth of the increment")  # as the solver


def certified(name: str, second: bool = True) -> Shipped:
    """A problem with its answers made anew; `second`: by the second routes as well, without which there are no checks.

    ChallengeError where there is no such problem, ArithmeticError where a route does not converge.
    """
    one = shipped(name)
    data = with_arrays(one.data)
    problem = Problem.of(data)
    result = solve_scene(boundary_elements.tables(problem, 1e-12))
    ours = boundary_elements.answers(problem, result)
    values: Mapping[str, Any]
    if name in CLOSED:
        values, made, estimates, beside = CLOSED[name](data), "closed form", {}, {SOLVER: Answer(values=ours)}
    else:
        values, made = ours, SOLVER
        estimates = {quantity: _estimates(result, quantity) for quantity in ours}
        routes = ("finite elements", "dense algebra") if name in FEW_CONTACTS else AS_FINE
        beside = {route: ROUTES[route](problem, result) for route in routes if second}
    answers = {}
    for quantity, asked in data["asked"].items():
        value = np.array(values[quantity], dtype=np.float64)
        scale, checks = scale_of(quantity, value.tolist()), _checks(quantity, value, beside)
        spread = np.full(value.size, 0.0 if quantity in COUNTS else FLOOR * scale)
        for known in (estimates.get(quantity), *(check.difference for check in checks if check.route in AS_FINE)):
            if known:
                spread = np.maximum(spread, np.abs(known))
        answers[quantity] = Certified(asked["unit"], tuple(value.tolist()), tuple(spread.tolist()), scale, made, checks)
    return replace(one, answers=answers)


def write(one: Shipped, folder: Path) -> None:
    """Write problem.toml, answers.json and answers.csv into folder/NAME."""
    place = folder / one.name
    place.mkdir(parents=True, exist_ok=True)
    for file, text in ((PROBLEM_FILE, one.text), (ANSWERS_FILE, one.json_text), ("answers.csv", one.csv_text)):
        write_atomically(place / file, text)


def _checks(quantity: str, value: FloatArray, beside: Mapping[str, Answer]) -> tuple[Check, ...]:
    """How far other routes are from values (n,)."""
    checks = []
    for route, answer in beside.items():
        if quantity in answer.values:
            spread = answer.uncertainty.get(quantity)
            known = "" if spread is None else f", known to {np.max(spread):.1g}"
            apart = np.abs(np.array(answer.values[quantity], dtype=np.float64) - value)
            checks.append(Check(route + known, tuple(float(f"{one:.2g}") for one in apart)))
    return tuple(checks)


def _estimates(result: Result, name: str) -> tuple[float, ...]:
    """The solver's own, of every state or of its events; none for what it does not estimate."""
    if name == "dissipated_energy":  # a difference of energies as large as these
        return (FLOOR * max(abs(state.elastic_energy) for state in result.states),)
    if name in OF_PULL_OFF:
        (last,) = (event for event in result.events if event.kind == "pull_off")
        return (getattr(last.error_estimate, OF_PULL_OFF[name]) or 0.0,)
    source = "contact_fraction" if name == "gap_fraction" else name
    found = [getattr(state.error_estimate, source, None) for state in result.targets]
    return () if any(value is None for value in found) else tuple(map(float, found))  # type: ignore[arg-type]


FINEST = Resolution(4, 8, 18)
STATE = ("contact_fraction", "mean_pressure", "separation", "elastic_energy", "stress_intensity_max")
NODES = 400  # of the quadrature of the pressure, on every patch


def dense(problem: Problem, result: Result) -> Answer:
    """Scalars of every state by dense algebra; states apart have none of their own."""
    scene = parse_scene(boundary_elements.tables(problem, 1e-12))
    states = [reference(scene, state) if state.edges else None for state in result.targets]
    found = {name: np.array([0.0 if state is None else state[name] for state in states]) for name in STATE}
    found["gap_fraction"] = 1 - found["contact_fraction"]
    apart = [state is None for state in states]
    found["separation"][apart] = [target.separation for target in np.array(result.targets)[apart]]
    if "displacement_amplitudes" in problem.asked:
        found["displacement_amplitudes"] = _amplitudes(problem, result)
    return Answer(values=problem.answered(found))


def _amplitudes(problem: Problem, result: Result) -> FloatArray:
    """(1/period) int pressure exp(-i q x) dx over the contacts, times twice the compliance 2 / (E* q)."""
    asked = problem.asked["displacement_amplitudes"]
    state = result.targets[int(asked["target"]) - 1]
    contact = contact_of(problem, state.edges, state.penetration)
    angle = np.pi * (np.arange(NODES) + 0.5) / NODES
    edges = np.array(state.edges)
    middle, half = edges.mean(axis=1)[:, None], np.diff(edges, axis=1) / 2
    x = middle + half * np.cos(angle)
    weight = half * np.sin(angle) * np.pi / NODES
    q = 2 * np.pi / problem.period * np.asarray(asked["orders"])
    modes = np.exp(-1j * np.multiply.outer(q, x.ravel())) @ (contact.pressure(x) * weight).ravel() / problem.period
    modulus = problem.youngs_modulus / (1 - problem.poisson_ratio**2)
    return np.asarray(2 * np.abs(modes) * 2 / (modulus * q))


ROUTES: dict[str, Callable[[Problem, Result], Answer]] = {
    "dense algebra": dense,
    "finite elements": lambda problem, result: finest(problem, FINEST, result.targets[-1].n_patches),
    "path at a tenth of the increment": lambda problem, _: boundary_elements.solve(problem, 1e-12, 0.1),
}
