"""Persson's theory with adhesion: what it says of a contact.

Area and effective work of adhesion over magnification, stress distribution with the paper's double Gaussian as a fit,
separation, power spectra of displacement and pressure, and contact at short wavelengths.
"""

import numpy as np

import persson
from validation.cases.shared.checks import Against, Found, case, column
from validation.cases.theory.theory_accuracy import EQUATIONS, MODULUS, Q0, SCENE, adhesive, dry, spectra
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, loglog, marks, semilogx, semilogy, table, trace

MAGNIFICATIONS = np.unique(np.round(np.geomspace(1.0, 1000.0, 61)))  # those at which a line is added
AREA_LOADS = (0.005, 0.02, 0.1)
RESOLVED = (1, 10, 100, 300, 500, 1000)  # magnifications
FIT_LOADS = (0.005, 0.02, 0.05, 0.1, 0.2)
FIT_LOAD = 0.1
FIT_POINTS = 600
FIT_REACH = 5.0  # standard deviations of the full-contact stress above sigma_0
SEPARATION_LOADS = np.geomspace(0.001, 0.1, 13)
STEP = 0.02  # of the load, in central differences
LINES = "paper's lines"
HURSTS = (0.3, 0.4, 0.6, 0.7)
SPECTRUM_LOAD = 0.005  # of E*


def _magnification() -> Found:
    spectrum, zeta = spectra()[LINES], MAGNIFICATIONS
    states = {load: adhesive(spectrum, load) for load in AREA_LOADS}
    integral = adhesive(spectrum, 0.02, route="volterra")
    yield Against("self", "the integral equation at the same magnifications").row(
        "A/A0 at 0.02 E*, magnifications 1, 10, 100, 300, 500, 1000", "",
        [integral.contact_fraction_at(order * Q0) for order in RESOLVED],
        [states[0.02].contact_fraction_at(order * Q0) for order in RESOLVED], 5.2e-7, "absolute",
        required=1e-5)  # fmt: skip
    yield Against("exact", "nothing is left unresolved").row(
        "gamma_eff / gamma with all roughness resolved", "", [1.0] * len(AREA_LOADS),
        [state.effective_work[-1] / state.work_of_adhesion for state in states.values()], 0.0, "absolute",
        required=1e-12)  # fmt: skip
    yield drawn(
        "theory-area-over-magnification",
        "Contact fraction that is left when wavenumbers up to zeta q0 are resolved, with adhesion (lines) and "
        "without (dashed). Contact with adhesion levels off where the effective work of adhesion turns positive.",
        loglog("magnification zeta = q / q0", "A / A0",
               *(trace(f"{load} E*", zeta, [states[load].contact_fraction_at(z * Q0) for z in zeta])
                 for load in AREA_LOADS),
               *(trace(f"{load} E*, no adhesion", zeta, [dry(spectrum, load).contact_fraction_at(z * Q0) for z in zeta],
                       "dashed") for load in AREA_LOADS)))  # fmt: skip
    resolved = [spectrum.resolved_variance(z * Q0) for z in zeta]
    yield drawn("theory-effective-work",
                "Effective work of adhesion at each magnification. Where it is negative, over most of the decades, the "
                "elastic energy of the finer roughness outweighs its adhesion and the barrier stays at zero.",
                semilogx("magnification zeta = q / q0", "gamma_eff / gamma",
                         *(trace(f"{load} E*", zeta,
                                 np.interp(resolved, s.slope_variances, s.effective_work) / s.work_of_adhesion)
                           for load, s in states.items())))  # fmt: skip


def _fit(state: persson.AdhesiveContact) -> tuple[persson.DoubleGaussian, FloatArray]:
    """The double Gaussian fitted from the barrier to FIT_REACH standard deviations, and the stresses in Pa."""
    top = state.mean_pressure + FIT_REACH * state.spectrum.slope_rms / 2 * MODULUS
    stress = np.linspace(-state.detachment_stress, top, FIT_POINTS)
    return persson.fit_double_gaussian(stress, state.pressure_distribution(stress), state.mean_pressure), stress


def _distribution() -> Found:
    spectrum = spectra()[LINES]
    states = {
        (load, width): adhesive(spectrum, load, detached_width=width) for load in FIT_LOADS for width in (1.0, 0.5)
    }
    fits = {key: _fit(state)[0] for key, state in states.items()}
    whole, half = states[FIT_LOAD, 1.0], states[FIT_LOAD, 0.5]
    fit, stress = _fit(whole)
    density = whole.pressure_distribution(stress)
    yield Against("self", "A/A0 by the integral equation").row(
        "int P dsigma at 0.1 E*", "", adhesive(spectrum, FIT_LOAD, route="volterra").contact_fraction,
        float(whole.stress_distribution().area[0]), 1.3e-6, "absolute", required=1e-5)  # fmt: skip
    yield Against("exact", "sigma_a = sqrt(2 E* gamma_eff q)/pi, the width 2 pi/q at the end").row(
        "sigma_a with half the detached width over that with the whole, 0.1 E*", "", 2**0.5,
        half.detachment_stress / whole.detachment_stress, (3e-12, 1e-12), "absolute")  # fmt: skip
    yield table(
        "Ours: the printed double Gaussian, sigma_a and G relaxed, fitted to the theory's own P from the barrier to "
        "five standard deviations of the full-contact stress; G over that of full contact, residual rms over the "
        "largest P. The theory's barrier moves with the wavenumber, so that its P is no double Gaussian and the fit "
        "ends at a third of its sigma_a. Half the detached width raises sigma_a by sqrt 2, the area by a few per cent.",
        {"load / E*": [load for load, _ in states], "detached width": [width for _, width in states],
         "A/A0": column(states.values(), "contact_fraction"),
         "sigma_a / E*": column(states.values(), "detachment_stress", MODULUS),
         "fitted sigma_a / E*": column(fits.values(), "detachment_stress", MODULUS),
         "fitted G / G": [one.diffusivity * 8 * load**2 / spectrum.total_slope_variance
                          for (load, _), one in fits.items()],
         "residual": column(fits.values(), "residual")})  # fmt: skip
    scaled = stress / MODULUS
    yield drawn("theory-stress-distribution",
                "Stress distribution at 0.1 E* with the roughness up to three magnifications resolved, and the double "
                "Gaussian fitted to the finest; tension is negative. Below: the fit less the theory.",
                axes("stress / E*", "P E*", trace("zeta = 1000", scaled, density * MODULUS),
                     trace("fit to zeta = 1000", scaled, fit(stress) * MODULUS, "dashed"),
                     *(trace(f"zeta = {order}", scaled, whole.pressure_distribution(stress, order * Q0) * MODULUS)
                       for order in (10, 100))),
                axes("stress / E*", "fit - theory",
                     trace("fit - theory", scaled, (fit(stress) - density) * MODULUS)))  # fmt: skip


def _apart(state: persson.AdhesiveContact) -> float:
    """The separation in m; ValueError where the theory gives none."""
    if state.separation is None:
        raise ValueError("separation: None where it was asked for")
    return state.separation


def _separation() -> Found:
    spectrum, balance = spectra()[LINES], []
    for load in (0.005, 0.02):
        below, above = (adhesive(spectrum, load * (1 + sign * STEP), with_separation=True) for sign in (-1, 1))
        closer = _apart(above) - _apart(below)
        balance.append((below.total_energy - above.total_energy) / closer / load / MODULUS)
    yield Against("exact", "work of the load; central differences over 4 % of the load").row(
        "-dU_tot/ds over sigma_0 at 0.005 and 0.02 E*", "", [1.0, 1.0], balance, 3.2e-4, scale=1.0)  # fmt: skip
    wet = np.array([_apart(adhesive(spectrum, float(load), with_separation=True)) for load in SEPARATION_LOADS])
    without = np.array([dry(spectrum, float(load)).separation for load in SEPARATION_LOADS]) / spectrum.h_rms
    wet /= spectrum.h_rms
    yield drawn(
        "theory-separation",
        "Load against separation of the mean planes with and without adhesion, and below how much closer adhesion "
        "brings them at the same load.",
        semilogy("separation / h_rms", "load / E*", marks("with adhesion", wet, SEPARATION_LOADS),
                 trace("no adhesion", without, SEPARATION_LOADS, "dashed")),
        axes("separation / h_rms without adhesion", "change / h_rms",
             trace("with less without adhesion", without, wet - without)))  # fmt: skip


def _spectra() -> Found:
    spectrum = persson.ContinuousSpectrum.self_affine(Q0, 1e5 * Q0, 0.7, 50e-6)
    state, without = adhesive(spectrum, SPECTRUM_LOAD), dry(spectrum, SPECTRUM_LOAD)
    q, onset = spectrum.wavenumbers, state.fields.onset()
    if onset is None:
        raise ValueError("the barrier never leaves zero: the scene must have adhesion that acts")
    negligible = (q > 300 * Q0) & (spectrum.slope_variance < onset)
    exponents = [
        np.polyfit(np.log(q[negligible]), np.log(power[negligible]), 1)[0]
        for power in (state.displacement_power(), state.pressure_power())
    ]
    slopes, curves, zeta = [], [], np.geomspace(1, 1e5, 51)
    for hurst in HURSTS:
        rough = persson.ContinuousSpectrum.self_affine(Q0, 1e5 * Q0, hurst, 5e-6)
        short = adhesive(rough, 0.02, resolution=0.5)
        before, after = (short.contact_fraction_at(10**power * Q0) for power in (4.0, 4.5))
        slopes.append(float(np.log(after / before) / np.log(10**0.5)))
        curves.append(trace(f"H = {hurst}", zeta, [short.contact_fraction_at(z * Q0) for z in zeta]))
    paper = "Carbone, Scaraggi, Tartaglino 2009"
    yield Against("theory", "C_u ~ q^-(2 + H), C_sigma ~ q^-H").row(
        "exponents of C_u and C_sigma where gamma_eff < 0, H = 0.7", "", [-2.7, -0.7], exponents, 4.4e-3,
        "absolute")  # fmt: skip
    yield Against("theory", f"{paper}, for H > 1/2").row(
        "d ln A / d ln q at zeta = 10^4 to 10^4.5, H = 0.6 and 0.7: contact complete", "", [0.0, 0.0], slopes[2:],
        1.2e-2, "absolute")  # fmt: skip
    yield Against("theory", "without adhesion, A ~ q^-(1 - H)").ratio(
        "d ln A / d ln q at zeta = 10^4 to 10^4.5, H = 0.3 and 0.4, over -(1 - H)", "",
        [-(1 - hurst) for hurst in HURSTS[:2]], slopes[:2], (0.85, 1.02),
        "for H < 1/2 adhesion loses against the elastic energy of ever finer roughness", paper)  # fmt: skip
    scaled, unit = q / Q0, float(spectrum.power[0])
    stress_unit = float((MODULUS * q[0] / 2) ** 2 * unit)
    along = "magnification q / q0"
    yield drawn("theory-displacement-power",
                "Power spectra of the profile and of the displacement at 0.005 E*, over C(q0); H = 0.7.",
                loglog(along, "C / C(q0)", trace("profile", scaled, spectrum.power / unit),
                       trace("displacement, with adhesion", scaled, state.displacement_power() / unit),
                       trace("displacement, no adhesion", scaled, without.displacement_power() / unit,
                             "dashed")))  # fmt: skip
    yield drawn("theory-pressure-power",
                "Power spectrum of the pressure at 0.005 E*, over that of full contact at q0; H = 0.7.",
                loglog(along, "C_sigma / (E* q0 / 2)^2 C(q0)",
                       trace("with adhesion", scaled, state.pressure_power() / stress_unit),
                       trace("no adhesion", scaled, without.pressure_power() / stress_unit, "dashed")))  # fmt: skip
    yield drawn("theory-short-wavelengths",
                "Contact fraction over magnification for four Hurst exponents, h_rms = 5 um, 0.02 E*: above H = 1/2 "
                "contact at short wavelengths becomes complete, below it does not.",
                loglog(along, "A / A0", *curves))  # fmt: skip


CASES = (
    case("theory-magnification", "theory", _magnification,
         "How much contact is left as finer roughness is resolved, and from where does adhesion act?",
         EQUATIONS, "carbone2009 persson2002", "adhesion", code="persson", scene=SCENE),
    case("theory-distribution", "theory", _distribution,
         "Which stresses does the contact carry, how well does the double Gaussian fit, and what does half the "
         "detached width change?",
         r"$P = \frac{1}{2 \sigma_0 \sqrt{\pi G}} [e^{-(s - \sigma_0)^2 / 4 G \sigma_0^2} "
         r"- e^{-(s + \sigma_0)^2 / 4 G \sigma_0^2}]$, $s = \sigma + \sigma_a$, a fit in $\sigma_a$ and $G$",
         "carbone2009", "adhesion", code="persson", scene=SCENE),
    case("theory-separation", "theory", _separation,
         "How far apart are the mean planes, and does the load do the work of approaching them?",
         r"$s = s_0 + \int \frac{1}{\sigma} \frac{dD}{d\sigma} \, d\sigma$, "
         r"$D = U_{\text{tot}} - U_{\text{el}}$ without adhesion",
         "carbone2009 persson2007", "adhesion", code="persson", scene=SCENE),
    case("theory-spectra", "theory", _spectra,
         "Are the spectra of displacement and pressure power laws, and is contact complete at short ones?",
         r"$C_u = C \, A(q) / A_0 \propto q^{-(2 + H)}$, $C_\sigma = (E^\ast)^2 q^2 C_u / 4 \propto q^{-H}$",
         "carbone2009 persson2001", "adhesion", code="persson",
         scene="power spectra over five decades; E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2\nh_rms = 50 um, H = 0.7\n"
         "h_rms = 5 um, H = 0.3, 0.4, 0.6, 0.7"),
)  # fmt: skip
