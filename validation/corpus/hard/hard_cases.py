"""Hard cases as data: what a scene asks for, what must come out, and why it is hard.

The expectation stands here before anything runs.  Every case has a reduced scene (at most 125 harmonics, 10 s) and
its full form; `hard_case_run.run_case` solves one and counts two things apart: converged (the solver's word, and
the statuses expected at the targets) and correct (the certificate of every target, and the independent checks named
here, which live in hard_case_checks.py).  SI units.
"""

from typing import Any

from validation.corpus.hard.hard_case_scenes import (
    WAVE,
    WAVE_WORK,
    WORK,
    HardCase,
    Reached,
    Samples,
    both,
    johnson_penetration,
    rough,
    scene,
    waves,
    westergaard_pressure,
)
from validation.references.paper_problem import PERIOD

SCAN = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m"}

# m.  With 1000 harmonics the lowest pressure of complete contact lies Q = 635 kPa below its mean, and K = 283 Pa m^0.5:
# by isolated_crack.py the load is tensile below a gap of 1.27e-5 periods, a separation of 6.0e-13 m; with 8 harmonics
# (Q = 60 kPa) below 7.2e-10 m.
TENSILE_1000 = 5e-13


def _hard_cases() -> list[HardCase]:
    same, low = ("converged",), [60e-6, 30e-6]
    down_up = [60e-6, 30e-6, 60e-6]
    double_crest, two_crests = waves([1, 2], [50e-6, -20e-6]), waves([1, 2], [50e-6, 40e-6])
    cases = [
        HardCase("twin_crests",
                 "two crests of equal height touch at the same instant and must stay equal",
                 scene(waves([2, 4], [50e-6, 10e-6]), "penetration", [1e-5, 3e-5, 0.0], 0.05),
                 scene(waves([2, 4, 200], [50e-6, 10e-6, 0.1e-6]), "penetration", [1e-5, 3e-5, 0.0], 0.05),
                 same * 3, ("dense", "mirror", "equal_patches"), events=("first_touch",)),
        HardCase("vanishing_patch",
                 "on unloading the patches of lower crests shrink and vanish one after the other",
                 *both(20, "separation", [30e-6, 75e-6], WORK, True),
                 same * 2, events=("detachment",)),
        HardCase("merging_patches",
                 "two patches merge on loading: with adhesion by a jump from a finite gap",
                 scene(rough(20), "separation", [40e-6, 20e-6], 0.01),
                 scene(rough(1000), "separation", [40e-6, 20e-6], WORK, True),
                 same * 2, events=("coalescence",)),
        HardCase(
            "merging_patches_without_adhesion",
            "the gap between two patches closes continuously, as a root of the load still missing, and opens again",
            scene(double_crest, "mean_pressure", [2e3, 2356.19387, 2.4e3, 2356.19387]),
            scene(rough(1000), "separation", [40e-6, 20e-6, 40e-6]),
            same * 4, ("dense", "compressive", "target_alone"), reached=Reached(gap=1e-4)
        ),
        HardCase("vanishing_patch_without_adhesion",
                 "on unloading a patch shrinks continuously to a point",
                 scene(two_crests, "penetration", [8e-5, 7.013966352601551e-05, 6.9e-5]),
                 scene(rough(1000), "separation", [20e-6, 40e-6, 75e-6]),
                 same * 3, ("dense", "compressive", "target_alone"), reached=Reached(patch=1e-4)),
        HardCase("gap_1e-4",
                 "a gap of 1e-4 wavelength: coupling modes by the hundred, K to rounding",
                 scene(waves([1], [WAVE]), "mean_pressure", [westergaard_pressure(0.9999)]),
                 scene(waves([1], [WAVE]), "mean_pressure", [westergaard_pressure(f) for f in (0.999, 0.9995, 0.9999)]),
                 same, ("wave",), reached=Reached(gap=1e-4), reached_in_full=Reached(gap=1e-4)),
        HardCase("contact_fraction_1e-5",
                 "heights cancel to ten digits on the smallest contact",
                 scene(waves([1], [WAVE]), "mean_pressure", [westergaard_pressure(f) for f in (1e-5, 1e-3)]),
                 scene(waves([1], [WAVE]), "mean_pressure",
                       [westergaard_pressure(f) for f in (1e-5, 1e-4, 1e-3, 0.01)]),
                 same * 2, ("wave",), reached=Reached(least=1e-5), reached_in_full=Reached(least=1e-5)),
        HardCase("contact_fraction_to_0.9999",
                 "at given separation the load ends in ever larger tension as the last gap closes",
                 scene(waves([1], [WAVE]), "separation",
                       [WAVE - johnson_penetration(f) for f in (0.3, 0.9, 0.999, 0.9999)], WAVE_WORK),
                 scene(waves([1], [WAVE]), "separation",
                       [WAVE - johnson_penetration(f) for f in (0.3, 0.6, 0.9, 0.99, 0.999, 0.9999, 0.5, 0.1)],
                       WAVE_WORK),
                 same * 4, ("wave", "tension_at_the_end"), reached=Reached(largest=0.9999),
                 reached_in_full=Reached(least=0.11, largest=0.9999)),
        HardCase(
            "rough_contact_fraction_to_0.9999",
            "on a rough profile, too, the load ends tensile, once the last gap is narrower than its pressure allows",
            scene(rough(8), "separation", [6e-5, 1e-11], WORK, True),
            scene(rough(1000), "separation", [6e-5, TENSILE_1000], WORK, True),
            same * 2, ("dense", "tension_at_the_end", "last_gap"), reached=Reached(largest=0.9999),
            reached_in_full=Reached(largest=0.9999)
        ),
        HardCase("rough_contact_fraction_1e-5_without_adhesion",
                 "from one crest that hardly touches to the last gap of a rough profile",
                 scene(rough(20), "mean_pressure", [3e-4, 1e2, 1.2085e5]),
                 scene(rough(1000), "separation", [20e-6, 1e-6, 1e-9]),
                 same * 3, ("dense", "compressive", "target_alone"), reached=Reached(least=1e-5, largest=0.998)),
        HardCase("penetration_beyond_complete_contact",
                 "nothing lies beyond complete contact: unreachable, the states before it kept",
                 scene(waves([1], [WAVE]), "penetration", [3e-5, 6e-5], WAVE_WORK),
                 scene(rough(1000), "penetration", [5e-5, 1e-3], WORK, True),
                 ("converged", "unreachable"), ("dense",), status="unreachable"),
        HardCase("complete_contact_and_back_by_separation",
                 "separation zero admits complete contact only; the way back opens a gap",
                 scene(waves([1], [WAVE]), "separation", [3e-5, 0.0, 3e-5], WAVE_WORK),
                 scene(waves([1], [WAVE]), "separation", [3e-5, 0.0, 3e-5], WAVE_WORK, max_increment=0.005),
                 ("converged", "complete_contact", "converged"), ("wave",),
                 events=("first_touch", "complete_contact", "opening")),
        HardCase("rough_complete_contact_and_back_by_separation",
                 "the last gaps of a rough profile close one by one as the separation vanishes",
                 *both(40, "separation", [3e-5, 0.0, 3e-5], WORK, True),
                 ("converged", "complete_contact", "converged"), events=("first_touch", "complete_contact", "opening")),
        HardCase("complete_contact_and_back_by_load",
                 "under load a jump into complete contact; a flaw opens on the way back",
                 scene(rough(20), "mean_pressure", [1e3, 3e5, 0.0], WORK, True, max_increment=4.0, flaw=1e-4),
                 scene(rough(1000), "mean_pressure", [1e3, 1e6, 0.0], WORK, True, max_increment=2.0, flaw=1e-5),
                 ("converged", "complete_contact", "converged"), events=("first_touch", "complete_contact", "opening")),
        HardCase("complete_contact_and_back_without_adhesion",
                 "complete contact and back without adhesion needs no flaw and no history",
                 scene(rough(40), "mean_pressure", [2e4, 1e6, 2e4]),
                 scene(rough(1000), "mean_pressure", [2e4, 2e6, 2e4]),
                 ("converged", "complete_contact", "converged"), ("dense", "target_alone")),
        HardCase("tension_no_branch_carries",
                 "a tension beyond pull-off: unreachable, the states before it kept",
                 *both(20, "mean_pressure", [1e3, -1e5], WORK, True, max_increment=2.0),
                 ("converged", "unreachable"), status="unreachable", events=("pull_off",)),
        HardCase("order_7",
                 "seven equal contacts lose their symmetry where the smallest eigenvalue passes zero",
                 scene(waves([7], [WAVE]), "penetration", [2e-5, 4e-5, 4.9e-5], 7 * WAVE_WORK),
                 scene(waves([7], [WAVE]), "penetration", [2e-5, 4e-5, 4.9e-5, 1e-5, -1e-5], 7 * WAVE_WORK),
                 same * 3, ("dense", "equal_until_bifurcation"), events=("first_touch", "bifurcation")),
        HardCase("order_7_without_adhesion",
                 "seven equal contacts stay equal",
                 scene(waves([7], [WAVE]), "mean_pressure", [1e3, 5e4, 1e5]),
                 scene(waves([7], [WAVE]), "mean_pressure", [1e2, 1e3, 1e4, 5e4, 1e5, 1.4e5]),
                 same * 3, ("dense", "equal_patches")),
        HardCase(
            "last_gap_without_adhesion",
            "the last gap closes: a billionth of the period wide, its tension a small difference of large pressures",
            *both(40, "separation", [1e-9, 1e-15, 1e-22, 1e-28]),
            same * 4, ("closing_gaps", "target_alone"), reached=Reached(largest=0.9999998),
            reached_in_full=Reached(largest=0.99999999)
        ),
        HardCase("last_gaps_that_close_together",
                 "two equal gaps, of which neither may be taken for contact before the other",
                 scene(waves([1, 2], [1e-4, 1e-4]), "mean_pressure", [86393.687, 86393.7934, 86393.797]),
                 scene(waves([1, 2], [1e-4, 1e-4]), "mean_pressure",
                       [86393.687, 86393.7934, 86393.797, 86393.79797363]),
                 same * 3, ("closing_gaps", "target_alone")),
        HardCase("samples_50000",
                 "50,000 noisy samples, cut at some harmonics",
                 scene(SCAN | {"harmonics": 100}, "separation", low, WORK, True),
                 scene(SCAN | {"harmonics": 1000}, "separation", low, WORK, True),
                 same * 2, samples=Samples(50_000, 1e-7)),
        HardCase("shift_and_mirror",
                 "a shifted and a mirrored profile have the same states",
                 *both(30, "separation", low, WORK, True),
                 same * 2, ("dense", "shift", "mirror")),
        HardCase("millionfold_units",
                 "lengths and stresses scaled by 1e6 either way",
                 *both(30, "separation", down_up, WORK, True),
                 same * 3, ("units_up", "units_down")),
        HardCase("increments_ten_times_too_large",
                 "increments ten times too large are refined, not failed",
                 *both(30, "separation", low, WORK, True, max_increment=0.5),
                 same * 2, ("dense", "smaller_increments")),
        HardCase(
            "restart",
            "a path restarted from a stored state on its way back ends in the same state, which its history decides",
            *both(30, "separation", [60e-6, 30e-6, 50e-6, 60e-6], WORK, True),
            same * 4, ("restart",)
        ),
        HardCase("thin_incompressible_layer",
                 "a layer of thickness 0.02 wavelengths with nu = 0.5 is stiff by its third power",
                 *both(30, "separation", [70e-6, 60e-6], WORK, True, 0.02 * PERIOD),
                 same * 2, ("doubled",)),
        HardCase("thin_layer_without_adhesion",
                 "the same without adhesion",
                 *both(30, "separation", [70e-6, 60e-6], thickness=0.02 * PERIOD),
                 same * 2, ("doubled", "target_alone")),
    ]  # fmt: skip
    for kind, work in (("", WORK), ("_without_adhesion", None)):
        flat = scene(waves([1], [0.0]), "mean_pressure", [1e3], work)
        cases.append(HardCase(f"flat{kind}", "nothing to solve", flat, flat, ("complete_contact",), ("uniform_load",)))
    return cases + _swept_cases()


def _swept_cases() -> list[HardCase]:
    """Cases along one parameter, all on the rough profile."""
    same = ("converged",)
    cases = [
        HardCase(f"work_{work:g}", "from hardly any adhesion to surfaces that jump together",
                 *both(40, "separation", [60e-6, 30e-6], work, True), same * 2)
        for work in (1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2)
    ]  # fmt: skip
    cases += [
        HardCase(f"rms_height_{height:g}", "nanometres to millimetres: adhesion from dominant to negligible",
                 *both(40, "separation", [1.2 * height, 0.6 * height], WORK, True, rms_height=height), same * 2)
        for height in (1e-9, 1e-7, 1e-5, 1e-3)
    ]  # fmt: skip
    cases += [
        HardCase(f"hurst_{hurst:g}{kind}", "roughness at the shortest wavelengths only, or hardly any",
                 *both(60, "separation", [50e-6, 30e-6], adhesion, hurst=hurst), same * 2)
        for hurst in (0.01, 0.99)
        for kind, adhesion in (("", WORK), ("_without_adhesion", None))
    ]  # fmt: skip
    for harmonics, full in ((1, 1), (10, 10), (125, 1000), (125, 4000)):
        targets = [60e-6, 40e-6] if full < 4000 else [60e-6, 48e-6]
        cases.append(
            HardCase(f"harmonics_{full}", "from one contact to hundreds",
                     *both(harmonics, "separation", targets, WORK, True, full=full), same * len(targets),
                     reached_in_full=Reached(largest=0.02) if full == 4000 else None),
        )  # fmt: skip
        if full < 4000:
            cases.append(
                HardCase(f"harmonics_{full}_without_adhesion", "from one contact to hundreds of tiny ones",
                         *both(harmonics, "separation", targets, full=full), same * len(targets),
                         ("dense", "target_alone")),
            )  # fmt: skip
    for ratio in (-0.9, 0.0, 0.499999, 0.5):
        asked: tuple[Any, ...] = (20, "separation", [60e-6, 40e-6], WORK)
        cases += [
            HardCase(f"poisson_ratio_{ratio:g}", "a half-space is E/(1 - nu^2) and no more",
                     *both(*asked, poisson_ratio=ratio), same * 2, ("dense", "plane_strain_only")),
            HardCase(f"poisson_ratio_{ratio:g}_layer", "a layer near incompressibility and beyond",
                     *both(*asked, thickness=5e-4, poisson_ratio=ratio), same * 2, ("doubled",)),
        ]  # fmt: skip
    return cases


HARD_CASES: tuple[HardCase, ...] = tuple(_hard_cases())
