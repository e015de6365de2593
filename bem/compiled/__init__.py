"""Kernels in C beside their references in NumPy: which run is settled in kernels.py."""
