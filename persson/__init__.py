"""Persson's contact theory for roughness in one direction, with and without adhesion.

`solve(spectrum, mean_pressure, ...)` is the entry; `DiscreteSpectrum` holds the lines of a periodic profile,
`ContinuousSpectrum` a power spectrum.
"""

from persson.area_factor import AREA_FACTORS, gaussian_slope_1d, isotropic_2d
from persson.contact import AdhesiveContact
from persson.double_gaussian import DoubleGaussian, double_gaussian, fit_double_gaussian
from persson.nonadhesive import NonadhesiveContact, solve_nonadhesive
from persson.solve import solve
from persson.spectrum import ContinuousSpectrum, DiscreteSpectrum

__all__ = [
    "AREA_FACTORS",
    "AdhesiveContact",
    "ContinuousSpectrum",
    "DiscreteSpectrum",
    "DoubleGaussian",
    "NonadhesiveContact",
    "double_gaussian",
    "fit_double_gaussian",
    "gaussian_slope_1d",
    "isotropic_2d",
    "solve",
    "solve_nonadhesive",
]
