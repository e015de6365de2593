"""Persson's theory: how exactly this implementation solves it, without adhesion and with it.

Without adhesion the closed forms against plain quadrature of what they stand for: integrals over the slope variance,
summed line by line with Gauss-Legendre points, the wavenumber of line m holding while V runs from S_{m-1} / 4 to
S_m / 4.  With adhesion reference points of the paper's case, two routes that share no discretisation of the stress
(areas and energies), refinement, and the balance of the load: once the barrier moves, int sigma P is not conserved but
gains a (-dA/dV).  SI units.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.special import erf, exp1

import persson
from persson.adhesive import ROUTES, Route
from persson.spectrum import Spectrum
from validation.cases.shared.checks import Against, Found, case, column, posed
from validation.harness.figure_data import drawn, loglog, marks, semilogx, trace
from validation.harness.schema import Table
from validation.references import adapters

YOUNGS_MODULUS, POISSON_RATIO, WORK_OF_ADHESION = 1e6, 0.5, 0.03
MODULUS = YOUNGS_MODULUS / (1 - POISSON_RATIO**2)
PAPER: dict[str, Any] = {"youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO,
                         "work_of_adhesion": WORK_OF_ADHESION, "with_separation": False}  # fmt: skip
Q0 = 2 * np.pi / 0.01
LOADS = (0.005, 0.02, 0.1)  # of E*
CURVE = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)
RESOLUTIONS = (0.25, 0.5, 1.0, 2.0)
REFERENCE_RESOLUTION = 4.0
ORDERS = (1, 3, 10, 30, 100, 200, 250, 275, 300, 400, 450, 500, 600, 700, 800, 900, 1000)
CONVERGENCE = ((2.0e-6, 2.1e-6, 1.5e-6), (1.2e-6, 1.2e-6, 1.1e-6), (2.7e-6, 2.7e-6, 2.3e-6))  # measured at LOADS
AREA, APART = "contact_fraction", "separation"
ROUTE_NAMES: dict[Route, str] = {"finite_volumes": "finite volumes", "volterra": "integral equation"}
SCENE = "E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2\nlines m q0, m = 1..1000, q0 = 2 pi / 10 mm, H = 0.7, h_rms = 50 um"
SCENES = SCENE + "\nH = 0.5, 300 lines, else the same\npower spectrum of the same h_rms and cut-offs"


def spectra() -> dict[str, Spectrum]:
    """The paper's lines, fewer and rougher lines, and a power spectrum of the same h_rms and cut-offs as the first."""
    return {
        "paper's lines": persson.DiscreteSpectrum.self_affine(Q0, 0.7, 50e-6, 1000),
        "H = 0.5, 300 lines": persson.DiscreteSpectrum.self_affine(Q0, 0.5, 50e-6, 300),
        "power spectrum": persson.ContinuousSpectrum.self_affine(Q0, 1000 * Q0, 0.7, 50e-6),
    }


def adhesive(spectrum: Spectrum, load: float, **options: Any) -> persson.AdhesiveContact:
    """The theory with adhesion at a load in units of the paper's E*, the paper's material; options of `solve`."""
    state = persson.solve(spectrum, load * MODULUS, **PAPER | options)
    if not isinstance(state, persson.AdhesiveContact):
        raise TypeError(f"work_of_adhesion = {WORK_OF_ADHESION} must give a state with adhesion")
    return state


def dry(spectrum: Spectrum, load: float) -> persson.NonadhesiveContact:
    """The theory without adhesion at a load in units of E*."""
    return persson.solve_nonadhesive(spectrum, load * MODULUS, youngs_modulus=YOUNGS_MODULUS,
                                     poisson_ratio=POISSON_RATIO)  # fmt: skip


def _quadrature() -> Found:
    scene = posed("rough_100", solid={"poisson_ratio": 0.3}, profile={"harmonics": 40})
    surface, modulus, load = scene.surface(), YOUNGS_MODULUS / (1 - 0.3**2), 0.01
    contact = persson.solve_nonadhesive(adapters.persson_spectrum(scene), load * modulus, youngs_modulus=YOUNGS_MODULUS,
                                        poisson_ratio=0.3)  # fmt: skip
    q = 2 * np.pi * surface.orders / surface.period
    steps = (q * surface.amplitudes) ** 2 / 2
    ends = np.cumsum(steps)
    node, weight = np.polynomial.legendre.leggauss(200)
    square = ((node + 1) / 2) ** 2  # the integrands of the first line have a root at zero
    inside = (ends - steps)[:, None] + steps[:, None] * square
    measure = steps[:, None] * weight * (node + 1) / 2
    area = erf(load * np.sqrt(2 / inside))
    gap = np.sqrt(2 / (np.pi * inside)) * exp1(2 * load**2 / inside)
    summed = Against("independent code", "Gauss-Legendre quadrature of the definitions, line by line")
    yield summed.row("contact fraction", "", float(erf(load * np.sqrt(2 / float(ends[-1])))), contact.contact_fraction,
                     (2e-15, 1.8e-16))  # fmt: skip
    yield summed.row("elastic energy", "J/m^2", modulus * float(np.sum(np.sum(area * measure, axis=1) / q)) / 4,
                     contact.elastic_energy, (5e-15, 8.5e-16))  # fmt: skip
    yield summed.row("separation", "m", float(np.sum(np.sum(gap * measure, axis=1) / q)) / 4, contact.separation,
                     (5e-15, 1.7e-15))  # fmt: skip


def _energies() -> Found:
    spectrum = persson.DiscreteSpectrum.self_affine(Q0, 0.7, 50e-6, 30)
    volumes, integral = (adhesive(spectrum, 1e4 / MODULUS, route=route, poisson_ratio=0.3) for route in ROUTES)
    known = Against("self", "the Volterra route of the same theory")
    yield known.row("elastic energy with adhesion by two routes", "J/m^2", integral.elastic_energy,
                    volumes.elastic_energy, (6e-9, 2.1e-9))  # fmt: skip
    yield known.row("energy of adhesion by two routes", "J/m^2", integral.adhesion_energy, volumes.adhesion_energy,
                    (8e-6, 3.3e-6))  # fmt: skip


def _points() -> Found:
    spectrum, loads = spectra()["paper's lines"], (0.005, 0.02)
    without = [dry(spectrum, load) for load in loads]
    wet = [adhesive(spectrum, load, with_separation=True) for load in loads]
    known = Against("theory", "points of the paper's case: narrow-band rule, factor of a 1D slope")
    for quantity, states, name, unit, expected, measured, required in (
        ("A/A0 without adhesion, 0.005 and 0.02 E*", without, AREA, 1.0, (0.0292763, 0.1167122), 2.8e-8, 5e-8),
        ("A/A0 with adhesion, 0.005 and 0.02 E*", wet, AREA, 1.0, (0.03397, 0.13527), 3.9e-6, 5e-6),
        ("separation over h_rms without adhesion", without, APART, spectrum.h_rms, (0.85857, 0.15338), 2.9e-6, 5e-6),
        ("separation over h_rms with adhesion", wet, APART, spectrum.h_rms, (0.8488, 0.1477), 4.4e-5, 5e-5),
    ):
        yield known.row(quantity, "", expected, column(states, name, unit), measured, "absolute", required=required)
    yield {"nodes": sum(state.areas.size for state in wet)}
    yield {"iterations": sum(state.fields.iterations for state in wet)}


def _routes() -> Found:
    solution, errors = [], []
    for (name, spectrum), measured in zip(spectra().items(), (4.5e-6, 2.8e-6, 5.6e-6), strict=True):
        volumes, integral = (
            np.array([adhesive(spectrum, load, route=route).contact_fraction for load in CURVE]) for route in ROUTES
        )
        yield Against("self", "the other route, with its own fixed point").row(
            f"A/A0 by finite volumes over that by the integral equation, {name}", "", [1.0] * len(CURVE),
            volumes / integral, measured, scale=1.0, required=1e-5, pinned="unconverged")  # fmt: skip
        solution += [trace(name, CURVE, volumes), marks(f"{name}, integral equation", CURVE, integral)]
        errors.append(marks(name, CURVE, volumes / integral - 1))
    yield drawn("theory-routes",
                "Contact fraction of the theory with adhesion by two routes: conservative finite volumes on the moving "
                "domain (lines) and a Volterra integral equation for the flux at the barrier (points).",
                loglog("load / E*", "A / A0", *(solution[::2] + solution[1::2])),
                semilogx("load / E*", "ratio of routes - 1", *errors))  # fmt: skip


def _convergence() -> Found:
    finer = Against("self", "every discretisation at half the step")
    for (name, spectrum), known in zip(spectra().items(), CONVERGENCE, strict=True):
        for load, measured in zip(LOADS, known, strict=True):
            default, half = (adhesive(spectrum, load, resolution=factor).contact_fraction for factor in (1.0, 2.0))
            yield finer.row(f"A/A0 at {load} E*, {name}", "", half, default, measured, required=1e-5)
    spectrum = spectra()["paper's lines"]
    series, table = [], []
    for route, words in ROUTE_NAMES.items():
        reference = adhesive(spectrum, 0.02, route=route, resolution=REFERENCE_RESOLUTION).contact_fraction
        states = [adhesive(spectrum, 0.02, route=route, resolution=factor) for factor in RESOLUTIONS]
        errors = [abs(state.contact_fraction / reference - 1) for state in states]
        series.append(marks(words, [state.areas.size for state in states], errors))
        table += [[words, factor, state.areas.size, state.contact_fraction, error]
                  for factor, state, error in zip(RESOLUTIONS, states, errors, strict=True)]  # fmt: skip
    yield drawn("theory-self-convergence",
                "Error of A/A0 at 0.02 E* of the paper's lines, against the same route at "
                f"{REFERENCE_RESOLUTION:g} times the default resolution.",
                loglog("nodes in magnification", "relative error of A / A0", *series))  # fmt: skip
    yield Table(caption="Refinement of both routes, paper's lines, 0.02 E*.",
                columns=["route", "resolution", "nodes", "A/A0", "error"], rows=table)  # fmt: skip


def _balance() -> Found:
    carried, absorbed, errors = [], [], []
    for (name, spectrum), measured in zip(spectra().items(), (6.7e-7, 1.1e-7, 2.3e-7), strict=True):
        state = adhesive(spectrum, 0.02)
        gained_at = PchipInterpolator(state.slope_variances, _absorbed(state) / 0.02)
        zeta, at, due = [], [], []
        for order in (order for order in ORDERS if order * Q0 <= spectrum.wavenumbers[-1]):
            variance = spectrum.resolved_variance(order * Q0)
            if variance == 0:  # the lowest wavenumber of a power spectrum
                continue
            zeta.append(float(order))
            at.append(float(state.stress_distribution(order * Q0).load[0]) / 0.02)
            due.append(1 + float(gained_at(variance)))
        yield Against("exact", "1 + int a (-dA/dV) dV / sigma_0").row(
            f"int sigma P / sigma_0 at magnifications up to all roughness, {name}", "", due, at, measured, scale=1.0,
            required=1e-6)  # fmt: skip
        carried.append(marks(f"{name}: int sigma P", zeta, at))
        absorbed.append(trace(f"{name}: 1 + int a (-dA)", zeta, due))
        errors.append(marks(name, zeta, np.subtract(at, due)))
    yield drawn("theory-load-balance",
                "Mean stress carried by the contact at each magnification, over sigma_0 = 0.02 E*: it grows once the "
                "effective work of adhesion is positive, by the tension at which contact is lost.",
                semilogx("magnification q / q0", "int sigma P / sigma_0", *(carried + absorbed)),
                semilogx("magnification q / q0", "difference", *errors))  # fmt: skip


def _absorbed(state: persson.AdhesiveContact) -> NDArray[np.float64]:
    """int a (-dA) up to each node in units of E*, (n + 1,)."""
    barrier = state.fields.problem.mesh.smoothed(state.fields.barrier)[0]
    return np.concatenate([[0.0], np.cumsum((barrier[1:] + barrier[:-1]) / 2 * -np.diff(state.areas))])


EQUATIONS = (
    r"$\frac{\partial P}{\partial V} = \frac{1}{2} \frac{\partial^2 P}{\partial \sigma^2}$, "
    r"$P = 0$ at $\sigma = -a(V)$, $a = \frac{1}{\pi} \sqrt{2 \gamma_{\text{eff}} \, q / E^\ast}$, "
    r"$\gamma_{\text{eff}} A = \gamma A(1) M - U_{\text{el}}(V)$"
)

CASES = (
    case("theory-quadrature", "theory", _quadrature,
         "Are the closed forms of the theory without adhesion the integrals they stand for?",
         r"$A = \operatorname{erf}(\sqrt{2} \, \sigma_0 / (E^\ast \sqrt{S}))$, "
         r"$U_{\text{el}} = \frac{E^\ast}{4} \int \frac{A}{q} \, dS$, narrow-band rule inside a line",
         "persson2001 carbone2009", code="persson"),
    case("theory-energies", "theory", _energies,
         "Do finite volumes and the Volterra equation store the same energies in the theory with adhesion?",
         r"$U_{\text{el}} = \frac{E^\ast}{4} \int \frac{A}{q} \, dS$ at $A$ with adhesion, "
         r"$U_{\text{ad}} = -\gamma A M$, both at all roughness",
         "carbone2009 persson2001", "adhesion", code="persson"),
    case("theory-points", "theory", _points,
         "Does the theory with adhesion reproduce area and separation of the paper's case?",
         EQUATIONS, "carbone2009 persson2001 persson2002", "adhesion", code="persson", scene=SCENE),
    case("theory-routes", "theory", _routes,
         "Do finite volumes and an integral equation, each with its own fixed point, give the same area?",
         EQUATIONS + r"; $N(\frac{-D(V)}{\sqrt{V}}) = \int N(-\frac{D(V) - D(U)}{\sqrt{V - U}}) \, dF(U)$, "
         r"$D = \sigma_0 + a$, $F = 1 - A$",
         "carbone2009 peskir2002", "adhesion", code="persson", scene=SCENES),
    case("theory-convergence", "theory", _convergence,
         "Does the area of the theory with adhesion converge when every step is halved?",
         EQUATIONS, "carbone2009", "adhesion", code="persson", scene=SCENES),
    case("theory-load-balance", "theory", _balance,
         "Does the load grow by just the stress that the moving barrier absorbs?",
         r"$\frac{d}{dV} \int \sigma P \, d\sigma = -a \frac{dA}{dV}$",
         "carbone2009", "adhesion", code="persson", scene=SCENES),
)  # fmt: skip
