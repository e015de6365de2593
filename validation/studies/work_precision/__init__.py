"""Error against time of every method, and the price of each effect."""
