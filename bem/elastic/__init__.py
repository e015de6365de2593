"""Pressure and displacement of the half-space or layer for given edges: kernels, solution, K, and the gap outside."""
