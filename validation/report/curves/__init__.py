"""Curves of a run, and of the theory beside it."""
