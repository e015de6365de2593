"""The form of a hard case, and the profiles and scenes that the corpus is written with.  SI units.

The rough profile is that of Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65: period 0.01 m, H = 0.7,
rms height 50 um, E = 1 MPa, nu = 0.5, 0.03 J/m^2.
"""

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Samples:
    """A noisy scan: one rough profile at this many points plus uncorrelated noise, rms in m."""

    number: int
    noise: float
    seed: int = 0


@dataclass(frozen=True)
class Reached:
    """What the targets of a scene must include: without it the case is not the hard one it is meant to be."""

    least: float | None = None  # contact fraction that some target does not exceed
    largest: float | None = None  # and one that some target has at least
    gap: float | None = None  # width in periods that the narrowest gap of some target has, to a factor of two
    patch: float | None = None  # the same of the narrowest patch


@dataclass(frozen=True)
class HardCase:
    """One hard case."""

    id: str
    reason: str  # what is hard about it
    reduced: Table  # and `full`: scenes, SI
    full: Table
    targets: tuple[str, ...]  # expected status of each target state of the reduced scene
    checks: tuple[str, ...] = ("dense",)  # independent ones, by their names in hard_case_checks.py
    status: str = "converged"  # expected of the result
    events: tuple[str, ...] = ()  # kinds that must occur
    samples: Samples | None = None  # the scan to write as profile.file
    reached: Reached | None = None  # and `reached_in_full`: what the targets must include to be as hard as intended
    reached_in_full: Reached | None = None

    def expectation(self, full: bool) -> tuple[str, ...]:
        """Expected status of the result, then of each target: in the full scene the same, or all converged.

        The second where the full scene has another number of targets.
        """
        wanted, count = len(self.reduced["loading"]["targets"]), len(self.full["loading"]["targets"])
        targets = self.targets if not full or count == wanted else ("converged",) * count
        return (self.status, *targets)


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


def both(
    harmonics: int, control: str, targets: list[float], *others: Any, full: int = 1000, **changes: Any
) -> tuple[Table, Table]:
    """The reduced and the full scene on the rough profile, which differ in its harmonics alone.

    `changes` are of `scene`, or of `rough` (hurst, rms_height); control, targets and others as of `scene`.
    """
    shape = {name: changes.pop(name) for name in ("hurst", "rms_height") if name in changes}
    reduced, whole = (scene(rough(count, **shape), control, targets, *others, **changes) for count in (harmonics, full))
    return reduced, whole


def westergaard_pressure(fraction: float) -> float:
    """Mean pressure of the wave of order 1 without adhesion at a contact fraction."""
    return float(DRY.mean_pressure(np.pi * fraction / 2))


def johnson_penetration(fraction: float) -> float:
    """Penetration of the adhesive wave of order 1 at a contact fraction."""
    return float(ADHESIVE.penetration(np.pi * fraction / 2))
