"""Hard scenes of the boundary elements as data: what each asks for, what must come out, and why it is hard.

The expectation stands here before anything runs: the status of every target ("converged" unless stated) and the events
that must occur.  The rough profile is that of Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65: period
0.01 m, H = 0.7, rms height 50 um, E = 1 MPa, nu = 0.5, 0.03 J/m^2.  SI units.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.references.closed_forms import Sinusoid
from validation.references.paper_problem import PERIOD, Table, lines, self_affine

RMS, MODULUS, WORK, WAVE = 50e-6, 1e6, 0.03, 50e-6
DRY, ADHESIVE = (Sinusoid(WAVE, PERIOD, MODULUS, 0.5, alpha) for alpha in (0.0, 0.3))
WAVE_WORK = ADHESIVE.work_of_adhesion  # J/m^2


@dataclass(frozen=True)
class Hard:
    """Hard scene; `checks` name the checks besides dense algebra.

    "wave" and "last gap", "closing gaps": closed forms; "equal": patches; "tension": the load at the end.
    """

    name: str
    why: str
    tables: Table
    statuses: tuple[str, ...] = ()  # of the targets; all converged where none is given
    events: tuple[str, ...] = ()
    checks: tuple[str, ...] = ()
    level: str = "standard"

    @property
    def expected(self) -> tuple[str, ...]:
        """Status of every target."""
        return self.statuses or ("converged",) * len(self.tables["loading"]["targets"])


def rough(harmonics: int, hurst: float = 0.7, rms_height: float = RMS) -> Table:
    """Return [profile] of a self-affine profile."""
    return self_affine(0, harmonics, hurst, rms_height)


def waves(orders: list[int], amplitudes: list[float]) -> Table:
    """Return [profile] of cosines."""
    return lines(orders, amplitudes, [0.0] * len(orders))


def scene(
    profile: Table, control: str, targets: list[float], work: float | None = None, slope_term: bool = False,
    **other: Any,
) -> Table:
    """Return the tables of a scene; `other` are poisson_ratio, thickness, max_increment and flaw."""
    tables: Table = {
        "title": "hard scene",
        "solid": {"youngs_modulus": MODULUS, "poisson_ratio": other.get("poisson_ratio", 0.5)},
        "profile": profile,
        "loading": {"control": control, "targets": targets} | ({"flaw": other["flaw"]} if "flaw" in other else {}),
    }
    if work is not None:
        tables["adhesion"] = {"work_of_adhesion": work, "slope_term": slope_term}
    if "thickness" in other:
        tables["layer"] = {"thickness": other["thickness"]}
    if "max_increment" in other:
        tables["accuracy"] = {"max_increment": other["max_increment"]}
    return tables


def wave(control: str, targets: list[float], work: float | None = None) -> Table:
    """Return a scene of one wave."""
    return scene(waves([1], [WAVE]), control, targets, work)


def sticky(harmonics: int, control: str, targets: list[float], work: float = WORK, **other: Any) -> Table:
    """Return a scene of the rough profile with adhesion along its true length."""
    return scene(rough(harmonics), control, targets, work, True, **other)


def dry_loads(*fractions: float) -> list[float]:
    """Return mean pressures of the dry wave at contact fractions."""
    return [float(DRY.mean_pressure(np.pi / 2 * fraction)) for fraction in fractions]


def separations(*fractions: float) -> list[float]:
    """Return separations of the adhesive wave at contact fractions."""
    return [WAVE - float(ADHESIVE.penetration(np.pi / 2 * fraction)) for fraction in fractions]


BACK = ("converged", "complete_contact", "converged")
BEYOND = ("converged", "unreachable")
THERE_AND_BACK = ("first_touch", "complete_contact", "opening")
LOW = [60e-6, 30e-6]


def crests_and_gaps() -> Iterator[Hard]:
    """Yield scenes with contacts that begin, vanish, merge and nearly close."""
    yield Hard("twin crests", "two crests of equal height touch at one instant and must stay equal",
               scene(waves([2, 4], [50e-6, 10e-6]), "penetration", [1e-5, 3e-5, 0.0], 0.05),
               events=("first_touch",), checks=("equal",))
    yield Hard("vanishing patch", "on unloading the patches of lower crests vanish one after the other",
               sticky(20, "separation", [30e-6, 75e-6]), events=("detachment",))
    yield Hard("merging patches", "two patches merge by a jump from a finite gap",
               scene(rough(20), "separation", [40e-6, 20e-6], 0.01), events=("coalescence",))
    yield Hard("merging patches, dry", "a gap closes continuously and opens again",
               scene(waves([1, 2], [50e-6, -20e-6]), "mean_pressure", [2e3, 2356.19387, 2.4e3, 2356.19387]),
               level="quick")
    yield Hard("vanishing patch, dry", "a patch shrinks continuously to a point",
               scene(waves([1, 2], [50e-6, 40e-6]), "penetration", [8e-5, 7.013966352601551e-05, 6.9e-5]),
               level="quick")
    yield Hard("gap of 1e-4", "coupling modes by the hundred, K to rounding", wave("mean_pressure", dry_loads(0.9999)),
               checks=("wave",), level="quick")
    yield Hard("contact fraction of 1e-5", "heights cancel to ten digits on the smallest contact",
               wave("mean_pressure", dry_loads(1e-5, 1e-3)), checks=("wave",), level="quick")
    fractions = separations(0.3, 0.9, 0.999, 0.9999)
    yield Hard("contact fraction to 0.9999", "the load ends in ever larger tension as the last gap closes",
               wave("separation", fractions, WAVE_WORK), checks=("wave", "tension"))
    yield Hard("rough contact fraction to 0.9999", "the load ends tensile on the last gap of a rough profile",
               sticky(8, "separation", [6e-5, 1e-11]), checks=("last gap", "tension"))
    yield Hard("rough from 1e-5 to 0.998, dry", "from one crest that hardly touches to the last gap",
               scene(rough(20), "mean_pressure", [3e-4, 1e2, 1.2085e5]), level="quick")


def ends_of_the_path() -> Iterator[Hard]:
    """Yield scenes of complete contact and beyond, of symmetry that breaks, and of the last gaps."""
    yield Hard("penetration beyond complete contact", "unreachable; the states before it stay",
               wave("penetration", [3e-5, 6e-5], WAVE_WORK), BEYOND, level="quick")
    yield Hard("complete contact by separation", "separation zero admits complete contact only",
               wave("separation", [3e-5, 0.0, 3e-5], WAVE_WORK), BACK, THERE_AND_BACK, ("wave",))
    yield Hard("rough complete contact by separation", "the last gaps close one by one",
               sticky(40, "separation", [3e-5, 0.0, 3e-5]), BACK, THERE_AND_BACK)
    yield Hard("complete contact by load", "a jump into complete contact; a flaw opens on the way back",
               sticky(20, "mean_pressure", [1e3, 3e5, 0.0], max_increment=4.0, flaw=1e-4), BACK,
               THERE_AND_BACK, level="quick")
    yield Hard("complete contact, dry", "needs no flaw and no history",
               scene(rough(40), "mean_pressure", [2e4, 1e6, 2e4]), BACK, level="quick")
    yield Hard("tension that no branch carries", "beyond pull-off: unreachable",
               sticky(20, "mean_pressure", [1e3, -1e5], max_increment=2.0), BEYOND, ("pull_off",),
               level="quick")
    seven = waves([7], [WAVE])
    yield Hard("seven equal contacts", "symmetry breaks where the smallest eigenvalue passes zero",
               scene(seven, "penetration", [2e-5, 4e-5, 4.9e-5], 7 * WAVE_WORK),
               events=("first_touch", "bifurcation"))
    yield Hard("seven equal contacts, dry", "they stay equal", scene(seven, "mean_pressure", [1e3, 5e4, 1e5]),
               checks=("equal",), level="quick")
    yield Hard("last gap, dry", "a billionth of the period wide; its tension is a small difference",
               scene(rough(40), "separation", [1e-9, 1e-15, 1e-22, 1e-28]), checks=("closing gaps",), level="quick")
    yield Hard("last gaps that close together", "neither of two equal gaps may be taken for contact first",
               scene(waves([1, 2], [1e-4, 1e-4]), "mean_pressure", [86393.687, 86393.7934, 86393.797]),
               checks=("closing gaps",), level="quick")
    for work in (WORK, None):
        flat = scene(waves([1], [0.0]), "mean_pressure", [1e3], work)
        yield Hard(f"flat{'' if work else ', dry'}", "nothing to solve", flat, ("complete_contact",), level="quick")


def swept() -> Iterator[Hard]:
    """Yield scenes that vary one parameter from end to end, on the rough profile."""
    thin = 0.02 * PERIOD
    yield Hard("thin incompressible layer", "stiff by the third power of its thickness",
               sticky(30, "separation", [70e-6, 60e-6], thickness=thin), level="quick")
    yield Hard("thin incompressible layer, dry", "stiff by the third power of its thickness",
               scene(rough(30), "separation", [70e-6, 60e-6], thickness=thin), level="quick")
    for work in (1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2):
        yield Hard(f"work of adhesion {work:g}", "from hardly any adhesion to surfaces that jump together",
                   sticky(40, "separation", LOW, work))
    for height in (1e-9, 1e-7, 1e-5, 1e-3):
        profile, targets = rough(40, rms_height=height), [1.2 * height, 0.6 * height]
        yield Hard(f"rms height {height:g}", "nanometres to millimetres: adhesion from dominant to negligible",
                   scene(profile, "separation", targets, WORK, True))
    for hurst in (0.01, 0.99):
        for gamma in (WORK, None):
            yield Hard(f"H = {hurst:g}{'' if gamma else ', dry'}", "roughness at short wavelengths only, or hardly any",
                       scene(rough(60, hurst), "separation", [50e-6, 30e-6], gamma))
    for harmonics, level in ((1, "quick"), (10, "standard"), (125, "standard"), (1000, "full")):
        yield Hard(f"{harmonics} harmonics", "from one contact to hundreds",
                   sticky(harmonics, "separation", [60e-6, 40e-6]), level=level)
        yield Hard(f"{harmonics} harmonics, dry", "from one contact to hundreds of tiny ones",
                   scene(rough(harmonics), "separation", [60e-6, 40e-6]), level=level)
    for ratio in (-0.9, 0.0, 0.499999, 0.5):
        for layer in (Table(), Table(thickness=5e-4)):
            yield Hard(f"nu = {ratio:g}{', layer' if layer else ''}", "near incompressibility, and auxetic",
                       scene(rough(20), "separation", [60e-6, 40e-6], WORK, poisson_ratio=ratio, **layer))


SCENES: tuple[Hard, ...] = (*crests_and_gaps(), *ends_of_the_path(), *swept())
