"""Contact area against load: one rough profile with and without adhesion, beside the theory with and without."""

from __future__ import annotations

from typing import Any

import numpy as np

import bem
from bem.scene.result import State
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, trace
from validation.harness.schema import Band, Reference, Row, Series
from validation.references import adapters

PERIOD, YOUNGS_MODULUS, POISSON_RATIO, WORK = 0.01, 1e6, 0.5, 0.03
MODULUS = YOUNGS_MODULUS / (1 - POISSON_RATIO**2)
LOADS = (0.002, 0.005, 0.01, 0.02)  # of E*
THEORY_LOADS = tuple(np.geomspace(0.001, 0.03, 7).tolist())
HARMONICS = 50


def _solved(changes: dict[str, Any]) -> list[State]:
    return list(bem.solve(adapters.scene("rough_100", {"profile": {"harmonics": HARMONICS}} | changes)).states)


def _area() -> Outcome:
    dry = _solved(
        {"adhesion": None, "loading": {"control": "mean_pressure", "targets": [load * MODULUS for load in LOADS]}}
    )
    wet = [state for state in _solved({"loading": {"targets": [30e-6]}}) if state.mean_pressure > 0]

    def theory(load: float, work: float | None) -> float:
        adhesion = None if work is None else {"work_of_adhesion": work}
        posed = adapters.scene("rough_100", {"profile": {"harmonics": HARMONICS}, "adhesion": adhesion})
        return adapters.persson_contact(posed, load * MODULUS, with_separation=False).contact_fraction

    targets = [state for state in dry if state.target]
    row = Row(
        quantity="contact fraction without adhesion, bem over Persson, 0.002 to 0.02 E*",
        unit="",
        reference=Reference(kind="theory", source="Persson 2001, closed form for one-dimensional roughness"),
        norm="ratio",
        expected=[theory(load, None) for load in LOADS],
        computed=[state.contact_fraction for state in targets],
        uncertainty=max(state.error_estimate.contact_fraction or 0.0 for state in targets),
        band=Band(low=BAND[0], high=BAND[1], cause=CAUSE, source=BAND_SOURCE, review="2027-11-21"),
    )
    figure = drawn(
        "landing-area-against-load",
        "Contact area against load of one rough profile. Points above the lines are a known discrepancy: Persson's "
        "theory, which is a mean-field one, gives too little area, and adhesion adds more than it says.",
        axes("mean pressure / E*", "contact fraction", _curve("bem, adhesion", wet, "points"),
             trace("theory, adhesion", THEORY_LOADS, [theory(load, WORK) for load in THEORY_LOADS]),
             _curve("bem, no adhesion", targets, "points"),
             trace("theory, no adhesion", THEORY_LOADS, [theory(load, None) for load in THEORY_LOADS],
                   "dashed"))
    )  # fmt: skip
    counts = {"evaluations": sum(state.evaluations for state in dry + wet)}
    return Outcome(rows=(row,), figures=(figure,), counts=counts)


def _curve(label: str, states: list[State], style: Any) -> Series:
    return trace(
        label, [state.mean_pressure / MODULUS for state in states], [state.contact_fraction for state in states], style
    )


CAUSE = "mean-field theory: it neglects correlations between neighbouring contacts, strongest for lines"
BAND_SOURCE = (
    "measured on this realisation, 1.4 to 1.7; the factor of two of Carbone, Scaraggi, Tartaglino 2009 is with adhesion"
)
BAND = (1.25, 1.85)
CASES = (
    Case(id="area-against-load", group="rough profiles", level="quick",
         question="How does contact area grow with load, with and without adhesion, and what does the theory say?",
         equations=r"$A / A_0 = \operatorname{erf}(\sqrt{2} \, \sigma_0 / (E^\ast h'_{\text{rms}}))$ "
                   "(Persson, no adhesion)",
         sources=("carbone2009", "persson2001"), compute=_area,
         effects=("half_space", "adhesion", "slope_term", "load_control"), scene=adapters.scene_text("rough_100")),
)  # fmt: skip
