"""Hard cases along one parameter: work of adhesion, height, Hurst exponent, harmonics, Poisson's ratio."""

from __future__ import annotations

from typing import Any

from validation.corpus.hard.hard_case_scenes import WORK, HardCase, Reached, both


def swept_cases() -> list[HardCase]:
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
