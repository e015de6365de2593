"""Machinery that runs and judges cases: rows, schema, comparison, verdicts, baselines, processes, provenance."""
