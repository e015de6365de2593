"""Observables of a state as the arrays of fields.npz, in SI units.

shapes:                 x_k, displacement_k, gap_k (m), pressure_k (Pa, nan outside contact), patch_k (-1 outside)
spectra:                q (rad/m), C_h, C_u_k (m^3), C_sigma_k (Pa^2 m), two-sided per line, at q = m q0
pressure_distribution:  sigma_k (Pa, bin centers), P_k (1/Pa, mean over the bin), sigma_bounds_k (Pa),
                        outside_contact_k (weight of the delta function at zero), tail_coefficient_k (Pa^2)

k is `State.stored`.  Methods: shapes.py, spectra.py and pressure_distribution.py of bem/observables.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.geometry.patches import PatchPressure
from bem.loading.complete_contact import CompleteContact
from bem.observables.pressure_distribution import (
    PressureDistribution,
    complete_contact_distribution,
    pressure_distribution,
)
from bem.observables.shapes import Shape, complete_contact_shape, separated_shape, shape
from bem.observables.spectra import Spectra, complete_contact_spectra, spectra
from bem.problem import Problem

Fields = dict[str, NDArray[Any]]


def contact_fields(
    wanted: Collection[str], problem: Problem, pressure: PatchPressure, penetration: float, k: int
) -> Fields:
    """Return the arrays of a state with patches and gaps, or without any patch.

    `wanted` are names of [output]; pressure and penetration Delta are dimensionless.
    """
    profile, ratio = problem.profile, problem.compliance_ratio
    makers: dict[str, Callable[[], Fields]] = {
        "shapes": lambda: _shape(
            problem,
            shape(profile, pressure, penetration, ratio)
            if pressure.left.size
            else separated_shape(profile, penetration),
            k,
        ),
        "spectra": lambda: _spectra(problem, spectra(profile, pressure, None, ratio), k),
        "pressure_distribution": lambda: _distribution(problem, pressure_distribution(pressure), k),
    }
    return {name: values for each in wanted for name, values in makers[each]().items()}


def complete_contact_fields(
    wanted: Collection[str], problem: Problem, complete: CompleteContact, load: float, k: int
) -> Fields:
    """Return the arrays of complete contact under a dimensionless load per period."""
    profile, pressure, mean = problem.profile, complete.pressure, load / (2 * np.pi)
    makers: dict[str, Callable[[], Fields]] = {
        "shapes": lambda: _shape(problem, complete_contact_shape(profile, pressure, mean), k),
        "spectra": lambda: _spectra(problem, complete_contact_spectra(profile, None, problem.compliance_ratio), k),
        "pressure_distribution": lambda: _distribution(problem, complete_contact_distribution(pressure, mean), k),
    }
    return {name: values for each in wanted for name, values in makers[each]().items()}


def _shape(problem: Problem, shape: Shape, k: int) -> Fields:
    scales = problem.scales
    return {
        f"x_{k}": shape.x * scales.length,
        f"displacement_{k}": shape.displacement * scales.height,
        f"gap_{k}": shape.gap * scales.height,
        f"pressure_{k}": shape.pressure * scales.stress,
        f"patch_{k}": shape.patch,
    }


def _spectra(problem: Problem, spectra: Spectra, k: int) -> Fields:
    scales = problem.scales
    return {
        "q": spectra.orders / scales.length,
        "C_h": spectra.profile * (scales.height**2 * scales.length),
        f"C_u_{k}": spectra.displacement * (scales.height**2 * scales.length),
        f"C_sigma_{k}": spectra.pressure * (scales.stress**2 * scales.length),
    }


def _distribution(problem: Problem, distribution: PressureDistribution, k: int) -> Fields:
    stress = problem.scales.stress
    return {
        f"sigma_{k}": distribution.pressures * stress,
        f"P_{k}": distribution.density / stress,
        f"sigma_bounds_{k}": distribution.levels * stress,
        f"outside_contact_{k}": np.array(distribution.outside_contact),
        f"tail_coefficient_{k}": np.array(distribution.tail_coefficient * stress**2),
    }
