"""Persson's theory with adhesion: power spectra of displacement and pressure, and contact at short wavelengths."""

from __future__ import annotations

import numpy as np

import persson
from validation.cases.theory.theory_accuracy import MODULUS, Q0, adhesive, dry
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, trace
from validation.harness.rows import compared
from validation.harness.schema import Band, Panel, Reference, Row, Series

HURSTS = (0.3, 0.4, 0.6, 0.7)
SPECTRUM_LOAD = 0.005  # of E*


def _spectra() -> Outcome:
    spectrum = persson.ContinuousSpectrum.self_affine(Q0, 1e5 * Q0, 0.7, 50e-6)
    state, without = adhesive(spectrum, SPECTRUM_LOAD), dry(spectrum, SPECTRUM_LOAD)
    q = spectrum.wavenumbers
    onset = state.fields.onset()
    if onset is None:
        raise ValueError("the barrier never leaves zero: the scene must have adhesion that acts")
    negligible = (q > 300 * Q0) & (spectrum.slope_variance < onset)
    exponents = [
        float(np.polyfit(np.log(q[negligible]), np.log(power[negligible]), 1)[0])
        for power in (state.displacement_power(), state.pressure_power())
    ]
    slopes = []
    curves = []
    for hurst in HURSTS:
        rough = persson.ContinuousSpectrum.self_affine(Q0, 1e5 * Q0, hurst, 5e-6)
        short = adhesive(rough, 0.02, resolution=0.5)
        before, after = (short.contact_fraction_at(10**power * Q0) for power in (4.0, 4.5))
        slopes.append(float(np.log(after / before) / np.log(10**0.5)))
        zeta = np.geomspace(1, 1e5, 51)
        curves.append(trace(f"H = {hurst}", zeta, [short.contact_fraction_at(z * Q0) for z in zeta]))
    rows = (
        compared("exponents of C_u and C_sigma where gamma_eff < 0, H = 0.7", "",
                 Reference(kind="theory", source="C_u ~ q^-(2 + H), C_sigma ~ q^-H"), [-2.7, -0.7], exponents,
                 2.5 * MEASURED_EXPONENT, MEASURED_EXPONENT, "absolute"),
        compared("d ln A / d ln q at zeta = 10^4 to 10^4.5, H = 0.6 and 0.7: contact complete", "",
                 Reference(kind="theory", source="Carbone, Scaraggi, Tartaglino 2009, for H > 1/2"), [0.0, 0.0],
                 slopes[2:], 2.5 * MEASURED_LEVEL, MEASURED_LEVEL, "absolute"),
        Row(quantity="d ln A / d ln q at zeta = 10^4 to 10^4.5, H = 0.3 and 0.4, over -(1 - H)", unit="",
            reference=Reference(kind="theory", source="without adhesion, A ~ q^-(1 - H)"), norm="ratio",
            expected=[-(1 - hurst) for hurst in HURSTS[:2]], computed=list(slopes[:2]),
            band=Band(low=0.85, high=1.02,
                      cause="for H < 1/2 adhesion loses against the elastic energy of ever finer roughness",
                      source="Carbone, Scaraggi, Tartaglino 2009", review="2027-11-21")),
    )  # fmt: skip
    scaled = (q / Q0).tolist()
    unit = float(spectrum.power[0])
    stress_unit = float((MODULUS * q[0] / 2) ** 2 * unit)

    def panel(name: str, *powers: Series) -> Panel:
        return loglog("magnification q / q0", name, *list(powers))

    figures = (
        drawn("theory-displacement-power",
              "Power spectra of the profile and of the displacement at 0.005 E*, over C(q0); H = 0.7.",
              panel("C / C(q0)", trace("profile", scaled, spectrum.power / unit),
              trace("displacement, with adhesion", scaled, state.displacement_power() / unit),
              trace("displacement, no adhesion", scaled, without.displacement_power() / unit, "dashed"))),
        drawn("theory-pressure-power",
              "Power spectrum of the pressure at 0.005 E*, over that of full contact at q0; H = 0.7.",
              panel("C_sigma / (E* q0 / 2)^2 C(q0)",
              trace("with adhesion", scaled, state.pressure_power() / stress_unit),
              trace("no adhesion", scaled, without.pressure_power() / stress_unit, "dashed"))),
        drawn("theory-short-wavelengths",
              "Contact fraction over magnification for four Hurst exponents, h_rms = 5 um, 0.02 E*: above H = 1/2 "
              "contact at short wavelengths becomes complete, below it does not.",
              loglog("magnification q / q0", "A / A0", *curves)),
    )  # fmt: skip
    return Outcome(rows=rows, figures=figures)


MEASURED_EXPONENT = 4.4e-3
MEASURED_LEVEL = 1.2e-2

CASES = (
    Case(id="theory-spectra", group="theory", code="persson", level="quick",
         question="Are the spectra of displacement and pressure power laws, and is contact complete at short ones?",
         equations=r"$C_u = C \, A(q) / A_0 \propto q^{-(2 + H)}$, $C_\sigma = (E^\ast)^2 q^2 C_u / 4 \propto q^{-H}$",
         sources=("carbone2009", "persson2001"), compute=_spectra, effects=("adhesion",),
         scene="power spectra over five decades; E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2\nh_rms = 50 um, H = 0.7\n"
         "h_rms = 5 um, H = 0.3, 0.4, 0.6, 0.7"),
)  # fmt: skip
