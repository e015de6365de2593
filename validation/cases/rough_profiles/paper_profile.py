"""The paper's profile, one realisation with 1000 harmonics, against Persson's theory without adhesion.

The theory is known to give about half the area; the ratio is a known discrepancy with a band that fails on both sides.
"""

from __future__ import annotations

import numpy as np

import bem
from bem.scene.result import State
from persson import DiscreteSpectrum, solve_nonadhesive
from validation.harness.case import Case, Outcome
from validation.harness.drawings import axes, drawn, marks, semilogy, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Band, Figure, Reference, Row, Table
from validation.references import adapters

COMPARED_FROM = 0.005  # of E*
CAUSE = (
    "mean-field theory that neglects correlations between neighbouring contacts, strongest for roughness in one "
    "direction; adhesion, which adds area, is absent from it"
)


def _paper_profile() -> Outcome:
    posed = adapters.scene("paper_profile")
    result = bem.solve(posed)
    solid = {"youngs_modulus": posed.solid.youngs_modulus, "poisson_ratio": posed.solid.poisson_ratio}
    modulus = posed.solid.youngs_modulus / (1 - posed.solid.poisson_ratio**2)
    spectrum = adapters.persson_spectrum(posed)
    at_load = [state for state in result.targets if state.mean_pressure >= 0.999 * COMPARED_FROM * modulus]
    theory = [solve_nonadhesive(spectrum, state.mean_pressure, **solid) for state in at_load]
    rows = (
        Row(quantity="contact fraction, bem over Persson, 0.005 to 0.02 E*", unit="",
            reference=Reference(kind="theory", source="Persson 2001, closed form for one-dimensional roughness"),
            norm="ratio", expected=[contact.contact_fraction for contact in theory],
            computed=[state.contact_fraction for state in at_load],
            uncertainty=max(state.error_estimate.contact_fraction or 0.0 for state in at_load),
            band=Band(low=1.5, high=3.0, cause=CAUSE,
                      source="Carbone, Scaraggi, Tartaglino 2009, section 5: about a factor of two",
                      review="2027-11-21")),
        compared("loads reached (0.0025 to 0.02 E* in eight steps)", "Pa", Reference(kind="exact", source="the scene"),
                 [0.0025 * step * modulus for step in range(1, 9)],
                 [state.mean_pressure for state in result.targets[:8]] + [None] * (8 - len(result.targets[:8])), 5e-13,
                 MEASURED_LOAD, scale=modulus),
        counted("states whose certificate is not ok",
                Reference(kind="exact", source="every state of the path is a stable equilibrium"), [0.0],
                [float(sum(not state.certificate.ok for state in result.states))]),
        compared("closure max |G/w - 1| over all states", "", Reference(kind="exact", source="G = w at every edge"),
                 [0.0] * len(result.states), [state.certificate.closure or 0.0 for state in result.states], 1e-8,
                 MEASURED_CLOSURE, "maximum over states", 1.0, basis="required"),
    )  # fmt: skip
    touching = [state for state in result.states if state.n_patches]
    counts = {
        "unknowns": max(state.unknowns for state in touching),
        "evaluations": sum(state.evaluations for state in result.states),
        "events": len(result.events),
        "patches": touching[-1].n_patches,
    }
    figures = _figures(touching, spectrum, solid, modulus)
    return Outcome(rows=rows, figures=figures, tables=(_table(result.targets, modulus),), counts=counts)


def _figures(
    states: list[State], spectrum: DiscreteSpectrum, solid: dict[str, float], modulus: float
) -> tuple[Figure, ...]:
    ordered = sorted(states, key=lambda state: state.mean_pressure)
    compressive = [state for state in ordered if state.mean_pressure > 0]
    load = [state.mean_pressure / modulus for state in compressive]
    curve = np.linspace(1e-4, 0.021, 60)
    theory = [solve_nonadhesive(spectrum, value * modulus, **solid) for value in curve]
    area = drawn("landing-area-against-load",
                 "Contact area of the paper's profile against load: solver with adhesion, Persson's theory without.",
                 axes("mean pressure / E*", "contact fraction",
                      marks("bem, adhesive", load, [state.contact_fraction for state in compressive]),
                      trace("Persson, no adhesion", curve,
                            [contact.contact_fraction for contact in theory])))  # fmt: skip
    separation = drawn("separation-against-load", "Separation of the mean planes against load, in rms heights.",
                       semilogy("separation / h_rms", "mean pressure / E*",
                                marks("bem, adhesive", [state.separation / spectrum.h_rms for state in compressive],
                                      load),
                                trace("Persson, no adhesion",
                                      [contact.separation / spectrum.h_rms for contact in theory], curve)))  # fmt: skip
    return area, separation


def _table(targets: tuple[State, ...], modulus: float) -> Table:
    return Table(caption="States at the loads asked for.",
                 columns=["mean pressure / E*", "separation / um", "contact fraction", "estimated error", "patches",
                          "unknowns", "closure", "stable at fixed load"],
                 rows=[[state.mean_pressure / modulus, state.separation * 1e6, state.contact_fraction,
                        state.error_estimate.contact_fraction, state.n_patches, state.unknowns,
                        state.certificate.closure, str(state.stable_at_fixed_load)]
                       for state in targets])  # fmt: skip


MEASURED_LOAD, MEASURED_CLOSURE = 2e-13, 7.6e-10

CASES = (
    Case(id="paper-profile", group="rough profiles", level="standard",
         question="What is the contact area of the paper's profile, and how far off is the theory?",
         equations=r"$A / A_0 = \operatorname{erf}(\sqrt{2} \, \sigma_0 / (E^\ast h'_{\text{rms}}))$ "
                   "(Persson, no adhesion)",
         sources=("carbone2009", "persson2001"), compute=_paper_profile,
         effects=("half_space", "adhesion", "slope_term"), scene=adapters.scene_text("paper_profile")),
)  # fmt: skip
