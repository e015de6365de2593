"""Effects that a scene may call for, priced on one rough profile: the scene with each, and that without.

The profile is the registry's self-affine one, loaded to two separations.  An effect that a scene does not call for must
cost nothing: a bare scene, in a process of its own, names the modules of absent effects that it loads.
"""

import json
import math
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import bem
from bem.scene.result import Result
from validation.references import adapters

Changes = dict[str, Mapping[str, Any] | None]

ABSENT = (
    "bem.elastic.layer",
    "bem.adhesive.adhesion",
    "bem.observables.observables",
    "bem.observables.spectra",
    "bem.observables.pressure_distribution",
    "bem.observables.shapes",
)
TARGETS = [45e-6, 35e-6]
LAYER = 0.002
ADHESIVE: Changes = {"adhesion": {"work_of_adhesion": 0.03, "slope_term": True}}
ALONE = (
    "import json; from validation.corpus.effects import loaded_for_nothing; print(json.dumps(loaded_for_nothing(%d)))"
)


@dataclass(frozen=True)
class Effect:
    """An effect, the scene that has it, and the one it is priced against."""

    name: str
    on_top_of: str
    changes: Changes  # of the registry's rough scene


EFFECTS: tuple[Effect, ...] = (
    Effect("bare", "", {"adhesion": None}),
    Effect("layer", "bare", {"adhesion": None, "layer": {"thickness": LAYER}}),
    Effect("adhesion", "bare", {"adhesion": {"work_of_adhesion": 0.03, "slope_term": False}}),
    Effect("slope term", "adhesion", ADHESIVE),
    Effect("unloading", "slope term", ADHESIVE | {"loading": {"targets": [*TARGETS, TARGETS[0]]}}),
    Effect("shapes", "slope term", ADHESIVE | {"output": {"shapes": TARGETS}}),
    Effect("spectra", "slope term", ADHESIVE | {"output": {"spectra": True}}),
    Effect("pressure distribution", "slope term", ADHESIVE | {"output": {"pressure_distribution": True}}),
    Effect("width distributions", "slope term", ADHESIVE | {"output": {"width_distributions": True}}),
)


def loaded_for_nothing(harmonics: int) -> list[str]:
    """Modules of absent effects that the bare scene loads, in a process of its own: the list must be empty."""
    bem.solve(rough({"adhesion": None}, harmonics))
    return sorted(name for name in ABSENT if name in sys.modules)


def loaded_alone(harmonics: int) -> list[str]:
    """The same from a process made for it; CalledProcessError where that fails."""
    done = subprocess.run([sys.executable, "-c", ALONE % harmonics], capture_output=True, text=True, check=True)
    return [str(name) for name in json.loads(done.stdout)]


def rough(changes: Changes, harmonics: int) -> Any:
    """The rough scene with an effect."""
    usual: Changes = {"profile": {"harmonics": harmonics}, "loading": {"targets": TARGETS}}
    return adapters.scene("rough_100", usual | changes)


def seconds_of(scene: Any, runs: int) -> tuple[float, int]:
    """Least CPU seconds of a few runs after a warm-up, and evaluations."""
    result = solved(scene)
    least = math.inf
    for _ in range(runs):
        begun = time.process_time()
        result = solved(scene)
        least = min(least, time.process_time() - begun)
    return least, sum(state.evaluations for state in result.states)


def solved(scene: Any) -> Result:
    """The result of a scene; ArithmeticError where it does not converge."""
    result = bem.solve(scene)
    if result.status != "converged":
        raise ArithmeticError(f"the scene ended with {result.status}")
    return result
