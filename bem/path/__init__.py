"""The path of adhesive equilibria as its control changes: stands, spans, folds, touches, jumps."""
