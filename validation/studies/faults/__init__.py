"""Faults of the code as a table, and the script that asks whether the cases notice them."""
