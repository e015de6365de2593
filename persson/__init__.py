"""Persson's contact theory for one-dimensional roughness."""

from persson.nonadhesive import NonadhesiveContact, solve_nonadhesive
from persson.spectrum import DiscreteSpectrum

__all__ = ["DiscreteSpectrum", "NonadhesiveContact", "solve_nonadhesive"]
