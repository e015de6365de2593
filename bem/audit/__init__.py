"""The independent check of a state by routes that share nothing with the solver, and the dense evaluation."""
