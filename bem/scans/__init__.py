"""Measured profiles: from a file to the uniform samples of a period, in m.

file -> measured line   read_scan.py: positions and heights in m, NaN where missing.  Text goes through read_bytes.py
                        (bytes to text), read_text.py (columns of numbers), read_columns.py and read_map.py (the columns
                        or the row that the scene names); .npy files through read_array.py, others through
                        read_instrument.py.  Units: read_units.py.
line -> samples         prepare_scan.py, step by step: prepare_heights.py (dropouts, spikes, gaps), prepare_spacing.py
                        (equal steps), trend, noise_floor.py, continuation over a period, gaussian_filter.py.
samples -> profile      prepared_scan.py: `Scan`, from which bem.geometry.profile makes the profile, and what the cut of
                        the scene leaves of it.
"""
