"""Accuracies, sizes of increments and counts of work of every path, with adhesion or without.

Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

SAFETY = 3.0  # ratio of a stated error to the change by a finer evaluation
MAXIMUM_ITERATIONS = 400  # limit: of a loop that should end by itself; then it is a named failure


@dataclass(frozen=True)
class Accuracy:
    """Accuracy of a state.

    Parameters
    ----------
    tolerance : float
        Tolerance of the evaluation.
    residual : float
        Largest |G/w - 1| of an equilibrium; without adhesion largest |K| over K of a flat punch of equal load.
    allowed : float
        Interpenetration that is not a contact, in units of the rms height.
    """

    tolerance: float
    residual: float
    allowed: float = 1e-10


COARSE = Accuracy(1e-3, 1e-4)
# derived: of targets at an accuracy.tolerance of 1e-6: a hundredth of it, and a tenth of that (bem/path_increments.py)
FINE = Accuracy(1e-8, 1e-9)


@dataclass(frozen=True)
class Increments:
    """Sizes of the increments in units of the control value, and accuracies.

    Parameters
    ----------
    largest, smallest, apart : float
        Increments; an event is resolved within the smallest, or less in thin layers; states stored between targets are
        `apart`.
    coarse, way, fine : Accuracy
        Of descents in a frozen field, of the path and its events, and of its targets.
    between : float
        Tolerance of evaluations between events, which only lead from one to the next.
    deepest : float
        Change of the penetration, in rms heights, up to which an increment may be longer than `largest`: under load a
        stiff contact hardly moves.
    """

    largest: float
    smallest: float
    apart: float
    coarse: Accuracy = COARSE
    way: Accuracy = FINE
    fine: Accuracy = FINE
    deepest: float = 0.05
    between: float = FINE.tolerance


@dataclass
class Effort:
    """Counts of work along a path.

    Attributes
    ----------
    evaluations, local_evaluations : int
        Evaluations of the forces on the edges of all patches, and of a few patches in the field of the others, which
        are not in results.  Evaluations that led nowhere are counted too.
    accepted, rejected : int
        Steps; steps that were too long are among the rejected.
    unlocated : int
        Ends of branches that were not located.
    cpu_elsewhere : float
        CPU seconds of other processes.
    """

    evaluations: int = 0
    local_evaluations: int = 0
    accepted: int = 0
    rejected: int = 0
    unlocated: int = 0
    cpu_elsewhere: float = 0.0
