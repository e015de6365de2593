"""The theory against what it stands for: its closed forms by plain quadrature, and its energies by its two routes.

Without adhesion the integrals over the slope variance are summed line by line with Gauss-Legendre points, the
wavenumber of line m holding while V runs from S_{m-1} / 4 to S_m / 4.  With adhesion the energies are integrals over
all magnifications, by finite volumes and by the Volterra equation; areas by both routes: theory_accuracy.py.  SI units.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.special import erf, exp1

import persson
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared
from validation.harness.schema import Reference
from validation.references import adapters

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
        compared("contact fraction", "", source, [float(erf(load * np.sqrt(2 / total)))], [contact.contact_fraction],
                 *MEASURED_THEORY[0]),
        compared("elastic energy", "J/m^2", source, [MODULUS * float(np.sum(np.sum(area * measure, axis=1) / q)) / 4],
                 [contact.elastic_energy],
                 *MEASURED_THEORY[1]),
        compared("separation", "m", source, [float(np.sum(np.sum(gap * measure, axis=1) / q)) / 4],
                 [contact.separation],
                 *MEASURED_THEORY[2]),
    )  # fmt: skip
    return Outcome(rows=rows)


def _energies(route: Literal["finite_volumes", "volterra"]) -> tuple[float, float]:
    """Elastic energy and energy of adhesion of the theory, J/m^2."""
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
    return found.elastic_energy, found.adhesion_energy


def _energies_by_two_routes() -> Outcome:
    source = Reference(kind="self", source="the Volterra route of the same theory")
    pairs = zip(_energies("volterra"), _energies("finite_volumes"), strict=True)
    rows = tuple(
        compared(f"{name} by two routes", "J/m^2", source, [integral], [volumes], *bounds)
        for name, (integral, volumes), bounds in zip(
            ("elastic energy with adhesion", "energy of adhesion"), pairs, MEASURED_ROUTES, strict=True
        )
    )
    return Outcome(rows=rows)


# tolerance, error measured
MEASURED_THEORY = ((2e-15, 1.8e-16), (5e-15, 8.5e-16), (5e-15, 1.7e-15))
MEASURED_ROUTES = ((6e-9, 2.1e-9), (8e-6, 3.3e-6))

CASES = (
    Case(id="theory-quadrature", group="theory", code="persson", level="quick",
         question="Are the closed forms of the theory without adhesion the integrals they stand for?",
         equations=r"$A = \operatorname{erf}(\sqrt{2} \, \sigma_0 / (E^\ast \sqrt{S}))$, "
                   r"$U_{\text{el}} = \frac{E^\ast}{4} \int \frac{A}{q} \, dS$, narrow-band rule inside a line",
         sources=("persson2001", "carbone2009"), compute=_theory_by_quadrature),
    Case(id="theory-energies", group="theory", code="persson", level="quick",
         question="Do finite volumes and the Volterra equation store the same energies in the theory with adhesion?",
         equations=r"$U_{\text{el}} = \frac{E^\ast}{4} \int \frac{A}{q} \, dS$ at $A$ with adhesion, "
                   r"$U_{\text{ad}} = -\gamma A M$, both at all roughness",
         sources=("carbone2009", "persson2001"), compute=_energies_by_two_routes, effects=("adhesion",)),
)  # fmt: skip
