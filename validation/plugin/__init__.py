"""Pytest plugin of the verification: rows of cases, stored errors, levels, resumption, report."""
