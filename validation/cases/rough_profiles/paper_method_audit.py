"""The solver audited by the paper's own method: other cells, another iteration, another minimisation, no code shared.

Its second-order error is taken away by extrapolation in 1/cells^2, (4 fine - coarse) / 3; the uncertainty left is that
of one level of extrapolation, from three grids.  On the rough path it starts from first touch on its own and makes its
own contacts; on the state with many patches it starts from edges moved at random by up to a twentieth of their edge
scale and finds its own.  The FEM reference cannot reach either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bem.scene.result import State
from bem.scene.scene import parse_scene
from validation.cases.shared.checks import OVER_STATES, Against, Found, beside, case, column, posed
from validation.corpus.effects import solved
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import drawn, loglog, marks, table, trace
from validation.references.paper_method import PaperState, Surface, follow, solve
from validation.references.posed_contacts import Posed, scene_tables, scenes

MOVED = 0.05  # of its edge scale: how far an edge is moved before the audit finds it again
STEPS = 30
RESIDUAL, PATH_RESIDUAL, GAP = 1e-7, 1e-5, 1e-3
METHOD = "the paper's own method: graded cells, Gauss-Seidel, Polak-Ribiere"
# errors measured, over their scales: contact fraction, mean pressure, elastic energy, edges
MEASURED = {
    "layer": (4.7e-7, 7.7e-7, 9.8e-7, 2e-7),
    "path": (1.8e-6, 2e-7, 7.5e-7, 3.6e-7),
    "many": (2.2e-5, 3.3e-7, 2.1e-6, 1.1e-5),
}


@dataclass(frozen=True)
class Limit:
    """A quantity on three grids, taken to the limit."""

    value: FloatArray
    uncertainty: float

    @classmethod
    def of(cls, coarse: FloatArray, middle: FloatArray, fine: FloatArray) -> Limit:
        """From three grids, each with half the cells of the next; the uncertainty is the change by one level."""
        last, before = (4 * fine - middle) / 3, (4 * middle - coarse) / 3
        return cls(last, float(np.max(np.abs(last - before))))


def _solved(posed: Posed) -> State:
    return solved(parse_scene(scene_tables(posed) | {"accuracy": {"tolerance": 1e-8}})).targets[-1]


def _audited(surface: Surface, penetration: float, edges: FloatArray, cells: Sequence[int]) -> list[PaperState]:
    """States on grids of these cells, the first from the given edges, each next from those found."""
    states: list[PaperState] = []
    for count in cells:
        states.append(solve(surface, penetration, edges, count, RESIDUAL, GAP))
        if states[-1].status != "converged":
            raise ArithmeticError(f"paper's method at {count} cells: {states[-1].message}")
        edges = states[-1].edges
    return states


def _audit(name: str, state: State, states: list[PaperState], cells: Sequence[int], surface: Surface) -> Found:
    """A state of the solver against three grids of the paper's method."""
    heights, period = np.asarray(surface.amplitudes, dtype=np.float64) / surface.unit_height, surface.period
    unit = surface.unit_pressure * float(np.sqrt(np.sum((surface.order * heights) ** 2) / 2))
    fractions, energy = column(states, "contact_fraction"), state.elastic_energy
    patches = [len(found.edges) for found in states]
    compared: list[tuple[str, str, float, Any, list[Any]]] = [
        ("contact fraction", "", 1.0, state.contact_fraction, fractions),
        ("mean pressure over E* h'_rms / 2", "Pa", unit, state.mean_pressure, column(states, "mean_pressure")),
        ("elastic energy, relative", "J/m^2", energy, energy, column(states, "elastic_energy", period)),
    ]
    if set(patches) == {state.n_patches}:
        edges = [_listed(found.edges, period) for found in states]
        compared.append(("edges over the period", "m", period, _listed(np.array(state.edges), period), edges))
    yield Against("paper's method", METHOD).count("patches on every grid", patches, [state.n_patches] * len(states))
    for (quantity, unit_name, scale, computed, found), measured in zip(compared, MEASURED[name], strict=False):
        limit = Limit.of(*map(np.asarray, found))
        yield Against("paper's method", f"{METHOD}; extrapolated", limit.uncertainty).row(
            quantity, unit_name, np.ravel(limit.value), np.ravel(computed), measured, OVER_STATES, scale)  # fmt: skip
    apart, sizes = [abs(fraction - state.contact_fraction) for fraction in fractions], column(states, "unknowns")
    yield drawn(f"paper-method-{name}-cells",
                "Contact fraction of the paper's method less that of the solver, against its cells.",
                loglog("cells", "difference of the contact fraction", marks("paper's method", sizes, apart),
                       trace("second order", sizes, [apart[-1] * (sizes[-1] / n) ** 2 for n in sizes])))  # fmt: skip
    told = {"contact fraction": "contact_fraction", "mean pressure / Pa": "mean_pressure", "|G/w - 1|": "residual",
            "smallest gap / m": "smallest_gap", "pressures": "evaluations", "sweeps": "sweeps"}  # fmt: skip
    yield table("The audit on its grids.",
                {"cells per patch": cells, "cells": sizes, "patches": patches}
                | {heading: column(states, name) for heading, name in told.items()})  # fmt: skip
    yield {"cells": states[-1].unknowns, "patches": state.n_patches}


def _listed(edges: FloatArray, period: float) -> FloatArray:
    """Edges (L, 2) with every left one in [0, period), in order."""
    shifted = edges - np.floor(edges[:, :1] / period) * period
    return np.asarray(shifted[np.argsort(shifted[:, 0])])


def _layer() -> Found:
    posed = scenes()["layer"]
    state, surface, cells = _solved(posed), posed.surface(), (16, 32, 64)
    states = _audited(surface, posed.penetration, np.array([[0.004, 0.006], [0.009, 0.011]]), cells)
    return _audit("layer", state, states, cells, surface)


def _path() -> Found:
    posed = scenes()["rough"]
    state, surface, cells = _solved(posed), posed.surface(), (6, 12, 24)
    path = follow(surface, np.linspace(0.0, posed.penetration, STEPS + 1)[1:], 6, PATH_RESIDUAL, GAP)
    if path[-1].status != "converged":
        raise ArithmeticError(f"path of the paper's method: {path[-1].message}")
    return _audit("path", state, _audited(surface, posed.penetration, path[-1].edges, cells), cells, surface)


def _many() -> Found:
    scene = posed("rough_100", profile={"harmonics": 300}, loading={"targets": [25e-6]}, accuracy={"tolerance": 1e-8})
    state, profile, cells = solved(scene).targets[-1], scene.surface(), (4, 8, 16)
    assert scene.adhesion is not None
    surface = Surface(
        scene.solid.youngs_modulus, scene.solid.poisson_ratio, profile.period, profile.orders, profile.amplitudes,
        profile.phases, scene.adhesion.work_of_adhesion, scene.adhesion.slope_term,
    )  # fmt: skip
    edges = np.array(state.edges)
    moved = edges + MOVED * beside(edges, surface.period) * np.random.default_rng(0).uniform(-1, 1, edges.shape)
    return _audit("many", state, _audited(surface, state.penetration, moved, cells), cells, surface)


CASES = (
    case("paper-method-layer", "paper's method", _layer,
         "Does the paper's own method find the same two contacts on a layer?",
         "minimum of $U$ over the edges; second order in 1/cells, extrapolated",
         "carbone2009 carbone2008", "layer adhesion", problem="two crests on a layer"),
    case("paper-method-path", "paper's method", _path,
         "Does it, from first touch on a rough profile, through all events, end in the same state?",
         "30 steps of penetration; contacts made where the profile enters, joined and lost as they vanish",
         "carbone2009", "half_space adhesion slope_term", level="standard",
         problem="rough profile of 60 harmonics, path"),
    case("paper-method-many", "paper's method", _many,
         "Is a state with dozens of contacts, its edges moved at random, found again by the paper's method?",
         "edges moved by up to a twentieth of their edge scale, then minimised on three grids, extrapolated",
         "carbone2009", "half_space adhesion slope_term", level="full", scene="rough_100"),
)  # fmt: skip
