"""Contact area against load: one rough profile with and without adhesion, beside the theory; the problem drawn."""

from typing import Any

import numpy as np

import bem
from validation.cases.shared.checks import Against, case, column, posed, solved
from validation.harness.case import Outcome
from validation.harness.figure_data import axes, drawn, trace
from validation.harness.schema import Series
from validation.references import adapters
from validation.references.paper_sketch import sketch_scene, sketches

MODULUS, WORK = 1e6 / (1 - 0.5**2), 0.03
LOADS = (0.002, 0.005, 0.01, 0.02)  # of E*
THEORY_LOADS = tuple(np.geomspace(0.001, 0.03, 7).tolist())
FEWER = {"harmonics": 50}
CAUSE = "mean-field theory: it neglects correlations between neighbouring contacts, strongest for lines"
BAND = (1.25, 1.85)
MEASURED = ("measured on this realisation, 1.4 to 1.7; the factor of two of Carbone, Scaraggi, Tartaglino 2009 is with "
            "adhesion")  # fmt: skip


def _area() -> Outcome:
    loading: dict[str, Any] = {"control": "mean_pressure", "targets": [load * MODULUS for load in LOADS]}
    dry = solved("rough_100", profile=FEWER, adhesion=None, loading=loading)
    path = solved("rough_100", profile=FEWER, loading={"targets": [30e-6]})
    wet = [state for state in path.states if state.mean_pressure > 0]

    def theory(load: float, work: float | None) -> float:
        scene = posed("rough_100", profile=FEWER, adhesion=None if work is None else {"work_of_adhesion": work})
        return adapters.persson_contact(scene, load * MODULUS, with_separation=False).contact_fraction

    row = Against("theory", "Persson 2001, closed form for one-dimensional roughness").ratio(
        "contact fraction without adhesion, bem over Persson, 0.002 to 0.02 E*", "",
        [theory(load, None) for load in LOADS], column(dry.targets, "contact_fraction"), BAND, CAUSE, MEASURED,
        uncertainty=max(state.error_estimate.contact_fraction or 0.0 for state in dry.targets))  # fmt: skip
    figure = drawn(
        "landing-area-against-load",
        "Contact area against load of one rough profile. Points above the lines are a known discrepancy: Persson's "
        "theory, which is a mean-field one, gives too little area, and adhesion adds more than it says.",
        axes("mean pressure / E*", "contact fraction", _points("bem, adhesion", wet),
             trace("theory, adhesion", THEORY_LOADS, [theory(load, WORK) for load in THEORY_LOADS]),
             _points("bem, no adhesion", dry.targets),
             trace("theory, no adhesion", THEORY_LOADS, [theory(load, None) for load in THEORY_LOADS], "dashed")),
    )  # fmt: skip
    counts = {"evaluations": sum(state.evaluations for state in (*dry.states, *wet))}
    _, heights = sketches(bem.solve(sketch_scene()), "problem-layer", "landing-problem")
    return Outcome(rows=(row,), figures=(heights, figure), counts=counts)


def _points(label: str, states: Any) -> Series:
    return trace(label, column(states, "mean_pressure", MODULUS), column(states, "contact_fraction"), "points")


CASES = (
    case("area-against-load", "rough profiles", _area,
         "How does contact area grow with load, with and without adhesion, and what does the theory say?",
         r"$A / A_0 = \operatorname{erf}(\sqrt{2} \, \sigma_0 / (E^\ast h'_{\text{rms}}))$ (Persson, no adhesion)",
         "carbone2009 persson2001", "half_space adhesion slope_term load_control", scene="rough_100"),
)  # fmt: skip
