"""Points of an adhesive path that have edges: states of a branch, and the ends of its spans.  Dimensionless."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from bem.adhesive.equilibrium import Balance
from bem.elastic.collocation import Evaluation
from bem.geometry.patches import Patches
from bem.loading.path_events import PathStatus
from bem.loading.points_without_edges import Complete, Failed, PathPoint, Separated
from bem.path.locating import Located
from bem.path.span import Span
from bem.path.stand import Stand


@dataclass(frozen=True, eq=False)
class Stretch:
    """The part of a span of the curve that leads to a point: from one parameter to another, with the loads there."""

    span: Span
    ends: tuple[float, float]
    loads: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Equilibrium(PathPoint):
    """An equilibrium of the edges, stable but for the end of a branch.

    Attributes
    ----------
    balance : Balance
        Forces on the edges: of the point itself at the accuracy of targets, or one Newton step away.
    patches : Patches
        The contact patches, whose ends are the edges.
    load : float
    stretch : Stretch or None
        Of the curve, from the point before it.
    last : bool
        Whether the branch ends here.
    settled : bool
        Whether the balance is that of the point at the accuracy of targets.
    """

    balance: Balance
    patches: Patches
    load: float
    stretch: Stretch | None = field(default=None, kw_only=True)
    last: bool = field(default=False, kw_only=True)
    settled: bool = field(default=False, kw_only=True)
    status: ClassVar[PathStatus] = "converged"

    @property
    def state(self) -> Evaluation:
        """The evaluation behind the balance."""
        return self.balance.state

    @classmethod
    def of(cls, value: float, balance: Balance, settled: bool = False) -> Equilibrium:
        """The point of a balance in equilibrium."""
        return cls(value, balance, balance.state.patches, balance.state.load, settled=settled)

    @classmethod
    def near(cls, at: Stand | Located, last: bool = False) -> Equilibrium:
        """A point of a curve, or what is located, near its balance."""
        return cls(at.numbers.value, at.balance, at.patches, at.numbers.load, last=last)


Point = Separated | Complete | Failed | Equilibrium
