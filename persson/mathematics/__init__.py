"""Mathematics that the theory uses and that knows nothing of it."""
