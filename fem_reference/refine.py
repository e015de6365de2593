"""Every quantity with its uncertainty and observed order, from a sequence of meshes.

The problem is solved on meshes of increasing fineness h_k = 1 / cells_k (the closure, too, is closed anew on each).
For a quantity q with values q_1 .. q_n the observed order p solves

    |q_{n-1} - q_{n-2}| / |q_n - q_{n-1}| = (h_{n-2}^p - h_{n-1}^p) / (h_{n-1}^p - h_n^p)

(Roache, Verification and Validation in Computational Science and Engineering, 1998, ch. 5; for arrays in the largest
norm). The uncertainty of the finest value is that of `result`; on the coarser levels U_k = |q_k - q_n| + U_n. Nothing
is extrapolated.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from fem_reference.closure import ControlKind, Evaluation, evaluate
from fem_reference.mesh import Resolution
from fem_reference.problem import FloatArray, InvalidProblemError
from fem_reference.result import (
    ROUNDING,
    Quantity,
    Result,
    aligned_values,
    defect_spread,
    quantities,
    resolutions_of,
    spread,
    uncertainties,
)
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

ORDERS = (0.3, 20.0)  # an observed order outside is no order


@dataclass(frozen=True)
class Estimate:
    """A quantity on a sequence of meshes.

    Parameters
    ----------
    value, uncertainty : float or FloatArray
        On the finest mesh; unit as in `Result`.
    observed_order : float or None
        None when the differences do not decrease, or are down to rounding.
    levels, level_uncertainties : tuple
        The same on every mesh, coarsest first.
    """

    value: Quantity
    uncertainty: Quantity
    observed_order: float | None
    levels: tuple[Quantity, ...]
    level_uncertainties: tuple[Quantity, ...]


@dataclass(frozen=True)
class Refinement:
    """The state on the finest mesh and an estimate for every quantity.

    Parameters
    ----------
    result : Result
        On the finest mesh, its `uncertainty` taken from the estimates.
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


def observed_order(differences: Sequence[float], sizes: Sequence[float]) -> float | None:
    """Order p at which two successive differences (coarse, fine) agree with mesh sizes (coarse, middle, fine).

    Examples
    --------
    >>> observed_order([4.0**2 - 2.0**2, 2.0**2 - 1.0], [4.0, 2.0, 1.0])
    2.0
    """
    coarse, fine = differences
    if not (coarse > 0.0 and fine > 0.0):
        return None
    h1, h2, h3 = sizes

    def mismatch(p: float) -> float:
        return float(np.log((h1**p - h2**p) / (h2**p - h3**p)) - np.log(coarse / fine))

    low, high = ORDERS
    if mismatch(low) * mismatch(high) > 0.0:
        return None
    return round(float(brentq(mismatch, low, high, xtol=1e-10)), 9)


def estimate(name: str, evaluations: Sequence[Evaluation]) -> Estimate:
    """Estimate of one named quantity from solved meshes, coarsest first (at least two)."""
    values = aligned_values(name, evaluations)
    total = spread(values, resolutions_of(evaluations)) + defect_spread(name, evaluations[-1])
    steps = [float(np.max(np.abs(b - a), initial=0.0)) for a, b in pairwise(values)]
    order = None
    if len(steps) > 1 and steps[-1] > ROUNDING * np.max(np.abs(values[-1]), initial=0.0):
        order = observed_order(steps[-2:], [1.0 / e.resolution.cells for e in evaluations[-3:]])
    totals = [np.abs(v - values[-1]) + total for v in values[:-1]] + [total]
    return Estimate(_plain(values[-1]), _plain(total), order, tuple(map(_plain, values)), tuple(map(_plain, totals)))


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
        Coarsest first, one element order, at least three, cells increasing; by default P4/P3 with 6, 8 and 10 cells.

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
    """P4/P3 with 6, 8 and 10 cells per period, the tips following."""
    return companions(Resolution(4, 10, 20))
