"""Scenes by which the predicted cost is judged, and what they were measured to cost.

cost_scenes.toml lists them: scenes of the cases, examples, and changes of a base scene. Every other one calibrated
the constants of bem/scene/cost_prediction.py, the others are a hold-out; so are random scenes (random_scenes.py),
drawn after the form of the prediction was settled. cost_measured.json holds evaluations, which depend on no machine,
and CPU seconds with compiled kernels and in NumPy, divided by the pace of the machine
(`bem.scene.cost_prediction.pace`). It is written by

    python -m validation.corpus.cost_scenes validation/corpus/cost_measured.json

which measures with the kernels in use what the file does not hold yet: run it again with LINECONTACT_KERNELS=numpy.
"""

import copy
import json
import math
import sys
import time
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from bem.compiled.kernels import IN_USE
from bem.scene.atomic_file import write_atomically
from bem.scene.cost_prediction import cost_of, pace
from bem.scene.scene import Scene, SceneError, parse_scene
from bem.solver import solve
from validation.corpus.random.random_scenes import draw

FOLDER = resources.files("validation")
TABLE, MEASURED = "corpus/cost_scenes.toml", "corpus/cost_measured.json"
PLACES = {"cases": "cases/scenes", "examples": "command_line/examples"}
RANDOM_SEED, RANDOM_SCENES, RANDOM_HARMONICS = 19, 40, 60
PARTS = ("calibration", "hold-out", "random")
KERNELS = ("compiled", "NumPy")


@dataclass(frozen=True)
class Foretold:
    """Predicted and measured cost of a scene; `kernels` are those of the seconds."""

    name: str
    part: str
    kernels: str
    predicted_evaluations: float
    evaluations: int
    predicted_seconds: float
    seconds: float

    @property
    def ratios(self) -> tuple[float, float]:
        """Predicted over measured: evaluations, seconds."""
        return self.predicted_evaluations / self.evaluations, self.predicted_seconds / self.seconds


def cost_scenes() -> dict[str, tuple[str, Scene]]:
    """The scenes by name, each with its part: calibration, hold-out, random."""
    listed = tomllib.loads(FOLDER.joinpath(TABLE).read_text("utf-8"))
    found: list[tuple[str, Scene]] = []
    for kind, place in PLACES.items():
        for name in listed[kind]["names"]:
            path = FOLDER.joinpath(place, f"{name}.toml")
            scene = parse_scene(tomllib.loads(path.read_text("utf-8")), Path(str(FOLDER.joinpath(place))))
            found.append((f"{kind}/{name}", scene))
    for name, changes in listed["scenes"].items():
        found.append((name, parse_scene(_changed(listed["base"], changes))))
    parts = {name: (PARTS[k % 2], scene) for k, (name, scene) in enumerate(found)}
    for index in range(RANDOM_SCENES):
        drawn = draw(RANDOM_SEED, index, RANDOM_HARMONICS)
        if drawn.scan is None and drawn.expected == "an answer":
            try:
                parts[drawn.id] = PARTS[2], parse_scene(drawn.tables)
            except SceneError:  # a flaw in the wrong place is found by posing alone
                continue
    return parts


def judged() -> list[Foretold]:
    """All scenes that take any evaluations, by kernels, against what was measured."""
    measured = json.loads(FOLDER.joinpath(MEASURED).read_text("utf-8"))
    found = []
    for name, (part, scene) in cost_scenes().items():
        for kernels in KERNELS:
            known = measured.get(name, {}).get(kernels)
            if known is None or known["evaluations"] == 0:
                continue
            cost = cost_of(scene, kernels)
            seconds = 1e-3 * cost.evaluations * cost.milliseconds
            found.append(
                Foretold(name, part, kernels, cost.evaluations, known["evaluations"], seconds, known["seconds"])
            )
    return found


def measure(scene: Scene) -> dict[str, float]:
    """Evaluations and CPU seconds over the pace of this machine; none of a scene that is not solved to its end."""
    begun = time.process_time()
    result = solve(scene)
    seconds = time.process_time() - begun
    if result.status != "converged":
        return {"evaluations": 0, "seconds": 0.0}
    taken = sum(state.evaluations for state in result.states)
    return {"evaluations": taken, "seconds": float(f"{seconds / pace():.3g}")}


def main(path: Path) -> None:
    """Measure what the file does not hold yet."""
    known = json.loads(path.read_text("utf-8")) if path.exists() else {}
    for name, (_, scene) in cost_scenes().items():
        if IN_USE not in known.setdefault(name, {}):
            known[name][IN_USE] = measure(scene)
            write_atomically(path, json.dumps(known, indent=1) + "\n")
            print(name, known[name][IN_USE], flush=True)


def _changed(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Tables with others in their place, or with some of their keys changed; an empty one is left out."""
    tables = copy.deepcopy(dict(base))
    for name, keys in changes.items():
        whole = "kind" in keys or "control" in keys or not keys
        tables[name] = dict(keys) if whole else tables.get(name, {}) | keys
    return {name: table for name, table in tables.items() if table}


def outside(ratios: list[float], factor: float) -> float:
    """Share of ratios beyond a factor, either way.

    Examples
    --------
    >>> outside([1.0, 2.0, 0.3, 4.0], 3.0)
    0.5
    """
    return sum(abs(math.log(ratio)) > math.log(factor) for ratio in ratios) / len(ratios)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
