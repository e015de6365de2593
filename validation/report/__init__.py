"""The report: figures drawn from numbers, one self-contained page rendered from report.json alone."""
