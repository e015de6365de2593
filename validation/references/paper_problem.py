"""Scenes like the paper's: its solid, its profile or other lines of its period, and loads met from first touch on.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  SI units.
"""

from collections.abc import Iterable
from typing import Any

Table = dict[str, Any]

PERIOD, HURST, RMS_HEIGHT, RMS_SLOPE = 0.01, 0.7, 50e-6, 0.272
YOUNGS_MODULUS, POISSON_RATIO, WORK_OF_ADHESION = 1e6, 0.5, 0.03
MODULUS = YOUNGS_MODULUS / (1 - POISSON_RATIO**2)


def self_affine(seed: int, harmonics: int, hurst: float = HURST, rms_height: float = RMS_HEIGHT) -> Table:
    """Return the table [profile] of a self-affine profile."""
    kind = {"kind": "self_affine", "period": PERIOD, "hurst": hurst}
    return kind | {"rms_height": rms_height, "harmonics": harmonics, "seed": seed}


def lines(orders: Iterable[Any], amplitudes: Iterable[Any], phases: Iterable[Any]) -> Table:
    """Return the table [profile] of harmonics, amplitudes in m."""
    numbers = {"amplitudes": list(map(float, amplitudes)), "phases": list(map(float, phases))}
    return {"kind": "harmonics", "period": PERIOD, "orders": list(map(int, orders))} | numbers


def up_to(pressures: Iterable[float], deepest: float) -> Table:
    """Return the table [loading] from first touch to the last of the mean pressures in Pa, or to a separation in m.

    States are kept at all mean pressures.
    """
    *others, last = pressures
    way = {"control": "separation", "targets": [deepest], "stop_at_mean_pressure": last}
    return way | ({"at_mean_pressures": others} if others else {})


def scene(title: str, profile: Table, loading: Table, work: float | None = None, **tables: Table) -> Table:
    """Return the content of a scene file; with adhesion if `work` in J/m^2 is given, without slope term."""
    solid = {"youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO}
    adhesion = {} if work is None else {"adhesion": {"work_of_adhesion": work}}
    return {"title": title, "solid": solid, "profile": profile, "loading": loading} | adhesion | tables
