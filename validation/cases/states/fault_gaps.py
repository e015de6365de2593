"""Small cases that faults asked for: what no other case of the quick level would have seen (study faults).

A layer against the finite elements and against its closed form, spectra and pressure distribution against closed
forms, a profile shifted over the end of the period, and phases of realisations.  References are written here from the
equations, with none of the codes compared.  SI units.
"""

from dataclasses import replace
from itertools import chain, combinations

import numpy as np

import bem
import fem_reference
from validation.cases.shared.checks import Against, case, column, posed, refused, solved
from validation.corpus.hard.hard_case_scenes import waves_of
from validation.harness.arrays import FloatArray
from validation.harness.case import Outcome
from validation.harness.schema import Row
from validation.references.adapters import NOT_SELF_AFFINE
from validation.references.closed_forms import Sinusoid, layer_compliance

PERIOD, YOUNGS_MODULUS = 0.01, 1e6
SHIFTS = (0.0, 0.1672, 0.86)  # periods; at the second two patches merge across the end of the period


def _uniform(thickness: float, nu: float) -> float:
    """c(0) in m/Pa."""
    return thickness * (1 - 2 * nu) * (1 + nu) / (YOUNGS_MODULUS * (1 - nu))


def _layer_complete() -> Outcome:
    nu, thickness, pressure = 0.3, 0.1 * PERIOD, 2e5
    orders, amplitudes, phases = np.array([1, 2, 5]), np.array([20e-6, 10e-6, 3e-6]), [0.0, 1.0, 2.0]
    profile = NOT_SELF_AFFINE | waves_of(bem.Profile.from_harmonics(PERIOD, orders, amplitudes, phases))
    (state,) = solved("rough_100", adhesion=None, solid={"poisson_ratio": nu}, profile=profile,
                      layer={"thickness": thickness},
                      loading={"control": "mean_pressure", "targets": [pressure]}).targets  # fmt: skip
    compliance = layer_compliance(2 * np.pi * orders / PERIOD, thickness, YOUNGS_MODULUS, nu)
    x = np.linspace(0, PERIOD, 1 << 16)
    height = np.cos(2 * np.pi * np.outer(x, orders) / PERIOD + phases) @ amplitudes
    modes = Against("exact", "Carbone and Mangialardi 2008, mode by mode")
    rows = (
        modes.row("elastic energy of complete contact", "J/m^2", float(np.sum(amplitudes**2 / compliance)) / 4,
                  state.elastic_energy, (1e-14, 2e-16)),
        modes.row("total displacement, with the mean compression", "m",
                  float(height.max()) + _uniform(thickness, nu) * pressure, state.total_displacement,
                  (2e-10, 7.4e-11)),  # the highest point on a grid of 65536
    )  # fmt: skip
    return Outcome(rows=rows)


def _layer_by_fem() -> Outcome:
    nu, thickness, penetration = 0.3, 0.2 * PERIOD, 12e-6
    harmonics = ([1, 2], [4e-6, 20e-6], [0.5, 0.3])
    profile = bem.Profile.from_harmonics(PERIOD, *harmonics)
    edges = [[place - 0.7e-3, place + 0.9e-3] for place in np.sort(profile.crests[0])]
    solid, layer = bem.Solid(YOUNGS_MODULUS, nu), bem.Layer(thickness)
    state = bem.ContactState(profile, solid, edges, penetration, layer=layer)
    fem = fem_reference.solve(
        youngs_modulus=YOUNGS_MODULUS,
        poisson_ratio=nu,
        thickness=thickness,
        period=PERIOD,
        harmonics=harmonics,
        control="penetration",
        value=penetration,
        edges=edges,
        resolution=fem_reference.Resolution(4, 6, 9),
    )
    total = layer.total_displacement(solid, penetration, state.mean_pressure)
    rows = [  # errors measured: within the uncertainty of the finite elements, which is larger still
        Against("FEM", "P4/P3, 6 cells", float(np.max(fem.uncertainty[name]))).row(
            f"{name.replace('_', ' ')} at given edges", unit, np.ravel(getattr(fem, name)), np.ravel(computed),
            measured)
        for name, unit, computed, measured in (
            ("load", "N/m", state.load, (3e-4, 1.3e-4)),
            ("stress_intensity", "Pa m^1/2", state.stress_intensity, (9e-4, 3.5e-4)),
            ("elastic_energy", "J/m", state.elastic_energy, (1.5e-4, 5.8e-5)),
            ("total_displacement", "m", total, (6e-5, 2.4e-5)),
        )
    ]  # fmt: skip
    rows += [
        Against("exact", "Betti: c(0) times the mean pressure").row(
            "mean displacement of the face, finite elements", "m", _uniform(thickness, nu) * fem.mean_pressure,
            fem.total_displacement - fem.penetration, (2e-12, 6.8e-13), code="fem"),
        Against("exact", "an exact solution has none: as sharp as when it was measured").row(
            "uncertainty of the load of the finite elements, over the load", "", 0.0,
            float(fem.uncertainty["load"]) / fem.load, (4.5e-3, 1.9e-3), "absolute", code="fem"),
    ]  # fmt: skip
    return Outcome(rows=tuple(rows), counts={"unknowns": fem.unknowns})


def _spectra() -> Outcome:
    wave = Sinusoid(1e-4, PERIOD, YOUNGS_MODULUS, 0.5, 0.0)
    loading = {"control": "penetration", "targets": [float(wave.penetration(np.pi / 4))]}
    output = {"spectra": True, "pressure_distribution": True}
    result = solved("sinusoid", adhesion=None, loading=loading, output=output)
    fields, (state,), star = result.fields, result.targets, wave.full_contact_pressure
    # half of the period in contact: sigma = 2 p* cos(x/2) sqrt(1/2 - sin^2(x/2)), whose first modes are 3/8 and 1/8 p*
    exact = np.array([(0.375 * star) ** 2, (0.125 * star) ** 2]) / (2 * np.pi / PERIOD)
    levels = fields["sigma_bounds_0"]
    shares = fields["P_0"] * np.diff(levels)
    known = Against("exact", "Westergaard 1939, half of the period in contact")
    # rounding: the largest over the BLAS kernels of five processors (least: 6e-16 each)
    rows = (
        known.row("two-sided pressure spectrum at the first two orders", "Pa^2 m", exact, fields["C_sigma_0"][:2],
                  (5e-15, 1.5e-15)),
        known.row("integral of the pressure distribution = contact fraction", "", 0.5, float(np.sum(shares)),
                  (2.5e-14, 9.1e-15)),
        known.row("contact fraction", "", 0.5, state.contact_fraction, (3e-12, 1e-12)),
        known.row("share of the period above each pressure of the distribution, up to the highest", "",
                  _share_above(levels[:-1] / star), np.cumsum(shares[::-1])[::-1], 9.1e-15, "absolute"),
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
    scene = posed("layer_two_crests", adhesion=None, output={"spectra": True})
    fields, orders = bem.solve(scene).fields, np.arange(1, 7)
    assert scene.layer is not None
    compliance = layer_compliance(2 * np.pi * orders / scene.surface().period, scene.layer.thickness,
                                  scene.solid.youngs_modulus, scene.solid.poisson_ratio)  # fmt: skip
    found = np.sqrt(fields["C_u_0"][: orders.size] / fields["C_sigma_0"][: orders.size])
    return Against("exact", "Carbone and Mangialardi 2008, c(q)").row(
        "displacement over pressure on a layer, spectra of orders 1 to 6", "m/Pa", compliance, found, 3e-16
    )


def _shifted() -> Outcome:
    surface = posed("rough_100", profile={"harmonics": 40}).surface()
    moved = [replace(surface, phases=surface.phases - 2 * np.pi * shift * surface.orders) for shift in SHIFTS]
    results = [
        solved("rough_100", profile=NOT_SELF_AFFINE | waves_of(one), adhesion={"work_of_adhesion": 0.01},
               loading={"targets": [60e-6, 45e-6, 60e-6]})
        for one in moved
    ]  # fmt: skip
    first, *others = results
    known, equal = Against("self", "the same profile elsewhere in the period"), (1e-12, 0.0)
    rows = [
        known.row(f"{name.replace('_', ' ')}, over all shifts", unit, column(first.targets, key) * len(others),
                  chain.from_iterable(column(one.targets, key) for one in others), measured)
        for name, key, unit, measured in (
            ("contact fraction", "contact_fraction", "", (2e-13, 7.4e-14)),
            ("mean pressure", "mean_pressure", "Pa", (3e-14, 1e-14)),
            ("patches", "n_patches", "", equal),
        )
    ]  # fmt: skip
    met = [[column(result.events, "kind").count(kind)
            for kind in ("new_contact", "coalescence", "detachment", "pull_off")] for result in results]  # fmt: skip
    rows += [
        known.row("events of each kind, over all shifts", "", met[0] * len(others), chain.from_iterable(met[1:]),
                  equal),
        Against("exact", "every state of a path is an equilibrium without interpenetration").row(
            "states whose certificate is not ok, per shift", "", [0.0] * len(results), map(refused, results),
            (0.5, 0.0), "absolute"),
    ]  # fmt: skip
    return Outcome(rows=tuple(rows), counts={"states": sum(len(result.states) for result in results)})


def _realisations() -> Outcome:
    phases = [bem.Profile.self_affine(PERIOD, 0.7, 50e-6, 400, seed).phases for seed in range(8)]
    alike = [float(np.mean(np.cos(one - other))) for one, other in combinations(phases, 2)]
    row = Against("exact", "independent phases, n = 400: zero within 1 / sqrt(2 n) each").row(
        "mean cosine of the phase differences of any two of eight realisations", "", [0.0] * len(alike), alike,
        (0.15, 0.07), "absolute")  # fmt: skip
    return Outcome(rows=(row,))


CASES = (
    case("layer-complete-contact", "closed forms", _layer_complete,
         "Has a compressible layer pressed flat the energy and the displacement of its closed form?",
         r"$U_{\text{el}} = \sum_m \frac{h_m^2}{4 c(q_m)}$, $u_{\text{tot}} = h_{\text{max}} + c(0) \sigma_0$",
         "carbone2008", "layer load_control", problem="complete contact of a layer"),
    case("layer-two-patches-fem", "boundary elements against finite elements", _layer_by_fem,
         "Do both codes see the same load, stress intensity, energy and displacement of two given patches?",
         r"$\nabla \cdot \sigma = 0$ in the layer; $u_y = h - h_{\text{max}} + u_{\text{tot}}$ on "
         r"the patches; $K = \sqrt{2 E^\ast G}$",
         "carbone2008", "layer", problem="two patches on a layer, given edges"),
    case("westergaard-spectrum", "closed forms", _spectra,
         "Are spectrum and distribution of the pressure those of Westergaard's contact?",
         r"$\sigma = 2 p^\ast \cos \frac{x}{2} \sqrt{\sin^2 \psi - \sin^2 \frac{x}{2}}$, "
         r"$C_\sigma(m q_0) = \sigma_m^2 / q_0$",
         "westergaard1939", "half_space spectra pressure_distribution", scene="sinusoid",
         problem="wave without adhesion"),
    case("shifted-profile", "identities", _shifted,
         "Is a profile the same wherever the period begins, also when patches merge across its end?",
         "$h(x - s)$ has the contact fractions, loads and patches of $h(x)$",
         "carbone2009", "half_space adhesion slope_term unloading", scene="rough_100"),
    case("independent-realisations", "identities", _realisations,
         "Are the phases of different realisations independent?",
         r"mean over $m$ of $\cos(\varphi_m - \varphi'_m) = 0$ within $1 / \sqrt{2 n}$", "carbone2009"),
)  # fmt: skip
