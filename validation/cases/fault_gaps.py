"""Small cases that faults asked for: what no other case of the quick level would have seen (study faults).

A layer against the finite elements and against its closed form, the theory against plain quadrature and by its two
routes, spectra and pressure distribution against closed forms, a profile shifted over the end of the period, and
phases of realisations.  References are written here from the equations, with none of the codes compared.  SI units.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf, exp1

import bem
import fem_reference
import persson
from validation import adapters
from validation.case import Case, Outcome
from validation.cases.closed_forms import Sinusoid
from validation.schema import Norm, Reference, Row, Tolerance

FloatArray = NDArray[np.float64]
PERIOD, YOUNGS_MODULUS = 0.01, 1e6
MODULUS = YOUNGS_MODULUS / (1 - 0.3**2)  # of solids with nu = 0.3


def _row(
    quantity: str,
    unit: str,
    reference: Reference,
    expected: Sequence[float],
    computed: Sequence[float],
    tolerance: float,
    measured: float,
    norm: Norm = "relative",
) -> Row:
    """A comparison scaled by the largest value expected, or not at all where the norm is absolute."""
    return Row(
        quantity=quantity,
        unit=unit,
        reference=reference,
        norm=norm,
        expected=[float(value) for value in expected],
        computed=[float(value) for value in computed],
        scale=1.0 if norm == "absolute" else float(np.max(np.abs(expected))),
        tolerance=Tolerance(value=tolerance, measured=measured),
    )


def _layer_compliance(q: FloatArray, thickness: float, nu: float) -> FloatArray:
    """c(q) in m/Pa of a bonded layer, as printed: fine for q d of order one."""
    y = 2 * q * thickness
    bracket = ((3 - 4 * nu) * np.sinh(y) - y) / ((3 - 4 * nu) * np.cosh(y) + y**2 / 2 + 5 - 12 * nu + 8 * nu**2)
    return np.asarray(2 * (1 - nu**2) / (YOUNGS_MODULUS * q) * bracket)


def _layer_complete() -> Outcome:
    nu, thickness, pressure = 0.3, 0.1 * PERIOD, 2e5
    orders, amplitudes = np.array([1, 2, 5]), np.array([20e-6, 10e-6, 3e-6])
    changes: dict[str, Any] = {
        "adhesion": None,
        "solid": {"poisson_ratio": nu},
        "profile": {
            "kind": "harmonics",
            "orders": orders.tolist(),
            "amplitudes": amplitudes.tolist(),
            "phases": [0.0, 1.0, 2.0],
            **dict.fromkeys(("hurst", "rms_height", "harmonics", "seed")),
        },
        "layer": {"thickness": thickness},
        "loading": {"control": "mean_pressure", "targets": [pressure]},
    }
    posed = adapters.scene("rough_100", changes)
    (state,) = bem.solve(posed).targets
    compliance = _layer_compliance(2 * np.pi * orders / PERIOD, thickness, nu)
    mean = thickness * (1 - 2 * nu) * (1 + nu) / (YOUNGS_MODULUS * (1 - nu))
    x = np.linspace(0, PERIOD, 1 << 16)
    height = np.cos(2 * np.pi * np.outer(x, orders) / PERIOD + [0.0, 1.0, 2.0]) @ amplitudes
    source = Reference(kind="exact", source="Carbone and Mangialardi 2008, mode by mode")
    rows = (
        _row(
            "elastic energy of complete contact",
            "J/m^2",
            source,
            [float(np.sum(amplitudes**2 / compliance)) / 4],
            [state.elastic_energy],
            *MEASURED_LAYER_ENERGY,
        ),
        _row(
            "total displacement, with the mean compression",
            "m",
            source,
            [float(height.max()) + mean * pressure],
            [float("nan") if state.total_displacement is None else state.total_displacement],
            *MEASURED_LAYER_DISPLACEMENT,
        ),
    )
    return Outcome(rows=rows)


def _layer_by_fem() -> Outcome:
    nu, thickness, penetration = 0.3, 0.2 * PERIOD, 12e-6
    orders, amplitudes, phases = [1, 2], [4e-6, 20e-6], [0.5, 0.3]
    profile = bem.Profile.from_harmonics(PERIOD, orders, amplitudes, phases)
    edges = [[place - 0.7e-3, place + 0.9e-3] for place in np.sort(profile.crests[0])]
    solid, layer = bem.Solid(YOUNGS_MODULUS, nu), bem.Layer(thickness)
    state = bem.ContactState(profile, solid, edges, penetration, layer=layer)
    found = fem_reference.solve(
        youngs_modulus=YOUNGS_MODULUS,
        poisson_ratio=nu,
        thickness=thickness,
        period=PERIOD,
        harmonics=(orders, amplitudes, phases),
        control="penetration",
        value=penetration,
        edges=edges,
        resolution=fem_reference.Resolution(2, 8, 8),
    )
    known: dict[str, tuple[str, list[float], list[float]]] = {
        "load": ("N/m", [state.load], [found.load]),
        "stress_intensity": (
            "Pa m^1/2",
            state.stress_intensity.ravel().tolist(),
            found.stress_intensity.ravel().tolist(),
        ),
        "elastic_energy": ("J/m", [state.elastic_energy], [found.elastic_energy]),
        "total_displacement": (
            "m",
            [layer.total_displacement(solid, penetration, state.mean_pressure)],
            [found.total_displacement],
        ),
    }
    rows = tuple(
        _row(
            f"{name.replace('_', ' ')} at given edges",
            unit,
            Reference(kind="FEM", source="P2/P1, 8 cells", uncertainty=float(np.max(found.uncertainty[name]))),
            expected,
            computed,
            *MEASURED_FEM[name],
        )
        for name, (unit, computed, expected) in known.items()
    )
    return Outcome(rows=rows, counts={"unknowns": found.unknowns})


def _theory_by_quadrature() -> Outcome:
    """Line by line, V running from S_{m-1} / 4 to S_m / 4 with the wavenumber of line m."""
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
        _row(
            "contact fraction",
            "",
            source,
            [float(erf(load * np.sqrt(2 / total)))],
            [contact.contact_fraction],
            *MEASURED_THEORY[0],
        ),
        _row(
            "elastic energy",
            "J/m^2",
            source,
            [MODULUS * float(np.sum(np.sum(area * measure, axis=1) / q)) / 4],
            [contact.elastic_energy],
            *MEASURED_THEORY[1],
        ),
        _row(
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
        _row(
            "contact fraction with adhesion by two routes",
            "",
            source,
            [integral[0]],
            [volumes[0]],
            *MEASURED_ROUTES[0],
        ),
        _row(
            "total energy with adhesion by two routes",
            "J/m^2",
            source,
            [integral[1]],
            [volumes[1]],
            *MEASURED_ROUTES[1],
        ),
    )
    return Outcome(rows=rows)


def _spectra() -> Outcome:
    wave = Sinusoid(1e-4, PERIOD, YOUNGS_MODULUS, 0.5, 0.0)
    target = float(wave.penetration(np.pi / 4))
    changes = {
        "adhesion": None,
        "loading": {"control": "penetration", "targets": [target]},
        "output": {"spectra": True, "pressure_distribution": True},
    }
    result = bem.solve(adapters.scene("sinusoid", changes))
    fields, (state,) = result.fields, result.targets
    # half of the period in contact: sigma = 2 p* cos(x/2) sqrt(1/2 - sin^2(x/2)), whose first modes are 3/8 and 1/8 p*
    star, q0 = wave.full_contact_pressure, 2 * np.pi / PERIOD
    exact = np.array([(0.375 * star) ** 2, (0.125 * star) ** 2]) / q0
    levels = fields["sigma_bounds_0"]
    carried = float(np.sum(fields["P_0"] * np.diff(levels)))
    source = Reference(kind="exact", source="Westergaard 1939, half of the period in contact")
    rows = (
        _row(
            "two-sided pressure spectrum at the first two orders",
            "Pa^2 m",
            source,
            exact.tolist(),
            fields["C_sigma_0"][:2].tolist(),
            *MEASURED_SPECTRUM,
        ),
        _row(
            "integral of the pressure distribution = contact fraction",
            "",
            source,
            [0.5],
            [carried],
            *MEASURED_DISTRIBUTION,
        ),
        _row(
            "contact fraction",
            "",
            source,
            [0.5],
            [state.contact_fraction],
            1e-10,
            1e-12,
        ),
    )
    return Outcome(rows=rows)


def _shifted() -> Outcome:
    posed = adapters.scene("rough_100", {"profile": {"harmonics": 20}})
    surface = posed.surface()
    found = []
    for shift in SHIFTS:
        changes: dict[str, Any] = {
            "profile": {
                "kind": "harmonics",
                "orders": surface.orders.tolist(),
                "amplitudes": surface.amplitudes.tolist(),
                "phases": (surface.phases - 2 * np.pi * shift * surface.orders).tolist(),
                **dict.fromkeys(("hurst", "rms_height", "harmonics", "seed")),
            },
            "loading": {"targets": [55e-6, 30e-6, 70e-6]},
        }
        found.append(bem.solve(adapters.scene("rough_100", changes)).targets)
    source = Reference(kind="self", source="the same profile elsewhere in the period")
    rows = tuple(
        _row(f"{quantity}, over all shifts", unit, source, expected, computed, *bounds)
        for quantity, unit, name, bounds in (
            ("contact fraction", "", "contact_fraction", MEASURED_SHIFT[0]),
            ("mean pressure", "Pa", "mean_pressure", MEASURED_SHIFT[1]),
            ("patches", "", "n_patches", MEASURED_SHIFT[2]),
        )
        for expected, computed in [
            (
                [float(getattr(state, name)) for state in found[0]] * (len(SHIFTS) - 1),
                [float(getattr(state, name)) for states in found[1:] for state in states],
            )
        ]
    )
    return Outcome(rows=rows, counts={"states": sum(len(states) for states in found)})


def _realisations() -> Outcome:
    phases = [bem.Profile.self_affine(PERIOD, 0.7, 50e-6, 400, seed).phases for seed in range(8)]
    alike = [float(np.mean(np.cos(one - other))) for one, other in combinations(phases, 2)]
    rows = (
        _row(
            "mean cosine of the phase differences of any two of eight realisations",
            "",
            Reference(kind="exact", source="independent phases, n = 400: zero within 1 / sqrt(2 n) each"),
            [0.0] * len(alike),
            alike,
            *MEASURED_PHASES,
            norm="absolute",
        ),
    )
    return Outcome(rows=rows)


SHIFTS = (0.0, 0.37, 0.71)  # periods

# tolerance, error measured
MEASURED_LAYER_ENERGY = (1e-14, 2e-16)
MEASURED_LAYER_DISPLACEMENT = (2e-10, 7.4e-11)  # the highest point on a grid of 65536
MEASURED_FEM = {  # within the uncertainty of the finite elements, which is larger still
    "load": (1.2e-3, 4.6e-4),
    "stress_intensity": (4e-3, 1.7e-3),
    "elastic_energy": (1.2e-3, 4.5e-4),
    "total_displacement": (2.5e-4, 8.8e-5),
}
MEASURED_THEORY = ((2e-15, 1.8e-16), (5e-15, 8.5e-16), (5e-15, 1.7e-15))
MEASURED_ROUTES = ((1e-5, 3.3e-6), (1.4e-7, 4.7e-8))
MEASURED_SPECTRUM = (5e-15, 1.1e-15)
MEASURED_DISTRIBUTION = (1e-14, 4.5e-15)
MEASURED_SHIFT = ((1e-12, 3e-14), (1e-12, 1e-14), (1e-12, 0.0))
MEASURED_PHASES = (0.15, 0.07)

CASES = (
    Case(
        id="layer-complete-contact",
        group="closed forms",
        level="quick",
        question="Has a compressible layer pressed flat the energy and the displacement of its closed form?",
        equations="U_el = sum h_m^2 / (4 c(q_m)),  u_tot = h_max + c(0) sigma_0",
        sources=("carbone2008",),
        compute=_layer_complete,
        effects=("layer", "load_control"),
    ),
    Case(
        id="layer-two-patches-fem",
        group="finite elements",
        level="quick",
        question="Do both codes see the same load, stress intensity, energy and displacement of two given patches?",
        equations="div sigma = 0 in the layer;  u_y = h - h_max + u_tot on the patches;  K = sqrt(2 E* G)",
        sources=("carbone2008",),
        compute=_layer_by_fem,
        effects=("layer",),
    ),
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
    Case(
        id="westergaard-spectrum",
        group="closed forms",
        level="quick",
        question="Are spectrum and distribution of the pressure those of Westergaard's contact?",
        equations="sigma = 2 p* cos(x/2) sqrt(sin^2 psi - sin^2(x/2)),  C_sigma(m q0) = sigma_m^2 / q0",
        sources=("westergaard1939",),
        compute=_spectra,
        effects=("half_space", "spectra", "pressure_distribution"),
        scene=adapters.scene_text("sinusoid"),
    ),
    Case(
        id="shifted-profile",
        group="identities",
        level="quick",
        question="Is a profile the same wherever the period begins, also when patches merge across its end?",
        equations="h(x - s) has the contact fractions, loads and patches of h(x)",
        sources=("carbone2009",),
        compute=_shifted,
        effects=("half_space", "adhesion", "slope_term", "unloading"),
        scene=adapters.scene_text("rough_100"),
    ),
    Case(
        id="independent-realisations",
        group="identities",
        level="quick",
        question="Are the phases of different realisations independent?",
        equations="mean over m of cos(phi_m - phi'_m) = 0 within 1 / sqrt(2 n)",
        sources=("carbone2009",),
        compute=_realisations,
    ),
)
