"""What every path has, with adhesion or without: sizes of its increments, counts of its work, its events.

Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

PathStatus = Literal["converged", "separated", "complete_contact", "not_converged", "ill_conditioned"]


@dataclass(frozen=True)
class Increments:
    """Sizes of the increments in units of the control value, and accuracies.

    Parameters
    ----------
    largest, smallest : float
        Increments; an event is resolved within the smallest, or less in thin layers.
    tolerance, closure : float
        Of the evaluations, and of max |G/w - 1|, between targets.
    fine_tolerance, fine_closure : float
        The same at targets.
    allowed : float
        Interpenetration that is not a contact, in units of the rms height.
    """

    largest: float
    smallest: float
    tolerance: float = 1e-3
    closure: float = 1e-4
    fine_tolerance: float = 1e-8
    fine_closure: float = 1e-9
    allowed: float = 1e-10


@dataclass
class Effort:
    """Counts of work along a path."""

    evaluations: int = 0
    local_evaluations: int = 0
    unknowns: int = 0
    accepted: int = 0
    rejected: int = 0

    def book(self, evaluations: int, local_evaluations: int) -> None:
        """Add what an event cost."""
        self.evaluations += evaluations
        self.local_evaluations += local_evaluations


@dataclass(frozen=True)
class PathEvent:
    """A discontinuity of the path; the energy of an avalanche is booked on its first event."""

    kind: str
    value: float
    penetration: float
    load: float
    position: float
    energy_released: float


def path_events(
    changes: tuple[tuple[str, float], ...], value: float, penetration: float, load: float, released: float
) -> tuple[PathEvent, ...]:
    """Events of an avalanche; a jump of the edges alone is a (saddle-node) bifurcation."""
    named = changes or (("bifurcation", np.nan),)
    return tuple(
        PathEvent(kind, value, penetration, load, position % (2 * np.pi), released if i == 0 else 0.0)
        for i, (kind, position) in enumerate(named)
    )
