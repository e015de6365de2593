"""The profiles and scenes that the corpus is written with, and what is derived of their tables.  SI units.

The rough profile is that of Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65: period 0.01 m, H = 0.7,
rms height 50 um, E = 1 MPa, nu = 0.5, 0.03 J/m^2.
"""

from typing import Any

import numpy as np

from bem.geometry.profile import Profile
from validation.references import paper_problem
from validation.references.closed_forms import Sinusoid
from validation.references.paper_problem import PERIOD, RMS_HEIGHT, Table

MODULUS, WORK = paper_problem.YOUNGS_MODULUS, paper_problem.WORK_OF_ADHESION
WAVE = 50e-6  # amplitude of single harmonics
JOHNSON = 0.3  # alpha of the adhesive waves
DRY, ADHESIVE = (Sinusoid(WAVE, PERIOD, MODULUS, 0.5, alpha) for alpha in (0.0, JOHNSON))  # waves of order 1
WAVE_WORK = ADHESIVE.work_of_adhesion  # J/m^2


def rough(harmonics: int, hurst: float = 0.7, rms_height: float = RMS_HEIGHT, seed: int = 0) -> Table:
    """[profile] of a self-affine profile."""
    return paper_problem.self_affine(seed, harmonics, hurst, rms_height)


def waves(orders: list[int], amplitudes: list[float]) -> Table:
    """[profile] of cosines."""
    return waves_of(Profile.from_harmonics(PERIOD, orders, amplitudes))


def waves_of(surface: Profile) -> Table:
    """[profile] of the harmonics of a surface."""
    lists: Table = {name: getattr(surface, name).tolist() for name in ("orders", "amplitudes", "phases")}
    return {"kind": "harmonics", "period": surface.period} | lists


def mean_compliance(tables: Table) -> float:
    """c(0) = d (1 - 2 nu)(1 + nu) / (E (1 - nu)) of a layer, m/Pa; 0 of a half-space, which has none."""
    if tables.get("layer") is None:
        return 0.0
    nu, modulus = tables["solid"]["poisson_ratio"], tables["solid"]["youngs_modulus"]
    return float(tables["layer"]["thickness"] * (1 - 2 * nu) * (1 + nu) / (modulus * (1 - nu)))


def in_units(tables: Table, length: float, modulus: float) -> Table:
    """A scene with lengths and moduli so many times larger, and all that follows from them."""
    target = modulus if tables["loading"]["control"] == "mean_pressure" else length
    factors = {
        "solid": {"youngs_modulus": modulus},
        "profile": {"period": length, "rms_height": length, "amplitudes": length},
        "layer": {"thickness": length},
        "adhesion": {"work_of_adhesion": length * modulus},
        "loading": {"targets": target, "flaw": length, "stop_at_mean_pressure": modulus, "at_mean_pressures": modulus},
    }

    def times(value: Any, factor: float | None) -> Any:
        if factor is None:
            return value
        return [one * factor for one in value] if isinstance(value, list) else value * factor

    return {name: {key: times(value, factors.get(name, {}).get(key)) for key, value in table.items()}
            for name, table in tables.items()}  # fmt: skip


def scene(
    profile: Table,
    control: str,
    targets: list[float],
    work: float | None = None,
    slope_term: bool = False,
    thickness: float | None = None,
    poisson_ratio: float = 0.5,
    max_increment: float | None = None,
    **loading: Any,
) -> Table:
    """A scene."""
    tables: Table = {
        "solid": {"youngs_modulus": MODULUS, "poisson_ratio": poisson_ratio},
        "profile": profile,
        "loading": {"control": control, "targets": targets, **loading},
    }
    if work is not None:
        tables["adhesion"] = {"work_of_adhesion": work, "slope_term": slope_term}
    if thickness is not None:
        tables["layer"] = {"thickness": thickness}
    if max_increment is not None:
        tables["accuracy"] = {"max_increment": max_increment}
    return tables


def westergaard_pressure(fraction: float) -> float:
    """Mean pressure of the wave of order 1 without adhesion at a contact fraction."""
    return float(DRY.mean_pressure(np.pi * fraction / 2))


def johnson_penetration(fraction: float) -> float:
    """Penetration of the adhesive wave of order 1 at a contact fraction."""
    return float(ADHESIVE.penetration(np.pi * fraction / 2))
