"""The finite element reference of this project: single states of few contacts, which find edges of their own.

`solve` takes one mesh after its scouting mesh, and the number of contacts from the crests above the undeformed face;
`finest` takes three meshes, and with them the uncertainty that the reference states of itself.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

import fem_reference
from fem_reference.closure import Evaluation
from fem_reference.face import face_nodes, interpolate
from fem_reference.mesh import Resolution
from fem_reference.result import quantities
from fem_reference.solve import closed, control_of, problem_of
from validation.harness.arrays import FloatArray
from validation.harness.route import Answer, Laps, Problem
from validation.routes.fem_scenes import raw

POINTS = 4096
MOST_HARMONICS = 4


def solve(problem: Problem, setting: tuple[int, int, int], start: FloatArray | None = None) -> Answer:
    """Every target as a state of its own, on a mesh of an order, cells and halvings at an edge.

    From the crests, or from edges near those that are sought, (L, 2) in m.
    """
    if (start is None and len(problem.orders) > MOST_HARMONICS) or problem.control == "separation":
        raise NotImplementedError(f"more than {MOST_HARMONICS} harmonics, or a given separation")
    if problem.work_of_adhesion is not None and len(problem.targets) > 1:
        raise NotImplementedError("paths of loading and unloading")
    laps = Laps()
    posed = problem_of(**raw(problem))
    patches = crests(problem) if problem.control == "penetration" else 1
    laps.end("setup")
    found: list[Evaluation] = []
    for target in problem.targets:
        control = control_of(posed, problem.control, target)  # type: ignore[arg-type]
        last = closed(posed, control, [Resolution(*setting)], patches, 1.0, start)[-1]
        if last.outcome not in ("converged", "complete_contact"):
            raise ArithmeticError(f"{last.outcome}: {last.message}")
        found.append(last.evaluation)
    laps.end("solve")
    every = [quantities(evaluation) for evaluation in found]
    states = [_scalars(problem, state) for state in every]
    highest = problem.height(np.linspace(0, problem.period, POINTS)).max()
    values: dict[str, Any] = {name: [state[name] for state in states] for name in states[0]}
    values |= {
        "gap_fraction": [1 - state["contact_fraction"] for state in every],
        "separation": [highest - state["penetration"] for state in every],
        "patches": [len(np.atleast_1d(state["edges"])) for state in every],
        "edges": np.ravel(every[-1]["edges"]),
    }
    if gap := problem.asked.get("gap_at"):
        values["gap_at"] = _gap(found[int(gap["target"]) - 1], np.asarray(gap["points"]) / problem.period)
    unknowns = max(evaluation.states.unknowns for evaluation in found)
    laps.end("post")
    return Answer(values=problem.answered(values), unknowns=unknowns, counts={"unknowns": unknowns}, parts=laps.parts)


def finest(problem: Problem, resolution: Resolution, patches: int) -> Answer:
    """The last target as a state of so many contacts, on three meshes; ArithmeticError where there is none."""
    found = fem_reference.solve(
        **raw(problem),
        control=problem.control,  # type: ignore[arg-type]
        value=problem.targets[-1],
        patches=patches,
        resolution=resolution,
    )
    if found.status != "converged":
        raise ArithmeticError(f"{problem.id}: finite elements: {found.status}: {found.message}")
    spread = found.uncertainty
    values = _scalars(problem, vars(found)) | {"edges": np.ravel(found.edges), "patches": len(found.edges)}
    uncertainty = _scalars(problem, spread) | {"edges": np.ravel(spread["edges"]), "patches": 0.0}
    if gap := problem.asked.get("gap_at"):
        values["gap_at"], uncertainty["gap_at"] = found.gap(np.asarray(gap["points"])), np.max(spread["gap"])
    return Answer(values=problem.answered(values), uncertainty=problem.answered(uncertainty))


def _scalars(problem: Problem, state: Mapping[str, Any]) -> dict[str, Any]:
    """Of the quantities of a state, or their uncertainties, those that are numbers, energy per area."""
    return {
        "contact_fraction": state["contact_fraction"],
        "mean_pressure": state["mean_pressure"],
        "elastic_energy": np.asarray(state["elastic_energy"]) / problem.period,
        "stress_intensity_max": np.max(state["stress_intensity"]),
    }


def crests(problem: Problem) -> int:
    """Intervals of a period in which the profile is above the undeformed face."""
    height = problem.height(np.arange(POINTS) * (problem.period / POINTS))
    inside = height > height.max() - problem.targets[-1]
    return int(np.sum(inside & ~np.roll(inside, 1)))


def _gap(evaluation: Evaluation, place: FloatArray) -> FloatArray:
    """Gap in m at places over the period, in the elements."""
    states, posed = evaluation.states, evaluation.states.problem
    nodes = face_nodes(states.spaces)
    field = states.fields[0] + evaluation.load * states.fields[1]
    local = (place - states.mesh.seam) % 1.0
    face = interpolate(local, nodes.x, field[states.spaces.sizes[0] + nodes.index], nodes.order)
    plate = float(states.displacement_of_plate[0] + evaluation.load * states.displacement_of_plate[1])
    return np.asarray((face - (posed.height(place) - posed.highest + plate)) * posed.unit_height)
