"""Points of a loading path without edges: surfaces apart, complete contact, and places where no state was found.

Such points are alike with adhesion and without.  Points with edges are defined in bem/path/points_with_edges.py
(Equilibrium) and in bem/nonadhesive/convex_path.py (ContactPoint).  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

from bem.loading.path_events import PathEvent, PathStatus


@dataclass(frozen=True, eq=False)
class PathPoint:
    """Value of the control, events and separation of a point of a path.

    Attributes
    ----------
    value : float
        Value of the control.
    events : tuple of PathEvent
        Events on the way to the point.
    separation : float or None
        Separation asked for, if it holds more digits than its difference to `value`, which is rounded.
    """

    value: float
    events: tuple[PathEvent, ...] = field(default=(), kw_only=True)
    separation: float | None = field(default=None, kw_only=True)

    @property
    def last(self) -> bool:
        """True if a branch ends at the point: the next point is at the same value, behind a jump."""
        return False


@dataclass(frozen=True, eq=False)
class Separated(PathPoint):
    """Point with the surfaces apart."""

    status: ClassVar[PathStatus] = "separated"
    state: ClassVar[None] = None


@dataclass(frozen=True, eq=False)
class Complete(PathPoint):
    """Point in complete contact."""

    status: ClassVar[PathStatus] = "complete_contact"
    state: ClassVar[None] = None


@dataclass(frozen=True, eq=False)
class Failed(PathPoint):
    """Point at which no state was found."""

    status: Literal["not_converged", "ill_conditioned", "jumps_again"]
    state: ClassVar[None] = None
