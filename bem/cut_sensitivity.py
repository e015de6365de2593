"""How much the contact fraction changes with half and with twice the cut of a scan.

The first target is solved once more with each.  The cut is profile.cutoff_short where it is given (m: half of it keeps
more), else profile.harmonics (half of them keep less).  A cut that the samples do not hold is left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from bem.geometry.ranges import MOST_HARMONICS
from bem.scans.gaussian_filter import GaussianFilter
from bem.scene.result import Result
from bem.scene.scene import Scene
from bem.scene.scene_tables import OutputTable
from bem.solver import solve


def is_asked(scene: Scene) -> bool:
    """Whether output.cut_sensitivity is true, or not given for a scan without adhesion; never from a stored state.

    Examples
    --------
    >>> from bem.scene.scene import parse_scene
    >>> is_asked(parse_scene({
    ...     "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    ...     "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
    ...     "loading": {"control": "mean_pressure", "targets": [1e3]},
    ... }))
    False
    """
    asked = scene.output.cut_sensitivity
    free = scene.scan is not None and scene.start_state is None  # a stored state is one of its own cut
    return free and (scene.adhesion is None if asked is None else asked)


def cut_sensitivity(scene: Scene, result: Result) -> tuple[dict[str, Any], ...]:
    """For half and twice the cut: key and value of it, status, contact fraction at the first target, its change.

    The status is that of the solve; contact fraction and change are NaN where the target was not met.
    """
    if not is_asked(scene) or result.status != "converged" or not result.targets:
        return ()
    found = []
    for key, value, other in _others(scene):
        solved = solve(other)
        fraction = solved.targets[0].contact_fraction if solved.targets else float("nan")
        change = fraction - result.targets[0].contact_fraction
        facts = {"key": key, "value": value, "status": solved.status, "contact_fraction": fraction, "change": change}
        found.append(facts)
        if solved.status == "interrupted":
            break
    return tuple(found)


def _others(scene: Scene) -> Iterator[tuple[str, float, Scene]]:
    """Key and value of each other cut, and the scene with it."""
    scan, short, harmonics = scene.scan, scene.profile.cutoff_short, scene.profile.harmonics
    if scan is None or not isinstance(harmonics, int):
        return
    loading = scene.loading.model_copy(update={"targets": scene.loading.targets[:1], "at_mean_pressures": ()})
    first = replace(scene, loading=loading, output=OutputTable(), shape_targets=())
    most = min(scan.max_harmonics, MOST_HARMONICS)
    changed: dict[str, Any]
    for factor in (0.5, 2.0):
        if short is None or scan.unfiltered is None:
            changed = {"harmonics": round(factor * harmonics)}
            if 1 <= changed["harmonics"] <= most:
                yield (
                    "harmonics",
                    changed["harmonics"],
                    replace(first, profile=scene.profile.model_copy(update=changed)),
                )
            continue
        gaussian = GaussianFilter(factor * short, scan.gaussian.long)
        if any(gaussian.refusals(scan.spacing, scan.spectrum.h.size * scan.spacing)):
            continue
        other = scan.unfiltered.filtered(gaussian)
        changed = {"cutoff_short": gaussian.short, "harmonics": min(other.carrying, most)}
        profile = scene.profile.model_copy(update=changed)
        yield "cutoff_short", gaussian.short, replace(first, scan=other, profile=profile)


def in_words(facts: tuple[dict[str, Any], ...]) -> str:
    """What was found, on one line.

    Examples
    --------
    >>> in_words(({"key": "harmonics", "value": 500, "status": "converged", "contact_fraction": 0.3, "change": 0.06},))
    'the contact fraction at the first target is 0.3 (+0.06) with harmonics = 500'
    """
    told = (f"{fact['contact_fraction']:.3g} ({fact['change']:+.2g}) with {fact['key']} = {fact['value']:g}"
            for fact in facts)  # fmt: skip
    return "the contact fraction at the first target is " + ", ".join(told)
