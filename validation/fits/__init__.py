"""Scripts, run by hand, that fit the laws of `persson.contact_area` on boundary-element ensembles."""
