"""Measured profiles: from a file to the uniform samples of a period, in m.

read      read_scan.py calls one reader: read_bytes.py and read_table.py for columns of numbers (their heading:
          read_heading.py), read_npy.py for .npy files, read_instrument.py for all others.
pick      pick_columns.py or pick_row.py takes the line that the scene names; find_axes.py refuses axes among heights,
          mark_missing.py puts NaN for missing heights.
units     convert_units.py turns positions and heights into m: a `MeasuredLine` (measured_line.py).
prepare   prepare_line.py changes the line step by step: prepare_heights.py (dropouts, spikes, gaps), prepare_spacing.py
          (equal steps), trend, continuation over a period, gaussian_filter.py; noise_floor.py looks at the spectrum.
profile   `PeriodicSamples` (periodic_samples.py) are the result: bem/scene/surface.py makes the profile of them.

scan_keys.py lists the keys of [profile] for all this; every mistake is a `ScanFileError` (scan_file_error.py).
Arrays given in Python begin at `MeasuredLine` (`read_scan.line_of_arrays`).
"""
