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
    """Part of a span that leads to a point: from one parameter to another, with the loads at both parameters."""

    span: Span
    ends: tuple[float, float]
    loads: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Equilibrium(PathPoint):
    """Equilibrium of the edges, stable but for the end of a branch.

    Attributes
    ----------
    balance : Balance
        Forces on the edges: of the point itself at the accuracy of targets, or one Newton step away.
    patches : Patches
        The contact patches, whose ends are the edges.
    load : float
    stretch : Stretch or None
        Stretch of the curve from the point before.
    last : bool
        True if the branch ends at the point.
    settled : bool
        True if the balance is evaluated at the point itself, at the accuracy of targets.
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
        """Evaluation behind the balance."""
        return self.balance.state

    @classmethod
    def of(cls, value: float, balance: Balance, settled: bool = False) -> Equilibrium:
        """Return the point of a balance in equilibrium."""
        return cls(value, balance, balance.state.patches, balance.state.load, settled=settled)

    @classmethod
    def near(cls, at: Stand | Located, last: bool = False) -> Equilibrium:
        """Return a point of a curve, or a located point, near its balance."""
        return cls(at.numbers.value, at.balance, at.patches, at.numbers.load, last=last)


Point = Separated | Complete | Failed | Equilibrium
