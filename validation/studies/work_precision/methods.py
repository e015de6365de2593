"""The methods compared, each a route with its one knob, and the points of its curve: settings with their errors.

All but the knob is fixed, and named in `fixed`.  A method is a record; another one (a uniform-grid solver, say) is one
more entry of METHODS.  Where a method cannot do a scene, the reason stands in `cannot`.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from validation.harness.route import Answer, Problem, Route
from validation.references.paper_method import follow
from validation.references.posed_contacts import THEORY_LOAD, surface_of
from validation.routes import boundary_elements, dense_algebra, finite_elements, paper_method
from validation.routes.persson_theory import by_route, by_separation

SHOWN = ("contact_fraction", "mean_pressure")  # the error of a point is the larger of these


@dataclass(frozen=True)
class Method(Route):
    """A route and the scenes it takes part in."""

    scenes: tuple[str, ...] = ()
    cannot: Mapping[str, str] = field(default_factory=dict)  # scenes it cannot do, and why
    slow: int = 0  # how many of its settings, from the finest, the quick form of the study leaves out
    # on scenes where those of `settings` do not fit
    other_settings: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)

    def settings_for(self, scene: str, quick: bool) -> tuple[Any, ...]:
        """Settings on a scene, in full or in the quick form."""
        every = self.other_settings.get(scene, self.settings)
        return every[: len(every) - self.slow] if quick else every


@dataclass(frozen=True)
class Timed:
    """A setting, measured; `status` is a message where it failed."""

    setting: str
    status: str = "done"
    found: Answer | None = None
    wall_seconds: float = math.nan
    spread: float = math.nan
    cpu_seconds: float = math.nan
    repeats: int = 0
    peak_megabytes: float = math.nan


@dataclass(frozen=True)
class MethodPoint:
    """A setting of a method on a scene, with its errors."""

    scene: str
    method: str
    timed: Timed
    errors: dict[str, float] = field(default_factory=dict)
    floor: float = math.nan
    reference: str = ""

    @property
    def error(self) -> float:
        """The larger of the errors of SHOWN; nan where the setting failed."""
        return max((self.errors[name] for name in SHOWN if name in self.errors), default=math.nan)

    @property
    def grey(self) -> bool:
        """Below what the reference resolves."""
        return self.error < self.floor


def by_method(points: Iterable[MethodPoint], scene: str) -> dict[str, list[MethodPoint]]:
    """The points of a scene that have an error, by the names of their methods."""
    found: dict[str, list[MethodPoint]] = {}
    for point in points:
        if point.scene == scene and not math.isnan(point.error):
            found.setdefault(point.method, []).append(point)
    return found


def solve_paper(problem: Problem, cells: int) -> Answer:
    """The paper's own method: from the geometric overlap, or along a path where the state depends on it."""
    if problem.id == "rough":
        return paper_method.solve(problem, cells, PATH_STEPS, PATH_RESIDUAL)
    return paper_method.solve(problem, cells, 0, PAPER_RESIDUAL)


def solve_finite_elements(problem: Problem, mesh: tuple[int, int, int]) -> Answer:
    """Finite elements, from the crests; contacts of many sizes from coarse edges of the paper's method."""
    if problem.id != "rough":
        return finite_elements.solve(problem, mesh)
    way = np.linspace(0.0, problem.targets[-1], PATH_STEPS + 1)[1:]
    scouted = follow(surface_of(problem), way, SCOUTING_CELLS, PATH_RESIDUAL, paper_method.GAP)[-1]
    return finite_elements.solve(problem, mesh, scouted.edges)


SCOUTING_CELLS = 4
PAPER_RESIDUAL = 1e-7  # of the paper's method: |G/w - 1|
PATH_RESIDUAL, PATH_STEPS = 1e-5, 40
TOO_MANY = {"paper": "up to forty contacts and a thousand harmonics: hours"}
NOT_THEORY = {
    "sinusoid": "Persson's theory needs roughness on many scales",
    "layer": "Persson's theory is for a half-space",
    "rough": "its two routes give the same contact, off by tens of per cent: as `persson, by separation`",
    "paper": "as on the rough profile",
}
PERSSON_SETTINGS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0)

METHODS: tuple[Method, ...] = (
    Method(name="bem", code="bem", knob="accuracy.tolerance",
           fixed="path from first touch, increments 0.05 rms heights",
           settings=(1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9), scenes=("sinusoid", "layer", "rough", "paper"),
           solve=boundary_elements.solve),
    Method(name="bem, dense", code="bem", knob="nodes per patch",
           fixed="Newton on K from the geometric overlap: patches given, no path, no search for contacts",
           settings=(4, 6, 8, 10, 12, 16, 20, 24), scenes=("sinusoid", "layer"), solve=dense_algebra.solve,
           cannot=dict.fromkeys(("rough", "paper"), "without a path and a search for contacts: patches not known")),
    Method(name="fem", code="fem", knob="mesh: order, cells, tip levels",
           fixed="closure from crests on a scouting mesh, then one mesh; half-space: layer of three periods; rough: "
                 f"from the edges of the paper's method with {SCOUTING_CELLS} cells, its seconds included",
           settings=((2, 4, 4), (2, 6, 6), (2, 8, 8), (2, 12, 10), (4, 6, 11), (4, 8, 14), (4, 12, 19)),
           scenes=("sinusoid", "layer", "rough"), solve=solve_finite_elements, cannot=TOO_MANY, slow=1,
           other_settings={"rough": ((2, 4, 4), (2, 6, 6), (2, 8, 8), (4, 4, 6), (4, 4, 8))}),
    Method(name="paper's method", code="paper's method", knob="cells per patch",
           fixed=f"residual {PAPER_RESIDUAL:g}; rough: {PATH_RESIDUAL:g}, path of {PATH_STEPS} steps from first touch",
           settings=(4, 8, 16, 32, 64, 128, 256), scenes=("sinusoid", "layer", "rough"), solve=solve_paper,
           cannot=TOO_MANY, other_settings={"rough": (4, 6, 8, 12, 16, 24)}),
    Method(name="persson, by separation", code="persson, volterra", knob="resolution",
           fixed="the published theory, its load sought at which it has the separation",
           settings=(0.03, 0.045, 0.06, 0.09, 0.125, 0.2), scenes=("rough", "paper"), solve=by_separation,
           cannot={"sinusoid": "Persson's theory needs roughness on many scales",
                   "layer": "Persson's theory is for a half-space"}),
    Method(name="persson, finite volumes", code="persson, finite volumes", knob="resolution",
           fixed=f"mean pressure {THEORY_LOAD:g} Pa, no separation",
           settings=PERSSON_SETTINGS, scenes=("theory",), solve=partial(by_route, "finite_volumes"),
           cannot=NOT_THEORY, slow=2),
    Method(name="persson, volterra", code="persson, volterra", knob="resolution",
           fixed=f"mean pressure {THEORY_LOAD:g} Pa, no separation",
           settings=PERSSON_SETTINGS, scenes=("theory",), solve=partial(by_route, "volterra"),
           cannot=NOT_THEORY, slow=2),
)  # fmt: skip
