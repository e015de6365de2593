"""Hard cases as data: what a scene asks for, what must come out, and why it is hard.

The expectation stands here before anything runs.  Every case has a reduced scene (at most 125 harmonics, 10 s) and
its full form; `hard_case_run.run_case` solves one and counts two things apart: converged (the solver's word, and
the statuses expected at the targets) and correct (the certificate of every target, and the independent checks named
here, which live in hard_case_checks.py).  SI units.

The rough profile is that of Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65: period 0.01 m, H = 0.7,
rms height 50 um, E = 1 MPa, nu = 0.5, 0.03 J/m^2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Table = dict[str, Any]

PERIOD, RMS_HEIGHT, MODULUS, WORK = 0.01, 50e-6, 1e6, 0.03
WAVE = 50e-6  # amplitude of single harmonics
PEAK_PRESSURE = np.pi * MODULUS / 0.75 * WAVE / PERIOD  # p* of the wave of order 1
JOHNSON = 0.3  # alpha of the adhesive waves
WAVE_WORK = (JOHNSON * PEAK_PRESSURE) ** 2 * PERIOD * 0.75 / (2 * MODULUS)  # J/m^2, of the wave of order 1


@dataclass(frozen=True)
class Samples:
    """A noisy scan: one rough profile at this many points plus uncorrelated noise, rms in m."""

    number: int
    noise: float
    seed: int = 0


@dataclass(frozen=True)
class HardCase:
    """One hard case.

    Parameters
    ----------
    id : str
    reason : str
        What is hard about it.
    reduced, full : dict
        Scenes, SI.
    targets : tuple of str
        Expected status of each target state of the reduced scene.
    checks : tuple of str
        Independent checks, by their names in hard_case_checks.py.
    status : str
        Expected status of the result.
    events : tuple of str
        Kinds of events that must occur.
    samples : Samples, optional
        The scan to write as profile.file.
    """

    id: str
    reason: str
    reduced: Table
    full: Table
    targets: tuple[str, ...]
    checks: tuple[str, ...] = ("dense",)
    status: str = "converged"
    events: tuple[str, ...] = ()
    samples: Samples | None = None

    @property
    def targets_of_full(self) -> tuple[str, ...]:
        """Expected status of each target state of the full scene: the same, or all converged where it has others."""
        count = len(self.full["loading"]["targets"])
        return self.targets if count == len(self.targets) else ("converged",) * count


def rough(harmonics: int, hurst: float = 0.7, rms_height: float = RMS_HEIGHT, seed: int = 0) -> Table:
    """[profile] of a self-affine profile."""
    kind = {"kind": "self_affine", "period": PERIOD, "hurst": hurst}
    return kind | {"rms_height": rms_height, "harmonics": harmonics, "seed": seed}


def waves(orders: list[int], amplitudes: list[float]) -> Table:
    """[profile] of cosines."""
    return {
        "kind": "harmonics",
        "period": PERIOD,
        "orders": orders,
        "amplitudes": amplitudes,
        "phases": [0.0] * len(orders),
    }


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
    return float(PEAK_PRESSURE * np.sin(np.pi * fraction / 2) ** 2)


def johnson_penetration(fraction: float) -> float:
    """Penetration of the adhesive wave of order 1 at a contact fraction."""
    psi = np.pi * fraction / 2
    share = np.sin(psi) ** 2
    bulk = WAVE * share * (1 - np.log(share))
    return float(bulk + JOHNSON * WAVE * np.sqrt(np.tan(psi)) * np.log(share))


def _hard_cases() -> list[HardCase]:
    same, low = ("converged",), [60e-6, 30e-6]
    down_up = [60e-6, 30e-6, 60e-6]
    cases = [
        HardCase(
            "twin_crests",
            "two crests of equal height touch at the same instant and must stay equal",
            scene(waves([2, 4], [50e-6, 10e-6]), "penetration", [1e-5, 3e-5, 0.0], 0.05),
            scene(waves([2, 4, 200], [50e-6, 10e-6, 0.1e-6]), "penetration", [1e-5, 3e-5, 0.0], 0.05),
            same * 3,
            ("dense", "mirror", "equal_patches"),
            events=("first_touch",),
        ),
        HardCase(
            "vanishing_patch",
            "on unloading the patches of lower crests shrink and vanish one after the other",
            scene(rough(20), "separation", [30e-6, 75e-6], WORK, True),
            scene(rough(1000), "separation", [30e-6, 75e-6], WORK, True),
            same * 2,
            events=("detachment",),
        ),
        HardCase(
            "merging_patches",
            "two patches merge on loading: with adhesion by a jump from a finite gap",
            scene(rough(20), "separation", [40e-6, 20e-6], 0.01),
            scene(rough(1000), "separation", [40e-6, 20e-6], WORK, True),
            same * 2,
            events=("coalescence",),
        ),
        HardCase(
            "merging_patches_without_adhesion",
            "the gap between two patches closes continuously",
            scene(waves([1, 4], [50e-6, 6e-6]), "mean_pressure", [3e3, 2e4, 2.4e4]),
            scene(rough(1000), "separation", [40e-6, 20e-6]),
            same * 3,
            ("dense", "target_alone"),
        ),
        HardCase(
            "gap_1e-4",
            "a gap of 1e-4 wavelength: coupling modes by the hundred, K to rounding",
            scene(waves([1], [WAVE]), "mean_pressure", [westergaard_pressure(0.9999)]),
            scene(waves([1], [WAVE]), "mean_pressure", [westergaard_pressure(f) for f in (0.999, 0.9995, 0.9999)]),
            same,
            ("westergaard",),
        ),
        HardCase(
            "contact_fraction_1e-5",
            "heights cancel to ten digits on the smallest contact",
            scene(waves([1], [WAVE]), "mean_pressure", [westergaard_pressure(f) for f in (1e-5, 1e-3)]),
            scene(waves([1], [WAVE]), "mean_pressure", [westergaard_pressure(f) for f in (1e-5, 1e-4, 1e-3, 0.01)]),
            same * 2,
            ("westergaard",),
        ),
        HardCase(
            "contact_fraction_to_0.9999",
            "at given separation the load ends in ever larger tension as the last gap closes",
            scene(
                waves([1], [WAVE]),
                "penetration",
                [johnson_penetration(f) for f in (0.3, 0.9, 0.999, 0.9999)],
                WAVE_WORK,
            ),
            scene(
                waves([1], [WAVE]),
                "penetration",
                [johnson_penetration(f) for f in (0.3, 0.6, 0.9, 0.99, 0.999, 0.9999, 0.5, 0.1)],
                WAVE_WORK,
            ),
            same * 4,
            ("johnson",),
        ),
        HardCase(
            "complete_contact_and_back_by_separation",
            "separation zero admits complete contact only; the way back opens a gap",
            scene(waves([1], [WAVE]), "separation", [3e-5, 0.0, 3e-5], WAVE_WORK),
            scene(waves([1], [WAVE]), "separation", [3e-5, 0.0, 3e-5], WAVE_WORK, max_increment=0.005),
            ("converged", "complete_contact", "converged"),
            ("johnson",),
            events=("first_touch", "complete_contact", "opening"),
        ),
        HardCase(
            "rough_complete_contact_and_back_by_separation",
            "the last gaps of a rough profile close one by one as the separation vanishes",
            scene(rough(40), "separation", [3e-5, 0.0, 3e-5], WORK, True),
            scene(rough(1000), "separation", [3e-5, 0.0, 3e-5], WORK, True),
            ("converged", "complete_contact", "converged"),
            events=("first_touch", "complete_contact", "opening"),
        ),
        HardCase(
            "complete_contact_and_back_by_load",
            "under load a jump into complete contact; a flaw opens on the way back",
            scene(rough(20), "mean_pressure", [1e3, 3e5, 0.0], WORK, True, max_increment=4.0, flaw=1e-4),
            scene(rough(1000), "mean_pressure", [1e3, 1e6, 0.0], WORK, True, max_increment=2.0, flaw=1e-5),
            ("converged", "complete_contact", "converged"),
            events=("first_touch", "complete_contact", "opening"),
        ),
        HardCase(
            "complete_contact_and_back_without_adhesion",
            "complete contact and back without adhesion needs no flaw and no history",
            scene(rough(40), "mean_pressure", [2e4, 1e6, 2e4]),
            scene(rough(1000), "mean_pressure", [2e4, 2e6, 2e4]),
            ("converged", "complete_contact", "converged"),
            ("dense", "target_alone"),
        ),
        HardCase(
            "tension_no_branch_carries",
            "a tension beyond pull-off: unreachable, the states before it kept",
            scene(rough(20), "mean_pressure", [1e3, -1e5], WORK, True, max_increment=2.0),
            scene(rough(1000), "mean_pressure", [1e3, -1e5], WORK, True, max_increment=2.0),
            ("converged", "unreachable"),
            status="unreachable",
            events=("pull_off",),
        ),
        HardCase(
            "order_7",
            "seven equal contacts lose their symmetry where the smallest eigenvalue passes zero",
            scene(waves([7], [WAVE]), "penetration", [2e-5, 4e-5, 4.9e-5], 7 * WAVE_WORK),
            scene(waves([7], [WAVE]), "penetration", [2e-5, 4e-5, 4.9e-5, 1e-5, -1e-5], 7 * WAVE_WORK),
            same * 3,
            ("dense", "equal_until_bifurcation"),
            events=("first_touch", "bifurcation"),
        ),
        HardCase(
            "order_7_without_adhesion",
            "seven equal contacts stay equal",
            scene(waves([7], [WAVE]), "mean_pressure", [1e3, 5e4, 1e5]),
            scene(waves([7], [WAVE]), "mean_pressure", [1e2, 1e3, 1e4, 5e4, 1e5, 1.4e5]),
            same * 3,
            ("dense", "equal_patches"),
        ),
        HardCase(
            "samples_50000",
            "50,000 noisy samples, cut at some harmonics",
            scene({"kind": "samples", "file": "scan.csv", "harmonics": 100}, "separation", low, WORK, True),
            scene({"kind": "samples", "file": "scan.csv", "harmonics": 1000}, "separation", low, WORK, True),
            same * 2,
            samples=Samples(50_000, 1e-7),
        ),
        HardCase(
            "shift_and_mirror",
            "a shifted and a mirrored profile have the same states",
            scene(rough(30), "separation", low, WORK, True),
            scene(rough(1000), "separation", low, WORK, True),
            same * 2,
            ("dense", "shift", "mirror"),
        ),
        HardCase(
            "thousandfold_units",
            "lengths and stresses scaled by 1e6 either way",
            scene(rough(30), "separation", down_up, WORK, True),
            scene(rough(1000), "separation", down_up, WORK, True),
            same * 3,
            ("units_up", "units_down"),
        ),
        HardCase(
            "increments_ten_times_too_large",
            "increments ten times too large are refined, not failed",
            scene(rough(30), "separation", low, WORK, True, max_increment=0.5),
            scene(rough(1000), "separation", low, WORK, True, max_increment=0.5),
            same * 2,
            ("dense", "smaller_increments"),
        ),
        HardCase(
            "restart",
            "a path restarted from a stored state ends in the same state",
            scene(rough(30), "separation", [60e-6, 45e-6, 30e-6], WORK, True),
            scene(rough(1000), "separation", [60e-6, 45e-6, 30e-6], WORK, True),
            same * 3,
            ("restart",),
        ),
        HardCase(
            "thin_incompressible_layer",
            "a layer of thickness 0.02 wavelengths with nu = 0.5 is stiff by its third power",
            scene(rough(30), "separation", [70e-6, 60e-6], WORK, True, 0.02 * PERIOD),
            scene(rough(1000), "separation", [70e-6, 60e-6], WORK, True, 0.02 * PERIOD),
            same * 2,
            ("doubled",),
        ),
        HardCase(
            "thin_layer_without_adhesion",
            "the same without adhesion",
            scene(rough(30), "separation", [70e-6, 60e-6], thickness=0.02 * PERIOD),
            scene(rough(1000), "separation", [70e-6, 60e-6], thickness=0.02 * PERIOD),
            same * 2,
            ("doubled", "target_alone"),
        ),
    ]
    for kind, work in (("", WORK), ("_without_adhesion", None)):
        flat = waves([1], [0.0])
        flat_scene = scene(flat, "mean_pressure", [1e3], work)
        cases.append(
            HardCase(
                f"flat{kind}", "nothing to solve", flat_scene, flat_scene, ("complete_contact",), ("uniform_load",)
            )
        )
    return cases + _swept()


def _swept() -> list[HardCase]:
    """Cases along one parameter."""
    same, cases = ("converged",), []
    for work in (1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2):
        cases.append(
            HardCase(
                f"work_{work:g}",
                "from hardly any adhesion to surfaces that jump together",
                scene(rough(40), "separation", [60e-6, 30e-6], work, True),
                scene(rough(1000), "separation", [60e-6, 30e-6], work, True),
                same * 2,
            )
        )
    for height in (1e-9, 1e-7, 1e-5, 1e-3):
        targets = [1.2 * height, 0.6 * height]
        cases.append(
            HardCase(
                f"rms_height_{height:g}",
                "nanometres to millimetres: adhesion from dominant to negligible",
                scene(rough(40, rms_height=height), "separation", targets, WORK, True),
                scene(rough(1000, rms_height=height), "separation", targets, WORK, True),
                same * 2,
            )
        )
    for hurst in (0.01, 0.99):
        for kind, adhesion in (("", WORK), ("_without_adhesion", None)):
            cases.append(
                HardCase(
                    f"hurst_{hurst:g}{kind}",
                    "roughness at the shortest wavelengths only, or hardly any",
                    scene(rough(60, hurst=hurst), "separation", [50e-6, 30e-6], adhesion),
                    scene(rough(1000, hurst=hurst), "separation", [50e-6, 30e-6], adhesion),
                    same * 2,
                )
            )
    for harmonics, full in ((1, 1), (10, 10), (125, 1000), (125, 4000)):
        targets = [60e-6, 40e-6] if full < 4000 else [60e-6]
        cases.append(
            HardCase(
                f"harmonics_{full}",
                "from one contact to hundreds",
                scene(rough(harmonics), "separation", targets, WORK, True),
                scene(rough(full), "separation", targets, WORK, True),
                same * len(targets),
            )
        )
        if full < 4000:
            cases.append(
                HardCase(
                    f"harmonics_{full}_without_adhesion",
                    "from one contact to hundreds of tiny ones",
                    scene(rough(harmonics), "separation", targets),
                    scene(rough(full), "separation", targets),
                    same * len(targets),
                    ("dense", "target_alone"),
                )
            )
    for ratio in (-0.9, 0.0, 0.499999, 0.5):
        cases.append(
            HardCase(
                f"poisson_ratio_{ratio:g}",
                "a half-space knows E/(1 - nu^2) only",
                scene(rough(20), "separation", [60e-6, 40e-6], WORK, poisson_ratio=ratio),
                scene(rough(1000), "separation", [60e-6, 40e-6], WORK, poisson_ratio=ratio),
                same * 2,
                ("dense", "plane_strain_only"),
            )
        )
        cases.append(
            HardCase(
                f"poisson_ratio_{ratio:g}_layer",
                "a layer near incompressibility and beyond",
                scene(rough(20), "separation", [60e-6, 40e-6], WORK, thickness=5e-4, poisson_ratio=ratio),
                scene(rough(1000), "separation", [60e-6, 40e-6], WORK, thickness=5e-4, poisson_ratio=ratio),
                same * 2,
                ("doubled",),
            )
        )
    return cases


HARD_CASES: tuple[HardCase, ...] = tuple(_hard_cases())
