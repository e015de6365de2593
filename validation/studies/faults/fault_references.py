"""Faults of the finite elements, of Persson's theory, and of what leads from a scene to the codes.

A fault is a function from the right code and a size to the wrong code; size 1 is the slip itself.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from fem_reference.face import face_nodes
from fem_reference.problem import Problem
from validation.studies.faults.fault_injection import Fault, Function, scaled


def _under_integrated(original: Function, size: float) -> Function:
    """Stiffness by a quadrature two degrees too low."""

    def wrong(triangles: Any, order: int, quadrature_order: int | None = None) -> Any:
        return original(triangles, order, 2 * order - 4 or 1)

    return wrong


def _locked(original: Function, size: float) -> Function:
    """The layer is assembled as nearly incompressible whatever its Poisson's ratio."""
    return lambda spaces, shear, inverse_bulk: original(spaces, shear, inverse_bulk * (1 - 0.9 * size))


def _engineering_shear(original: Function, size: float) -> Function:
    """mu assembled too stiff: the factor one half of the shear strain partly lost."""
    return lambda spaces, shear, inverse_bulk: original(spaces, shear * (1 + size), inverse_bulk)


def _stiffer_reference_modulus(original: Function, size: float) -> Function:
    """E in place of E* where the finite elements turn G into K."""
    return lambda problem: original(problem) * (1 - size * problem.poisson_ratio**2)


def _closure_with_youngs_modulus(original: Function, size: float) -> Function:
    """E in place of E* in one step of the closure, its stress intensities and its critical ones alike."""

    class Softer(Problem):
        @property
        def plane_strain_modulus(self) -> float:
            return (1 - size * self.poisson_ratio**2) * super().plane_strain_modulus

    def wrong(problem: Problem, *given: Any) -> Any:
        return original(Softer(**{field.name: getattr(problem, field.name) for field in fields(problem)}), *given)

    return wrong


def _mean_of_ends(original: Function, size: float) -> Function:
    """The mean over the face by the trapezoid rule of the ends of the facets."""

    def wrong(spaces: Any, field: Any) -> Any:
        nodes = face_nodes(spaces)
        ends = field[spaces.sizes[0] + nodes.index][:: nodes.order]
        rough = float(np.sum(np.diff(nodes.x[:: nodes.order]) * (ends[1:] + ends[:-1]) / 2))
        return (1 - size) * original(spaces, field) + size * rough

    return wrong


def _youngs_in_theory(original: Function, size: float) -> Function:
    """E in place of E / (1 - nu^2), from numbers."""
    return lambda youngs_modulus, poisson_ratio: original(youngs_modulus, poisson_ratio) * (1 - size * poisson_ratio**2)


def _previous_wavenumber(original: Function, size: float) -> Function:
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


def _higher_barrier(original: Function, size: float) -> Function:
    """Stress absorbed at a tension too large by sqrt 2."""

    def wrong(loads: Any, variance: Any, barrier: Any, *given: Any, **named: Any) -> Any:
        return original(loads, variance, barrier * (1 + size * (np.sqrt(2) - 1)), *given, **named)

    return wrong


def _variance_of_stress(original: Function, size: float) -> Function:
    """V = S / 2 in place of S / 4: the contact sees roughness too steep by sqrt 2."""
    return lambda variance, load: original(np.asarray(variance) * (1 + size), load)


def _amplitudes_as_rms(original: Function, size: float) -> Function:
    """The rms of each harmonic handed over as its amplitude."""

    def wrong(posed: Any) -> Any:
        right = original(posed)
        return type(right)(right.wavenumbers, right.amplitudes * (1 + size * (np.sqrt(0.5) - 1)))

    return wrong


REFERENCE_FAULTS: tuple[Fault, ...] = (
    Fault(
        "fem-e-for-e-star",
        "E in place of E* where G becomes K",
        "fem_reference.problem:Problem.plane_strain_modulus",
        _stiffer_reference_modulus,
        "E* becomes E",
    ),
    Fault(
        "fem-closure-e-for-e-star",
        "E in place of E* in the closure only, in K and in the critical K alike",
        "fem_reference.solve:closed",
        _closure_with_youngs_modulus,
        "E* becomes E",
    ),
    Fault(
        "fem-stability-e-for-e-star",
        "E in place of E* in the second derivatives of the energy at the edges",
        "fem_reference.closure:hessian",
        _closure_with_youngs_modulus,
        "E* becomes E",
    ),
    Fault(
        "fem-under-integrated",
        "stiffness by a quadrature two degrees too low",
        "fem_reference.elasticity:taylor_hood",
        _under_integrated,
    ),
    Fault(
        "fem-locked",
        "assembled ten times less compressible than it is",
        "fem_reference.elasticity:assemble",
        _locked,
        "1/k a tenth",
    ),
    Fault(
        "fem-shear-factor-2",
        "factor 2 in the shear modulus of the stiffness",
        "fem_reference.elasticity:assemble",
        _engineering_shear,
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
        _mean_of_ends,
        "trapezoid rule",
    ),
    Fault(
        "persson-e-for-e-star",
        "E in place of E*",
        "persson.nonadhesive:plane_strain_modulus",
        _youngs_in_theory,
        "E* becomes E",
    ),
    Fault(
        "persson-variance",
        "V = S / 2 in place of S / 4",
        "persson.nonadhesive:contact_fraction",
        _variance_of_stress,
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
        _previous_wavenumber,
        "one line late",
    ),
    Fault(
        "persson-barrier-sqrt-2",
        "stress absorbed at a tension too large by sqrt 2",
        "persson.diffusion:march",
        _higher_barrier,
        "barrier times sqrt 2",
    ),
    Fault(
        "adapter-rms-for-amplitude",
        "the theory is handed rms values for amplitudes",
        "validation.references.adapters:persson_spectrum",
        _amplitudes_as_rms,
        "amplitudes by 1 / sqrt 2",
    ),
)
