"""Where what was fitted may be used: one table for each law, read by the guard here and by the page of its study.

A case is described by numbers without units (`groups_of`), weighted by the roughness that they stand for, so that a
line without power changes nothing:

    rms_slope         h'_rms: linear elasticity, small slopes
    load_over_slope   p / (E* h'_rms)
    bandwidth         exp(<ln q>_slope - <ln q>_height), means over the slope and over the height variance; 1 for a line
    lines             1 / sum (dS_m / S)^2, how many lines carry the slope; thousands for a continuous spectrum
    theta             work of adhesion over the elastic energy of full contact
    contact_fraction  A/A0 that was found

The tables (`domain` of the data files of the package: `data_file`) have the interval of each, and boxes inside that
are forbidden, with the reason. Source: validation/studies/theory_correction/, contact_slope.py, adhesive_edges.py.
Limits: what a spectrum does not show, a layer, roughness in two directions, unloading, is not seen here.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from persson.spectrum import Spectrum, slope_shares

REPRESENTED = (1e-60, 1e60)  # cubes and squares of these are floating-point numbers
SAME = 1e-9  # relative: a case on the bound of an interval lies inside
WORDS = {
    "rms_slope": "rms slope",
    "load_over_slope": "p/(E* h'_rms)",
    "bandwidth": "bandwidth exp(<ln q>_slope - <ln q>_height)",
    "lines": "number of lines that carry the slope, 1/sum (dS_m/S)^2",
    "theta": "theta",
    "contact_fraction": "contact fraction",
}


@cache
def data_file(name: str) -> dict[str, Any]:
    """A data file of the package: coefficients, domain, and what they were fitted to and judged on."""
    found: dict[str, Any] = json.loads(resources.files("persson").joinpath(name).read_text("utf-8"))
    return found


def groups_of(spectrum: Spectrum, load: float, contact_fraction: float, work_length: float = 0.0) -> dict[str, float]:
    """The numbers of a case, by the names above.

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
    >>> two = groups_of(DiscreteSpectrum([1.0, 4.0], [0.4, 0.1]), 0.01, 0.1)
    >>> round(two["lines"], 12), round(two["bandwidth"], 3)
    (2.0, 1.843)
    """
    wavenumbers, slope = slope_shares(spectrum)
    height = slope / wavenumbers**2
    logarithm = np.log(wavenumbers)
    centre = logarithm @ slope - (logarithm @ height) / height.sum()
    return {
        "rms_slope": spectrum.slope_rms,
        "load_over_slope": load / spectrum.slope_rms,
        "bandwidth": float(np.exp(centre)),
        "lines": float(1 / (slope @ slope)),
        "theta": work_length / spectrum.full_contact_energy,
        "contact_fraction": contact_fraction,
    }


def refuse_extremes(spectrum: Spectrum, load: float, work_length: float | None = None) -> None:
    """ValueError, with name and value, for what no floating-point answer is true of.

    Examples
    --------
    >>> from persson.spectrum import DiscreteSpectrum
    >>> refuse_extremes(DiscreteSpectrum([1.0], [1e-80]), 0.01)
    Traceback (most recent call last):
    ...
    ValueError: rms slope of the spectrum: 7.07107e-81 must lie in 1e-60 to 1e+60
    """
    lowest, highest = REPRESENTED
    asked = {"rms slope of the spectrum": spectrum.slope_rms, "rms height of the spectrum (m)": spectrum.h_rms}
    asked["mean_pressure: sigma_0 / E*"] = load
    asked["mean_pressure: sigma_0 / (E* h'_rms)"] = load / max(spectrum.slope_rms, lowest)
    if work_length is not None:
        asked["work_of_adhesion: gamma / E* (m)"] = work_length
        asked["work_of_adhesion: gamma / energy of full contact"] = work_length / max(
            spectrum.full_contact_energy, lowest
        )
    for name, value in asked.items():
        if not lowest <= value <= highest:
            raise ValueError(f"{name}: {value:g} must lie in {lowest:g} to {highest:g}")


def outside(table: Mapping[str, Any], found: Mapping[str, float]) -> tuple[str, ...]:
    """Where a case lies outside of a domain, in words, one for each interval and each forbidden box; empty if nowhere.

    Parameters
    ----------
    table : mapping
        `between`: [lowest, highest] by name; `forbidden`: list of boxes, [lowest, highest] by name and `why`; null for
        no bound.
    found : mapping
        As of `groups_of`.

    Examples
    --------
    >>> box = {"theta": [0.05, None], "why": "not tried"}
    >>> outside({"between": {"theta": [0.0, 0.1]}, "forbidden": [box]}, {"theta": 0.06})
    ('theta 0.06: not tried',)
    """
    said = [
        f"{name} {found[name]:.3g} is outside {interval(bounds)}"
        for name, bounds in table["between"].items()
        if not _within(found[name], bounds)
    ]
    for box in table["forbidden"]:
        sides = {name: bounds for name, bounds in box.items() if name != "why"}
        if all(_within(found[name], bounds) for name, bounds in sides.items()):
            said.append(", ".join(f"{name} {found[name]:.3g}" for name in sides) + f": {box['why']}")
    return tuple(said)


def in_words(table: Mapping[str, Any]) -> str:
    """The domain as a sentence for a reader."""
    inside = "; ".join(f"{WORDS[name]} {interval(bounds)}" for name, bounds in table["between"].items())
    boxes = [
        " and ".join(f"{WORDS[name]} {interval(bounds)}" for name, bounds in box.items() if name != "why")
        + f" ({box['why']})"
        for box in table["forbidden"]
    ]
    return f"Use it only for {inside}" + "".join(f"; not for {box}" for box in boxes) + "."


def interval(bounds: tuple[float | None, float | None]) -> str:
    """An interval in words.

    Examples
    --------
    >>> interval((0.05, None)), interval((None, 0.3)), interval((1.0, 2.0))
    ('at least 0.05', 'at most 0.3', '1 to 2')
    """
    low, high = bounds
    if high is None:
        return f"at least {low:g}"
    return f"at most {high:g}" if low is None else f"{low:g} to {high:g}"


def _within(value: float, bounds: tuple[float | None, float | None]) -> bool:
    low, high = bounds
    return (low is None or value >= low * (1 - SAME)) and (high is None or value <= high * (1 + SAME))
