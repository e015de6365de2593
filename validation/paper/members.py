"""The realisations of the replication, as scenes.

loading    the paper's profile (H = 0.7, h_rms = 50 um, period 0.01 m, E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2) with
           1000 harmonics, seeds 0 to 10, from first touch to 0.025 E*; spectra and distributions at all of `LOADS`
shapes     one of them whose highest crest lies above 90 um, through s = 86, 48, 38 and 9.6 um
high load  one profile with fewer harmonics, pressed until contact is all but complete
Hurst      H = 0.8 and H = 0.3 with fewer harmonics, each to the same load over its rms slope
faint      profiles with 100 harmonics and a work of adhesion that vanishes, beside the same without adhesion
sketch     a layer on a profile of few waves, by which the problem is drawn

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  The quick form has the same
scenes with fewer realisations and harmonics: it shows that everything runs, and replicates nothing.
"""

from dataclasses import dataclass

from bem.geometry.profile import Profile
from validation.paper.ensemble import Member
from validation.paper.paper_sketch import sketch_scene
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
HIGHEST_CREST = 90e-6  # m, exceeded by the profile whose shapes are shown
NEARLY_FLAT = (1e-6, 0.2e-6, 0.04e-6, 8e-9, 2e-9)  # separations, m
HURSTS = (0.8, 0.3)
HURST_LOAD = 0.08  # of E* times the rms slope

FAINT_WORKS = (0.0, 1e-7, 1e-6, 1e-5, 1e-4, WORK_OF_ADHESION)  # J/m^2; 0: without adhesion
FAINT_HARMONICS = 100
FAINT_AT = (0.005, 0.01, 0.015, 0.02)  # of E*


@dataclass(frozen=True)
class Size:
    """Numbers of realisations and of harmonics to compute."""

    seeds: int  # realisations 0, 1, .. of the loading ensemble
    harmonics: int  # of the loading ensemble and of the shapes
    fewer_harmonics: int  # at high load, and of the profiles of other Hurst exponents
    hurst_seeds: int  # realisations of each of these, and with vanishing adhesion


PAPER = Size(seeds=11, harmonics=1000, fewer_harmonics=250, hurst_seeds=6)
QUICK = Size(seeds=2, harmonics=64, fewer_harmonics=32, hurst_seeds=2)


def loading(size: Size) -> list[Member]:
    """Return the ensemble that is loaded to the highest of `LOADS`."""
    output, pressures = {"spectra": True, "pressure_distribution": True}, [load * MODULUS for load in LOADS]
    return [
        _member(f"loading-{seed:02d}", seed, HURST, size.harmonics, up_to(pressures, 1e-6), output)
        for seed in range(size.seeds)
    ]


def shapes(size: Size) -> Member:
    """Return the first realisation with a crest above `HIGHEST_CREST`, loaded through `SHAPES_AT`."""
    surfaces = (Profile.self_affine(PERIOD, HURST, RMS_HEIGHT, size.harmonics, k) for k in range(1000))
    seed = next(k for k, surface in enumerate(surfaces) if surface.max_height > HIGHEST_CREST)
    loading = {"control": "separation", "targets": list(SHAPES_AT)}
    output = {"shapes": list(SHAPES_AT), "spectra": True}
    return _member(f"shapes-{seed:02d}", seed, HURST, size.harmonics, loading, output)


def high_load(size: Size) -> Member:
    """Return a profile pressed to `NEARLY_FLAT`."""
    loading = {"control": "separation", "targets": list(NEARLY_FLAT)}
    return _member("high-load-02", 2, HURST, size.fewer_harmonics, loading, {"spectra": True})


def hurst(size: Size) -> dict[float, list[Member]]:
    """Return profiles of the Hurst exponents `HURSTS`, loaded to `HURST_LOAD`."""
    return {
        exponent: [
            _member(
                f"hurst-{exponent:g}-{seed:02d}",
                seed,
                exponent,
                size.fewer_harmonics,
                up_to([HURST_LOAD * MODULUS * slope], 1e-6),
                {"spectra": True},
            )
            for seed in range(size.hurst_seeds)
        ]
        for exponent in HURSTS
        for slope in [Profile.self_affine(PERIOD, exponent, RMS_HEIGHT, size.fewer_harmonics, 0).rms_slope]
    }


def faint(size: Size) -> list[list[Member]]:
    """Return for every seed its profile with each of `FAINT_WORKS`, loaded to the highest of `FAINT_AT`."""
    pressures, harmonics = [load * MODULUS for load in FAINT_AT], min(FAINT_HARMONICS, size.fewer_harmonics)
    return [
        [
            _member(f"faint-{work:g}-{seed:02d}", seed, HURST, harmonics, up_to(pressures, 1e-6), {}, work)
            for work in FAINT_WORKS
        ]
        for seed in range(size.hurst_seeds)
    ]


def sketch() -> Member:
    """Return the member from which the sketch of the problem is drawn."""
    return Member("sketch", sketch_scene())


def all_members(size: Size) -> list[Member]:
    """Return all members, the long runs first."""
    groups = hurst(size)
    others = [member for exponent in sorted(groups) for member in groups[exponent]]  # the roughest take longest
    vanishing = [member for group in faint(size) for member in group]
    return [*loading(size), shapes(size), high_load(size), *others, *vanishing, sketch()]


def _member(
    name: str, seed: int, exponent: float, harmonics: int, loading: Table, output: Table, work: float = WORK_OF_ADHESION
) -> Member:
    tables: dict[str, Table] = {"adhesion": {"work_of_adhesion": work, "slope_term": True}} if work else {}
    tables |= {"output": output} if output else {}
    title = f"self-affine profile, H = {exponent:g}, seed {seed}"
    return Member(name, scene(title, self_affine(seed, harmonics, exponent), loading, None, **tables))
