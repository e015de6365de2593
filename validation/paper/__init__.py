"""Replication of Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.

replicate.py (command), members.py (scenes), ensemble.py (solve and store), evidence.py (means and errors),
statements.py (the rule that judges a statement), and a module for each topic: area, separation, spectra, pressure and
double_gaussian_fit, hurst, shapes, heights, vanishing_adhesion, layer_problem.
"""
