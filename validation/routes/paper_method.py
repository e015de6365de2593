"""The method of Carbone, Scaraggi, Tartaglino (2009), written anew: cells on the contacts, minimisation of the energy.

It needs adhesion, and goes up a path of penetrations in steps, or directly from the overlap of the undeformed shapes;
nothing is said of unloading in the paper.
"""

from typing import Any

import numpy as np

from validation.harness.route import Answer, Laps, Problem
from validation.references.paper_method import follow
from validation.references.paper_method import solve as solve_state
from validation.references.posed_contacts import highest, overlap, surface_of

STEPS = 30  # of the path to the deepest target
RESIDUAL, GAP = 1e-4, 1e-3  # max |G/w - 1|; interpenetration in rms heights that makes no new contact
MOST = 100  # harmonics: the cost of a descent grows with the cube of the cells


def solve(problem: Problem, cells: int, steps: int = STEPS, residual: float = RESIDUAL) -> Answer:
    """The states of a path of loading in so many steps; in none: the only state, from the overlap."""
    if problem.work_of_adhesion is None:
        raise NotImplementedError("contact without adhesion: the energy is flat at its minimum")
    if problem.control == "mean_pressure":
        raise NotImplementedError("load control")
    if len(problem.orders) > MOST:
        raise NotImplementedError(f"more than {MOST} harmonics: hours")
    laps = Laps()
    surface, targets = surface_of(problem), np.array(problem.targets)
    depths = targets if problem.control == "penetration" else highest(problem) - targets
    loading = depths[: int(np.argmax(depths)) + 1]
    way = np.union1d(np.linspace(0, loading[-1], steps + 1)[1:], loading)
    start = None if steps else overlap(problem)
    laps.end("setup")
    if start is None:
        states = follow(surface, way, cells, residual, GAP)
    else:
        states = [solve_state(surface, loading[-1], start, cells, residual, GAP)]
    laps.end("solve")
    reached = dict(zip(way, states, strict=False))
    found = [reached.get(depth) for depth in loading]
    last = found[-1]
    if last is None or last.status != "converged":
        why = "" if last is None else f": {last.status}: {last.message}"
        raise ArithmeticError(f"the path ends before its deepest target{why}")
    there = [state for state in found if state]
    values: dict[str, Any] = {
        "contact_fraction": problem.padded(state.contact_fraction for state in there),
        "mean_pressure": problem.padded(state.mean_pressure for state in there),
        "elastic_energy": problem.padded(state.elastic_energy / problem.period for state in there),
        "patches": problem.padded(len(state.edges) for state in there),
        "edges": np.ravel(np.sort(last.edges, axis=0)),
    }
    asked = problem.asked.get("gap_at")
    if asked and asked["target"] <= len(there):
        values["gap_at"] = there[int(asked["target"]) - 1].gap(np.asarray(asked["points"]))
    counts = {
        "evaluations": sum(state.evaluations for state in states),
        "sweeps": sum(state.sweeps for state in states),
        "patches": len(last.edges),
    }
    laps.end("post")
    return Answer(values=problem.answered(values), unknowns=last.unknowns, counts=counts, parts=laps.parts)
