"""Second routes to the answers, each as a function of a problem and of the solver's result for it.

- dense algebra: Newton on the closure from each state of the solver, by the plain dense evaluation of
  dense_equilibrium.py; the spectrum by a Gauss-Chebyshev quadrature of the pressure on edges and penetration;
- finite elements: the quartic elements of `fem_reference`, with the uncertainty of its three meshes;
- the path at a tenth of the increment, which answers everything that depends on it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bem.scene.result import Result
from bem.scene.scene import parse_scene
from fem_reference import Resolution
from validation.harness.arrays import FloatArray
from validation.harness.route import Answer, Problem
from validation.references.dense_equilibrium import reference
from validation.routes import boundary_elements
from validation.routes.finite_elements import finest

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
    contact = boundary_elements.contact_of(problem, state.edges, state.penetration)
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
