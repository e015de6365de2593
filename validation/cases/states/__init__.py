"""Cases on what is said of a state: identities, error estimates, verdicts, observables."""
