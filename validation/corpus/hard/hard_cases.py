"""Hard cases of the boundary elements as data: what a scene asks for, what must come out, and why it is hard.

The expectation stands here before anything runs.  Every case has a reduced scene (at most 125 harmonics, 10 s) and its
full form, which takes the finest profile and what `full` says.  Checks are named as in hard_case_checks.py, by default
the dense route; every target converges unless `expected` says otherwise.  SI units.
"""

from collections.abc import Iterator
from typing import Any

from validation.corpus.hard.hard_case_scenes import (
    WAVE,
    WAVE_WORK,
    WORK,
    johnson_penetration,
    rough,
    scene,
    waves,
    westergaard_pressure,
)
from validation.corpus.hard.scene_case import HardCase
from validation.references.paper_problem import PERIOD, Table

SCAN = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": 100}

# m.  With 1000 harmonics the lowest pressure of complete contact lies Q = 635 kPa below its mean, and K = 283 Pa m^0.5:
# by isolated_crack.py the load is tensile below a gap of 1.27e-5 periods, a separation of 6.0e-13 m; with 8 harmonics
# (Q = 60 kPa) below 7.2e-10 m.
TENSILE_1000 = 5e-13

THERE_AND_BACK = {"expected": ("converged", "complete_contact", "converged")}
ITS_EVENTS = {"events": ("first_touch", "complete_contact", "opening")}
BEYOND = {"expected": ("converged", "unreachable")}


def _case(name: str, reason: str, question: Table, *checks: str, **named: Any) -> HardCase:
    return HardCase(name, reason, question, checks or ("dense",), **named)


def _to(control: str, *targets: float) -> Table:
    """[loading] of a full form that is loaded otherwise."""
    return {"loading": {"control": control, "targets": list(targets)}}


def _wave(control: str, targets: list[float], work: float | None = None, **changes: Any) -> Table:
    return scene(waves([1], [WAVE]), control, targets, work, **changes)


def _sticky(harmonics: int, control: str, targets: list[float], work: float = WORK, **changes: Any) -> Table:
    """The rough profile with adhesion, over the true length of the surface."""
    return scene(rough(harmonics), control, targets, work, True, **changes)


def _at_separations(*fractions: float) -> list[float]:
    """Separations of the adhesive wave at contact fractions."""
    return [WAVE - johnson_penetration(fraction) for fraction in fractions]


def _loads(*fractions: float) -> list[float]:
    """Mean pressures of the wave without adhesion at contact fractions."""
    return [westergaard_pressure(fraction) for fraction in fractions]


# fmt: off
def _crests_and_gaps() -> Iterator[HardCase]:
    """Contacts that begin, vanish, merge and nearly close."""
    yield _case("twin_crests", "two crests of equal height touch at the same instant and must stay equal",
                scene(waves([2, 4], [50e-6, 10e-6]), "penetration", [1e-5, 3e-5, 0.0], 0.05),
                "dense", "mirror", "equal_patches", events=("first_touch",),
                full={"profile": waves([2, 4, 200], [50e-6, 10e-6, 0.1e-6])})
    yield _case("vanishing_patch", "on unloading the patches of lower crests shrink and vanish one after the other",
                _sticky(20, "separation", [30e-6, 75e-6]), events=("detachment",))
    yield _case("merging_patches", "two patches merge on loading: with adhesion by a jump from a finite gap",
                scene(rough(20), "separation", [40e-6, 20e-6], 0.01), events=("coalescence",),
                full={"adhesion": {"work_of_adhesion": WORK, "slope_term": True}})
    yield _case("merging_patches_without_adhesion",
                "the gap between two patches closes continuously, as a root of the load still missing, and opens again",
                scene(waves([1, 2], [50e-6, -20e-6]), "mean_pressure", [2e3, 2356.19387, 2.4e3, 2356.19387]),
                "dense", "compressive", "target_alone", reached={"gap": 1e-4},
                full={"profile": rough(1000)} | _to("separation", 40e-6, 20e-6, 40e-6))
    yield _case("vanishing_patch_without_adhesion", "on unloading a patch shrinks continuously to a point",
                scene(waves([1, 2], [50e-6, 40e-6]), "penetration", [8e-5, 7.013966352601551e-05, 6.9e-5]),
                "dense", "compressive", "target_alone", reached={"patch": 1e-4},
                full={"profile": rough(1000)} | _to("separation", 20e-6, 40e-6, 75e-6))
    yield _case("gap_1e-4", "a gap of 1e-4 wavelength: coupling modes by the hundred, K to rounding",
                _wave("mean_pressure", _loads(0.9999)), "wave", reached={"gap": 1e-4}, reached_in_full={"gap": 1e-4},
                full=_to("mean_pressure", *_loads(0.999, 0.9995, 0.9999)))
    yield _case("contact_fraction_1e-5", "heights cancel to ten digits on the smallest contact",
                _wave("mean_pressure", _loads(1e-5, 1e-3)), "wave",
                reached={"least": 1e-5}, reached_in_full={"least": 1e-5},
                full=_to("mean_pressure", *_loads(1e-5, 1e-4, 1e-3, 0.01)))
    yield _case("contact_fraction_to_0.9999",
                "at given separation the load ends in ever larger tension as the last gap closes",
                _wave("separation", _at_separations(0.3, 0.9, 0.999, 0.9999), WAVE_WORK),
                "wave", "tension_at_the_end", reached={"largest": 0.9999},
                reached_in_full={"least": 0.11, "largest": 0.9999},
                full=_to("separation", *_at_separations(0.3, 0.6, 0.9, 0.99, 0.999, 0.9999, 0.5, 0.1)))
    yield _case("rough_contact_fraction_to_0.9999",
                "on a rough profile, too, the load ends tensile, once the last gap is narrower than its pressure "
                "allows",
                _sticky(8, "separation", [6e-5, 1e-11]), "dense", "tension_at_the_end", "last_gap",
                reached={"largest": 0.9999}, reached_in_full={"largest": 0.9999},
                full=_to("separation", 6e-5, TENSILE_1000))
    yield _case("rough_contact_fraction_1e-5_without_adhesion",
                "from one crest that hardly touches to the last gap of a rough profile",
                scene(rough(20), "mean_pressure", [3e-4, 1e2, 1.2085e5]), "dense", "compressive", "target_alone",
                reached={"least": 1e-5, "largest": 0.998}, full=_to("separation", 20e-6, 1e-6, 1e-9))


def _ends_of_the_path() -> Iterator[HardCase]:
    """Complete contact, what lies beyond, symmetry that breaks, and the last gaps."""
    yield _case("penetration_beyond_complete_contact",
                "nothing lies beyond complete contact: unreachable, the states before it kept",
                _wave("penetration", [3e-5, 6e-5], WAVE_WORK), **BEYOND,
                full=_sticky(1000, "penetration", [5e-5, 1e-3]))
    yield _case("complete_contact_and_back_by_separation",
                "separation zero admits complete contact only; the way back opens a gap",
                _wave("separation", [3e-5, 0.0, 3e-5], WAVE_WORK), "wave", **THERE_AND_BACK, **ITS_EVENTS,
                full={"accuracy": {"max_increment": 0.005}})
    yield _case("rough_complete_contact_and_back_by_separation",
                "the last gaps of a rough profile close one by one as the separation vanishes",
                _sticky(40, "separation", [3e-5, 0.0, 3e-5]), **THERE_AND_BACK, **ITS_EVENTS)
    yield _case("complete_contact_and_back_by_load",
                "under load a jump into complete contact; a flaw opens on the way back",
                _sticky(20, "mean_pressure", [1e3, 3e5, 0.0], max_increment=4.0, flaw=1e-4),
                **THERE_AND_BACK, **ITS_EVENTS,
                full=_sticky(1000, "mean_pressure", [1e3, 1e6, 0.0], max_increment=2.0, flaw=1e-5))
    yield _case("complete_contact_and_back_without_adhesion",
                "complete contact and back without adhesion needs no flaw and no history",
                scene(rough(40), "mean_pressure", [2e4, 1e6, 2e4]), "dense", "target_alone", **THERE_AND_BACK,
                full=_to("mean_pressure", 2e4, 2e6, 2e4))
    yield _case("tension_no_branch_carries", "a tension beyond pull-off: unreachable, the states before it kept",
                _sticky(20, "mean_pressure", [1e3, -1e5], max_increment=2.0), **BEYOND, events=("pull_off",))
    seven = waves([7], [WAVE])
    yield _case("order_7", "seven equal contacts lose their symmetry where the smallest eigenvalue passes zero",
                scene(seven, "penetration", [2e-5, 4e-5, 4.9e-5], 7 * WAVE_WORK),
                "dense", "equal_until_bifurcation", events=("first_touch", "bifurcation"),
                full=_to("penetration", 2e-5, 4e-5, 4.9e-5, 1e-5, -1e-5))
    yield _case("order_7_without_adhesion", "seven equal contacts stay equal",
                scene(seven, "mean_pressure", [1e3, 5e4, 1e5]), "dense", "equal_patches",
                full=_to("mean_pressure", 1e2, 1e3, 1e4, 5e4, 1e5, 1.4e5))
    yield _case("last_gap_without_adhesion",
                "the last gap closes: a billionth of the period wide, its tension a small difference of large "
                "pressures",
                scene(rough(40), "separation", [1e-9, 1e-15, 1e-22, 1e-28]), "closing_gaps", "target_alone",
                reached={"largest": 0.9999998}, reached_in_full={"largest": 0.99999999})
    loads = [86393.687, 86393.7934, 86393.797]
    yield _case("last_gaps_that_close_together",
                "two equal gaps, of which neither may be taken for contact before the other",
                scene(waves([1, 2], [1e-4, 1e-4]), "mean_pressure", loads), "closing_gaps", "target_alone",
                full=_to("mean_pressure", *loads, 86393.79797363))


def _asked_another_way() -> Iterator[HardCase]:
    """Scans, other units and increments, restarts, layers, and nothing to solve."""
    low = [60e-6, 30e-6]
    yield _case("samples_50000", "50,000 noisy samples, cut at some harmonics",
                scene(SCAN, "separation", low, WORK, True), samples=(50_000, 1e-7))
    yield _case("shift_and_mirror", "a shifted and a mirrored profile have the same states",
                _sticky(30, "separation", low), "dense", "shift", "mirror")
    yield _case("millionfold_units", "lengths and stresses scaled by 1e6 either way",
                _sticky(30, "separation", [*low, 60e-6]), "units_up", "units_down")
    yield _case("increments_ten_times_too_large", "increments ten times too large are refined, not failed",
                _sticky(30, "separation", low, max_increment=0.5), "dense", "smaller_increments")
    yield _case("restart",
                "a path restarted from a stored state on its way back ends in the same state, which its history "
                "decides",
                _sticky(30, "separation", [*low, 50e-6, 60e-6]), "restart")
    yield _case("thin_incompressible_layer",
                "a layer of thickness 0.02 wavelengths with nu = 0.5 is stiff by its third power",
                _sticky(30, "separation", [70e-6, 60e-6], thickness=0.02 * PERIOD), "doubled")
    yield _case("thin_layer_without_adhesion", "the same without adhesion",
                scene(rough(30), "separation", [70e-6, 60e-6], thickness=0.02 * PERIOD),
                "doubled", "target_alone")
    for kind, work in (("", WORK), ("_without_adhesion", None)):
        yield _case(f"flat{kind}", "nothing to solve", scene(waves([1], [0.0]), "mean_pressure", [1e3], work),
                    "uniform_load", expected=("complete_contact",))


def _swept() -> Iterator[HardCase]:
    """Cases along one parameter, all on the rough profile."""
    for work in (1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2):
        yield _case(f"work_{work:g}", "from hardly any adhesion to surfaces that jump together",
                    _sticky(40, "separation", [60e-6, 30e-6], work))
    for height in (1e-9, 1e-7, 1e-5, 1e-3):
        yield _case(f"rms_height_{height:g}", "nanometres to millimetres: adhesion from dominant to negligible",
                    scene(rough(40, rms_height=height), "separation", [1.2 * height, 0.6 * height], WORK, True))
    for hurst in (0.01, 0.99):
        for kind, adhesion in (("", WORK), ("_without_adhesion", None)):
            yield _case(f"hurst_{hurst:g}{kind}", "roughness at the shortest wavelengths only, or hardly any",
                        scene(rough(60, hurst=hurst), "separation", [50e-6, 30e-6], adhesion))
    for harmonics, full in ((1, 1), (10, 10), (125, 1000), (125, 4000)):
        finest, targets = {"profile": rough(full)}, [60e-6, 48e-6 if full == 4000 else 40e-6]
        yield _case(f"harmonics_{full}", "from one contact to hundreds",
                    _sticky(harmonics, "separation", targets), full=finest,
                    reached_in_full={"largest": 0.02} if full == 4000 else {})
        if full < 4000:
            yield _case(f"harmonics_{full}_without_adhesion", "from one contact to hundreds of tiny ones",
                        scene(rough(harmonics), "separation", targets), "dense", "target_alone", full=finest)
    targets = [60e-6, 40e-6]
    for ratio in (-0.9, 0.0, 0.499999, 0.5):
        yield _case(f"poisson_ratio_{ratio:g}", "a half-space is E/(1 - nu^2) and no more",
                    scene(rough(20), "separation", targets, WORK, poisson_ratio=ratio), "dense", "plane_strain_only")
        yield _case(f"poisson_ratio_{ratio:g}_layer", "a layer near incompressibility and beyond",
                    scene(rough(20), "separation", targets, WORK, thickness=5e-4, poisson_ratio=ratio), "doubled")
# fmt: on


HARD_CASES: tuple[HardCase, ...] = (*_crests_and_gaps(), *_ends_of_the_path(), *_asked_another_way(), *_swept())
