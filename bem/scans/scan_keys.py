"""Keys of [profile] that say how a scan is read and prepared, for scenes with a scan and without."""

TEXT_KEYS = ("skip_lines", "decimal", "columns", "valid_column", "valid_value")  # of text files alone
SCAN_KEYS = ("unit_x", "unit_h", *TEXT_KEYS, "missing_value", "spacing", "row", "every", "channel")  # how it is read
ARRAY_KEYS = ("spacing", "row", "every")  # of SCAN_KEYS, those of arrays in memory
DEFAULTS = {  # how it is prepared
    **{"dropouts": "missing", "missing": "refuse", "outliers": "keep"},
    **{"detrend": "mean", "periodic": "as_is", "unequal_spacing": "refuse"},
}
CUTOFFS = ("cutoff_short", "cutoff_long")  # of Gaussian filters, m; without them nothing is filtered
