"""Gaps, shapes, spectra and distributions of the pressure of a state."""
