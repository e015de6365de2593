"""Persson's theory: closed forms without adhesion, power laws and contact at short wavelengths with it.

Without adhesion area, energy and separation are integrals over the slope variance resolved, here by quadrature.  With
adhesion (gamma = 0.03 J/m^2), over five decades: C_u = C A(q) / A0 ~ q^-(2 + H) and C_sigma = (E* q / 2)^2 C_u ~ q^-H
where the effective work of adhesion is negative; for H > 1/2 contact at short wavelengths becomes complete, without
adhesion A ~ q^-(1 - H).  E = 1 MPa, period 10 mm, rms height 50 um.  What holds by construction, such as the two routes
of the diffusion and the balance of the load, is asked by tests/persson.  Sources: Persson, J. Chem. Phys. 115 (2001)
3840; Eur. Phys. J. E 8 (2002) 385; Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65.
"""

import numpy as np
import pytest
from scipy.special import erf, exp1

import persson
from validation.plugin.rows import Code, Quantity

E, NU, Q0 = 1e6, 0.5, 2 * np.pi / 0.01
MODULUS = E / (1 - NU**2)
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
def test_closed_forms_without_adhesion(rows):
    """Are area, energy and separation without adhesion the integrals they stand for, summed line by line?"""
    m = np.arange(1, 41)
    amplitudes, load, modulus = 50e-6 * m**-1.2 / np.sqrt(np.sum(m**-2.4) / 2), 0.01, E / (1 - 0.3**2)
    contact = persson.solve_nonadhesive(persson.DiscreteSpectrum(Q0 * m, amplitudes), load * modulus, youngs_modulus=E,
                                        poisson_ratio=0.3)
    q, steps = Q0 * m, (Q0 * m * amplitudes) ** 2 / 2
    ends = np.cumsum(steps)
    node, weight = np.polynomial.legendre.leggauss(200)
    square = ((node + 1) / 2) ** 2  # the integrands of the first line have a root at zero
    inside = (ends - steps)[:, None] + steps[:, None] * square
    measure = steps[:, None] * weight * (node + 1) / 2
    area, gap = erf(load * np.sqrt(2 / inside)), np.sqrt(2 / (np.pi * inside)) * exp1(2 * load**2 / inside)
    quadrature = rows.between(Code.THEORY, Code.EXACT, "Gauss-Legendre quadrature of the definitions, line by line")
    for name, quantity, unit, kind, reference in (
        ("contact_fraction", Quantity.AREA, "", "construction", float(erf(load * np.sqrt(2 / ends[-1])))),
        ("elastic_energy", Quantity.ENERGY, "J/m^2", "accuracy",
         modulus * float(np.sum(np.sum(area * measure, axis=1) / q)) / 4),
        ("separation", Quantity.LENGTH, "m", "accuracy", float(np.sum(np.sum(gap * measure, axis=1) / q)) / 4),
    ):
        quadrature.compare(name.replace("_", " "), getattr(contact, name), reference, quantity=quantity, unit=unit,
                           kind=kind, uncertainty=1e-13 * reference, required=1e-12 * reference,
                           because="rounding of sums of 8000 terms")


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
