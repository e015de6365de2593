"""Persson's contact theory for one-dimensional roughness."""
