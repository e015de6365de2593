"""Small cases that faults asked for: what no other case of the quick level would have seen (study faults).

A layer against the finite elements and against its closed form, spectra and pressure distribution against closed
forms, a profile shifted over the end of the period, and phases of realisations.  References are written here from the
equations, with none of the codes compared.  SI units.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

import bem
import fem_reference
from validation.corpus.hard.hard_case_scenes import waves_of
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared
from validation.harness.schema import Reference, Row
from validation.references import adapters
from validation.references.closed_forms import Sinusoid, layer_compliance

PERIOD, YOUNGS_MODULUS = 0.01, 1e6


def _layer_complete() -> Outcome:
    nu, thickness, pressure = 0.3, 0.1 * PERIOD, 2e5
    orders, amplitudes, phases = np.array([1, 2, 5]), np.array([20e-6, 10e-6, 3e-6]), [0.0, 1.0, 2.0]
    changes: dict[str, Any] = {
        "adhesion": None,
        "solid": {"poisson_ratio": nu},
        "profile": adapters.NOT_SELF_AFFINE | waves_of(bem.Profile.from_harmonics(PERIOD, orders, amplitudes, phases)),
        "layer": {"thickness": thickness},
        "loading": {"control": "mean_pressure", "targets": [pressure]},
    }
    posed = adapters.scene("rough_100", changes)
    (state,) = bem.solve(posed).targets
    compliance = layer_compliance(2 * np.pi * orders / PERIOD, thickness, YOUNGS_MODULUS, nu)
    mean = thickness * (1 - 2 * nu) * (1 + nu) / (YOUNGS_MODULUS * (1 - nu))
    x = np.linspace(0, PERIOD, 1 << 16)
    height = np.cos(2 * np.pi * np.outer(x, orders) / PERIOD + phases) @ amplitudes
    source = Reference(kind="exact", source="Carbone and Mangialardi 2008, mode by mode")
    rows = (
        compared("elastic energy of complete contact", "J/m^2", source, [float(np.sum(amplitudes**2 / compliance)) / 4],
                 [state.elastic_energy],
                 *MEASURED_LAYER_ENERGY),
        compared("total displacement, with the mean compression", "m", source, [float(height.max()) + mean * pressure],
                 [float("nan") if state.total_displacement is None else state.total_displacement],
                 *MEASURED_LAYER_DISPLACEMENT),
    )  # fmt: skip
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
        resolution=fem_reference.Resolution(4, 6, 9),
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
        compared(f"{name.replace('_', ' ')} at given edges", unit,
                 Reference(kind="FEM", source="P4/P3, 6 cells", uncertainty=float(np.max(found.uncertainty[name]))),
                 expected, computed,
                 *MEASURED_FEM[name])
        for name, (unit, computed, expected) in known.items()
    )  # fmt: skip
    mean = thickness * (1 - 2 * nu) * (1 + nu) / (YOUNGS_MODULUS * (1 - nu)) * found.mean_pressure
    rows += (
        compared("mean displacement of the face, finite elements", "m",
                 Reference(kind="exact", source="Betti: c(0) times the mean pressure"), [mean],
                 [found.total_displacement - found.penetration],
                 *MEASURED_BETTI),
        compared("uncertainty of the load of the finite elements, over the load", "",
                 Reference(kind="exact", source="an exact solution has none: as sharp as when it was measured"), [0.0],
                 [float(found.uncertainty["load"]) / found.load],
                 *MEASURED_SHARPNESS, norm="absolute"),
    )  # fmt: skip
    return Outcome(rows=rows, counts={"unknowns": found.unknowns})


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
        compared("two-sided pressure spectrum at the first two orders", "Pa^2 m", source, exact.tolist(),
                 fields["C_sigma_0"][:2].tolist(),
                 *MEASURED_SPECTRUM),
        compared("integral of the pressure distribution = contact fraction", "", source, [0.5], [carried],
                 *MEASURED_DISTRIBUTION),
        compared("contact fraction", "", source, [0.5], [state.contact_fraction], 3e-12, 1e-12),
        compared("share of the period above each pressure of the distribution, up to the highest", "", source,
                 _share_above(levels[:-1] / star), np.cumsum((fields["P_0"] * np.diff(levels))[::-1])[::-1],
                 2.5 * MEASURED_TAIL, MEASURED_TAIL, "absolute"),
        _displacement_on_a_layer(),
    )  # fmt: skip
    return Outcome(rows=rows)


def _share_above(pressure: FloatArray) -> FloatArray:
    """Share of the period above pressures over p*, half of it in contact.

    With S = cos^2(x/2) the pressure p = 2 p* cos(x/2) sqrt(S - 1/2) gives S^2 - S/2 = (p / 2 p*)^2.
    """
    square = 0.25 * (1.0 + np.sqrt(1.0 + 4.0 * pressure**2))
    return np.asarray(2.0 / np.pi * np.arccos(np.sqrt(np.minimum(square, 1.0))))


def _displacement_on_a_layer() -> Row:
    """Displacement over pressure, order by order: the compliance of the layer, whatever the contact."""
    posed = adapters.scene("layer_two_crests", {"adhesion": None, "output": {"spectra": True}})
    fields = bem.solve(posed).fields
    assert posed.layer is not None
    orders = np.arange(1, 7)
    compliance = layer_compliance(2 * np.pi * orders / posed.surface().period, posed.layer.thickness,
                                  posed.solid.youngs_modulus, posed.solid.poisson_ratio)  # fmt: skip
    found = np.sqrt(fields["C_u_0"][: orders.size] / fields["C_sigma_0"][: orders.size])
    return compared("displacement over pressure on a layer, spectra of orders 1 to 6", "m/Pa",
                    Reference(kind="exact", source="Carbone and Mangialardi 2008, c(q)"), compliance, found,
                    2.5 * MEASURED_COMPLIANCE, MEASURED_COMPLIANCE)  # fmt: skip


def _shifted() -> Outcome:
    surface = adapters.scene("rough_100", {"profile": {"harmonics": 40}}).surface()
    results = []
    for shift in SHIFTS:
        moved = replace(surface, phases=surface.phases - 2 * np.pi * shift * surface.orders)
        changes: dict[str, Any] = {
            "profile": adapters.NOT_SELF_AFFINE | waves_of(moved),
            "adhesion": {"work_of_adhesion": 0.01},
            "loading": {"targets": [60e-6, 45e-6, 60e-6]},
        }
        results.append(bem.solve(adapters.scene("rough_100", changes)))
    first, *others = (result.targets for result in results)
    kinds = ("new_contact", "coalescence", "detachment", "pull_off")
    met = [[float(sum(event.kind == kind for event in result.events)) for kind in kinds] for result in results]
    source = Reference(kind="self", source="the same profile elsewhere in the period")
    rows = [compared(f"{quantity}, over all shifts", unit, source,
                     [float(getattr(state, name)) for state in first] * len(others),
                     [float(getattr(state, name)) for states in others for state in states],
                     *bounds)
            for quantity, unit, name, bounds in (("contact fraction", "", "contact_fraction", MEASURED_SHIFT[0]),
                ("mean pressure", "Pa", "mean_pressure", MEASURED_SHIFT[1]),
                ("patches", "", "n_patches", MEASURED_SHIFT[2]))]  # fmt: skip
    rows.append(
        compared("events of each kind, over all shifts", "", source, met[0] * len(others),
                 [number for numbers in met[1:] for number in numbers],
                 *MEASURED_SHIFT[2]),
    )  # fmt: skip
    rows.append(
        compared("states whose certificate is not ok, per shift", "",
                 Reference(kind="exact", source="every state of a path is an equilibrium without interpenetration"),
                 [0.0] * len(results),
                 [float(sum(not state.certificate.ok for state in result.states)) for result in results], 0.5, 0.0,
                 norm="absolute"),
    )  # fmt: skip
    return Outcome(rows=tuple(rows), counts={"states": sum(len(result.states) for result in results)})


def _realisations() -> Outcome:
    phases = [bem.Profile.self_affine(PERIOD, 0.7, 50e-6, 400, seed).phases for seed in range(8)]
    alike = [float(np.mean(np.cos(one - other))) for one, other in combinations(phases, 2)]
    rows = (
        compared("mean cosine of the phase differences of any two of eight realisations", "",
                 Reference(kind="exact", source="independent phases, n = 400: zero within 1 / sqrt(2 n) each"),
                 [0.0] * len(alike), alike,
                 *MEASURED_PHASES, norm="absolute"),
    )  # fmt: skip
    return Outcome(rows=rows)


SHIFTS = (0.0, 0.1672, 0.86)  # periods; at the second two patches merge across the end of the period

# tolerance, error measured
MEASURED_LAYER_ENERGY = (1e-14, 2e-16)
MEASURED_LAYER_DISPLACEMENT = (2e-10, 7.4e-11)  # the highest point on a grid of 65536
MEASURED_FEM = {  # within the uncertainty of the finite elements, which is larger still
    "load": (3e-4, 1.3e-4),
    "stress_intensity": (9e-4, 3.5e-4),
    "elastic_energy": (1.5e-4, 5.8e-5),
    "total_displacement": (6e-5, 2.4e-5),
}
MEASURED_BETTI = (2e-12, 6.8e-13)
MEASURED_SHARPNESS = (4.5e-3, 1.9e-3)
# rounding: the largest over the BLAS kernels of five processors (least: 6e-16 each)
MEASURED_SPECTRUM = (5e-15, 1.5e-15)
MEASURED_DISTRIBUTION = (2.5e-14, 9.1e-15)
MEASURED_TAIL, MEASURED_COMPLIANCE = 9.1e-15, 3e-16
MEASURED_SHIFT = ((2e-13, 7.4e-14), (3e-14, 1e-14), (1e-12, 0.0))
MEASURED_PHASES = (0.15, 0.07)

CASES = (
    Case(id="layer-complete-contact", group="closed forms", level="quick",
         problem="complete contact of a layer",
         question="Has a compressible layer pressed flat the energy and the displacement of its closed form?",
         equations=r"$U_{\text{el}} = \sum_m \frac{h_m^2}{4 c(q_m)}$, "
                   r"$u_{\text{tot}} = h_{\text{max}} + c(0) \sigma_0$",
         sources=("carbone2008",), compute=_layer_complete, effects=("layer", "load_control")),
    Case(id="layer-two-patches-fem", group="boundary elements against finite elements", level="quick",
         problem="two patches on a layer, given edges",
         question="Do both codes see the same load, stress intensity, energy and displacement of two given patches?",
         equations=r"$\nabla \cdot \sigma = 0$ in the layer; $u_y = h - h_{\text{max}} + u_{\text{tot}}$ on "
                   r"the patches; $K = \sqrt{2 E^\ast G}$",
         sources=("carbone2008",), compute=_layer_by_fem, effects=("layer",)),
    Case(id="westergaard-spectrum", group="closed forms", level="quick", problem="wave without adhesion",
         question="Are spectrum and distribution of the pressure those of Westergaard's contact?",
         equations=r"$\sigma = 2 p^\ast \cos \frac{x}{2} \sqrt{\sin^2 \psi - \sin^2 \frac{x}{2}}$, "
                   r"$C_\sigma(m q_0) = \sigma_m^2 / q_0$",
         sources=("westergaard1939",), compute=_spectra, effects=("half_space", "spectra", "pressure_distribution"),
         scene=adapters.scene_text("sinusoid")),
    Case(id="shifted-profile", group="identities", level="quick",
         question="Is a profile the same wherever the period begins, also when patches merge across its end?",
         equations="$h(x - s)$ has the contact fractions, loads and patches of $h(x)$",
         sources=("carbone2009",), compute=_shifted, effects=("half_space", "adhesion", "slope_term", "unloading"),
         scene=adapters.scene_text("rough_100")),
    Case(id="independent-realisations", group="identities", level="quick",
         question="Are the phases of different realisations independent?",
         equations=r"mean over $m$ of $\cos(\varphi_m - \varphi'_m) = 0$ within $1 / \sqrt{2 n}$",
         sources=("carbone2009",), compute=_realisations),
)  # fmt: skip
