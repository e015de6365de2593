"""Profile, contact patches on it, Chebyshev polynomials, and the scales of the dimensionless problem."""
