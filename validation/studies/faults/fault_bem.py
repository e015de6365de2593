"""Faults of the boundary elements: moduli, factors in K and G, weights, kernels, gaps, merges, sensitivities, layer.

A fault is a function from the right code and a size to the wrong code; size 1 is the slip itself.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from bem.elastic import gap
from validation.studies.faults.fault_injection import Fault, Function, scaled


def _youngs_for_plane_strain(original: Function, size: float) -> Function:
    """E in place of E / (1 - nu^2)."""
    return lambda solid: original(solid) * (1 - size * solid.poisson_ratio**2)


def _without_slope_term(original: Function, size: float) -> Function:
    """w = gamma in place of gamma sqrt(1 + h'^2)."""
    return lambda law, x: (1 - size) * original(law, x) + size * law.work


def _without_slope_energy(original: Function, size: float) -> Function:
    """U_ad on the projected length."""
    return lambda law, patches: (1 - size) * original(law, patches) - size * law.work * float(np.sum(patches.width))


def _sign_of_edge_slope(original: Function, size: float) -> Function:
    """+ in place of - before the regular part of the pressure in dK / d(edge)."""

    def wrong(state: Any) -> Any:
        radius = np.tile(state.patches.half_width, 2)
        return original(state) + size * np.diag(np.sqrt(np.pi / radius) * state.edge_slope)

    return wrong


def _without_width_term(original: Function, size: float) -> Function:
    """The change of K by the width of the patch itself, K / (4 r), forgotten."""

    def wrong(state: Any) -> Any:
        radius = np.tile(state.patches.half_width, 2)
        return original(state) + size * np.diag(state.stress_intensity / (4 * radius))

    return wrong


def _wrong_bracket(original: Function, size: float) -> Function:
    """5 - 12 nu + 4 nu^2 in place of 5 - 12 nu + 8 nu^2 in the compliance of a layer."""
    return lambda poisson_ratio: original(poisson_ratio) - 4 * size * poisson_ratio**2


def _uniaxial_compression(original: Function, size: float) -> Function:
    """d / E in place of the confined compliance c(0) of a layer."""

    def wrong(layer: Any, solid: Any) -> Any:
        return (1 - size) * original(layer, solid) + size * layer.thickness / solid.youngs_modulus

    return wrong


def _heavier_node(original: Function, size: float) -> Function:
    """One node of the transform counts twice."""

    def wrong(samples: Any) -> Any:
        changed = np.array(samples, dtype=np.float64)
        changed[..., 0] *= 1 + size
        return original(changed)

    return wrong


def _heavier_charge(original: Function, size: float) -> Function:
    """One weight of the logarithmic moment matrix is doubled (and with it, for symmetry, its column)."""

    @lru_cache(maxsize=256)
    def wrong(n: int) -> Any:
        table = original(n)
        moments = table.log_moments.copy()
        moments[0, 0] *= 1 + size
        return replace(table, log_moments=moments)

    return wrong


def _open_kernel(original: Function, size: float) -> Function:
    """log|r (t - t')| within a patch: the period is forgotten there."""

    def wrong(half_width: Any, table: Any) -> Any:
        difference = np.subtract.outer(table.nodes, table.nodes)
        smooth = np.log(np.sinc(half_width[:, None, None] * (difference / (2 * np.pi))))
        return original(half_width, table) - size * smooth

    return wrong


def _forgotten_constant(original: Function, size: float) -> Function:
    """The addition theorem without its factor 2."""

    def wrong(x: Any, beta: float, delta: float, accuracy: float) -> Any:
        kernel = original(x, beta, delta, accuracy)
        columns = kernel.columns.copy()
        columns[:, 0] -= size * np.log(2) / 2
        return replace(kernel, columns=columns)

    return wrong


def _every_second_point(original: Function, size: float) -> Function:
    """The gap is looked at in every second point of the grid, and nowhere between."""

    def wrong(field: Any, threshold: float = gap.SUSPICIOUS_GAP) -> Any:
        patches = field.state.patches
        waves = patches.gap_after * (field.elastic.profile.max_order / (2 * np.pi))
        counts = np.ceil(20 + gap.POINTS_PER_WAVELENGTH * np.pi / 2 * waves).astype(np.int64) // 2
        where = [
            edge + width * (1 - np.cos((np.arange(n) + 0.5) * np.pi / n)) / 2
            for edge, width, n in zip(patches.right, patches.gap_after, counts, strict=True)
        ]
        position, owner = np.concatenate(where), np.repeat(np.arange(patches.count), counts)
        depth = field(position, owner)
        lowest = np.flatnonzero((depth[1:-1] < threshold) & (depth[1:-1] <= depth[:-2]) & (depth[1:-1] < depth[2:])) + 1
        inside = lowest[(owner[lowest - 1] == owner[lowest]) & (owner[lowest + 1] == owner[lowest])]
        return gap.GapMinima(position[inside], depth[inside], owner[inside])

    return wrong


def _every_second_minimum(original: Function, size: float) -> Function:
    """Every second minimum of the gap is passed over."""

    def wrong(*given: Any, **named: Any) -> Any:
        found = original(*given, **named)
        return type(found)(found.position[1::2], found.depth[1::2], found.gap[1::2])

    return wrong


def _merge_forgets_wrap(original: Function, size: float) -> Function:
    """At the end of the period there is no following patch: the last one is merged with the one before it instead."""

    def wrong(patches: Any, index: int) -> Any:
        following = min(index + 1, patches.count - 1)
        if patches.count == 1 or following == index + 1:
            return original(patches, index)
        return original(patches, index - 1)

    return wrong


def _gap_forgets_wrap(original: Function, size: float) -> Function:
    """The gap behind the last patch ends with the period."""

    def wrong(patches: Any) -> Any:
        gaps = np.array(original(patches))
        beyond = 2 * np.pi - patches.right[-1]
        if beyond > 0:
            gaps[-1] = beyond
        return gaps

    return wrong


def _sign_of_outer_series(original: Function, size: float) -> Function:
    """The logarithm of a patch seen from its gap lacks the part of its uneven pressure."""

    def wrong(field: Any, index: int, x: Any) -> Any:
        patches = field.state.patches
        t = (x - patches.center[index]) / patches.half_width[index]
        zeta = t - np.copysign(np.sqrt(np.maximum(t * t - 1, 0.0)), t)
        uneven = np.array([series[1] for series in field.state.pressure().charges])
        return original(field, index, x) + size * np.pi * zeta * uneven[index]

    return wrong


def _phases_reused(original: Function, size: float) -> Function:
    """All realisations get the phases of the first."""
    return lambda cls, period, hurst, rms_height, harmonics, seed: original(
        cls, period, hurst, rms_height, harmonics, 0
    )


def _one_sided(original: Function, size: float) -> Function:
    """Spectra two-sided in name, one-sided in fact."""

    def wrong(*given: Any, **named: Any) -> Any:
        return np.asarray(original(*given, **named)) * np.sqrt(1 + size)

    return wrong


def _unnoticed(original: Function, size: float) -> Function:
    """Energy never tells that Newton left the branch."""
    return lambda *given, **named: bool(original(*given, **named)) and size < 1


def _released_to_wrong_unit(original: Function, size: float) -> Function:
    """The energy an event releases, by a factor."""

    def wrong(problem: Any, event: Any) -> Any:
        right = original(problem, event)
        return replace(right, energy_released=right.energy_released * (1 + size))

    return wrong


BEM_FAULTS: tuple[Fault, ...] = (
    Fault(
        "bem-e-for-e-star",
        "E in place of E* = E / (1 - nu^2)",
        "bem.geometry.scaling:Solid.plane_strain_modulus",
        _youngs_for_plane_strain,
        "E* becomes E",
    ),
    Fault(
        "bem-work-factor-2",
        "factor 2 in G: work of adhesion made dimensionless with half its unit",
        "bem.geometry.scaling:Scales.release_rate",
        scaled(1.0),
        "unit of G doubled",
    ),
    Fault(
        "bem-k-factor-sqrt-2",
        "factor sqrt 2 in K: sqrt(2 pi) for sqrt(pi) in its definition",
        "bem.geometry.scaling:Scales.stress_intensity",
        scaled(np.sqrt(2) - 1),
        "unit of K times sqrt 2",
    ),
    Fault(
        "bem-stress-factor-2",
        "factor 2 in the unit of stress",
        "bem.geometry.scaling:Scales.stress",
        scaled(1.0),
        "doubled",
    ),
    Fault(
        "bem-energy-factor-2",
        "the 1/2 of the elastic energy lost where it becomes J/m^2",
        "bem.geometry.scaling:Scales.energy_per_area",
        scaled(1.0),
        "unit of energy doubled",
    ),
    Fault(
        "bem-slope-term-dropped",
        "edges see gamma, not gamma sqrt(1 + h'^2)",
        "bem.adhesive.adhesion:SlopeLaw.work_of_adhesion",
        _without_slope_term,
        "slope term absent",
    ),
    Fault(
        "bem-slope-energy-dropped",
        "adhesion energy on the projected length",
        "bem.adhesive.adhesion:SlopeLaw.energy",
        _without_slope_energy,
        "slope term absent",
    ),
    Fault(
        "bem-sensitivity-sign",
        "sign of the regular part of the pressure in dK / d(edge)",
        "bem.elastic.sensitivities:stress_intensity_jacobian",
        _sign_of_edge_slope,
        "sign turned",
    ),
    Fault(
        "bem-sensitivity-width",
        "K / (4 r) forgotten in dK / d(edge)",
        "bem.elastic.sensitivities:stress_intensity_jacobian",
        _without_width_term,
        "term absent",
    ),
    Fault(
        "bem-layer-bracket",
        "5 - 12 nu + 4 nu^2 for 5 - 12 nu + 8 nu^2 in the compliance of a layer",
        "bem.elastic.layer:_constant",
        _wrong_bracket,
        "coefficient 8 becomes 4",
    ),
    Fault(
        "bem-layer-mean-compliance",
        "mean compression of a layer as of a free bar, d / E",
        "bem.elastic.layer:Layer.mean_compliance",
        _uniaxial_compression,
        "c(0) becomes d / E",
    ),
    Fault(
        "bem-one-node-weight",
        "one node of the Chebyshev transform counts twice",
        "bem.geometry.chebyshev:coefficients",
        _heavier_node,
        "weight doubled",
    ),
    Fault(
        "bem-one-moment",
        "one entry of the logarithmic moments is doubled",
        "bem.geometry.chebyshev:basis",
        _heavier_charge,
        "entry doubled",
    ),
    Fault(
        "bem-kernel-between",
        "kernel between patches by log of the squared distance",
        "bem.elastic.half_space:between_nodes",
        scaled(1.0),
        "kernel doubled",
    ),
    Fault(
        "bem-kernel-between-clusters",
        "a constant of the kernel between clusters of patches forgotten",
        "bem.elastic.separated_kernel:separated_kernel",
        _forgotten_constant,
        "log 2 absent",
    ),
    Fault(
        "bem-kernel-open",
        "the period forgotten within a patch",
        "bem.elastic.half_space:within_patch",
        _open_kernel,
        "log sinc absent",
    ),
    Fault(
        "bem-leap-unnoticed",
        "a leap of Newton to another branch is taken for the branch",
        "bem.adhesive.branch:misses_energy",
        _unnoticed,
    ),
    Fault(
        "bem-gap-every-second-point",
        "the gap is looked at in every second point, and nowhere between",
        "bem.elastic.gap:low_minima",
        _every_second_point,
    ),
    Fault(
        "bem-gap-every-second-minimum",
        "every second minimum of the gap is passed over",
        "bem.elastic.gap:low_minima",
        _every_second_minimum,
    ),
    Fault(
        "bem-merge-forgets-wrap",
        "a merge across the end of the period closes the gap on the other side",
        "bem.geometry.patches:Patches.merged_after",
        _merge_forgets_wrap,
    ),
    Fault(
        "bem-gap-forgets-wrap",
        "the last gap ends with the period",
        "bem.geometry.patches:Patches.gap_after",
        _gap_forgets_wrap,
    ),
    Fault(
        "bem-gap-outer-series",
        "the tilt of the pressure is not seen from the gap",
        "bem.elastic.gap:GapField._near_patch",
        _sign_of_outer_series,
        "term absent",
    ),
    Fault(
        "bem-event-energy",
        "energy released by an event counted twice",
        "bem.states:event_of",
        _released_to_wrong_unit,
        "doubled",
    ),
    Fault(
        "bem-phases-reused",
        "every realisation gets the phases of the first",
        "bem.geometry.profile:Profile.self_affine",
        _phases_reused,
    ),
    Fault(
        "bem-spectrum-one-sided",
        "pressure modes of a spectrum counted on one side",
        "bem.observables.spectra:pressure_modes",
        _one_sided,
        "power doubled",
    ),
)
