"""Layers along whole paths: thin and incompressible ones against doubled resolution, thick ones against none at all.

The reference is dense algebra with twice the nodes it needs (dense_equilibrium.py), at the control of each state; for
complete contact the pressure of the layer, and for a layer as thick as to be left out the half-space itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import bem
from bem.scene.result import Result, State
from bem.scene.scene import Scene
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Figure, Panel, Reference, Row, Table
from validation.references import adapters
from validation.references.closed_forms import layer_compliance
from validation.references.dense_equilibrium import reference

QUANTITIES = {
    "mean_pressure": "mean pressure",
    "contact_fraction": "contact fraction",
    "elastic_energy": "elastic energy",
}
REQUIRED = 1e-10


def _scenes() -> dict[str, Scene]:
    """The layers compared, by name."""
    mild: dict[str, Any] = {"solid": {"poisson_ratio": 0.3}}
    driven = {"control": "total_displacement", "targets": [20e-6, 60e-6, 90e-6, 50e-6]}  # of the plate
    return {
        "nu = 0.5, adhesion": adapters.scene("thin_layer"),
        "nu = 0.5": adapters.scene("thin_layer", {"adhesion": None}),
        "nu = 0.3, adhesion": adapters.scene("thin_layer", mild),
        "nu = 0.3, driven by its plate": adapters.scene("thin_layer", {**mild, "loading": driven}),
    }


def errors(posed: Scene, states: tuple[State, ...]) -> dict[str, tuple[list[float], list[float]]]:
    """Computed and expected values of every quantity at the states with edges."""
    touching = [state for state in states if state.edges]
    known = [reference(posed, state, refinement=2) for state in touching]
    return {
        name: ([getattr(state, name) for state in touching], [values[name] for values in known]) for name in QUANTITIES
    }


def _layer_path() -> Outcome:
    scenes = _scenes()
    results = {name: bem.solve(posed) for name, posed in scenes.items()}
    doubled = Reference(kind="independent code", source="dense algebra with doubled resolution")
    rows, found = [], {}
    for name, posed in scenes.items():
        found[name] = errors(posed, results[name].targets)
        for quantity, words in QUANTITIES.items():
            computed, expected = found[name][quantity]
            rows.append(
                compared(f"{words}, d = 0.02 wavelengths, {name}, over the largest",
                         {"mean_pressure": "Pa", "contact_fraction": "", "elastic_energy": "J/m^2"}[quantity], doubled,
                         expected, computed, REQUIRED, MEASURED, "maximum over states",
                         max(abs(value) for value in expected), basis="required"),
            )  # fmt: skip
    rows += [_certificates(results), *_thick(), _complete()]
    unknowns = max(state.unknowns for result in results.values() for state in result.states)
    evaluations = sum(state.evaluations for result in results.values() for state in result.states)
    return Outcome(
        rows=tuple(rows),
        figures=(_figure(results, found),),
        tables=(_table(found, results),),
        counts={"unknowns": unknowns, "evaluations": evaluations},
    )


def _certificates(results: dict[str, Result]) -> Row:
    bad = sum(not state.certificate.ok for result in results.values() for state in result.states)
    return counted("states whose certificate is not ok",
                   Reference(kind="exact", source="every state of the paths is an equilibrium"), [0.0],
                   [float(bad)])  # fmt: skip


def _thick() -> tuple[Row, Row]:
    """A layer of four periods changes the compliance by 1e-19: left out with a note, and nothing else changes."""
    thick = bem.solve(adapters.scene("thin_layer", {"layer": {"thickness": 0.04}}))
    none = bem.solve(adapters.scene("thin_layer", {"layer": None}))
    note = next(effect for effect in thick.effects if effect.name == "layer")
    said = float(not note.active and "left out" in note.reason)
    exact = Reference(kind="exact", source="the layer is thicker than any wave reaches")
    return (
        counted("layer of four periods left out, with a note in effects (1: yes)", exact, [1.0], [said]),
        compared("mean pressure of that layer, over the largest of the half-space", "Pa", exact,
                 [state.mean_pressure for state in none.targets], [state.mean_pressure for state in thick.targets],
                 1e-13, 0.0, "maximum over states", max(abs(state.mean_pressure) for state in none.targets),
                 basis="required"),
    )  # fmt: skip


def _complete() -> Row:
    """D / c(q0), the pressure that just closes the last gap of a sinusoid on a thin incompressible layer, bracketed."""
    amplitude, period, thickness = 1e-4, 0.01, 2e-4
    exact = amplitude / float(layer_compliance(2 * np.pi / period, thickness, 1e6, 0.5))
    targets = [exact * (1 - 1e-6), exact * (1 + 1e-6)]
    profile = {"kind": "harmonics", "orders": [1], "amplitudes": [amplitude], "phases": [0.0]}
    changes: dict[str, Any] = {
        "adhesion": None,
        "profile": profile | adapters.NOT_SELF_AFFINE,
        "loading": {"control": "mean_pressure", "targets": targets},
    }
    joined = [state.status == "complete_contact" for state in bem.solve(adapters.scene("thin_layer", changes)).targets]
    found = exact if joined == [False, True] else None
    return compared("pressure of complete contact of a sinusoid, bracketed to 1e-6", "Pa",
                    Reference(kind="exact", source="compliance of a bonded incompressible layer"), [exact], [found],
                    1e-6, 0.0, basis="required")  # fmt: skip


def _table(found: dict[str, dict[str, tuple[list[float], list[float]]]], results: dict[str, Result]) -> Table:
    return Table(caption="Largest relative error against doubled resolution along each path, d = 0.02 wavelengths.",
                 columns=["path", "states", "events", *QUANTITIES.values()],
                 rows=[[name, len(results[name].targets), len(results[name].events),
                        *(float(f"{max(abs(np.subtract(*pair))) / max(abs(value) for value in pair[1]):.1e}")
                          for pair in found[name].values())]
                       for name in found])  # fmt: skip


def _figure(results: dict[str, Result], found: dict[str, dict[str, tuple[list[float], list[float]]]]) -> Figure:
    half_space = bem.solve(adapters.scene("thin_layer", {"layer": None}))
    shown = {name: results[name] for name in ("nu = 0.5, adhesion", "nu = 0.3, adhesion")} | {"half-space": half_space}
    below = []
    for name in ("nu = 0.5, adhesion", "nu = 0.5"):
        computed, expected = found[name]["mean_pressure"]
        at = [state.separation * 1e6 for state in results[name].targets if state.edges]
        relative = (np.subtract(computed, expected) / max(abs(value) for value in expected)).tolist()
        below.append(marks(name, at, relative))
    series = []
    for name, result in shown.items():
        touching = [state for state in result.states if state.edges]
        pressures = [state.mean_pressure / 1e3 for state in touching]
        style = "dashed" if name == "half-space" else "line"
        series.append(trace(name, [state.separation * 1e6 for state in touching], pressures, style))
    return drawn(
        "thin-layer-path",
        "Loading and unloading on a layer of 0.02 wavelengths and on a half-space; below, bem less reference.",
        Panel(xlabel="separation / um", ylabel="mean pressure / kPa", yscale="symlog", series=series),
        axes("separation / um", "relative to the largest", *below),
    )


MEASURED = 1.1e-11

CASES = (
    Case(
        id="layer-path",
        group="layer",
        level="standard",
        question="Do thin and incompressible layers keep their accuracy along whole paths, with adhesion and without?",
        equations=(
            r"$c(q) = \frac{2}{E^\ast q} "
            r"\frac{(3 - 4 \nu) \sinh 2qd - 2qd}{(3 - 4 \nu) \cosh 2qd + 2 (qd)^2 + 5 - 12 \nu + 8 \nu^2}$"
        ),
        sources=("carbone2008",),
        compute=_layer_path,
        effects=("layer", "adhesion", "slope_term", "unloading"),
        scene=adapters.scene_text("thin_layer"),
    ),
)
