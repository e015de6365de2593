"""Persson's theory with adhesion: area over magnification, stresses, separation, power spectra, short wavelengths.

Lines m q0, m = 1 to 1000, period 10 mm, H = 0.7, h_rms = 50 um; E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2.  Spectra over
five decades: C_u = C A(q) / A0 ~ q^-(2 + H) and C_sigma = (E* q / 2)^2 C_u ~ q^-H where the effective work of adhesion
is negative; for H > 1/2 contact at short wavelengths becomes complete, without adhesion A ~ q^-(1 - H).  Sources:
Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65; Persson, Eur. Phys. J. E 8 (2002) 385; Phys. Rev. Lett. 99
(2007) 125502.
"""

import numpy as np
import pytest

import persson
from validation.plugin.rows import Code, Quantity

E, NU, Q0 = 1e6, 0.5, 2 * np.pi / 0.01
MODULUS = E / (1 - NU**2)
LINES = persson.DiscreteSpectrum.self_affine(Q0, 0.7, 50e-6, 1000)
FIVE_DIGITS = "five digits: a mean-field theory is off by tens of per cent"
PAPER = "Carbone, Scaraggi, Tartaglino 2009"


def adhesive(spectrum, load, **options):
    """Return the theory with adhesion at a load in units of E*."""
    given = {"youngs_modulus": E, "poisson_ratio": NU, "work_of_adhesion": 0.03, "with_separation": False}
    state = persson.solve(spectrum, load * MODULUS, **given | options)
    assert isinstance(state, persson.AdhesiveContact) and state.status in ("converged", "branches")
    return state


def dry(spectrum, load):
    """Return the theory without adhesion at a load in units of E*."""
    return persson.solve_nonadhesive(spectrum, load * MODULUS, youngs_modulus=E, poisson_ratio=NU)


@pytest.mark.quick
def test_magnification(rows):
    """As finer roughness is resolved, how much contact is left, and from which magnification does adhesion act?"""
    zeta = np.unique(np.round(np.geomspace(1.0, 1000.0, 61)))
    states = {load: adhesive(LINES, load) for load in (0.005, 0.02, 0.1)}
    integral, resolved = adhesive(LINES, 0.02, route="volterra"), (1, 10, 100, 300, 500, 1000)
    rows.compare("contact fraction at 0.02 E*, magnifications 1 to 1000",
                 [states[0.02].contact_fraction_at(m * Q0) for m in resolved],
                 [integral.contact_fraction_at(m * Q0) for m in resolved], of=Code.THEORY, by=Code.THEORY,
                 quantity=Quantity.AREA, kind="construction", required=1e-5, because=FIVE_DIGITS,
                 source="integral equation")
    rows.curves("Contact fraction left when wavenumbers up to zeta q0 are resolved", "zeta = q / q0", "A / A0",
                {f"{load} E*": (zeta, [state.contact_fraction_at(z * Q0) for z in zeta])
                 for load, state in states.items()}
                | {f"{load} E*, no adhesion": (zeta, [dry(LINES, load).contact_fraction_at(z * Q0) for z in zeta])
                   for load in states}, log="xy")
    variances = [LINES.resolved_variance(z * Q0) for z in zeta]
    rows.curves("Effective work of adhesion at each magnification", "zeta = q / q0", "gamma_eff / gamma",
                {f"{load} E*": (zeta, np.interp(variances, s.slope_variances, s.effective_work) / s.work_of_adhesion)
                 for load, s in states.items()}, log="x")


@pytest.mark.quick
def test_stress_distribution(rows):
    """Which stresses does the contact carry, and does their distribution integrate to the area?

    The paper's double Gaussian, sigma_a and G free, is fitted from the barrier to five standard deviations.
    """
    states = {load: adhesive(LINES, load) for load in (0.005, 0.02, 0.05, 0.1, 0.2)}
    rows.compare("int P dsigma at 0.1 E*", float(states[0.1].stress_distribution().area[0]),
                 adhesive(LINES, 0.1, route="volterra").contact_fraction, of=Code.THEORY, by=Code.THEORY,
                 quantity=Quantity.AREA, kind="construction", required=1e-5, because=FIVE_DIGITS,
                 source="A/A0 by the integral equation")
    lines = []
    for load, state in states.items():
        top = state.mean_pressure + 5.0 * LINES.slope_rms / 2 * MODULUS
        stress = np.linspace(-state.detachment_stress, top, 600)
        density = state.pressure_distribution(stress)
        fit = persson.fit_double_gaussian(stress, density, state.mean_pressure)
        lines.append([load, state.contact_fraction, state.detachment_stress / MODULUS, fit.detachment_stress / MODULUS,
                      fit.diffusivity * 8 * load**2 / LINES.total_slope_variance, fit.residual])
        if load == 0.1:
            rows.curves("Stress distribution at 0.1 E* and its double Gaussian", "stress / E*", "P E*",
                        {"theory": (stress / MODULUS, density * MODULUS),
                         "double Gaussian": (stress / MODULUS, fit(stress) * MODULUS)})
    rows.table("The double Gaussian fitted to the theory; its barrier moves, so that P is no double Gaussian",
               ["load / E*", "A / A0", "sigma_a / E*", "fitted sigma_a / E*", "fitted G / G", "residual"],
               lines)


@pytest.mark.quick
def test_work_of_the_load(rows):
    """Does the load do the work of approaching the mean planes, -dU_tot/ds = sigma_0?"""
    ratios = []
    for load in (0.005, 0.02):
        below, above = (adhesive(LINES, load * (1 + sign * 0.02), with_separation=True) for sign in (-1, 1))
        closer = above.separation - below.separation
        ratios.append((below.total_energy - above.total_energy) / closer / load / MODULUS)
    rows.compare("-dU_tot/ds over sigma_0 at 0.005 and 0.02 E*", ratios, 1.0, of=Code.THEORY, by=Code.IDENTITY,
                 quantity=Quantity.PRESSURE, kind="construction", required=1e-3,
                 because="central differences over 4 % of the load leave (0.02)^2",
                 source="s is integrated from dU_tot / sigma")
    loads = np.geomspace(0.001, 0.1, 13)
    wet = np.array([adhesive(LINES, load, with_separation=True).separation for load in loads]) / LINES.h_rms
    without = np.array([dry(LINES, load).separation for load in loads]) / LINES.h_rms
    rows.curves("Load against separation of the mean planes", "separation / h_rms", "load / E*",
                {"with adhesion": (wet, loads), "no adhesion": (without, loads)}, log="y")


@pytest.mark.quick
def test_power_laws(rows):
    """Are the spectra of displacement and pressure power laws where adhesion is negligible?"""
    spectrum = persson.ContinuousSpectrum.self_affine(Q0, 1e5 * Q0, 0.7, 50e-6)
    state, without, q = adhesive(spectrum, 0.005), dry(spectrum, 0.005), spectrum.wavenumbers
    negligible = (q > 300 * Q0) & (spectrum.slope_variance < state.fields.onset())
    for name, power, exponent in (("displacement", state.displacement_power(), -2.7),
                                  ("pressure", state.pressure_power(), -0.7)):
        (fitted, _), covariance = np.polyfit(np.log(q[negligible]), np.log(power[negligible]), 1, cov=True)
        rows.compare(f"exponent of the {name} spectrum", fitted, exponent, of=Code.THEORY, by=Code.RATE,
                     quantity=Quantity.RATE, uncertainty=2 * float(np.sqrt(covariance[0, 0])), required=0.02,
                     because="the law is asymptotic: A(q) still falls towards q^-(1 - H)", source=PAPER)
    unit = float(spectrum.power[0])
    rows.curves("Power spectra at 0.005 E*, H = 0.7", "q / q0", "C / C(q0)",
                {"profile": (q / Q0, spectrum.power / unit),
                 "displacement, with adhesion": (q / Q0, state.displacement_power() / unit),
                 "displacement, no adhesion": (q / Q0, without.displacement_power() / unit)}, log="xy")


@pytest.mark.quick
def test_contact_at_short_wavelengths(rows):
    """Does contact become complete at short wavelengths for H > 1/2, and for H < 1/2 nearly as without adhesion?"""
    slopes, curves, zeta = {}, {}, np.geomspace(1, 1e5, 51)
    for hurst in (0.3, 0.4, 0.6, 0.7):
        spectrum = persson.ContinuousSpectrum.self_affine(Q0, 1e5 * Q0, hurst, 5e-6)
        state = adhesive(spectrum, 0.02, resolution=0.5)
        before, after = (state.contact_fraction_at(10**power * Q0) for power in (4.0, 4.5))
        slopes[hurst] = float(np.log(after / before) / np.log(10**0.5))
        curves[f"H = {hurst}"] = zeta, [state.contact_fraction_at(z * Q0) for z in zeta]
    rows.compare("d ln A / d ln q at 1e4 to 3e4 q0, H = 0.6 and 0.7", [slopes[0.6], slopes[0.7]], 0.0, of=Code.THEORY,
                 by=Code.RATE, quantity=Quantity.RATE, uncertainty=1e-4, required=0.03,
                 because="a tenth of the exponent -(1 - H) without adhesion", source=PAPER)
    rows.known("d ln A / d ln q at 1e4 to 3e4 q0 over -(1 - H), H = 0.3 and 0.4", [slopes[0.3], slopes[0.4]],
               [-0.7, -0.6], band=(0.85, 1.02), of=Code.THEORY, by=Code.RATE, quantity=Quantity.RATE,
               uncertainty=(1e-4, 0.0), source=PAPER,
               cause="for H < 1/2 adhesion loses against the elastic energy of ever finer roughness")
    rows.curves("Contact fraction over magnification, h_rms = 5 um, 0.02 E*", "q / q0", "A / A0", curves,
                log="xy")
