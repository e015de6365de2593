"""A study of one's own scene: what its accuracy costs, and what the question leaves open beside it."""

SEEDS = 8  # realisations besides the scene's own
BUDGET = 3600.0  # CPU s
