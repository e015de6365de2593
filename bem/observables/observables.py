"""Observables of a state as the arrays of fields.npz, in SI units; only the methods asked for are imported and run.

shapes:                 x_k, displacement_k, gap_k (m), pressure_k (Pa, nan outside contact), patch_k (-1 outside)
spectra:                q (rad/m), C_h, C_u_k (m^3), C_sigma_k (Pa^2 m), two-sided per line, at q = m q0
pressure_distribution:  sigma_k (Pa, bin centers), P_k (1/Pa, mean over the bin), sigma_bounds_k (Pa),
                        outside_contact_k (weight of the delta function at zero), tail_coefficient_k (Pa^2)

k is `State.stored`.  Methods: shapes.py, spectra.py, pressure_distribution.py.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bem.geometry.arrays import FloatArray
from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile
from bem.geometry.scaling import Scales
from bem.loading.complete_contact import CompleteContact

if TYPE_CHECKING:
    from bem.observables.pressure_distribution import PressureDistribution
    from bem.observables.shapes import Shape
    from bem.observables.spectra import Spectra

Fields = dict[str, NDArray[Any]]


class Posed(Protocol):
    """Posed problem: the profile, its units, and the compliance of the modes."""

    @property
    def profile(self) -> Profile:
        """Profile, dimensionless."""
        ...

    @property
    def scales(self) -> Scales:
        """Units of the results."""
        ...

    @property
    def compliance_ratio(self) -> Callable[[FloatArray], FloatArray] | None:
        """Compliance relative to a half-space, (n,) to (n,) for modes m >= 1; None for a half-space."""
        ...


def contact_fields(
    wanted: Collection[str], problem: Posed, pressure: PatchPressure, penetration: float, index: int
) -> Fields:
    """Return the arrays of a state with patches and gaps, or without any patch, under names that end in `index`.

    `wanted` are names of [output]; pressure and penetration Delta are dimensionless.
    """
    fields: Fields = {}
    if "shapes" in wanted:
        fields |= _contact_shape(problem, pressure, penetration, index)
    if "spectra" in wanted:
        from bem.observables.spectra import spectra

        fields |= _spectra(problem, spectra(problem.profile, pressure, None, problem.compliance_ratio), index)
    if "pressure_distribution" in wanted:
        from bem.observables.pressure_distribution import pressure_distribution

        fields |= _distribution(problem, pressure_distribution(pressure), index)
    return fields


def complete_contact_fields(
    wanted: Collection[str], problem: Posed, complete: CompleteContact, load: float, index: int
) -> Fields:
    """Return the arrays of complete contact under a dimensionless load per period, named as by `contact_fields`."""
    fields: Fields = {}
    mean = load / (2 * np.pi)
    if "shapes" in wanted:
        from bem.observables.shapes import complete_contact_shape

        fields |= _shape(problem, complete_contact_shape(problem.profile, complete.pressure, mean), index)
    if "spectra" in wanted:
        from bem.observables.spectra import complete_contact_spectra

        fields |= _spectra(problem, complete_contact_spectra(problem.profile, None, problem.compliance_ratio), index)
    if "pressure_distribution" in wanted:
        from bem.observables.pressure_distribution import complete_contact_distribution

        fields |= _distribution(problem, complete_contact_distribution(complete.pressure, mean), index)
    return fields


def _contact_shape(problem: Posed, pressure: PatchPressure, penetration: float, index: int) -> Fields:
    from bem.observables.shapes import separated_shape, shape

    if pressure.left.size == 0:
        return _shape(problem, separated_shape(problem.profile, penetration), index)
    return _shape(problem, shape(problem.profile, pressure, penetration, problem.compliance_ratio), index)


def _shape(problem: Posed, shape: Shape, index: int) -> Fields:
    scales = problem.scales
    return {
        f"x_{index}": shape.x * scales.length,
        f"displacement_{index}": shape.displacement * scales.height,
        f"gap_{index}": shape.gap * scales.height,
        f"pressure_{index}": shape.pressure * scales.stress,
        f"patch_{index}": shape.patch,
    }


def _spectra(problem: Posed, spectra: Spectra, index: int) -> Fields:
    scales = problem.scales
    return {
        "q": spectra.orders / scales.length,
        "C_h": spectra.profile * (scales.height**2 * scales.length),
        f"C_u_{index}": spectra.displacement * (scales.height**2 * scales.length),
        f"C_sigma_{index}": spectra.pressure * (scales.stress**2 * scales.length),
    }


def _distribution(problem: Posed, distribution: PressureDistribution, index: int) -> Fields:
    stress = problem.scales.stress
    return {
        f"sigma_{index}": distribution.pressures * stress,
        f"P_{index}": distribution.density / stress,
        f"sigma_bounds_{index}": distribution.levels * stress,
        f"outside_contact_{index}": np.array(distribution.outside_contact),
        f"tail_coefficient_{index}": np.array(distribution.tail_coefficient * stress**2),
    }
