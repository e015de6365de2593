"""Keys of [profile] that say how a scan is read and prepared, for scenes with a scan and without."""

METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
SCAN_KEYS = ("unit_x", "unit_h", "decimal", "columns", "spacing", "row", "channel")  # how it is read
DEFAULTS = {  # how it is prepared
    "missing": "refuse",
    "outliers": "keep",
    "detrend": "mean",
    "periodic": "as_is",
    "unequal_spacing": "refuse",
}
