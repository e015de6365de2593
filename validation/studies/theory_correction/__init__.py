"""The correction of Persson's area: calibrated, and judged on a hold-out."""
