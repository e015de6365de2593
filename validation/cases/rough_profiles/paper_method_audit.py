"""The solver audited by the paper's own method: other cells, another iteration, another minimisation, no code shared.

Its second-order error is taken away by extrapolation in 1/cells^2, (4 fine - coarse) / 3; the uncertainty left is that
of one level of extrapolation, from three grids.  On the rough path it starts from first touch on its own and makes its
own contacts; on the state with many patches it starts from edges moved at random by up to a twentieth of their edge
scale and finds its own.  The FEM reference cannot reach either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import bem
from bem.scene.result import State
from bem.scene.scene import Scene, parse_scene
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, marks, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Reference, Row, Table
from validation.references import adapters
from validation.references.paper_method import PaperState, Surface, follow, solve
from validation.references.posed_contacts import Posed, scene_tables, scenes

MOVED = 0.05  # of its edge scale: how far an edge is moved before the audit finds it again
STEPS = 40
RESIDUAL, PATH_RESIDUAL, GAP = 1e-7, 1e-5, 1e-3
METHOD = "the paper's own method: graded cells, Gauss-Seidel, Polak-Ribiere"


@dataclass(frozen=True)
class Measured:
    """Errors measured, over their scales: contact fraction, mean pressure, elastic energy, edges."""

    fraction: float
    pressure: float
    energy: float
    edges: float


@dataclass(frozen=True)
class Extrapolated:
    """A quantity on three grids, taken to the limit."""

    value: FloatArray
    uncertainty: float

    @classmethod
    def of(cls, coarse: FloatArray, middle: FloatArray, fine: FloatArray) -> Extrapolated:
        """From three grids, each with half the cells of the next; the uncertainty is the change by one level."""
        last, before = (4 * fine - middle) / 3, (4 * middle - coarse) / 3
        return cls(last, float(np.max(np.abs(last - before))))


def _solved(posed: Posed) -> State:
    tables = scene_tables(posed) | {"accuracy": {"tolerance": 1e-8}}
    return _last(parse_scene(tables))


def _last(scene: Scene) -> State:
    result = bem.solve(scene)
    if result.status != "converged":
        raise ArithmeticError(f"solver: {result.status}")
    return result.targets[-1]


def _audited(surface: Surface, penetration: float, edges: FloatArray, cells: Sequence[int]) -> list[PaperState]:
    """States on grids of these cells, the first from the given edges, each next from those found."""
    states: list[PaperState] = []
    for count in cells:
        states.append(solve(surface, penetration, edges, count, RESIDUAL, GAP))
        if states[-1].status != "converged":
            raise ArithmeticError(f"paper's method at {count} cells: {states[-1].message}")
        edges = states[-1].edges
    return states


def _outcome(
    name: str, state: State, states: list[PaperState], cells: Sequence[int], surface: Surface, measured: Measured
) -> Outcome:
    """Rows, table and figure of a state of the solver against three grids of the paper's method."""
    heights = np.asarray(surface.amplitudes, dtype=np.float64) / surface.unit_height
    scales = surface.unit_pressure * float(np.sqrt(np.sum((surface.order * heights) ** 2) / 2))
    patches = [float(len(found.edges)) for found in states]
    rows = [
        counted("patches on every grid", Reference(kind="independent code", source=METHOD), patches,
                [float(state.n_patches)] * len(states)),
    ]  # fmt: skip
    period = surface.period
    quantities = (
        ("contact fraction", "", 1.0, state.contact_fraction, [s.contact_fraction for s in states], measured.fraction),
        ("mean pressure over E* h'_rms / 2", "Pa", scales, state.mean_pressure,
         [s.mean_pressure for s in states], measured.pressure),
        ("elastic energy, relative", "J/m^2", state.elastic_energy, state.elastic_energy,
         [s.elastic_energy / period for s in states], measured.energy),
    )  # fmt: skip
    for quantity, unit, scale, computed, found, error in quantities:
        rows.append(_row(quantity, unit, scale, np.array([computed]), [np.array([v]) for v in found], error))
    if len(set(patches)) == 1 and patches[0] == state.n_patches:
        computed_edges = _listed(np.array(state.edges), period)
        found_edges = [_listed(found.edges, period) for found in states]
        rows.append(_row("edges over the period", "m", period, computed_edges, found_edges, measured.edges))
    apart = [abs(found.contact_fraction - state.contact_fraction) for found in states]
    sizes = [float(found.unknowns) for found in states]
    figure = drawn(f"{name}-cells",
                   "Contact fraction of the paper's method less that of the solver, against its cells.",
                   loglog("cells", "difference of the contact fraction",
                          marks("paper's method", sizes, apart),
                          trace("second order", sizes, [apart[-1] * (sizes[-1] / n) ** 2 for n in sizes])))  # fmt: skip
    table = Table(caption="The audit on its grids.",
                  columns=["cells per patch", "cells", "patches", "contact fraction", "mean pressure / Pa", "|G/w - 1|",
                           "smallest gap / m", "pressures", "sweeps"],
                  rows=[[count, found.unknowns, len(found.edges), found.contact_fraction, found.mean_pressure,
                         found.residual, found.smallest_gap, found.evaluations, found.sweeps]
                        for count, found in zip(cells, states, strict=True)])  # fmt: skip
    counts = {"cells": states[-1].unknowns, "patches": state.n_patches}
    return Outcome(rows=tuple(rows), figures=(figure,), tables=(table,), counts=counts)


def _row(quantity: str, unit: str, scale: float, computed: FloatArray, found: list[FloatArray], measured: float) -> Row:
    limit = Extrapolated.of(*found)
    return compared(quantity, unit,
                    Reference(kind="independent code", source=f"{METHOD}; extrapolated", uncertainty=limit.uncertainty),
                    limit.value.ravel(), computed.ravel(), 2.5 * measured, measured, "maximum over states", scale,
                    pinned="converged")  # fmt: skip


def _listed(edges: FloatArray, period: float) -> FloatArray:
    """Edges (L, 2) with every left one in [0, period), in order."""
    shifted = edges - np.floor(edges[:, :1] / period) * period
    return np.asarray(shifted[np.argsort(shifted[:, 0])])


def _surface(scene: Scene) -> Surface:
    """A scene of the registry as the paper's method takes it."""
    profile = scene.surface()
    assert scene.adhesion is not None
    return Surface(
        scene.solid.youngs_modulus, scene.solid.poisson_ratio, profile.period, profile.orders, profile.amplitudes,
        profile.phases, scene.adhesion.work_of_adhesion, scene.adhesion.slope_term,
    )  # fmt: skip


def _layer() -> Outcome:
    posed = scenes()["layer"]
    state = _solved(posed)
    cells = (16, 32, 64)
    states = _audited(posed.surface(), posed.penetration, np.array([[0.004, 0.006], [0.009, 0.011]]), cells)
    return _outcome("paper-method-layer", state, states, cells, posed.surface(), MEASURED["layer"])


def _path() -> Outcome:
    posed = scenes()["rough"]
    state, surface = _solved(posed), posed.surface()
    way = np.linspace(0.0, posed.penetration, STEPS + 1)[1:]
    path = follow(surface, way, 6, PATH_RESIDUAL, GAP)
    if path[-1].status != "converged":
        raise ArithmeticError(f"path of the paper's method: {path[-1].message}")
    cells = (8, 16, 32)
    states = _audited(surface, posed.penetration, path[-1].edges, cells)
    return _outcome("paper-method-path", state, states, cells, surface, MEASURED["path"])


def _many() -> Outcome:
    scene = adapters.scene(
        "rough_100",
        {"profile": {"harmonics": 300}, "loading": {"targets": [25e-6]}, "accuracy": {"tolerance": 1e-8}},
    )
    state, surface = _last(scene), _surface(scene)
    edges = np.array(state.edges)
    behind = np.append(edges[1:, 0], edges[0, 0] + surface.period) - edges[:, 1]
    width = np.diff(edges, axis=1)[:, 0]
    scale = np.stack([np.minimum(width, np.roll(behind, 1)), np.minimum(width, behind)], axis=1)
    moved = edges + MOVED * scale * np.random.default_rng(0).uniform(-1, 1, edges.shape)
    cells = (4, 8, 16)
    states = _audited(surface, state.penetration, moved, cells)
    return _outcome("paper-method-many", state, states, cells, surface, MEASURED["many"])


MEASURED = {
    "layer": Measured(fraction=4.7e-7, pressure=7.7e-7, energy=9.8e-7, edges=2e-7),
    "path": Measured(fraction=8.3e-7, pressure=7e-8, energy=4.3e-7, edges=2e-7),
    "many": Measured(fraction=2.2e-5, pressure=3.3e-7, energy=2.1e-6, edges=1.1e-5),
}

CASES = (
    Case(id="paper-method-layer", group="paper's method", level="quick",
         problem="two crests on a layer",
         question="Does the paper's own method find the same two contacts on a layer?",
         equations="minimum of $U$ over the edges; second order in 1/cells, extrapolated",
         sources=("carbone2009", "carbone2008"), compute=_layer, effects=("layer", "adhesion")),
    Case(id="paper-method-path", group="paper's method", level="standard",
         problem="rough profile of 60 harmonics, path",
         question="Does it, from first touch on a rough profile, through all events, end in the same state?",
         equations="40 steps of penetration; contacts made where the profile enters, joined and lost as they vanish",
         sources=("carbone2009",), compute=_path, effects=("half_space", "adhesion", "slope_term")),
    Case(id="paper-method-many", group="paper's method", level="full",
         question="Is a state with dozens of contacts, its edges moved at random, found again by the paper's method?",
         equations="edges moved by up to a twentieth of their edge scale, then minimised on three grids, extrapolated",
         sources=("carbone2009",), compute=_many, effects=("half_space", "adhesion", "slope_term"),
         scene=adapters.scene_text("rough_100")),
)  # fmt: skip
