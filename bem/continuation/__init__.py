"""The path of adhesive equilibria as its control changes: limit points, jumps, touches, openings."""
