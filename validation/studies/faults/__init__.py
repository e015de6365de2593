"""Faults put into the running code, and what catches them."""
