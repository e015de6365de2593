"""Cases on rough profiles: the paper's profile, theory without adhesion, the paper's method, FFT solvers."""
