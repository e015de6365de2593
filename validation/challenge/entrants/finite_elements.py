"""The finite element reference of this project: single states of few contacts, on one mesh after its scouting mesh.

It finds edges of its own from a number of contacts, here that of the crests above the undeformed face.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from fem_reference.mesh import Resolution
from fem_reference.result import quantities
from fem_reference.solve import closed, control_of, problem_of
from validation.harness.arrays import FloatArray

DEPTH = 3.0  # periods: a layer so thick is the half-space within 1e-12
POINTS = 4096
HALVINGS = 14  # of the elements at an edge


def solve(problem: dict[str, Any], order: int, cells: int) -> dict[str, Any]:
    """Every target as a state of its own."""
    raw, solid, adhesion = problem["profile"], problem["solid"], problem.get("adhesion", {})
    path = problem["path"]
    if len(raw["orders"]) > 4 or path["control"] == "separation":
        raise NotImplementedError("a few contacts, whose number is known, at given penetration or load")
    if adhesion and len(path["targets"]) > 1:
        raise NotImplementedError("paths of loading and unloading")
    thickness = problem.get("layer", {}).get("thickness", DEPTH * raw["period"])
    posed = problem_of(
        solid["youngs_modulus"], solid["poisson_ratio"], thickness, raw["period"],
        (raw["orders"], raw["amplitudes"], raw["phases"]), adhesion.get("work_of_adhesion", 0.0),
        adhesion.get("slope_term", False),
    )  # fmt: skip
    patches = _crests(problem) if path["control"] == "penetration" else 1
    states = []
    for target in path["targets"]:
        closures = closed(posed, control_of(posed, path["control"], target), [Resolution(order, cells, HALVINGS)],
                          patches, 1.0)  # fmt: skip
        if closures[-1].outcome not in ("converged", "complete_contact"):
            raise ArithmeticError(f"{closures[-1].outcome}: {closures[-1].message}")
        states.append(quantities(closures[-1].evaluation))
    return {name: value for name, value in _answers(problem, states).items() if name in problem["asked"]}


def _answers(problem: dict[str, Any], states: list[Any]) -> dict[str, Any]:
    period, raw = problem["profile"]["period"], problem["profile"]
    highest = _heights(raw, np.linspace(0, period, POINTS)).max()
    return {
        "contact_fraction": [state["contact_fraction"] for state in states],
        "gap_fraction": [1 - state["contact_fraction"] for state in states],
        "mean_pressure": [state["mean_pressure"] for state in states],
        "separation": [highest - state["penetration"] for state in states],
        "elastic_energy": [state["elastic_energy"] / period for state in states],
        "patches": [len(state["edges"]) for state in states],
        "edges": np.ravel(states[-1]["edges"]),
        "stress_intensity_max": [np.max(state["stress_intensity"]) for state in states],
    }


def _crests(problem: dict[str, Any]) -> int:
    """Intervals of a period in which the profile is above the undeformed face."""
    raw = problem["profile"]
    height = _heights(raw, np.arange(POINTS) * (raw["period"] / POINTS))
    inside = height > height.max() - problem["path"]["targets"][-1]
    return int(np.sum(inside & ~np.roll(inside, 1)))


def _heights(raw: dict[str, Any], x: FloatArray) -> FloatArray:
    phase = 2 * np.pi / raw["period"] * np.multiply.outer(x, raw["orders"]) + raw["phases"]
    return np.asarray(np.cos(phase) @ raw["amplitudes"])


p2_6, p2_12, p4_6 = (partial(solve, order=p, cells=n) for p, n in ((2, 6), (2, 12), (4, 6)))
