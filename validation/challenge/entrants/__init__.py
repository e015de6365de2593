"""Solvers of the standings, each behind the public door: a function of a plain problem that returns plain numbers."""
