"""The method of Carbone, Scaraggi, Tartaglino (2009), written anew: cells on the contacts, minimisation of the energy.

It needs adhesion, and goes up a path of penetrations in steps; nothing is said of unloading in the paper.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from validation.references.paper_method import Surface, follow

STEPS = 30  # of the path to the deepest target
RESIDUAL, GAP = 1e-4, 1e-3  # max |G/w - 1|; interpenetration in rms heights that makes no new contact
MOST = 100  # harmonics: the cost of a descent grows with the cube of the cells


def solve(problem: dict[str, Any], cells: int) -> dict[str, Any]:
    """The states of a path of loading."""
    raw, solid, path = problem["profile"], problem["solid"], problem["path"]
    if "adhesion" not in problem:
        raise NotImplementedError("contact without adhesion: the energy is flat at its minimum")
    if path["control"] == "mean_pressure":
        raise NotImplementedError("load control")
    if len(raw["orders"]) > MOST:
        raise NotImplementedError(f"more than {MOST} harmonics: hours")
    surface = Surface(
        solid["youngs_modulus"], solid["poisson_ratio"], raw["period"], tuple(raw["orders"].tolist()),
        tuple(raw["amplitudes"].tolist()), tuple(raw["phases"].tolist()), problem["adhesion"]["work_of_adhesion"],
        problem["adhesion"]["slope_term"], problem.get("layer", {}).get("thickness"),
    )  # fmt: skip
    highest = surface.highest * surface.unit_height
    depths = path["targets"] if path["control"] == "penetration" else highest - path["targets"]
    loading = depths[: int(np.argmax(depths)) + 1]
    way = np.union1d(np.linspace(0, loading[-1], STEPS + 1)[1:], loading)
    states = dict(zip(way, follow(surface, way, cells, RESIDUAL, GAP), strict=False))
    found = [states.get(depth) for depth in loading]
    if found[-1] is None or found[-1].status != "converged":
        raise ArithmeticError("the path ends before its deepest target")
    rest = [None] * (len(depths) - len(loading))
    last, answers = found[-1], dict[str, Any]()
    answers["contact_fraction"] = [state.contact_fraction for state in found if state] + rest
    answers["mean_pressure"] = [state.mean_pressure for state in found if state] + rest
    answers["elastic_energy"] = [state.elastic_energy / raw["period"] for state in found if state] + rest
    answers["patches"] = [len(state.edges) for state in found if state] + rest
    if "edges" in problem["asked"]:
        answers["edges"] = np.ravel(np.sort(last.edges, axis=0))
    asked = problem["asked"].get("gap_at")
    if asked and asked["target"] <= len(found):
        answers["gap_at"] = found[asked["target"] - 1].gap(asked["points"])
    return {name: value for name, value in answers.items() if name in problem["asked"]}


cells_4, cells_8, cells_16 = (partial(solve, cells=n) for n in (4, 8, 16))
