"""Second routes to the answers, each as a function of a problem and of the solver's result for it.

- dense algebra: Newton on the closure from each state of the solver, by the plain dense evaluation of
  dense_equilibrium.py; the spectrum by a Gauss-Chebyshev quadrature of the pressure on edges and penetration;
- finite elements: the quartic elements of `fem_reference`, with the uncertainty of its three meshes;
- the path at a tenth of the increment, which answers everything that depends on it;
- the paper's method on the same path, extrapolated from 16 and 32 cells a contact.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import fem_reference
from bem.scene.result import Result
from bem.scene.scene import parse_scene
from bem.solver import solve as solve_scene
from fem_reference import Resolution
from validation.challenge.entrants import boundary_elements
from validation.harness.arrays import FloatArray
from validation.references.dense_equilibrium import reference

Route = tuple[dict[str, FloatArray], dict[str, FloatArray]]  # values, and the route's own uncertainties
FINEST = Resolution(4, 8, 18)
STATE = ("contact_fraction", "mean_pressure", "separation", "elastic_energy", "stress_intensity_max")
NODES = 400  # of the quadrature of the pressure, on every patch


def dense(problem: dict[str, Any], result: Result) -> Route:
    """Scalars of every state by dense algebra; states apart have none of their own."""
    scene = parse_scene(_plain(boundary_elements.tables(problem, 1e-12)))
    states = [reference(scene, state) if state.edges else None for state in result.targets]
    found = {}
    for name in (*STATE, "gap_fraction"):
        if name in problem["asked"]:
            source = "contact_fraction" if name == "gap_fraction" else name
            values = [0.0 if state is None else state[source] for state in states]
            found[name] = 1 - np.array(values) if name == "gap_fraction" else np.array(values)
            if name == "separation":
                apart = [target.separation for target in result.targets]
                found[name] = np.array([a if s is None else s[name] for a, s in zip(apart, states, strict=True)])
    if "displacement_amplitudes" in problem["asked"]:
        found["displacement_amplitudes"] = _amplitudes(problem, result)
    return found, {}


def _amplitudes(problem: dict[str, Any], result: Result) -> FloatArray:
    """(1/period) int pressure exp(-i q x) dx over the contacts, times twice the compliance 2 / (E* q)."""
    asked, solid = problem["asked"]["displacement_amplitudes"], problem["solid"]
    period, state = float(problem["profile"]["period"]), result.targets[int(asked["target"]) - 1]
    contact = boundary_elements.contact_of(problem, state.edges, state.penetration)
    angle = np.pi * (np.arange(NODES) + 0.5) / NODES
    edges = np.array(state.edges)
    middle, half = edges.mean(axis=1)[:, None], np.diff(edges, axis=1) / 2
    x = middle + half * np.cos(angle)
    weight = half * np.sin(angle) * np.pi / NODES
    q = 2 * np.pi / period * np.asarray(asked["orders"])
    modes = np.exp(-1j * np.multiply.outer(q, x.ravel())) @ (contact.pressure(x) * weight).ravel() / period
    modulus = solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)
    return np.asarray(2 * np.abs(modes) * 2 / (modulus * q))


def finite_elements(problem: dict[str, Any], result: Result) -> Route:
    """The last state on three meshes."""
    raw, adhesion = problem["profile"], problem.get("adhesion", {})
    found = fem_reference.solve(
        youngs_modulus=problem["solid"]["youngs_modulus"],
        poisson_ratio=problem["solid"]["poisson_ratio"],
        thickness=problem["layer"]["thickness"],
        period=raw["period"],
        harmonics=(raw["orders"], raw["amplitudes"], raw["phases"]),
        control=problem["path"]["control"],
        value=float(problem["path"]["targets"][-1]),
        work_of_adhesion=adhesion.get("work_of_adhesion", 0.0),
        slope_term=adhesion.get("slope_term", False),
        patches=result.targets[-1].n_patches,
        resolution=FINEST,
    )
    if found.status != "converged":
        raise ArithmeticError(f"{problem['name']}: finite elements: {found.status}: {found.message}")
    return fem_answers(problem, found)


def fem_answers(problem: dict[str, Any], found: fem_reference.Result) -> Route:
    """What is asked, from a state of the finite elements, with its uncertainties."""
    period, spread = float(problem["profile"]["period"]), found.uncertainty
    known: dict[str, tuple[Any, Any]] = {
        "contact_fraction": (found.contact_fraction, spread["contact_fraction"]),
        "mean_pressure": (found.mean_pressure, spread["mean_pressure"]),
        "elastic_energy": (found.elastic_energy / period, np.asarray(spread["elastic_energy"]) / period),
        "edges": (np.ravel(found.edges), np.ravel(spread["edges"])),
        "stress_intensity_max": (np.max(found.stress_intensity), np.max(spread["stress_intensity"])),
        "patches": (len(found.edges), 0.0),
    }
    asked = {name: pair for name, pair in known.items() if name in problem["asked"]}
    return tuple({name: np.atleast_1d(np.asarray(pair[i], float)) for name, pair in asked.items()} for i in (0, 1))  # type: ignore[return-value]


def tenth_of_the_increment(problem: dict[str, Any], result: Result) -> Route:
    """Everything, on a path of ten times as many increments."""
    finer = solve_scene(boundary_elements.tables(problem, 1e-12, increment=0.1))
    answers = boundary_elements.answers(problem, finer)
    return {name: np.atleast_1d(np.asarray(value, float)) for name, value in answers.items()}, {}


def _plain(value: Any) -> Any:
    """Arrays as lists."""
    if isinstance(value, dict):
        return {name: _plain(content) for name, content in value.items()}
    return value.tolist() if isinstance(value, np.ndarray) else value


ROUTES = {
    "dense algebra": dense,
    "finite elements": finite_elements,
    "path at a tenth of the increment": tenth_of_the_increment,
}
