"""Physical and numerical effects of a scene: which ones are active, and the reason.

An effect that is not active is a code path never entered.  elastic_tables.py lists the effects on the compliance.
"""

from __future__ import annotations

from collections.abc import Iterator

from bem.scene.elastic_tables import ELASTIC, elastic_effects, negligible
from bem.scene.result import Effect
from bem.scene.scene import Scene
from bem.scene.scene_tables import OUTPUTS
from bem.scene.targets import unloads

EFFECTS = (*("half_space", *ELASTIC, "adhesion", "slope_term", "unloading", "load_control"), *OUTPUTS)


def effects_of(scene: Scene) -> tuple[Effect, ...]:
    """Return every effect of the vocabulary, in the order of `EFFECTS`."""
    reasons = dict(_reasons(scene))
    return tuple(Effect(name, *reasons[name]) for name in EFFECTS)


def _reasons(scene: Scene) -> Iterator[tuple[str, tuple[bool, str]]]:
    """Yield the name of every effect, whether it is active, and the reason."""
    yield from _elastic_reasons(scene)
    adhesion = scene.adhesion
    if adhesion is None:
        yield "adhesion", (False, "no [adhesion]")
        yield "slope_term", (False, "no [adhesion]")
    else:
        yield "adhesion", (True, f"work_of_adhesion = {adhesion.work_of_adhesion:g} J/m^2")
        yield "slope_term", (adhesion.slope_term, f"adhesion.slope_term = {str(adhesion.slope_term).lower()}")
    back = sum(leg for leg in _legs(scene))
    yield "unloading", (back > 0, f"{back} of {len(_legs(scene))} legs of the path unload")
    yield "load_control", (scene.loading.control == "mean_pressure", f'loading.control = "{scene.loading.control}"')
    for name in OUTPUTS:
        count = _outputs(scene, name)
        asked = "asked for" if count else "not asked for"
        yield name, (count > 0, f"output.{name} {asked}" + (f" at {count} targets" if count else ""))


def _elastic_reasons(scene: Scene) -> Iterator[tuple[str, tuple[bool, str]]]:
    """Yield the elastic effects: the half-space or the tables that change it, with the default cut of a scan."""
    note = ""
    if scene.cut_by_default and scene.scan is not None:
        note = f"; profile.harmonics = {scene.profile.harmonics} by default for {scene.scan.x.size} samples"
    effects, limit = elastic_effects(scene), negligible(scene)
    changing, absent = [], "no " + " or ".join(f"[{name}]" for name in ELASTIC)
    for name, words in ELASTIC.items():
        if name not in effects:
            yield name, (False, f"no [{name}]")
            continue
        change = effects[name].relative_effect
        text = f"{words.format_map(vars(getattr(scene, name)))} changes the compliance by at most {change:.2g}"
        if change < limit:
            absent = text = f"{text}, below {limit:g}, a tenth of the tolerance: left out"
        else:
            changing.append(f"[{name}]")
        yield name, (change >= limit, text)
    yield (
        "half_space",
        (not changing, (f"the compliance is changed by {' and '.join(changing)}" if changing else absent) + note),
    )


def _legs(scene: Scene) -> list[bool]:
    """Return for each leg of the path, from one target to the next, whether it unloads."""
    targets = scene.loading.targets
    starts = (scene.origin, *targets[:-1])
    return [unloads(scene.loading.control, a, b) for a, b in zip(starts, targets, strict=True) if a != b]


def _outputs(scene: Scene, name: str) -> int:
    """Return the number of targets at which an output is asked for."""
    return sum(scene.wants(name, index) for index in range(len(scene.loading.targets)))
