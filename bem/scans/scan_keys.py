"""Keys of [profile] that say how a scan is read and prepared, for scenes with a scan and without."""

METRES = {  # the international inch
    **{"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "angstrom": 1e-10, "pm": 1e-12},
    **{"in": 25.4e-3, "mil": 25.4e-6, "uin": 25.4e-9},
}
UNITS = ", ".join(f'"{unit}"' for unit in METRES)
TEXT_KEYS = ("skip_lines", "decimal", "columns", "valid_column")  # of text files alone
SCAN_KEYS = ("unit_x", "unit_h", *TEXT_KEYS, "missing_value", "spacing", "row", "channel")  # how a scan is read
DEFAULTS = {  # how it is prepared
    "dropouts": "missing",
    "missing": "refuse",
    "outliers": "keep",
    "detrend": "mean",
    "periodic": "as_is",
    "unequal_spacing": "refuse",
}
CUTOFFS = ("cutoff_short", "cutoff_long")  # of Gaussian filters, m; without them nothing is filtered
BACKSLASHES = "backslashes in single quotes, 'C:\\Users\\me\\scan.csv', or with / instead"  # in names of files
