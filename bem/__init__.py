"""Free-boundary boundary element solver for adhesive line contact."""
