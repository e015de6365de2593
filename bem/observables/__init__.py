"""What is asked for besides the states: shapes, spectra, distributions of pressure and widths."""
