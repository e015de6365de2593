"""Persson's theory with adhesion: how exactly this implementation solves it.

Reference points of the paper's case, two routes that share no discretisation of the stress, refinement, and the
balance of the load: once the barrier moves, int sigma P is not conserved but gains a (-dA/dV).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

import persson
from persson.adhesive import ROUTES, Route
from persson.spectrum import Spectrum
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, marks, semilogx, trace
from validation.harness.rows import compared
from validation.harness.schema import Reference, Table

YOUNGS_MODULUS, POISSON_RATIO, WORK_OF_ADHESION = 1e6, 0.5, 0.03
MODULUS = YOUNGS_MODULUS / (1 - POISSON_RATIO**2)
Q0 = 2 * np.pi / 0.01
LOADS = (0.005, 0.02, 0.1)  # of E*
CURVE = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)
RESOLUTIONS = (0.25, 0.5, 1.0, 2.0)
REFERENCE_RESOLUTION = 4.0
ORDERS = (1, 3, 10, 30, 100, 200, 250, 275, 300, 400, 450, 500, 600, 700, 800, 900, 1000)
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


def adhesive(
    spectrum: Spectrum,
    load: float,
    *,
    route: Route = "finite_volumes",
    resolution: float = 1.0,
    with_separation: bool = False,
    detached_width: float = 1.0,
    area_factor: str = "gaussian_slope_1d",
) -> persson.AdhesiveContact:
    """The theory with adhesion at a load in units of E*, the paper's material."""
    state = persson.solve(
        spectrum,
        load * MODULUS,
        youngs_modulus=YOUNGS_MODULUS,
        poisson_ratio=POISSON_RATIO,
        work_of_adhesion=WORK_OF_ADHESION,
        route=route,
        resolution=resolution,
        with_separation=with_separation,
        detached_width=detached_width,
        area_factor=area_factor,
    )
    if not isinstance(state, persson.AdhesiveContact):
        raise TypeError(f"work_of_adhesion = {WORK_OF_ADHESION} must give a state with adhesion")
    return state


def dry(spectrum: Spectrum, load: float) -> persson.NonadhesiveContact:
    """The theory without adhesion at a load in units of E*."""
    return persson.solve_nonadhesive(
        spectrum, load * MODULUS, youngs_modulus=YOUNGS_MODULUS, poisson_ratio=POISSON_RATIO
    )


def _points() -> Outcome:
    spectrum = spectra()["paper's lines"]
    loads = (0.005, 0.02)
    without = [dry(spectrum, load) for load in loads]
    with_adhesion = [adhesive(spectrum, load, with_separation=True) for load in loads]
    source = Reference(kind="theory", source="points of the paper's case: narrow-band rule, factor of a 1D slope")
    given: tuple[tuple[str, list[float], list[float | None], float], ...] = (
        ("A/A0 without adhesion, 0.005 and 0.02 E*", [0.0292763, 0.1167122],
         [state.contact_fraction for state in without], 5e-8),
        ("A/A0 with adhesion, 0.005 and 0.02 E*", [0.03397, 0.13527],
         [state.contact_fraction for state in with_adhesion], 5e-6),
        ("separation over h_rms without adhesion", [0.85857, 0.15338],
         [state.separation / spectrum.h_rms for state in without], 5e-6),
        ("separation over h_rms with adhesion", [0.8488, 0.1477],
         [None if state.separation is None else state.separation / spectrum.h_rms for state in with_adhesion], 5e-5),
    )  # fmt: skip
    rows = tuple(
        compared(quantity, "", source, expected, computed, tolerance, measured, "absolute", basis="required")
        for (quantity, expected, computed, tolerance), measured in zip(given, MEASURED_POINTS, strict=True)
    )
    counts = {
        "nodes": sum(state.areas.size for state in with_adhesion),
        "iterations": sum(state.fields.iterations for state in with_adhesion),
    }
    return Outcome(rows=rows, counts=counts)


def _routes() -> Outcome:
    rows, solution, errors = [], [], []
    for (name, spectrum), measured in zip(spectra().items(), MEASURED_ROUTES, strict=True):
        volumes, integral = (
            [adhesive(spectrum, load, route=route).contact_fraction for load in CURVE] for route in ROUTES
        )
        ratio = [one / other for one, other in zip(volumes, integral, strict=True)]
        rows.append(
            compared(f"A/A0 by finite volumes over that by the integral equation, {name}", "",
                     Reference(kind="self", source="the other route, with its own fixed point"), [1.0] * len(CURVE),
                     ratio, 1e-5, measured, scale=1.0, basis="required", pinned="unconverged"),
        )  # fmt: skip
        solution += [trace(name, CURVE, volumes), marks(f"{name}, integral equation", CURVE, integral)]
        errors.append(marks(name, CURVE, [value - 1 for value in ratio]))
    figure = drawn(
        "theory-routes",
        "Contact fraction of the theory with adhesion by two routes: conservative finite volumes on the moving "
        "domain (lines) and a Volterra integral equation for the flux at the barrier (points).",
        loglog("load / E*", "A / A0", *(solution[::2] + solution[1::2])),
        semilogx("load / E*", "ratio of routes - 1", *errors),
    )
    return Outcome(rows=tuple(rows), figures=(figure,))


def _convergence() -> Outcome:
    rows = []
    for index, (name, spectrum) in enumerate(spectra().items()):
        for place, load in enumerate(LOADS):
            default, finer = (adhesive(spectrum, load, resolution=factor).contact_fraction for factor in (1.0, 2.0))
            rows.append(
                compared(f"A/A0 at {load} E*, {name}", "",
                         Reference(kind="self", source="every discretisation at half the step"), [finer], [default],
                         1e-5, MEASURED_CONVERGENCE[index][place], basis="required"),
            )  # fmt: skip
    spectrum = spectra()["paper's lines"]
    series, table = [], []
    for route in ROUTES:
        reference = adhesive(spectrum, 0.02, route=route, resolution=REFERENCE_RESOLUTION).contact_fraction
        states = [adhesive(spectrum, 0.02, route=route, resolution=factor) for factor in RESOLUTIONS]
        error = [abs(state.contact_fraction / reference - 1) for state in states]
        series.append(marks(ROUTE_NAMES[route], [s.areas.size for s in states], error))
        table += [
            [ROUTE_NAMES[route], factor, state.areas.size, state.contact_fraction, value]
            for factor, state, value in zip(RESOLUTIONS, states, error, strict=True)
        ]
    figure = drawn(
        "theory-self-convergence",
        f"Error of A/A0 at 0.02 E* of the paper's lines, against the same route at {REFERENCE_RESOLUTION:g} times "
        "the default resolution.",
        loglog("nodes in magnification", "relative error of A / A0", *series),
    )
    columns = ["route", "resolution", "nodes", "A/A0", "error"]
    return Outcome(
        rows=tuple(rows),
        figures=(figure,),
        tables=(Table(caption="Refinement of both routes, paper's lines, 0.02 E*.", columns=columns, rows=table),),
    )


def _balance() -> Outcome:
    rows, carried, absorbed, errors = [], [], [], []
    for (name, spectrum), measured in zip(spectra().items(), MEASURED_BALANCE, strict=True):
        state = adhesive(spectrum, 0.02)
        gained = _absorbed(state) / 0.02
        gained_at = PchipInterpolator(state.slope_variances, gained)
        zeta, at, due = [], [], []
        resolvable = [order for order in ORDERS if order * Q0 <= spectrum.wavenumbers[-1]]
        for order in resolvable:
            variance = spectrum.resolved_variance(order * Q0)
            if variance == 0:  # the lowest wavenumber of a power spectrum
                continue
            zeta.append(float(order))
            at.append(float(state.stress_distribution(order * Q0).load[0]) / 0.02)
            due.append(1 + float(gained_at(variance)))
        rows.append(
            compared(f"int sigma P / sigma_0 at magnifications up to all roughness, {name}", "",
                     Reference(kind="exact", source="1 + int a (-dA/dV) dV / sigma_0"), due, at, 1e-6, measured,
                     scale=1.0, basis="required"),
        )  # fmt: skip
        carried.append(marks(f"{name}: int sigma P", zeta, at))
        absorbed.append(trace(f"{name}: 1 + int a (-dA)", zeta, due))
        errors.append(marks(name, zeta, [one - other for one, other in zip(at, due, strict=True)]))
    figure = drawn(
        "theory-load-balance",
        "Mean stress carried by the contact at each magnification, over sigma_0 = 0.02 E*: it grows once the "
        "effective work of adhesion is positive, by the tension at which contact is lost.",
        semilogx("magnification q / q0", "int sigma P / sigma_0", *(carried + absorbed)),
        semilogx("magnification q / q0", "difference", *errors),
    )
    return Outcome(rows=tuple(rows), figures=(figure,))


def _absorbed(state: persson.AdhesiveContact) -> NDArray[np.float64]:
    """int a (-dA) up to each node in units of E*, (n + 1,)."""
    barrier = state.fields.problem.mesh.smoothed(state.fields.barrier)[0]
    return np.concatenate([[0.0], np.cumsum((barrier[1:] + barrier[:-1]) / 2 * -np.diff(state.areas))])


MEASURED_POINTS = (2.8e-8, 3.9e-6, 2.9e-6, 4.4e-5)
MEASURED_ROUTES = (4.5e-6, 2.8e-6, 5.6e-6)
MEASURED_CONVERGENCE = ((2.0e-6, 2.1e-6, 1.5e-6), (1.2e-6, 1.2e-6, 1.1e-6), (2.7e-6, 2.7e-6, 2.3e-6))
MEASURED_BALANCE = (6.7e-7, 1.1e-7, 2.3e-7)

EQUATIONS = (
    r"$\frac{\partial P}{\partial V} = \frac{1}{2} \frac{\partial^2 P}{\partial \sigma^2}$, "
    r"$P = 0$ at $\sigma = -a(V)$, $a = \frac{1}{\pi} \sqrt{2 \gamma_{\text{eff}} \, q / E^\ast}$, "
    r"$\gamma_{\text{eff}} A = \gamma A(1) M - U_{\text{el}}(V)$"
)

CASES = (
    Case(id="theory-points", group="theory", code="persson", level="quick",
         question="Does the theory with adhesion reproduce area and separation of the paper's case?",
         equations=EQUATIONS,
         sources=("carbone2009", "persson2001", "persson2002"), compute=_points, effects=("adhesion",), scene=SCENE),
    Case(
        id="theory-routes", group="theory", code="persson", level="quick",
        question="Do finite volumes and an integral equation, each with its own fixed point, give the same area?",
        equations=EQUATIONS + r"; $N(\frac{-D(V)}{\sqrt{V}}) = \int N(-\frac{D(V) - D(U)}{\sqrt{V - U}}) \, dF(U)$, "
        r"$D = \sigma_0 + a$, $F = 1 - A$",
        sources=("carbone2009", "peskir2002"), compute=_routes, effects=("adhesion",), scene=SCENES
    ),
    Case(id="theory-convergence", group="theory", code="persson", level="quick",
         question="Does the area of the theory with adhesion converge when every step is halved?",
         equations=EQUATIONS,
         sources=("carbone2009",), compute=_convergence, effects=("adhesion",), scene=SCENES),
    Case(id="theory-load-balance", group="theory", code="persson", level="quick",
         question="Does the load grow by just the stress that the moving barrier absorbs?",
         equations=r"$\frac{d}{dV} \int \sigma P \, d\sigma = -a \frac{dA}{dV}$",
         sources=("carbone2009",), compute=_balance, effects=("adhesion",), scene=SCENES),
)  # fmt: skip
