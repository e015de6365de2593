"""Points of a work-precision curve: a setting of a method, what it cost, and its errors against a reference."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from validation.harness.route import Answer
from validation.routes.boundary_elements import PATH_DOUBT

SHOWN = ("contact_fraction", "mean_pressure")  # the error of a point is the larger of these


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
    def doubt(self) -> float:
        """What the path leaves uncertain, whatever the error happens to be."""
        return self.timed.found.details.get(PATH_DOUBT, 0.0) if self.timed.found else 0.0

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
