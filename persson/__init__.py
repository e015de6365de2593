"""Persson's contact theory for roughness in one direction, with and without adhesion.

`solve(spectrum, mean_pressure, ...)` is the entry.  `DiscreteSpectrum` holds the lines of a periodic profile,
`ContinuousSpectrum` a power spectrum; a state gives its quantities at every magnification, in SI units:

>>> import numpy as np
>>> import persson
>>> lines = persson.DiscreteSpectrum.self_affine(first_wavenumber=628.3, hurst=0.7, h_rms=50e-6, n_lines=100)
>>> material = dict(youngs_modulus=1e6, poisson_ratio=0.5)
>>> state = persson.solve(lines, mean_pressure=6667.0, work_of_adhesion=0.03, **material)
>>> state.status, round(state.contact_fraction, 4)
('converged', 0.0633)
>>> round(state.separation / lines.h_rms, 3)
0.809
>>> state.contact_fraction_at(10 * 628.3) > state.contact_fraction
True
>>> stress = np.linspace(-2e4, 2e5, 500)
>>> fit = persson.fit_double_gaussian(stress, state.pressure_distribution(stress), state.mean_pressure)

Where to look: spectrum.py (what the theory sees of a profile), nonadhesive.py (closed forms), area_factor.py and
adhesive.py (effective work of adhesion, moving barrier, fixed point), magnification.py (the mesh both routes share),
diffusion.py and volterra.py (the two routes), separation.py, double_gaussian.py, contact.py (what is returned),
status.py (what can go wrong, with advice), solve.py (all of it in order).  `contact_area` gives the area alone, by two
laws fitted on boundary-element ensembles: fitted_area.py (entry and domain), contact_slope.py (without adhesion),
adhesive_edges.py (with adhesion).
"""

from persson.contact import AdhesiveContact
from persson.double_gaussian import DoubleGaussian, double_gaussian, fit_double_gaussian
from persson.fitted_area import FittedArea, contact_area
from persson.mathematics.area_factor import AREA_FACTORS, gaussian_slope_1d, isotropic_2d
from persson.nonadhesive import NonadhesiveContact, solve_nonadhesive
from persson.solve import solve
from persson.spectrum import ContinuousSpectrum, DiscreteSpectrum

__all__ = [
    "AREA_FACTORS",
    "AdhesiveContact",
    "ContinuousSpectrum",
    "DiscreteSpectrum",
    "DoubleGaussian",
    "FittedArea",
    "NonadhesiveContact",
    "contact_area",
    "double_gaussian",
    "fit_double_gaussian",
    "gaussian_slope_1d",
    "isotropic_2d",
    "solve",
    "solve_nonadhesive",
]
