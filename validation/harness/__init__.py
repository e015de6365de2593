"""What runs cases and judges them: rows and their schema, comparison, verdicts, baselines, processes, provenance."""
