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
from numpy.polynomial.hermite import hermgauss
from numpy.polynomial.laguerre import laggauss
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


def line_by_line(wavenumbers, steps):
    """Return S, dS and q at the points of a quadrature for lines; integrands of the first have a root at zero."""
    node, weight = np.polynomial.legendre.leggauss(200)
    inside = (np.cumsum(steps) - steps)[:, None] + steps[:, None] * ((node + 1) / 2) ** 2
    return inside, steps[:, None] * weight * (node + 1) / 2, np.broadcast_to(wavenumbers[:, None], inside.shape)


def power_law(level, hurst, highest):
    """Return S, dS and q at the points of a quadrature for C = level q^-(1 + 2 H) from q0 to `highest`."""
    node, weight = np.polynomial.legendre.leggauss(40)
    ends = np.log(Q0) + np.log(highest / Q0) * np.linspace(0, 1, 61) ** 3
    q = np.exp(ends[:-1, None] + np.diff(ends)[:, None] * (node + 1) / 2)
    variance = level / (1 - hurst) * (q ** (2 - 2 * hurst) - Q0 ** (2 - 2 * hurst))
    return variance, level * q ** (2 - 2 * hurst) * weight * np.diff(ends)[:, None], q


LINES, LAW = np.arange(1, 41), 0.8
AMPLITUDES = 50e-6 * LINES**-1.2 / np.sqrt(np.sum(LINES**-2.4) / 2)
LEVEL = LAW * 50e-6**2 / (Q0 ** (-2 * LAW) - (300 * Q0) ** (-2 * LAW))
SPECTRA = {
    "lines": (persson.DiscreteSpectrum(Q0 * LINES, AMPLITUDES),
              line_by_line(Q0 * LINES, (Q0 * LINES * AMPLITUDES) ** 2 / 2)),
    "power law": (persson.ContinuousSpectrum.self_affine(Q0, 300 * Q0, LAW, 50e-6), power_law(LEVEL, LAW, 300 * Q0)),
}


@pytest.mark.quick
@pytest.mark.parametrize("of", SPECTRA)
@pytest.mark.parametrize("load", [1e-3, 0.01, 0.1])
def test_closed_forms_without_adhesion(rows, of, load):
    """Are the moments of the pressure, energy and separation without adhesion the integrals they stand for?"""
    (spectrum, (s, ds, q)), modulus = SPECTRA[of], E / (1 - 0.3**2)
    contact = persson.solve_nonadhesive(spectrum, load * modulus, youngs_modulus=E, poisson_ratio=0.3)
    area, gap, total = erf(load * np.sqrt(2 / s)), np.sqrt(2 / (np.pi * s)) * exp1(2 * load**2 / s), float(np.sum(ds))
    node, weight = np.polynomial.legendre.leggauss(400)
    cut, width = float(spectrum.wavenumbers[-1]) / 3, load + 6 * np.sqrt(total)
    sigma, steps = modulus * width * (node + 1) / 2, modulus * width * weight / 2
    partly, moments = float(np.sum(ds[q <= cut])), []
    if of == "power law":
        partly = LEVEL / (1 - LAW) * (cut ** (2 - 2 * LAW) - Q0 ** (2 - 2 * LAW))
    for variance, at in ((total, None), (partly, cut)):
        pressures, v = contact.pressure_distribution(sigma, at), variance / 4
        level = erf(load / np.sqrt(2 * v))
        second = (load**2 + v) * level + load * np.sqrt(2 * v / np.pi) * np.exp(-(load**2) / (2 * v))
        for power, moment in ((0, level), (1, load), (2, second)):
            moments.append((float(np.sum(steps * pressures * (sigma / modulus) ** power)), float(moment)))
    exact = rows.between(Code.THEORY, Code.EXACT, "Gauss-Legendre quadrature of the definitions")
    for name, quantity, unit, value, reference in (
        ("elastic energy", Quantity.ENERGY, "J/m^2", contact.elastic_energy, modulus * np.sum(area * ds / q) / 4),
        ("separation", Quantity.LENGTH, "m", contact.separation, np.sum(gap * ds / q) / 4),
        ("moments of the pressure, all roughness and a part of it", Quantity.SPECTRUM, "", *np.array(moments).T),
    ):
        exact.compare(name, value, reference, quantity=quantity, unit=unit, uncertainty=1e-13 * np.max(reference),
                      required=1e-11 * np.min(reference), because="rounding of sums of thousands of terms")
    exact.compare("area with a part of the roughness", contact.contact_fraction_at(cut),
                  erf(load * np.sqrt(2 / partly)), quantity=Quantity.AREA, kind="construction", required=1e-13,
                  because="one closed form on both sides")


@pytest.mark.quick
@pytest.mark.parametrize("of", SPECTRA)
def test_moments_of_spectrum(rows, of):
    """Are rms height, rms slope and energy of complete contact the integrals they stand for?"""
    spectrum, (_, ds, q) = SPECTRA[of]
    found = spectrum.h_rms, spectrum.slope_rms, spectrum.full_contact_energy
    rows.compare("rms height, rms slope and energy of complete contact over their integrals",
                 np.divide(found, (np.sqrt(np.sum(ds / q**2)), np.sqrt(np.sum(ds)), np.sum(ds / q) / 4)), 1.0,
                 of=Code.THEORY, by=Code.EXACT, quantity=Quantity.SPECTRUM, uncertainty=1e-13,
                 kind="construction" if of == "lines" else "accuracy")


@pytest.mark.quick
def test_true_area_of_slopes(rows):
    """Is the true over the projected area the mean of sqrt(1 + h'^2) over slopes, on both sides of its series?"""
    variance, (x, weight), (r, share) = np.array([5e-5, 9e-5, 2e-4, 1e-3, 0.03]), hermgauss(150), laggauss(150)
    for name, of, mean in (
        ("in one direction", persson.gaussian_slope_1d,
         np.sqrt(1 + 2 * np.outer(variance, x**2)) @ weight / np.sqrt(np.pi)),
        ("in two directions", persson.isotropic_2d, np.sqrt(1 + np.outer(variance, r)) @ share),
    ):
        rows.compare(f"true over projected area, slopes {name}", of(variance), mean, of=Code.THEORY, by=Code.EXACT,
                     quantity=Quantity.AREA, uncertainty=1e-15, required=1e-13,
                     because="rounding of sums of 150 terms", source="Gauss quadrature over slopes")


@pytest.mark.quick
def test_double_gaussian(rows):
    """Does the fit of a double Gaussian find the one that is given, by all and by logarithms, and tell its load?"""
    sigma, spread = np.linspace(-0.5, 6.0, 80), 4 * 0.6
    above = np.maximum(sigma + 0.3, 0.0)
    density = 2 * np.exp(-(above**2 + 1) / spread) * np.sinh(2 * above / spread) / np.sqrt(np.pi * spread)
    wiggle = density + 1e-3 * np.max(density) * (-1.0) ** np.arange(80)
    fits = [persson.fit_double_gaussian(2e5 * sigma, density / 2e5, 2e5, logarithmic=way) for way in (False, True)]
    load = 1 - 0.3 * erf(1 / np.sqrt(spread))
    found = [(fit.detachment_stress / 2e5, fit.diffusivity, fit.load / 2e5) for fit in fits]
    rows.compare("detachment stress, diffusivity and load of two fits", np.ravel(found), [0.3, 0.6, load] * 2,
                 of=Code.THEORY, by=Code.EXACT, quantity=Quantity.SPECTRUM, uncertainty=1e-6, kind="construction",
                 required=1e-5, because="the least squares end at 1e-12 of the squares", source="density given")
    rows.compare("residual of a density with a wiggle", persson.fit_double_gaussian(sigma, wiggle, 1.0).residual, 1e-3,
                 of=Code.THEORY, by=Code.EXACT, quantity=Quantity.SPECTRUM, uncertainty=1e-5, kind="construction",
                 required=2e-5, because="two parameters of eighty points follow a wiggle by less than a hundredth")


@pytest.mark.quick
def test_state_with_adhesion(rows):
    """Do the parts of a state with adhesion fit together: areas, pressures, energies, work and detachment stress?"""
    state = adhesive(persson.DiscreteSpectrum(Q0 * LINES, AMPLITUDES), 0.01)
    steps, modulus, some = (Q0 * LINES * AMPLITUDES) ** 2 / 2, MODULUS, 9.5 * Q0
    node, weight = np.polynomial.legendre.leggauss(400)
    (x, share), s, area = hermgauss(100), state.slope_variances, state.areas
    true = np.sqrt(1 + 2 * np.outer(s[-1] - s, x**2)) @ share / np.sqrt(np.pi)
    q = Q0 * LINES[np.minimum(np.searchsorted(np.cumsum(steps), (s[1:] + s[:-1]) / 2), 39)]
    stored = np.cumsum((np.diff(s) * (area[1:] + area[:-1]) / (8 * q))[::-1])[::-1]  # of the roughness above each node
    integrals = []
    for at in (None, some):
        low, high = -state.detachment_stresses.max(), modulus * (0.01 + 6 * np.sqrt(s[-1]) / 2)
        sigma, width = low + (high - low) * (node + 1) / 2, (high - low) / 2
        integrals.append(float(np.sum(weight * width * state.pressure_distribution(sigma, at))))
    volumes = state.stress_distribution()
    points = np.linspace(volumes.faces[0, 0], volumes.faces[0, -1], 200_001)
    moment = float(np.sum(points * state.pressure_distribution(modulus * points)) * modulus * (points[1] - points[0]))
    own = rows.between(Code.THEORY, Code.IDENTITY, "as the equations print it", "construction")
    for name, unit, quantity, value, reference, required in (
        ("area as the integral of the pressure distribution", "", Quantity.AREA, integrals,
         [state.contact_fraction, state.contact_fraction_at(some)], 1e-3),
        ("area and load of the finite volumes", "", Quantity.AREA, np.ravel([volumes.area, volumes.load / 0.01]),
         [state.contact_fraction, moment / 0.01], 1e-5),
        ("displacement spectrum over that of the profile", "", Quantity.SPECTRUM,
         state.displacement_power(Q0) / (AMPLITUDES**2 / (4 * Q0)), np.interp(np.cumsum(steps), s, area), 1e-5),
        ("pressure over displacement spectrum", "Pa^2/m^2", Quantity.SPECTRUM,
         state.pressure_power(Q0) / state.displacement_power(Q0), (modulus * Q0 * LINES / 2) ** 2, 1e-10),
        ("adhesion energy", "J/m^2", Quantity.ENERGY, -state.adhesion_energy / 0.03, area[-1] * true[0], 1e-10),
        ("elastic energy", "J/m^2", Quantity.ENERGY, state.elastic_energy, modulus * stored[0], 1e-3),
        ("effective work times area", "J/m^2", Quantity.ENERGY, (state.effective_work * area)[:-1],
         0.03 * area[-1] * true[:-1] - modulus * stored, 1e-3),
        ("detachment stress", "Pa", Quantity.PRESSURE, state.detachment_stress,
         modulus / np.pi * np.sqrt(2 * 0.03 / modulus * 40 * Q0), 1e-10),
    ):
        own.compare(name, value, reference, unit=unit, quantity=quantity, required=required * np.max(np.abs(reference)),
                    because="trapezoid rule between nodes" if required > 1e-6 else "rounding")
    rows.count("nodes", s.size, within=0.001, of=Code.THEORY)


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
