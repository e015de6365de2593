"""Events of a path: kind and position, the state from which the path jumps, and its errors.  Dimensionless."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

PathStatus = Literal["converged", "separated", "complete_contact", "not_converged", "ill_conditioned", "jumps_again"]


@dataclass(frozen=True)
class EventNumbers:
    """Numbers of a state, or their errors, dimensionless: value of the control, Delta, load and potential."""

    value: float
    penetration: float
    load: float
    potential: float

    def apart(self, other: EventNumbers, force: float) -> EventNumbers:
        """Return absolute differences; potentials are compared at one value of the control, on which `force` acts."""
        value = self.value - other.value
        return EventNumbers(
            abs(value),
            abs(self.penetration - other.penetration),
            abs(self.load - other.load),
            abs(self.potential - other.potential - force * value),
        )


NO_ERROR = EventNumbers(0.0, 0.0, 0.0, 0.0)
FIRST_TOUCH = EventNumbers(0.0, 0.0, 0.0, 0.0)  # where any control starts to feel the contact


@dataclass(frozen=True)
class PathEvent:
    """A discontinuity of the path, in the state from which it jumps, with the errors of its numbers.

    Kinds: bem/README.md, section 5.  The energy of an avalanche is booked on its first event.
    """

    kind: str
    position: float
    at: EventNumbers
    error: EventNumbers
    energy_released: float
    energy_error: float


@dataclass(frozen=True)
class PathTension:
    """Least load that a path has met on unloading, located like an event.

    Candidates: turns of the load on a branch (dP/dDelta = 0), folds, and both sides of jumps.

    Attributes
    ----------
    kind : {"turn", "fold", "jump"}
    at : EventNumbers
        The state of least load.
    error : EventNumbers
        Bounds of the errors of these numbers.
    """

    kind: Literal["turn", "fold", "jump"]
    at: EventNumbers
    error: EventNumbers


def path_events(
    changes: tuple[tuple[str, float], ...],
    at: EventNumbers,
    error: EventNumbers,
    released: float,
    released_error: float,
) -> tuple[PathEvent, ...]:
    """Return the events of an avalanche that starts at a state."""
    return tuple(
        PathEvent(kind, position % (2 * np.pi), at, error, *((released, released_error) if i == 0 else (0.0, 0.0)))
        for i, (kind, position) in enumerate(changes)
    )
