"""Units of a line, stated by its file or given by the scene, and the line in m.

A file's units count if it states one for every column that is used.  Where scene and file both state a unit, the two
must be equal.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.lengths import LENGTH_UNITS, METRES
from bem.geometry.ranges import Mistake
from bem.scans.measured_line import MeasuredLine
from bem.scans.scan_file_error import ScanFileError
from bem.scans.scan_keys import TEXT_KEYS

SYMBOLS = {"μm": "um", "μin": "uin", "Å": "angstrom"}  # after NFKC, which has one micro sign and one angstrom sign


def unit_of(word: str) -> str:
    """Return the unit that a word means, as scenes spell it; other words unchanged.

    Examples
    --------
    >>> unit_of("µm"), unit_of("Å"), unit_of("mm"), unit_of("V")
    ('um', 'angstrom', 'mm', 'V')
    """
    word = unicodedata.normalize("NFKC", word.strip())
    return SYMBOLS.get(word, word)


def line_in_metres(
    values: Mapping[str, Any],
    x: FloatArray | None,
    h: FloatArray,
    stated: Mapping[str, str],
    source: str,
    facts: dict[str, Any],
) -> MeasuredLine:
    """Return the line of positions and heights in units of the file; `facts` receives how they were read.

    `values` are the keys of [profile], `stated` the units that `source` (a line of a text file, or an instrument)
    states by axis: "" for an axis without one.  Without positions the samples are `spacing` apart.
    ScanFileError for a spacing and units that are missing, for unknown and for contradictory units.
    """
    mistakes = []
    if x is None and "spacing" not in values:
        problem = "is missing: the file has heights alone, without positions or lengths"
        mistakes = [Mistake("profile.spacing", problem, "spacing = the distance of two samples, in unit_x")]
    for axis in "xh":
        key, own = f"unit_{axis}", stated.get(axis, "")
        path, given = f"profile.{key}", values.get(key)
        if own and own not in METRES:
            allowed = f"one of {LENGTH_UNITS} there: spell the unit so, or convert the numbers"
            mistakes.append(Mistake(path, f"is {own!r} in {source}", allowed))
        elif own and given and own != given:
            problem = f'= "{given}" contradicts the file, which says "{own}" in {source}'
            mistakes.append(Mistake(path, problem, f'{key} = "{own}", or correct the file'))
        elif given or (own and all(stated.values())):
            facts |= {key: given or own, f"{key}_from": "scene" if given else "file"}
        else:
            reason = f"{source} states a unit for one column alone" if own else "the file does not state it"
            mistakes.append(Mistake(path, f"is missing: {reason}", f"one of {LENGTH_UNITS}"))
    if mistakes:
        raise ScanFileError(mistakes)
    facts |= {key: values[key] for key in (*TEXT_KEYS, "missing_value", "row", "spacing") if key in values}
    steps = (
        values["spacing"] * METRES[facts["unit_x"]] * np.arange(h.size) if x is None else x * METRES[facts["unit_x"]]
    )
    return MeasuredLine(steps, h * METRES[facts["unit_h"]], facts)
