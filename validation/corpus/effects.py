"""Effects that a scene may call for, priced on one rough profile: the scene with each, and that without.

The profile is the registry's self-affine one, loaded to two separations.  Scenes run one after the other, and that
several times, so that what slows the machine slows all of them; the least CPU time of each counts.  The median above
the least is what repetition changes: a ratio is told to that digit, and one that does not exceed 1 by it is no price.
An effect that a scene does not call for must cost nothing: a bare scene, in a process of its own, names the modules of
absent effects that it loads.
"""

import json
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any

import bem
from bem.scene.result import Result
from validation.routes.scenes import posed

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
    return posed("rough_100", **(usual | changes))


@dataclass(frozen=True)
class Cost:
    """What a scene took: CPU seconds of every run, (n,), and evaluations of one."""

    seconds: tuple[float, ...]
    evaluations: int

    @property
    def least(self) -> float:
        """CPU seconds of the quickest run."""
        return min(self.seconds)

    @property
    def noise(self) -> float:
        """The median run above the quickest, over it."""
        return median(self.seconds) / self.least - 1


@dataclass(frozen=True)
class Times:
    """How many times the scene without an effect the one with it takes, and what repetition changes of that."""

    ratio: float
    noise: float

    @classmethod
    def of(cls, own: Cost, base: Cost) -> "Times":
        """Of two scenes that ran in alternation."""
        ratio = own.least / base.least
        return cls(ratio, ratio * (own.noise + base.noise))

    def __str__(self) -> str:
        """To the first digit of the noise.

        Examples
        --------
        >>> str(Times(6.4571, 0.0312)), str(Times(12.61, 2.3)), str(Times(1.04, 0.06)), str(Times(0.785, 0.02))
        ('6.46 ± 0.03', '13 ± 2', 'no more, ± 0.06', 'no more, ± 0.02')
        """
        if self.ratio - self.noise <= 1:
            return f"no more, ± {self.noise:.1g}"
        places = max(0, -int(f"{self.noise:.0e}".partition("e")[2]))
        return f"{self.ratio:.{places}f} ± {self.noise:.{places}f}"


def costs_of(scenes: Mapping[str, Any], runs: int) -> dict[str, Cost]:
    """What each scene takes by its name: so many rounds, each of one run of every scene."""
    seconds: dict[str, list[float]] = {name: [] for name in scenes}
    evaluations: dict[str, int] = {}
    for _ in range(runs):
        for name, scene in scenes.items():
            begun = time.process_time()
            result = solved(scene)
            seconds[name].append(time.process_time() - begun)
            evaluations[name] = sum(state.evaluations for state in result.states)
    return {name: Cost(tuple(took), evaluations[name]) for name, took in seconds.items()}


def solved(scene: Any) -> Result:
    """The result of a scene; ArithmeticError where it does not converge."""
    result = bem.solve(scene)
    if result.status != "converged":
        raise ArithmeticError(f"the scene ended with {result.status}")
    return result
