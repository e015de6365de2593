"""Scan of a scene: the samples that [profile] names, in a file or as arrays, and what follows from them.

The module imports the readers of bem/scans only for a scene with a scan.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from bem.geometry.ranges import MOST_HARMONICS, Mistake, shown
from bem.scans.scan_keys import CUTOFFS, DEFAULTS, SCAN_KEYS
from bem.scene.scene_tables import ProfileTable

if TYPE_CHECKING:
    from bem.scans.measured_line import MeasuredLine
    from bem.scans.periodic_samples import PeriodicSamples

ALL_ROWS = "all"  # profile.row of a map whose rows are solved each (bem/map_rows.py)
IN_MEMORY = "arrays in memory"  # the name of the file of samples that are given as arrays
SAMPLED_HARMONICS = 1000  # format: default cut of a scan that is not filtered

Samples = tuple[ArrayLike | None, ArrayLike]  # positions, where they are given, and heights


def without_arrays(data: Mapping[str, Any]) -> tuple[Mapping[str, Any], Samples | None, list[Mistake]]:
    """Return the tables with a name in place of the samples x and h of a profile, the samples, and their mistakes."""
    profile = data.get("profile")
    if not isinstance(profile, Mapping) or "file" in profile or profile.get("kind") != "samples":
        return data, None, []
    x, h = profile.get("x"), profile.get("h")
    if x is None and h is None:
        return data, None, []
    rest = {key: value for key, value in profile.items() if key not in ("x", "h")}
    data = {**data, "profile": rest | {"file": IN_MEMORY}}
    if h is None or (x is None and "spacing" not in profile):
        allowed = "samples in memory need x and h, arrays of equal length in m, or h and its spacing in m"
        return data, None, [Mistake(f"profile.{'h' if h is None else 'x'}", "is missing", allowed)]
    return data, (x, h), []


def scan_of(
    profile: Mapping[str, Any], given: set[str], base_dir: Path, arrays: Samples | None
) -> tuple[PeriodicSamples | None, list[Mistake]]:
    """Return the prepared samples of profile.file or of arrays, if the keys of [profile] for reading are valid."""
    wrong = [key for key in given.intersection((*SCAN_KEYS, *DEFAULTS, *CUTOFFS)) if key not in profile]
    if profile.get("kind") != "samples" or "file" not in profile or wrong:
        return None, []
    if profile.get("row") == ALL_ROWS:
        allowed = 'a row, or "mean"; all are solved by linecontact run, and by bem.solve_rows in Python'
        return None, [Mistake("profile.row", f'= "{ALL_ROWS}" is many scenes', allowed)]
    from bem.scans.prepare_line import prepare
    from bem.scans.scan_file_error import ScanFileError

    name = profile["file"]
    try:
        scan = prepare(measured_line(profile, base_dir, arrays), profile)
    except ScanFileError as error:
        named = f"= {shown(name)}: "
        return None, [
            replace(each, found=named * (each.path == "profile.file") + each.found) for each in error.mistakes
        ]
    return scan, list(_scan_mistakes(profile, scan))


def measured_line(profile: Mapping[str, Any], base_dir: Path, arrays: Samples | None) -> MeasuredLine:
    """Return the measured line of profile.file or of arrays; ScanFileError if there is none."""
    from bem.scans.read_scan import line_of_arrays, read_scan

    return read_scan(base_dir / profile["file"], profile) if arrays is None else line_of_arrays(*arrays, profile)


def with_scan(profile: ProfileTable, scan: PeriodicSamples) -> ProfileTable:
    """Return [profile] with its defaults for a scan: units, preparation, period and cut."""
    read = scan.steps[0]
    units = {key: read[key] for key in ("unit_x", "unit_h")}
    carried = SAMPLED_HARMONICS if profile.cutoff_short is None else min(scan.harmonics_needed, MOST_HARMONICS)
    defaults = DEFAULTS | units | {"period": scan.period, "harmonics": min(scan.max_harmonics, carried)}
    update = {key: value for key, value in defaults.items() if getattr(profile, key) is None}
    if profile.harmonics == "all":
        update["harmonics"] = min(scan.max_harmonics, MOST_HARMONICS)
    return replace(profile, **update)


def _scan_mistakes(values: Mapping[str, Any], scan: PeriodicSamples) -> Iterator[Mistake]:
    """Yield a period and a cut that do not fit the samples of a scan."""
    period, harmonics = values.get("period"), values.get("harmonics")
    if period is not None and abs(period - scan.period) > 0.5 * scan.spacing:
        yield Mistake(
            "profile.period",
            f"= {period:g} does not fit {scan.x.size} prepared samples at distance {scan.spacing:g}",
            f"{scan.period:g} m within half a sample distance (the end point of the period is excluded)",
        )
    if isinstance(harmonics, int) and harmonics > scan.max_harmonics:
        yield Mistake(
            "profile.harmonics",
            f"= {harmonics}",
            f"an integer from 1 to {scan.max_harmonics} for the {scan.x.size} prepared samples of a period",
        )
