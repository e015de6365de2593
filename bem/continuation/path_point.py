"""A point of an adhesive path.  Dimensionless."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.equilibrium import Balance
from bem.continuation.limit_points import LimitPoint
from bem.elastic.collocation import Evaluation
from bem.loading.path_events import PathEvent, PathStatus

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Point:
    """A state on the path: an equilibrium, or none where the surfaces are apart or fully joined.

    Attributes
    ----------
    value : float
        Of the control.
    balance : Balance or None
        Forces on the edges, where there are any.
    events : tuple of PathEvent
        What happened on the way here.
    rate, curvature : (2 L,) arrays or None
        First derivative and half the second derivative of the outward motion of the edges by the control; None at a
        fold, and where a tangent is not known.
    last : bool
        Whether a branch ends here: the next point is at the same value, behind a jump.
    fold : LimitPoint or None
        The fold, where one ends the branch.
    """

    status: PathStatus
    value: float
    balance: Balance | None = None
    events: tuple[PathEvent, ...] = ()
    rate: FloatArray | None = None
    curvature: FloatArray | None = None
    last: bool = False
    fold: LimitPoint | None = None

    @property
    def state(self) -> Evaluation | None:
        """The evaluation behind the balance."""
        return None if self.balance is None else self.balance.state
