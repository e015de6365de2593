"""The correction calibrated for roughness in one direction: coefficients, uncertainties, provenance from a data file.

`calibration.json` is written by `python -m validation study theory-correction` (calibration.json of its folder) and
copied here; it says which boundary-element ensembles it rests on, by commit, seeds and spectra, and how far it was off
on profiles that were held out.  Source: validation/studies/theory_correction/.  Limits: `range` in the file.
"""

from __future__ import annotations

import json
from functools import cache
from importlib import resources
from typing import Any

from persson.corrected_variance import Correction
from persson.spectrum import Spectrum

FILE = "calibration.json"
SCHEMA = "linecontact-theory-correction/1"


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


@cache
def calibration() -> dict[str, Any]:
    """The content of the data file: coefficients, standard errors, hold-out errors, provenance."""
    found: dict[str, Any] = json.loads(resources.files("persson").joinpath(FILE).read_text("utf-8"))
    return found


def outside(spectrum: Spectrum, load: float, contact_fraction: float, work_length: float = 0.0) -> tuple[str, ...]:
    """Where a case lies outside of what the calibration was made and judged for, in words; empty if nowhere.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    load : float
        sigma_0 / E*.
    contact_fraction : float
        A/A0 that was found.
    work_length : float
        gamma / E* in m; 0 without adhesion.

    Examples
    --------
    >>> from persson.spectrum import DiscreteSpectrum
    >>> lines = DiscreteSpectrum.self_affine(628.3, 0.7, 50e-6, 100)
    >>> outside(lines, 0.01, 0.1), len(outside(lines, 0.9, 1.0))
    ((), 2)
    """
    found = {
        "load_over_slope": load / spectrum.slope_rms,
        "bandwidth": float(spectrum.wavenumbers[-1] / spectrum.wavenumbers[0]),
        "theta": work_length / spectrum.full_contact_energy,
        "contact_fraction": contact_fraction,
    }
    limits = calibration()["limits"]
    return tuple(
        f"{name} {value:.3g} is outside {limits[name][0]:g} to {limits[name][1]:g}"
        for name, value in found.items()
        if not limits[name][0] <= value <= limits[name][1]
    )


def correction_of(content: dict[str, Any]) -> Correction:
    """The correction that a calibration describes.

    Parameters
    ----------
    content : dict
        `schema`, and `coefficients` with c_0, b_0, k, k_a and c.

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
        fringe=(value["k_a"], value["c"]),
        source="boundary-element ensembles, persson/calibration.json",
        range=content["range"],
    )
