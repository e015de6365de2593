"""Realistic faults, each one wrong piece of code: what a slip of the pen, a lost factor or a forgotten case would do.

A fault is a function from the right code and a size to the wrong code; size 1 is the slip itself, smaller sizes
scale it down where that has a meaning.  Those of the boundary elements come first, then of the finite elements, of
Persson's theory, of what leads from a scene to the codes, and of the harness that judges them all.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from bem import gap
from validation.studies.fault_harness import HARNESS_FAULTS
from validation.studies.fault_injection import Fault, Function


def scaled(excess: float) -> Any:
    """The result is wrong by a factor: 1 + size times `excess`."""

    def wrong(original: Function, size: float) -> Function:
        return lambda *given, **named: original(*given, **named) * (1 + size * excess)

    return wrong


def youngs_for_plane_strain(original: Function, size: float) -> Function:
    """E in place of E / (1 - nu^2)."""
    return lambda solid: original(solid) * (1 - size * solid.poisson_ratio**2)


def without_slope_term(original: Function, size: float) -> Function:
    """w = gamma in place of gamma sqrt(1 + h'^2)."""
    return lambda law, x: (1 - size) * original(law, x) + size * law.work


def without_slope_energy(original: Function, size: float) -> Function:
    """U_ad on the projected length."""
    return lambda law, patches: (1 - size) * original(law, patches) - size * law.work * float(np.sum(patches.width))


def sign_of_edge_slope(original: Function, size: float) -> Function:
    """+ in place of - before the regular part of the pressure in dK / d(edge)."""

    def wrong(state: Any) -> Any:
        radius = np.tile(state.patches.half_width, 2)
        return original(state) + size * np.diag(np.sqrt(np.pi / radius) * state.edge_slope)

    return wrong


def without_width_term(original: Function, size: float) -> Function:
    """The change of K by the width of the patch itself, K / (4 r), forgotten."""

    def wrong(state: Any) -> Any:
        radius = np.tile(state.patches.half_width, 2)
        return original(state) + size * np.diag(state.stress_intensity / (4 * radius))

    return wrong


def wrong_bracket(original: Function, size: float) -> Function:
    """5 - 12 nu + 4 nu^2 in place of 5 - 12 nu + 8 nu^2 in the compliance of a layer."""
    return lambda poisson_ratio: original(poisson_ratio) - 4 * size * poisson_ratio**2


def uniaxial_compression(original: Function, size: float) -> Function:
    """d / E in place of the confined compliance c(0) of a layer."""

    def wrong(layer: Any, solid: Any) -> Any:
        return (1 - size) * original(layer, solid) + size * layer.thickness / solid.youngs_modulus

    return wrong


def heavier_node(original: Function, size: float) -> Function:
    """One node of the transform counts twice."""

    def wrong(samples: Any) -> Any:
        changed = np.array(samples, dtype=np.float64)
        changed[..., 0] *= 1 + size
        return original(changed)

    return wrong


def heavier_charge(original: Function, size: float) -> Function:
    """One weight of the logarithmic moment matrix is doubled (and with it, for symmetry, its column)."""

    @lru_cache(maxsize=256)
    def wrong(n: int) -> Any:
        table = original(n)
        moments = table.log_moments.copy()
        moments[0, 0] *= 1 + size
        return replace(table, log_moments=moments)

    return wrong


def open_kernel(original: Function, size: float) -> Function:
    """log|r (t - t')| within a patch: the period is forgotten there."""

    def wrong(half_width: Any, table: Any) -> Any:
        difference = np.subtract.outer(table.nodes, table.nodes)
        smooth = np.log(np.sinc(half_width[:, None, None] * (difference / (2 * np.pi))))
        return original(half_width, table) - size * smooth

    return wrong


def every_second_point(original: Function, size: float) -> Function:
    """The gap is looked at on a grid of half the points, and what is found is not refined."""

    def wrong(*given: Any, **named: Any) -> Any:
        points, refinements = gap.POINTS_PER_WAVELENGTH, gap.REFINEMENTS
        gap.POINTS_PER_WAVELENGTH, gap.REFINEMENTS = points // 2, 0
        try:
            return original(*given, **named)
        finally:
            gap.POINTS_PER_WAVELENGTH, gap.REFINEMENTS = points, refinements

    return wrong


def every_second_minimum(original: Function, size: float) -> Function:
    """Every second minimum of the gap is passed over."""

    def wrong(*given: Any, **named: Any) -> Any:
        found = original(*given, **named)
        return type(found)(found.position[1::2], found.depth[1::2], found.gap[1::2])

    return wrong


def merge_forgets_wrap(original: Function, size: float) -> Function:
    """A merge across the end of the period keeps the part before it only."""

    def wrong(patches: Any, index: int) -> Any:
        if patches.count == 1 or index + 1 < patches.count:
            return original(patches, index)
        return patches.without_patch(0)

    return wrong


def gap_forgets_wrap(original: Function, size: float) -> Function:
    """The gap behind the last patch ends with the period."""

    def wrong(patches: Any) -> Any:
        gaps = np.array(original(patches))
        beyond = 2 * np.pi - patches.right[-1]
        if beyond > 0:
            gaps[-1] = beyond
        return gaps

    return wrong


def sign_of_outer_series(original: Function, size: float) -> Function:
    """The logarithm of a patch seen from its gap lacks the part of its uneven pressure."""

    def wrong(field: Any, index: int, x: Any) -> Any:
        patches = field.state.patches
        t = (x - patches.center[index]) / patches.half_width[index]
        zeta = t - np.copysign(np.sqrt(np.maximum(t * t - 1, 0.0)), t)
        return original(field, index, x) + size * np.pi * zeta * field.pressure.charges[index][1]

    return wrong


def phases_reused(original: Function, size: float) -> Function:
    """All realisations get the phases of the first."""
    return lambda cls, period, hurst, rms_height, harmonics, seed: original(
        cls, period, hurst, rms_height, harmonics, 0
    )


def one_sided(original: Function, size: float) -> Function:
    """Spectra two-sided in name, one-sided in fact."""

    def wrong(*given: Any, **named: Any) -> Any:
        return np.asarray(original(*given, **named)) * np.sqrt(1 + size)

    return wrong


def released_to_wrong_unit(original: Function, size: float) -> Function:
    """The energy an event releases, by a factor."""

    def wrong(problem: Any, event: Any) -> Any:
        right = original(problem, event)
        return replace(right, energy_released=right.energy_released * (1 + size))

    return wrong


def under_integrated(original: Function, size: float) -> Function:
    """Stiffness by a quadrature two degrees too low."""

    def wrong(triangles: Any, order: int, quadrature_order: int | None = None) -> Any:
        return original(triangles, order, 2 * order - 4 or 1)

    return wrong


def locked(original: Function, size: float) -> Function:
    """The layer is assembled as nearly incompressible whatever its Poisson's ratio."""
    return lambda spaces, shear, inverse_bulk: original(spaces, shear, inverse_bulk * (1 - 0.9 * size))


def engineering_shear(original: Function, size: float) -> Function:
    """mu assembled too stiff: the factor one half of the shear strain partly lost."""
    return lambda spaces, shear, inverse_bulk: original(spaces, shear * (1 + size), inverse_bulk)


def stiffer_reference_modulus(original: Function, size: float) -> Function:
    """E in place of E* where the finite elements turn G into K."""
    return lambda problem: original(problem) * (1 - size * problem.poisson_ratio**2)


def mean_of_ends(original: Function, size: float) -> Function:
    """The mean over the face by the trapezoid rule of the ends of the facets."""

    def wrong(spaces: Any, field: Any) -> Any:
        from fem_reference.face import face_nodes

        nodes = face_nodes(spaces)
        ends = field[spaces.sizes[0] + nodes.index][:: nodes.order]
        rough = float(np.sum(np.diff(nodes.x[:: nodes.order]) * (ends[1:] + ends[:-1]) / 2))
        return (1 - size) * original(spaces, field) + size * rough

    return wrong


def youngs_in_theory(original: Function, size: float) -> Function:
    """E in place of E / (1 - nu^2), from numbers."""
    return lambda youngs_modulus, poisson_ratio: original(youngs_modulus, poisson_ratio) * (1 - size * poisson_ratio**2)


def previous_wavenumber(original: Function, size: float) -> Function:
    """Inside a line the wavenumber of the line before stands in place of its own."""

    def wrong(spectrum: Any, antiderivative: Function, density: Function, ends: Any) -> Any:
        late = np.concatenate([spectrum.wavenumbers[:1], spectrum.wavenumbers[:-1]])
        held = (1 - size) * spectrum.wavenumbers + size * late
        bands = np.concatenate([[0.0], spectrum.slope_variance])
        at_bands = antiderivative(bands)
        full = np.concatenate([[0.0], np.cumsum(np.diff(at_bands) / held)])
        line = np.clip(np.searchsorted(bands, ends, side="left") - 1, 0, bands.size - 2)
        return np.asarray(full[line] + (antiderivative(ends) - at_bands[line]) / held[line])

    return wrong


def higher_barrier(original: Function, size: float) -> Function:
    """Stress absorbed at a tension too large by sqrt 2."""

    def wrong(loads: Any, variance: Any, barrier: Any, n_cells: int) -> Any:
        return original(loads, variance, barrier * (1 + size * (np.sqrt(2) - 1)), n_cells)

    return wrong


def variance_of_stress(original: Function, size: float) -> Function:
    """V = S / 2 in place of S / 4: the contact sees roughness too steep by sqrt 2."""
    return lambda variance, load: original(np.asarray(variance) * (1 + size), load)


def amplitudes_as_rms(original: Function, size: float) -> Function:
    """The rms of each harmonic handed over as its amplitude."""

    def wrong(posed: Any) -> Any:
        right = original(posed)
        return type(right)(right.wavenumbers, right.amplitudes * (1 + size * (np.sqrt(0.5) - 1)))

    return wrong


CATALOGUE: tuple[Fault, ...] = (
    Fault(
        "bem-e-for-e-star",
        "E in place of E* = E / (1 - nu^2)",
        "bem.scaling:Solid.plane_strain_modulus",
        youngs_for_plane_strain,
        "E* becomes E",
    ),
    Fault(
        "bem-work-factor-2",
        "factor 2 in G: work of adhesion made dimensionless with half its unit",
        "bem.scaling:Scales.release_rate",
        scaled(1.0),
        "unit of G doubled",
    ),
    Fault(
        "bem-k-factor-sqrt-2",
        "factor sqrt 2 in K: sqrt(2 pi) for sqrt(pi) in its definition",
        "bem.scaling:Scales.stress_intensity",
        scaled(np.sqrt(2) - 1),
        "unit of K times sqrt 2",
    ),
    Fault("bem-stress-factor-2", "factor 2 in the unit of stress", "bem.scaling:Scales.stress", scaled(1.0), "doubled"),
    Fault(
        "bem-energy-factor-2",
        "the 1/2 of the elastic energy lost where it becomes J/m^2",
        "bem.scaling:Scales.energy_per_area",
        scaled(1.0),
        "unit of energy doubled",
    ),
    Fault(
        "bem-slope-term-dropped",
        "edges see gamma, not gamma sqrt(1 + h'^2)",
        "bem.adhesion:SlopeLaw.work_of_adhesion",
        without_slope_term,
        "slope term absent",
    ),
    Fault(
        "bem-slope-energy-dropped",
        "adhesion energy on the projected length",
        "bem.adhesion:SlopeLaw.energy",
        without_slope_energy,
        "slope term absent",
    ),
    Fault(
        "bem-sensitivity-sign",
        "sign of the regular part of the pressure in dK / d(edge)",
        "bem.sensitivities:stress_intensity_jacobian",
        sign_of_edge_slope,
        "sign turned",
    ),
    Fault(
        "bem-sensitivity-width",
        "K / (4 r) forgotten in dK / d(edge)",
        "bem.sensitivities:stress_intensity_jacobian",
        without_width_term,
        "term absent",
    ),
    Fault(
        "bem-layer-bracket",
        "5 - 12 nu + 4 nu^2 for 5 - 12 nu + 8 nu^2 in the compliance of a layer",
        "bem.layer:_constant",
        wrong_bracket,
        "coefficient 8 becomes 4",
    ),
    Fault(
        "bem-layer-mean-compliance",
        "mean compression of a layer as of a free bar, d / E",
        "bem.layer:Layer.mean_compliance",
        uniaxial_compression,
        "c(0) becomes d / E",
    ),
    Fault(
        "bem-one-node-weight",
        "one node of the Chebyshev transform counts twice",
        "bem.chebyshev:coefficients",
        heavier_node,
        "weight doubled",
    ),
    Fault(
        "bem-one-moment",
        "one entry of the logarithmic moments is doubled",
        "bem.chebyshev:basis",
        heavier_charge,
        "entry doubled",
    ),
    Fault(
        "bem-kernel-between",
        "kernel between patches by log of the squared distance",
        "bem.half_space:between_nodes",
        scaled(1.0),
        "kernel doubled",
    ),
    Fault(
        "bem-kernel-open",
        "the period forgotten within a patch",
        "bem.half_space:within_patch",
        open_kernel,
        "log sinc absent",
    ),
    Fault(
        "bem-gap-every-second-point",
        "the gap is looked at in every second point, unrefined",
        "bem.gap:low_minima",
        every_second_point,
    ),
    Fault(
        "bem-gap-every-second-minimum",
        "every second minimum of the gap is passed over",
        "bem.gap:low_minima",
        every_second_minimum,
    ),
    Fault(
        "bem-merge-forgets-wrap",
        "a merge across the end of the period loses what lies beyond",
        "bem.patches:Patches.merged_after",
        merge_forgets_wrap,
    ),
    Fault(
        "bem-gap-forgets-wrap",
        "the last gap ends with the period",
        "bem.patches:Patches.gap_after",
        gap_forgets_wrap,
    ),
    Fault(
        "bem-gap-outer-series",
        "the tilt of the pressure is not seen from the gap",
        "bem.gap:GapField._near_patch",
        sign_of_outer_series,
        "term absent",
    ),
    Fault(
        "bem-event-energy",
        "energy released by an event counted twice",
        "bem.states:event_of",
        released_to_wrong_unit,
        "doubled",
    ),
    Fault(
        "bem-phases-reused",
        "every realisation gets the phases of the first",
        "bem.profile:Profile.self_affine",
        phases_reused,
    ),
    Fault(
        "bem-spectrum-one-sided",
        "pressure modes of a spectrum counted on one side",
        "bem.spectra:pressure_modes",
        one_sided,
        "power doubled",
    ),
    Fault(
        "fem-e-for-e-star",
        "E in place of E* where G becomes K",
        "fem_reference.problem:Problem.plane_strain_modulus",
        stiffer_reference_modulus,
        "E* becomes E",
    ),
    Fault(
        "fem-under-integrated",
        "stiffness by a quadrature two degrees too low",
        "fem_reference.elasticity:taylor_hood",
        under_integrated,
    ),
    Fault(
        "fem-locked",
        "assembled ten times less compressible than it is",
        "fem_reference.elasticity:assemble",
        locked,
        "1/k a tenth",
    ),
    Fault(
        "fem-shear-factor-2",
        "factor 2 in the shear modulus of the stiffness",
        "fem_reference.elasticity:assemble",
        engineering_shear,
        "mu doubled",
    ),
    Fault(
        "fem-profile-term-dropped",
        "a moving edge does not feel the curvature of the profile",
        "fem_reference.energy_release:_profile_term",
        scaled(-1.0),
        "term absent",
    ),
    Fault(
        "fem-mean-of-ends",
        "mean of the face by the trapezoid rule of facet ends",
        "fem_reference.contact:_mean_on_face",
        mean_of_ends,
        "trapezoid rule",
    ),
    Fault(
        "persson-e-for-e-star",
        "E in place of E*",
        "persson.nonadhesive:plane_strain_modulus",
        youngs_in_theory,
        "E* becomes E",
    ),
    Fault(
        "persson-variance",
        "V = S / 2 in place of S / 4",
        "persson.nonadhesive:contact_fraction",
        variance_of_stress,
        "V doubled",
    ),
    Fault(
        "persson-rms-for-amplitude",
        "q^2 h^2 in place of q^2 h^2 / 2",
        "persson.spectrum:DiscreteSpectrum.slope_variance_steps",
        scaled(1.0),
        "doubled",
    ),
    Fault(
        "persson-narrow-band",
        "inside a line the wavenumber of the line before",
        "persson.spectrum:DiscreteSpectrum.weighted_integral",
        previous_wavenumber,
        "one line late",
    ),
    Fault(
        "persson-barrier-sqrt-2",
        "stress absorbed at a tension too large by sqrt 2",
        "persson.diffusion:march",
        higher_barrier,
        "barrier times sqrt 2",
    ),
    Fault(
        "adapter-rms-for-amplitude",
        "the theory is handed rms values for amplitudes",
        "validation.adapters:persson_spectrum",
        amplitudes_as_rms,
        "amplitudes by 1 / sqrt 2",
    ),
    *HARNESS_FAULTS,
)

QUICK: tuple[str, ...] = (
    "bem-e-for-e-star",
    "bem-sensitivity-sign",
    "bem-stress-factor-2",
    "bem-kernel-open",
    "harness-verdict-accepts",
)
"""Five faults for continuous integration: each is caught by a case below a second."""
