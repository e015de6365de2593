"""Adapters from a scene, or a problem in raw numbers (harness/route.py), to each code."""
