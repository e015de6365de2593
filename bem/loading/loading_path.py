"""What the solver asks of a loading path: path/path.py with adhesion, nonadhesive/convex_path.py without.

`P` are the kinds of points that a path has, among them those of points_without_edges.py; `Q` are its own, with edges.
Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Protocol, TypeVar

from bem.geometry.patches import Patches
from bem.loading.assessment import Assessment
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import PathTension

P = TypeVar("P")
Q = TypeVar("Q", contravariant=True)


class LoadingPath(Protocol[P, Q]):
    """A way through the states of a contact, driven by its control.

    Attributes
    ----------
    has_history : bool
        Whether the next state depends on the last one, and not on the goal alone.
    """

    has_history: ClassVar[bool]

    @property
    def increments(self) -> Increments:
        """Sizes of its increments, and accuracies."""
        ...

    @property
    def effort(self) -> Effort:
        """What it has taken so far."""
        ...

    @property
    def largest_tension(self) -> PathTension | None:
        """Least load met on unloading since this path was made; None where nothing was unloaded, or not located."""
        ...

    def direction(self, point: P, goal: float, separation: float | None = None) -> float:
        """Sign of the motion from a point to a goal: 1 closer, -1 apart, 0 there."""
        ...

    def advance(self, point: P, goal: float, separation: float | None = None) -> Iterator[P]:
        """Yield the points on the way to a value of the control; the last one is there or has failed.

        `separation` is the goal to its last digit, where that is what is controlled.
        """
        ...

    def refine(self, point: P, direction: float) -> P:
        """The point at the accuracy of a target, with events that only this accuracy shows.

        `direction` is the sign of the motion that led here.
        """
        ...

    def restart(self, patches: Patches, penetration: float, value: float, separation: float | None = None) -> P:
        """The point at the stored edges of a state; `Failed` when they are not in equilibrium."""
        ...

    def assess(self, point: Q) -> Assessment:
        """Stability, stiffness and estimated errors of a refined point with edges, from finer evaluations."""
        ...

    def load_of(self, point: P) -> float | None:
        """Load at a point; None where no path leads through loads continuously to it."""
        ...

    def may_meet(self, before: P, after: P, load: float) -> bool:
        """Whether a load is met between two successive points, or may have been."""
        ...

    def at_load(self, before: P, after: P, load: float) -> P | None:
        """The refined point at a load between two successive points; None where the path jumps over it."""
        ...
