"""What every path has, with adhesion or without: sizes of its increments and counts of its work.

Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass


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
