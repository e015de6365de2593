"""The harness that compares solver, finite elements and theory."""
