"""Persson's theory with adhesion: closed forms, two numerical routes, refinement, and the balance of the load.

    dP/dV = 1/2 d2P/dsigma2,  P = 0 at sigma = -a(V),  a = sqrt(2 E* gamma_eff q) / pi,
    gamma_eff A = gamma A(1) M - U_el(V),  V = S / 4 in units of E*, S the slope variance resolved.

Route 1: conservative finite volumes on the moving domain.  Route 2: a Volterra integral equation for the flux at the
barrier, N(-D(V) / sqrt V) = int N(-(D(V) - D(U)) / sqrt(V - U)) dF(U), D = sigma_0 + a, F = 1 - A.  The routes share
the spectrum and the effective work, so that their rows hold by construction; without adhesion the closed forms stand
against quadrature of their definitions.  E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2.  Sources: Persson, J. Chem. Phys.
115 (2001) 3840; Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65; Peskir, J. Theor. Probab. 15 (2002) 1.
"""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.special import erf, exp1

import persson
from validation.plugin.rows import Code, Quantity

E, NU, Q0 = 1e6, 0.5, 2 * np.pi / 0.01
MODULUS = E / (1 - NU**2)
FIVE_DIGITS = "five digits: a mean-field theory is off by tens of per cent"
SPECTRA: dict[str, persson.DiscreteSpectrum | persson.ContinuousSpectrum] = {  # one rms height of 50 um
    "1000 lines, H = 0.7": persson.DiscreteSpectrum.self_affine(Q0, 0.7, 50e-6, 1000),
    "300 lines, H = 0.5": persson.DiscreteSpectrum.self_affine(Q0, 0.5, 50e-6, 300),
    "power spectrum, H = 0.7": persson.ContinuousSpectrum.self_affine(Q0, 1000 * Q0, 0.7, 50e-6),
}
each_spectrum = pytest.mark.parametrize("spectrum", SPECTRA.values(), ids=SPECTRA)


def adhesive(spectrum, load, **options):
    """Return the theory with adhesion at a load in units of E*."""
    given = {"youngs_modulus": E, "poisson_ratio": NU, "work_of_adhesion": 0.03, "with_separation": False}
    state = persson.solve(spectrum, load * MODULUS, **given | options)
    assert isinstance(state, persson.AdhesiveContact) and state.status == "converged"
    return state


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
    for name, quantity, unit, reference in (
        ("contact_fraction", Quantity.AREA, "", float(erf(load * np.sqrt(2 / ends[-1])))),
        ("elastic_energy", Quantity.ENERGY, "J/m^2", modulus * float(np.sum(np.sum(area * measure, axis=1) / q)) / 4),
        ("separation", Quantity.LENGTH, "m", float(np.sum(np.sum(gap * measure, axis=1) / q)) / 4),
    ):
        quadrature.compare(name.replace("_", " "), getattr(contact, name), reference, quantity=quantity, unit=unit,
                           uncertainty=1e-13 * reference, required=1e-12 * reference,
                           because="rounding of sums of 8000 terms")


@pytest.mark.quick
@each_spectrum
def test_two_routes(rows, spectrum):
    """Do finite volumes and the integral equation, each with its own fixed point, give the same area?"""
    loads = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)
    volumes, integral = (np.array([adhesive(spectrum, load, route=route).contact_fraction for load in loads])
                         for route in ("finite_volumes", "volterra"))
    rows.compare("contact fraction, 0.001 to 0.2 E*", volumes, integral, of=Code.THEORY, by=Code.THEORY,
                 quantity=Quantity.AREA, kind="construction", required=1e-5 * integral, because=FIVE_DIGITS,
                 source="integral equation")
    rows.curves("Area of the theory with adhesion by two routes", "load / E*", "A / A0",
                {"finite volumes": (loads, volumes), "integral equation": (loads, integral)}, log="xy")


@pytest.mark.quick
def test_energies_by_two_routes(rows):
    """Do finite volumes and the integral equation store the same energies?"""
    spectrum = persson.DiscreteSpectrum.self_affine(Q0, 0.7, 50e-6, 30)
    volumes, integral = (adhesive(spectrum, 1e4 / MODULUS, route=route, poisson_ratio=0.3)
                         for route in ("finite_volumes", "volterra"))
    for name in ("elastic_energy", "adhesion_energy"):
        reference = getattr(integral, name)
        rows.compare(name.replace("_", " "), getattr(volumes, name), reference, of=Code.THEORY, by=Code.THEORY,
                     quantity=Quantity.ENERGY, unit="J/m^2", kind="construction", required=1e-5 * abs(reference),
                     because=FIVE_DIGITS, source="integral equation")


@pytest.mark.quick
@each_spectrum
def test_refinement(rows, spectrum):
    """Does halving every step leave the area?"""
    loads = (0.005, 0.02, 0.1)
    default, half = (np.array([adhesive(spectrum, load, resolution=factor).contact_fraction for load in loads])
                     for factor in (1.0, 2.0))
    rows.compare("contact fraction at 0.005, 0.02 and 0.1 E*", default, half, of=Code.THEORY, by=Code.THEORY,
                 quantity=Quantity.AREA, kind="construction", required=1e-5 * half, because=FIVE_DIGITS,
                 source="every step halved")


@pytest.mark.quick
@each_spectrum
def test_load_balance(rows, spectrum):
    """Does the load grow by the stress that the moving barrier absorbs, int sigma P = sigma_0 + int a (-dA/dV) dV?"""
    state = adhesive(spectrum, 0.02)
    barrier = state.fields.problem.mesh.smoothed(state.fields.barrier)[0]
    absorbed = np.concatenate([[0.0], np.cumsum((barrier[1:] + barrier[:-1]) / 2 * -np.diff(state.areas))]) / 0.02
    gained = PchipInterpolator(state.slope_variances, absorbed)
    orders = [m for m in (1, 3, 10, 30, 100, 200, 250, 275, 300, 400, 450, 500, 600, 700, 800, 900, 1000)
              if m * Q0 <= spectrum.wavenumbers[-1] and spectrum.resolved_variance(m * Q0) > 0]
    carried = [float(state.stress_distribution(m * Q0).load[0]) / 0.02 for m in orders]
    due = [1 + float(gained(spectrum.resolved_variance(m * Q0))) for m in orders]
    rows.compare("int sigma P / sigma_0 at magnifications up to all roughness", carried, due, of=Code.THEORY,
                 by=Code.IDENTITY, quantity=Quantity.PRESSURE, kind="construction", required=1e-5,
                 because=FIVE_DIGITS, source="stress absorbed at the barrier")
    rows.curves("Stress carried at each magnification, 0.02 E*", "q / q0", "int sigma P / sigma_0",
                {"carried": (orders, carried), "1 + absorbed": (orders, due)}, log="x")


@pytest.mark.quick
def test_paper_case(rows):
    """Have area and separation of the paper's case, which the paper does not print, stayed as they were?"""
    spectrum = SPECTRA["1000 lines, H = 0.7"]
    for load in (0.005, 0.02):
        wet = adhesive(spectrum, load, with_separation=True)
        dry = persson.solve_nonadhesive(spectrum, load * MODULUS, youngs_modulus=E, poisson_ratio=NU)
        for words, state in (("with adhesion", wet), ("without adhesion", dry)):
            rows.count(f"contact fraction at {load} E*, {words}", state.contact_fraction, 1e-4, of=Code.THEORY)
            rows.count(f"separation over h_rms at {load} E*, {words}", state.separation / spectrum.h_rms, 1e-3,
                       of=Code.THEORY)
