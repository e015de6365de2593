"""Layers along whole paths: thin and incompressible ones against doubled resolution, thick ones against none at all.

The reference is dense algebra with twice the nodes it needs (dense_equilibrium.py), at the control of each state; for
complete contact the pressure of the layer, and for a layer as thick as to be left out the half-space itself.
"""

from typing import Any

import numpy as np

import bem
from bem.scene.result import Result
from validation.cases.shared.checks import (
    OVER_STATES,
    Against,
    Found,
    case,
    column,
    posed,
    refused,
    solved,
    touching,
    work,
)
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, digits, drawn, marks, table, trace
from validation.harness.schema import Row
from validation.references.adapters import NOT_SELF_AFFINE
from validation.references.closed_forms import layer_compliance
from validation.references.dense_equilibrium import reference

QUANTITIES = {"mean_pressure": "Pa", "contact_fraction": "", "elastic_energy": "J/m^2"}
MILD: dict[str, Any] = {"solid": {"poisson_ratio": 0.3}}
PLATE = {"control": "total_displacement", "targets": [20e-6, 60e-6, 90e-6, 50e-6]}
LAYERS: dict[str, dict[str, Any]] = {  # compared with doubled resolution, by name: changes of the scene
    "nu = 0.5, adhesion": {},
    "nu = 0.5": {"adhesion": None},
    "nu = 0.3, adhesion": MILD,
    "nu = 0.3, driven by its plate": {**MILD, "loading": PLATE},
}
ADHESIVE, INCOMPRESSIBLE = ("nu = 0.5, adhesion", "nu = 0.3, adhesion"), ("nu = 0.5, adhesion", "nu = 0.5")  # drawn


def _layer_path() -> Found:
    doubled, relative = Against("dense algebra", "doubled resolution"), dict[str, list[float]]()
    results: dict[str, Result] = {}
    apart: dict[str, FloatArray] = {}  # mean pressures less those of doubled resolution, over the largest
    for name, changes in LAYERS.items():
        scene = posed("thin_layer", **changes)
        results[name] = bem.solve(scene)
        states, relative[name] = touching(results[name].targets), []
        known = [reference(scene, state, refinement=2) for state in states]
        for key, unit in QUANTITIES.items():
            computed, expected = column(states, key), [values[key] for values in known]
            largest = max(map(abs, expected))
            yield doubled.row(f"{key.replace('_', ' ')}, d = 0.02 wavelengths, {name}, over the largest", unit,
                              expected, computed, 1.1e-11, OVER_STATES, largest, required=1e-10)  # fmt: skip
            relative[name].append(max(abs(np.subtract(computed, expected))) / largest)
            if key == "mean_pressure":
                apart[name] = np.subtract(computed, expected) / largest
    yield Against("exact", "every state of the paths is an equilibrium").count(
        "states whose certificate is not ok", 0.0, refused(*results.values()))  # fmt: skip
    half_space = solved("thin_layer", layer=None)
    yield from _thick(half_space)
    yield _complete()
    yield table("Largest relative error against doubled resolution along each path, d = 0.02 wavelengths.",
                {"path": results, "states": [len(result.targets) for result in results.values()],
                 "events": [len(result.events) for result in results.values()]}
                | {key.replace("_", " "): digits(errors, 2)
                   for key, errors in zip(QUANTITIES, zip(*relative.values(), strict=True), strict=True)})  # fmt: skip
    yield drawn("thin-layer-path",
                "Loading and unloading on a layer of 0.02 wavelengths and on a half-space; below, bem less reference.",
                axes("separation / um", "mean pressure / kPa",
                     *(trace(name, column(states, "separation", 1e-6), column(states, "mean_pressure", 1e3), style)
                       for name, result, style in (*((name, results[name], "line") for name in ADHESIVE),
                                                   ("half-space", half_space, "dashed"))
                       for states in [touching(result.states)]), yscale="symlog"),
                axes("separation / um", "relative to the largest",
                     *(marks(name, column(touching(results[name].targets), "separation", 1e-6), apart[name])
                       for name in INCOMPRESSIBLE)))  # fmt: skip
    yield work("unknowns evaluations", *results.values())


def _thick(half_space: Result) -> Found:
    """A layer of four periods changes the compliance by 1e-19: left out with a note, and nothing else changes."""
    thick, pressures = solved("thin_layer", layer={"thickness": 0.04}), column(half_space.targets, "mean_pressure")
    note = next(effect for effect in thick.effects if effect.name == "layer")
    known = Against("exact", "the layer is thicker than any wave reaches")
    yield known.count("layer of four periods left out, with a note in effects (1: yes)", 1.0,
                      not note.active and "left out" in note.reason)  # fmt: skip
    yield known.row("mean pressure of that layer, over the largest of the half-space", "Pa", pressures,
                    column(thick.targets, "mean_pressure"), 0.0, OVER_STATES, max(map(abs, pressures)),
                    required=1e-13)  # fmt: skip


def _complete() -> Row:
    """D / c(q0), the pressure that just closes the last gap of a sinusoid on a thin incompressible layer, bracketed."""
    amplitude, period, thickness = 1e-4, 0.01, 2e-4
    exact = amplitude / float(layer_compliance(2 * np.pi / period, thickness, 1e6, 0.5))
    profile = {"kind": "harmonics", "orders": [1], "amplitudes": [amplitude], "phases": [0.0]} | NOT_SELF_AFFINE
    loading = {"control": "mean_pressure", "targets": [exact * (1 - 1e-6), exact * (1 + 1e-6)]}
    result = solved("thin_layer", adhesion=None, profile=profile, loading=loading)
    joined = [state.status == "complete_contact" for state in result.targets]
    return Against("exact", "compliance of a bonded incompressible layer").row(
        "pressure of complete contact of a sinusoid, bracketed to 1e-6", "Pa", exact,
        exact if joined == [False, True] else None, 0.0, required=1e-6)  # fmt: skip


CASES = (
    case("layer-path", "layer", _layer_path,
         "Do thin and incompressible layers keep their accuracy along whole paths, with adhesion and without?",
         r"$c(q) = \frac{2}{E^\ast q} "
         r"\frac{(3 - 4 \nu) \sinh 2qd - 2qd}{(3 - 4 \nu) \cosh 2qd + 2 (qd)^2 + 5 - 12 \nu + 8 \nu^2}$",
         "carbone2008", "layer adhesion slope_term unloading", level="standard", scene="thin_layer"),
)  # fmt: skip
