"""Points of a loading path without edges: surfaces apart, complete contact, and places where no state was found.

These are alike with adhesion and without.  Points with edges are those of bem/path/points_with_edges.py
(Equilibrium) and of bem/nonadhesive/convex_path.py (ContactPoint).  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

from bem.loading.path_events import PathEvent, PathStatus


@dataclass(frozen=True, eq=False)
class PathPoint:
    """What every point has.

    Attributes
    ----------
    value : float
        Of the control.
    events : tuple of PathEvent
        What happened on the way here.
    separation : float or None
        What was asked for where that is more than its difference to `value`, which is rounded.
    """

    value: float
    events: tuple[PathEvent, ...] = field(default=(), kw_only=True)
    separation: float | None = field(default=None, kw_only=True)

    @property
    def last(self) -> bool:
        """Whether a branch ends here: the next point is at the same value, behind a jump."""
        return False


@dataclass(frozen=True, eq=False)
class Separated(PathPoint):
    """Surfaces apart."""

    status: ClassVar[PathStatus] = "separated"
    state: ClassVar[None] = None


@dataclass(frozen=True, eq=False)
class Complete(PathPoint):
    """Complete contact."""

    status: ClassVar[PathStatus] = "complete_contact"
    state: ClassVar[None] = None


@dataclass(frozen=True, eq=False)
class Failed(PathPoint):
    """No state was found here."""

    status: Literal["not_converged", "ill_conditioned", "jumps_again"]
    state: ClassVar[None] = None
