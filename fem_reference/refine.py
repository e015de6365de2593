"""Every quantity with its uncertainty and observed order, from a sequence of meshes.

The problem is solved on meshes of increasing fineness; the closure, too, is closed anew on each. Uncertainty and order
are those of `uncertainty`. Nothing is extrapolated.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from fem_reference.closure import ControlKind, Evaluation, evaluate
from fem_reference.mesh import Resolution
from fem_reference.problem import FloatArray, InvalidProblemError
from fem_reference.result import Quantity, Result, aligned_values, quantities, sizes_of, uncertainties
from fem_reference.solve import (
    Edges,
    Harmonics,
    closed,
    companions,
    control_of,
    judged,
    judged_closure,
    prescribed,
    problem_of,
)
from fem_reference.uncertainty import fitted


@dataclass(frozen=True)
class Estimate:
    """A quantity on a sequence of meshes.

    Parameters
    ----------
    value, uncertainty : float or FloatArray
        On the finest mesh; unit as in `Result`.
    observed_order : float or FloatArray
        nan where the values show none.
    levels : tuple
        Values on every mesh, coarsest first.
    """

    value: Quantity
    uncertainty: Quantity
    observed_order: Quantity
    levels: tuple[Quantity, ...]


@dataclass(frozen=True)
class Refinement:
    """The state on the finest mesh, with its uncertainties, and an estimate for every quantity.

    Parameters
    ----------
    result : Result
    resolutions : tuple of Resolution
        Coarsest first.
    estimates : mapping
        From the names in `Result` to `Estimate`; empty when the closure failed on some mesh.
    """

    result: Result
    resolutions: tuple[Resolution, ...]
    estimates: Mapping[str, Estimate]

    @property
    def status(self) -> str:
        """Status of the finest result."""
        return self.result.status


def estimate(name: str, evaluations: Sequence[Evaluation]) -> Estimate:
    """Return the estimate of one named quantity from solved meshes, coarsest first (at least two)."""
    values = aligned_values(name, evaluations)
    resolutions = [evaluation.resolution for evaluation in evaluations]
    total, order = fitted(values, sizes_of(resolutions), 2 * resolutions[-1].order)
    return Estimate(_plain(values[-1]), _plain(total), _plain(order), tuple(map(_plain, values)))


def _plain(value: FloatArray) -> Quantity:
    return float(value) if value.ndim == 0 else value


def refine(
    *,
    youngs_modulus: float,
    poisson_ratio: float,
    thickness: float,
    period: float,
    harmonics: Harmonics,
    control: ControlKind,
    value: float,
    work_of_adhesion: float = 0.0,
    slope_term: bool = False,
    edges: Edges = None,
    patches: int = 1,
    start_scale: float = 1.0,
    resolutions: Sequence[Resolution] | None = None,
) -> Refinement:
    """Solve on a sequence of meshes; arguments as in `fem_reference.solve`.

    Parameters
    ----------
    resolutions : sequence of Resolution, optional
        Coarsest first, one element order, at least three, cells increasing; by default P4/P3 with 5, 8 and 10 cells.

    Raises
    ------
    InvalidProblemError
        Naming the argument at fault.
    """
    ladder = default_ladder() if resolutions is None else list(resolutions)
    if len(ladder) < 3 or any(r.order != ladder[0].order for r in ladder):
        raise InvalidProblemError("resolutions", "needs three or more members of one element order")
    if any(b.cells <= a.cells for a, b in pairwise(ladder)):
        raise InvalidProblemError("resolutions", "cells must increase from one member to the next")
    problem = problem_of(youngs_modulus, poisson_ratio, thickness, period, harmonics, work_of_adhesion, slope_term)
    wanted = control_of(problem, control, value)
    if edges is None:
        closures = closed(problem, wanted, ladder, patches, start_scale)
        result = judged_closure(problem, closures)
        if len(closures) <= len(ladder) or closures[-1].outcome != "converged":
            return Refinement(result, tuple(ladder), {})
        evaluations = [closure.evaluation for closure in closures[1:]]
    else:
        evaluations = [evaluate(problem, mesh, r, wanted) for r, mesh in prescribed(problem, wanted, edges, ladder)]
        result = judged(evaluations[-1], uncertainties(evaluations), None)
    estimates = {name: estimate(name, evaluations) for name in quantities(evaluations[-1])}
    return Refinement(result, tuple(ladder), estimates)


def default_ladder() -> list[Resolution]:
    """Return P4/P3 with 5, 8 and 10 cells per period, the tips following."""
    return companions(Resolution(4, 10, 20))
