"""Replication of Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.

statements.toml (the paper's statements), statements.py (the rule that judges a statement), members.py (scenes),
ensemble.py (solutions, means and errors), load_curves.py, spectra.py, pressures.py and profiles.py (our numbers and
the figures), replicate.py (command and report).
"""
