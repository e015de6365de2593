"""Points of an adhesive path that have edges: equilibria, and limit points that end their branch.  Dimensionless."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from bem.adhesive.branch import tangent
from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.third_derivatives import branch_curvature
from bem.continuation.limit_points import LimitPoint, before_fold
from bem.elastic.collocation import Evaluation
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.path_events import PathEvent, PathStatus
from bem.loading.path_point import Complete, Failed, PathPoint, Separated


@dataclass(frozen=True, eq=False)
class Equilibrium(PathPoint):
    """A stable equilibrium of the edges.

    Attributes
    ----------
    balance : Balance
        Forces on the edges.
    rate : (2 L,) array
        Derivative of the outward motion of the edges by the control.
    curvature : (2 L,) array or None
        Half its second derivative, where the point before on the same branch is known.
    increment : float or None
        With which the path continues from here; None for that of a beginning.
    last : bool
        Whether the branch ends here, where a crest touches.
    """

    balance: Balance
    rate: FloatArray
    curvature: FloatArray | None = None
    increment: float | None = field(default=None, kw_only=True)
    last: bool = field(default=False, kw_only=True)
    status: ClassVar[PathStatus] = "converged"

    @property
    def state(self) -> Evaluation:
        """The evaluation behind the balance."""
        return self.balance.state

    def predicted(self, value: float) -> Patches:
        """Edges at another value of the control, to second order; they may overlap."""
        change = value - self.value
        outward = change * self.rate
        return self.state.patches.moved(outward if self.curvature is None else outward + change**2 * self.curvature)


def equilibrium(
    system: System, value: float, here: Balance, events: tuple[PathEvent, ...] = (), last: bool = False
) -> Equilibrium:
    """The point of a balance at a value of the control, with its tangent."""
    rate = tangent(system.control, here)
    curvature = branch_curvature(system, here, rate) if here.state.slope_compliance.size else None
    return Equilibrium(value, here, rate, curvature, events=events, last=last)


@dataclass(frozen=True, eq=False)
class BranchEnd(PathPoint):
    """A limit point: the next point is behind the jump from it.

    Attributes
    ----------
    limit : LimitPoint
    """

    limit: LimitPoint
    status: ClassVar[PathStatus] = "converged"

    @property
    def last(self) -> bool:
        """Always."""
        return True

    @property
    def balance(self) -> Balance:
        """Forces on the edges."""
        return self.limit.balance

    @property
    def state(self) -> Evaluation:
        """The evaluation behind the balance."""
        return self.limit.balance.state

    def predicted(self, value: float) -> Patches:
        """Edges on the branch at a value of the control close before its end."""
        return before_fold(self.limit, value) if self.limit.kind == "fold" else self.state.patches


WithEdges = Equilibrium | BranchEnd
Point = Separated | Complete | Failed | Equilibrium | BranchEnd
