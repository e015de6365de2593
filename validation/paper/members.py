"""Scenes of the replication, in groups.

loading    the paper's profile (H = 0.7, h_rms = 50 um, period 0.01 m, E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2) with
           1000 harmonics, seeds 0 to 10, from first touch to 0.025 E*; spectra and distributions at all of `LOADS`
shapes     one of these profiles whose highest crest lies above 90 um, through s = 86, 48, 38 and 9.6 um
high load  one profile with fewer harmonics, pressed until contact is all but complete
hurst H    H = 0.8 and H = 0.3 with fewer harmonics, each to the same load over its rms slope
faint W    profiles with 100 harmonics and work of adhesion W: zero, nearly zero, and the paper's

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  The quick form solves
these scenes with fewer realisations and harmonics: it shows that everything runs, and replicates nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bem.geometry.profile import Profile
from validation.references.paper_problem import (
    HURST,
    MODULUS,
    PERIOD,
    RMS_HEIGHT,
    WORK_OF_ADHESION,
    Table,
    scene,
    self_affine,
    up_to,
)

LOADS = (0.001, 0.0025, 0.005, 0.0075, 0.01, 0.0125, 0.015, 0.0175, 0.02, 0.0225, 0.025)  # of E*
SPECTRA_AT = (0.005, 0.02)  # of E*
SHAPES_AT = (86e-6, 48e-6, 38e-6, 9.6e-6)  # separations, m: the caption says 48 um where the text says 38 um
HIGHEST_CREST = 90e-6  # m, exceeded by the profile whose shapes are drawn
NEARLY_FLAT = (1e-6, 0.2e-6, 0.04e-6, 8e-9, 2e-9)  # separations, m
HURSTS = (0.3, 0.8)  # the rougher takes longer
HURST_LOAD = 0.08  # of E* times the rms slope
FAINT_WORKS = (0.0, 1e-6, WORK_OF_ADHESION)  # J/m^2
FAINT_HARMONICS = 100
FAINT_AT = (0.005, 0.01, 0.015, 0.02)  # of E*
DEEPEST = 1e-6  # m, separation that no loaded profile reaches


@dataclass(frozen=True)
class Member:
    """Solution of the ensemble, by name and scene."""

    name: str  # of its folder
    scene: Mapping[str, Any]  # content of a scene file, SI units


@dataclass(frozen=True)
class Size:
    """Numbers of realisations and of harmonics to compute."""

    seeds: int  # realisations 0, 1, .. of the loading ensemble
    harmonics: int  # of the loading ensemble and of the shapes
    fewer_harmonics: int  # at high load, and of the profiles of other Hurst exponents
    hurst_seeds: int  # realisations of each of these, and with faint adhesion


PAPER = Size(seeds=11, harmonics=1000, fewer_harmonics=250, hurst_seeds=6)
QUICK = Size(seeds=2, harmonics=64, fewer_harmonics=32, hurst_seeds=2)


def members_of(size: Size) -> dict[str, list[Member]]:
    """Return the members of every group, long runs first."""
    return {
        "loading": [_loading(size, seed) for seed in range(size.seeds)],
        "shapes": [_shapes(size)],
        "high load": [
            _member("high-load-02", 2, HURST, size.fewer_harmonics, _separations(NEARLY_FLAT), {"spectra": True})
        ],
        **{f"hurst {hurst:g}": [_hurst(size, hurst, seed) for seed in range(size.hurst_seeds)] for hurst in HURSTS},
        **{f"faint {work:g}": [_faint(size, work, seed) for seed in range(size.hurst_seeds)] for work in FAINT_WORKS},
    }


def _loading(size: Size, seed: int) -> Member:
    loading = up_to([load * MODULUS for load in LOADS], DEEPEST)
    output = {"spectra": True, "pressure_distribution": True}
    return _member(f"loading-{seed:02d}", seed, HURST, size.harmonics, loading, output)


def _shapes(size: Size) -> Member:
    profiles = (Profile.self_affine(PERIOD, HURST, RMS_HEIGHT, size.harmonics, seed) for seed in range(1000))
    seed = next(seed for seed, profile in enumerate(profiles) if profile.max_height > HIGHEST_CREST)
    output = {"shapes": list(SHAPES_AT), "spectra": True}
    return _member(f"shapes-{seed:02d}", seed, HURST, size.harmonics, _separations(SHAPES_AT), output)


def _hurst(size: Size, hurst: float, seed: int) -> Member:
    slope = Profile.self_affine(PERIOD, hurst, RMS_HEIGHT, size.fewer_harmonics, 0).rms_slope
    loading = up_to([HURST_LOAD * MODULUS * slope], DEEPEST)
    return _member(f"hurst-{hurst:g}-{seed:02d}", seed, hurst, size.fewer_harmonics, loading, {"spectra": True})


def _faint(size: Size, work: float, seed: int) -> Member:
    harmonics = min(FAINT_HARMONICS, size.fewer_harmonics)
    loading = up_to([load * MODULUS for load in FAINT_AT], DEEPEST)
    return _member(f"faint-{work:g}-{seed:02d}", seed, HURST, harmonics, loading, {}, work)


def _separations(targets: tuple[float, ...]) -> Table:
    return {"control": "separation", "targets": list(targets)}


def _member(
    name: str, seed: int, hurst: float, harmonics: int, loading: Table, output: Table, work: float = WORK_OF_ADHESION
) -> Member:
    tables: dict[str, Table] = {"adhesion": {"work_of_adhesion": work, "slope_term": True}} if work else {}
    tables |= {"output": output} if output else {}
    title = f"self-affine profile, H = {hurst:g}, seed {seed}"
    return Member(name, scene(title, self_affine(seed, harmonics, hurst), loading, None, **tables))
