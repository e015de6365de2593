"""Cases on the suite itself: the harness, the hard cases of all codes, rates of convergence."""
