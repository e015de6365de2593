"""Protocol of a loading path: path/path.py with adhesion, nonadhesive/convex_path.py without.

`P` are the kinds of points of a path, among them the points of points_without_edges.py; `Q` are its points with edges.
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
    """Path through the states of a contact, driven by its control.

    Attributes
    ----------
    has_history : bool
        True if the next state depends on the last state, and not on the goal alone.
    """

    has_history: ClassVar[bool]

    @property
    def increments(self) -> Increments:
        """Sizes of the increments of the path, and accuracies."""
        ...

    @property
    def effort(self) -> Effort:
        """Counts of the work done so far."""
        ...

    @property
    def largest_tension(self) -> PathTension | None:
        """Least load met on unloading since this path was made; None where nothing was unloaded, or not located."""
        ...

    def direction(self, point: P, goal: float, separation: float | None = None) -> float:
        """Return the sign of the motion from a point to a goal: 1 closer, -1 apart, 0 at the goal."""
        ...

    def advance(self, point: P, goal: float, separation: float | None = None) -> Iterator[P]:
        """Yield the points on the way to a value of the control; the last point is at this value or has failed.

        `separation` is the goal to its last digit, if the separation is controlled.
        """
        ...

    def refine(self, point: P, direction: float) -> P:
        """Return the point at the accuracy of a target, with events that only this accuracy shows.

        `direction` is the sign of the motion that led to the point.
        """
        ...

    def restart(self, patches: Patches, penetration: float, value: float, separation: float | None = None) -> P:
        """Return the point at the stored edges of a state; `Failed` when the edges are not in equilibrium."""
        ...

    def assess(self, point: Q) -> Assessment:
        """Return stability, stiffness and estimated errors of a refined point with edges, from finer evaluations."""
        ...

    def load_of(self, point: P) -> float | None:
        """Return the load at a point; None where no path leads through loads continuously to the point."""
        ...

    def may_meet(self, before: P, after: P, load: float) -> bool:
        """Return whether a load is met between two successive points, or may have been."""
        ...

    def at_load(self, before: P, after: P, load: float) -> P | None:
        """Return the refined point at a load between two successive points; None where the path jumps over it."""
        ...
