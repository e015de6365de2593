"""Units of length in which positions and heights of a scan may be given, in metres."""

METRES = {  # the international inch
    **{"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "angstrom": 1e-10, "pm": 1e-12},
    **{"in": 25.4e-3, "mil": 25.4e-6, "uin": 25.4e-9},
}
LENGTH_UNITS = ", ".join(f'"{unit}"' for unit in METRES)
