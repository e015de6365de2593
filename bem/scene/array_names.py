"""Names, lengths and types of the arrays of a result."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Set
from typing import Any

import numpy as np
from numpy.typing import NDArray

ARRAYS_TOGETHER = (  # arrays stored together: name without the k of a state, what an array runs along, and its unit
    {
        **dict.fromkeys(("x", "displacement", "gap"), ("point_{k}", "m")),
        "pressure": ("point_{k}", "Pa"),
        "patch": ("point_{k}", "1"),
    },
    {"C_u": ("wavenumber", "m^3"), "C_sigma": ("wavenumber", "Pa^2 m")},
    {
        "sigma": ("level_{k}", "Pa"),
        "P": ("level_{k}", "1/Pa"),
        "sigma_bounds": ("bound_{k}", "Pa"),
        "outside_contact": ("", "1"),
        "tail_coefficient": ("", "Pa^2"),
    },
    {"q": ("wavenumber", "rad/m"), "C_h": ("wavenumber", "m^3")},
    {
        **dict.fromkeys(("scan_x", "scan_h"), ("scan_point", "m")),
        **dict.fromkeys(("profile_x", "profile_h"), ("profile_point", "m")),
        "scan_wavelength": ("scan_band", "m"),
        "scan_density": ("scan_band", "m^3"),
    },
    {
        "profile_q": ("profile_line", "rad/m"),
        "profile_amplitude": ("profile_line", "m"),
        "profile_phase": ("profile_line", "1"),
    },
)
OF_STATES = ARRAYS_TOGETHER[:3]  # named with "_k"
FIELDS = {stem: along for group in ARRAYS_TOGETHER for stem, along in group.items()}
WHOLE, WITH_NAN = ("patch",), ("pressure", "scan_h")  # outside contact; where a sample is missing


def array_mistakes(arrays: Mapping[str, NDArray[Any]], states: Set[str]) -> Iterator[tuple[str, Any, str]]:
    """Yield the name of each wrong array, what is wrong, and the allowed values.

    Parameters
    ----------
    arrays : mapping of arrays
    states : set of str
        Each k of `State.stored`.  A result without any array is one whose fields are not written yet.
    """
    sizes = dict[str, tuple[str, int]]()
    for name, values in arrays.items():
        stem, k = split(name)
        group: Mapping[str, Any] = next((names for names in ARRAYS_TOGETHER if stem in names), {})
        if not group or (k not in states if group in OF_STATES else k):
            yield name, "an unknown name", "arrays of the stored states of this result"
            continue
        dimension = FIELDS[stem][0].format(k=k)
        first, size = sizes.setdefault(dimension, (name, values.size))
        kind = np.int64 if stem in WHOLE else np.float64
        if values.dtype != kind:
            yield name, f"of type {values.dtype}", kind.__name__
        elif values.ndim != bool(dimension) or values.size == 0:
            yield name, f"of shape {values.shape}", "a row of numbers" if dimension else "a number"
        elif dimension and values.size != size:
            yield name, f"of {values.size} values", f"{size}, as {first} has"
        elif stem not in WITH_NAN and not np.all(np.isfinite(values)):
            yield name, "not finite", "finite numbers"
        for other in [f"{other}_{k}" if k else other for other in group] + ["q"] * (stem == "C_u"):
            if other not in arrays:
                yield other, "missing", f"an array beside {name}"
    for k in sorted(states - {split(name)[1] for name in arrays}) if arrays else ():
        yield f"x_{k}", "missing", f"x_{k}, C_u_{k} or sigma_{k}, as a state has stored = {k}"


def split(name: str) -> tuple[str, str]:
    """Return the stem of the name of an array, and the index of its state; no index without one.

    Examples
    --------
    >>> split("C_sigma_12"), split("C_h")
    (('C_sigma', '12'), ('C_h', ''))
    """
    match = re.fullmatch(r"(.+)_([0-9]+)", name)
    return (match[1], match[2]) if match else (name, "")
