"""Layers along whole paths: thin and incompressible ones against doubled resolution, thick ones against none at all.

The reference is dense algebra with twice the nodes it needs (dense_equilibrium.py), at the control of each state; for
complete contact the pressure of the layer, and for a layer as thick as to be left out the half-space itself.
"""

from typing import Any

import numpy as np

import bem
from bem.scene.result import Result
from validation.cases.shared.checks import OVER_STATES, Against, case, column, posed, refused, solved, touching, work
from validation.harness.case import Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.schema import Figure, Row, Table
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
Pairs = dict[str, tuple[list[float], list[float]]]  # computed and expected values of every quantity


def _layer_path() -> Outcome:
    doubled = Against("dense algebra", "doubled resolution")
    results: dict[str, Result] = {}
    found: dict[str, Pairs] = {}
    rows = []
    for name, changes in LAYERS.items():
        scene = posed("thin_layer", **changes)
        results[name] = bem.solve(scene)
        states = touching(results[name].targets)
        known = [reference(scene, state, refinement=2) for state in states]
        found[name] = {key: (column(states, key), [values[key] for values in known]) for key in QUANTITIES}
        for key, unit in QUANTITIES.items():
            computed, expected = found[name][key]
            rows.append(doubled.row(f"{key.replace('_', ' ')}, d = 0.02 wavelengths, {name}, over the largest", unit,
                                    expected, computed, 1.1e-11, OVER_STATES, max(map(abs, expected)),
                                    required=1e-10))  # fmt: skip
    half_space = solved("thin_layer", layer=None)
    rows += [
        Against("exact", "every state of the paths is an equilibrium").count(
            "states whose certificate is not ok", 0.0, refused(*results.values())),
        *_thick(half_space), _complete(),
    ]  # fmt: skip
    return Outcome(
        rows=tuple(rows),
        figures=(_figure(results, half_space, found),),
        tables=(_table(found, results),),
        counts=work("unknowns evaluations", *results.values()),
    )


def _thick(half_space: Result) -> tuple[Row, Row]:
    """A layer of four periods changes the compliance by 1e-19: left out with a note, and nothing else changes."""
    thick = solved("thin_layer", layer={"thickness": 0.04})
    note = next(effect for effect in thick.effects if effect.name == "layer")
    known, pressures = (
        Against("exact", "the layer is thicker than any wave reaches"),
        column(half_space.targets, "mean_pressure"),
    )
    return (
        known.count("layer of four periods left out, with a note in effects (1: yes)", 1.0,
                    not note.active and "left out" in note.reason),
        known.row("mean pressure of that layer, over the largest of the half-space", "Pa", pressures,
                  column(thick.targets, "mean_pressure"), 0.0, OVER_STATES, max(map(abs, pressures)), required=1e-13),
    )  # fmt: skip


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


def _table(found: dict[str, Pairs], results: dict[str, Result]) -> Table:
    return Table(
        caption="Largest relative error against doubled resolution along each path, d = 0.02 wavelengths.",
        columns=["path", "states", "events", *(key.replace("_", " ") for key in QUANTITIES)],
        rows=[[name, len(results[name].targets), len(results[name].events),
               *(float(f"{max(abs(np.subtract(*pair))) / max(map(abs, pair[1])):.1e}") for pair in pairs.values())]
              for name, pairs in found.items()],
    )  # fmt: skip


def _figure(results: dict[str, Result], half_space: Result, found: dict[str, Pairs]) -> Figure:
    shown = {name: results[name] for name in ("nu = 0.5, adhesion", "nu = 0.3, adhesion")} | {"half-space": half_space}
    above = [
        trace(name, column(states, "separation", 1e-6), column(states, "mean_pressure", 1e3),
              "dashed" if name == "half-space" else "line")
        for name, result in shown.items()
        for states in [touching(result.states)]
    ]  # fmt: skip
    below = []
    for name in ("nu = 0.5, adhesion", "nu = 0.5"):
        computed, expected = found[name]["mean_pressure"]
        apart = np.subtract(computed, expected) / max(map(abs, expected))
        below.append(marks(name, column(touching(results[name].targets), "separation", 1e-6), apart))
    return drawn(
        "thin-layer-path",
        "Loading and unloading on a layer of 0.02 wavelengths and on a half-space; below, bem less reference.",
        axes("separation / um", "mean pressure / kPa", *above, yscale="symlog"),
        axes("separation / um", "relative to the largest", *below),
    )


CASES = (
    case("layer-path", "layer", _layer_path,
         "Do thin and incompressible layers keep their accuracy along whole paths, with adhesion and without?",
         r"$c(q) = \frac{2}{E^\ast q} "
         r"\frac{(3 - 4 \nu) \sinh 2qd - 2qd}{(3 - 4 \nu) \cosh 2qd + 2 (qd)^2 + 5 - 12 \nu + 8 \nu^2}$",
         "carbone2008", "layer adhesion slope_term unloading", level="standard", scene="thin_layer"),
)  # fmt: skip
