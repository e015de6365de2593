"""The correction calibrated for roughness in one direction: coefficients, uncertainties, provenance from a data file.

`calibration.json` is written by `python -m validation study theory-correction` (calibration.json of its folder) and
copied here; it says which boundary-element ensembles it rests on, by commit, seeds and spectra, and how far it was off
on profiles that were held out.  Source: validation/studies/theory_correction/.  Limits: `domain` in the file
(domain.py).
"""

from __future__ import annotations

from typing import Any

from persson.corrected_variance import Correction
from persson.domain import data_file, in_words

FILE = "calibration.json"
SCHEMA = "linecontact-theory-correction/3"


class CalibrationError(ValueError):
    """A data file that is not a calibration."""


def calibrated() -> Correction:
    """The correction of the data file that comes with the package.

    Examples
    --------
    >>> calibrated().form
    'slower'
    """
    return correction_of(calibration())


def calibration() -> dict[str, Any]:
    """The content of the data file: coefficients, standard errors, hold-out errors, provenance."""
    return data_file(FILE)


def correction_of(content: dict[str, Any]) -> Correction:
    """The correction that a calibration describes.

    Parameters
    ----------
    content : dict
        `schema`, and `coefficients` with c_0, b_0 and k.

    Raises
    ------
    CalibrationError
        Of another schema.
    """
    if content.get("schema") != SCHEMA:
        raise CalibrationError(f"{FILE}: schema {content.get('schema')!r} is not {SCHEMA!r}")
    value = content["coefficients"]
    return Correction(
        "calibrated",
        "slower",
        (value["c_0"], 0.0, 1 - value["c_0"]),
        breadth=value["b_0"],
        window=value["k"],
        edges=True,
        source="boundary-element ensembles, persson/calibration.json",
        range=in_words(content["domain"]),
    )
