"""A study of one's own scene: what its accuracy costs, and what the question leaves open beside it."""
