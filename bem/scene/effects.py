"""The physical and numerical effects a scene calls for, each with its reason and its predicted cost.

An effect that is not active is a code path never entered.  What changes the compliance: elastic_tables.py.

The predicted cost (cost_prediction.py) is told apart by effect: the bare targets, what adhesion adds to them on the
way in and on the way back, what a layer adds to every evaluation, and the outputs.
"""

from __future__ import annotations

from collections.abc import Iterator

from bem.scene.cost_prediction import cost_of, pace
from bem.scene.elastic_tables import ELASTIC, elastic_effects, negligible
from bem.scene.result import Effect
from bem.scene.scene import Scene
from bem.scene.scene_tables import OUTPUTS
from bem.scene.targets import unloads

EFFECTS = (
    *("half_space", *ELASTIC, "adhesion", "slope_term", "unloading", "load_control"),
    *OUTPUTS,
)

OUTPUT = 1e-4  # prediction: s for each harmonic: fields, spectra or a distribution at one target


def effects_of(scene: Scene) -> tuple[Effect, ...]:
    """Every effect of the vocabulary, in the order of `EFFECTS`."""
    reasons = dict(_reasons(scene))
    seconds = _seconds(scene, {name for name, (active, _) in reasons.items() if active})
    return tuple(Effect(name, *reasons[name], seconds=seconds.get(name, 0.0)) for name in EFFECTS)


def predicted_seconds(scene: Scene) -> float:
    """Predicted cost of the scene on one core, s."""
    return sum(effect.seconds for effect in effects_of(scene))


def _reasons(scene: Scene) -> Iterator[tuple[str, tuple[bool, str]]]:
    """Name, whether active, and why."""
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
    """Half-space or what changes it, and the default cut of a scan."""
    note = ""
    if scene.cut_by_default and scene.scan is not None:
        note = f"; profile.harmonics = {scene.profile.harmonics} by default for {scene.scan.x.size} samples"
    effects, limit = elastic_effects(scene), negligible(scene)
    kept, absent = [], "no " + " or ".join(f"[{name}]" for name in ELASTIC)
    for name, words in ELASTIC.items():
        if name not in effects:
            yield name, (False, f"no [{name}]")
            continue
        change = effects[name].relative_effect
        text = f"{words.format_map(getattr(scene, name).model_dump())} changes the compliance by at most {change:.2g}"
        if change < limit:
            absent = text = f"{text}, below a tenth of the tolerance, {limit:g}: left out"
        else:
            kept.append(f"[{name}]")
        yield name, (change >= limit, text)
    yield "half_space", (not kept, (f"the compliance is changed by {' and '.join(kept)}" if kept else absent) + note)


def _legs(scene: Scene) -> list[bool]:
    """Whether each leg of the path, from one target to the next, unloads."""
    targets = scene.loading.targets
    starts = (scene.origin, *targets[:-1])
    return [unloads(scene.loading.control, a, b) for a, b in zip(starts, targets, strict=True) if a != b]


def _outputs(scene: Scene, name: str) -> int:
    """Number of targets at which an output is asked for."""
    return sum(scene.wants(name, index) for index in range(len(scene.loading.targets)))


def _seconds(scene: Scene, active: set[str]) -> dict[str, float]:
    """Predicted cost of each active effect, s."""
    cost, legs = cost_of(scene), _legs(scene)
    size = max(scene.profile.orders) if scene.profile.orders else int(scene.profile.harmonics or 1)
    layer, bare = cost.layer_share * cost.seconds, min(1.0, cost.bare / (cost.evaluations or 1.0))
    plain = cost.seconds - layer
    way = [leg.evaluations for leg in cost.legs if leg.start != leg.stop]
    back = sum(spent for spent, unloads in zip(way, legs, strict=False) if unloads) / (sum(way) or 1.0)
    elastic = plain if "adhesion" not in active else bare * plain
    kept = [name for name in ELASTIC if name in active]  # in one kernel
    seconds = {
        **{name: (layer + elastic) / len(kept) for name in kept},
        "half_space": layer + elastic,
        "adhesion": (1 - back) * (plain - elastic),
        "unloading": back * (plain - elastic),
    }
    for name in OUTPUTS:
        seconds[name] = _outputs(scene, name) * OUTPUT * size * pace()
    return {name: value for name, value in seconds.items() if name in active}
