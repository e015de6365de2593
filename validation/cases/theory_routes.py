"""The theory against what it stands for: its closed forms by plain quadrature, and adhesion by its two routes.

Without adhesion the integrals over the slope variance are summed line by line with Gauss-Legendre points, the
wavenumber of line m holding while V runs from S_{m-1} / 4 to S_m / 4.  With adhesion finite volumes and the Volterra
equation share the fixed point, not the diffusion.  SI units.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.special import erf, exp1

import persson
from validation import adapters
from validation.case import Case, Outcome
from validation.cases.fault_gaps import compared
from validation.schema import Reference

PERIOD, YOUNGS_MODULUS = 0.01, 1e6
MODULUS = YOUNGS_MODULUS / (1 - 0.3**2)


def _theory_by_quadrature() -> Outcome:
    posed = adapters.scene("rough_100", {"solid": {"poisson_ratio": 0.3}, "profile": {"harmonics": 40}})
    surface = posed.surface()
    spectrum = adapters.persson_spectrum(posed)
    pressure = 0.01 * MODULUS
    contact = persson.solve_nonadhesive(spectrum, pressure, youngs_modulus=YOUNGS_MODULUS, poisson_ratio=0.3)
    q = 2 * np.pi * surface.orders / PERIOD
    steps = (q * surface.amplitudes) ** 2 / 2
    ends = np.cumsum(steps)
    node, weight = np.polynomial.legendre.leggauss(200)
    square = ((node + 1) / 2) ** 2  # the integrands of the first line have a root at zero
    inside = (ends - steps)[:, None] + steps[:, None] * square
    measure = steps[:, None] * weight * (node + 1) / 2
    load = pressure / MODULUS
    area = erf(load * np.sqrt(2 / inside))
    gap = np.sqrt(2 / (np.pi * inside)) * exp1(2 * load**2 / inside)
    source = Reference(kind="independent code", source="Gauss-Legendre quadrature of the definitions, line by line")
    total = float(ends[-1])
    rows = (
        compared(
            "contact fraction",
            "",
            source,
            [float(erf(load * np.sqrt(2 / total)))],
            [contact.contact_fraction],
            *MEASURED_THEORY[0],
        ),
        compared(
            "elastic energy",
            "J/m^2",
            source,
            [MODULUS * float(np.sum(np.sum(area * measure, axis=1) / q)) / 4],
            [contact.elastic_energy],
            *MEASURED_THEORY[1],
        ),
        compared(
            "separation",
            "m",
            source,
            [float(np.sum(np.sum(gap * measure, axis=1) / q)) / 4],
            [contact.separation],
            *MEASURED_THEORY[2],
        ),
    )
    return Outcome(rows=rows)


def _adhesive(route: Literal["finite_volumes", "volterra"]) -> tuple[float, float]:
    """Contact fraction, and total energy in J/m^2, of the theory with adhesion."""
    found = persson.solve(
        persson.DiscreteSpectrum.self_affine(2 * np.pi / PERIOD, 0.7, 50e-6, 30),
        1e4,
        youngs_modulus=YOUNGS_MODULUS,
        poisson_ratio=0.3,
        work_of_adhesion=0.03,
        route=route,
        with_separation=False,
    )
    if not isinstance(found, persson.AdhesiveContact):
        raise TypeError(f"{route}: a contact without adhesion came back")
    return found.contact_fraction, found.total_energy


def _theory_by_two_routes() -> Outcome:
    volumes, integral = _adhesive("finite_volumes"), _adhesive("volterra")
    source = Reference(kind="self", source="the Volterra route of the same theory")
    rows = (
        compared(
            "contact fraction with adhesion by two routes",
            "",
            source,
            [integral[0]],
            [volumes[0]],
            *MEASURED_ROUTES[0],
        ),
        compared(
            "total energy with adhesion by two routes",
            "J/m^2",
            source,
            [integral[1]],
            [volumes[1]],
            *MEASURED_ROUTES[1],
        ),
    )
    return Outcome(rows=rows)


# tolerance, error measured
MEASURED_THEORY = ((2e-15, 1.8e-16), (5e-15, 8.5e-16), (5e-15, 1.7e-15))
MEASURED_ROUTES = ((1e-5, 3.3e-6), (1.4e-7, 4.7e-8))

CASES = (
    Case(
        id="theory-quadrature",
        group="theory",
        level="quick",
        question="Are the closed forms of the theory without adhesion the integrals they stand for?",
        equations="A = erf(sqrt 2 sigma_0 / (E* S^1/2)),  U_el = E* / 4 int A / q dS,  narrow-band rule inside a line",
        sources=("persson2001", "carbone2009"),
        compute=_theory_by_quadrature,
    ),
    Case(
        id="theory-two-routes",
        group="theory",
        level="quick",
        question="Do finite volumes and the Volterra equation agree on the theory with adhesion?",
        equations="dP/dV = P'' / 2, P(-a(V), V) = 0;  N(-D / sqrt V) = int N(-(D - D') / sqrt(V - V')) dF",
        sources=("carbone2009", "persson2001"),
        compute=_theory_by_two_routes,
        effects=("adhesion",),
    ),
)
