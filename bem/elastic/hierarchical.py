"""Solution of the symmetric positive definite system of all patches, cluster by cluster.

Let A be the negated kernel between the nodes of a cluster of patches and b the columns that it must serve.  Wanted are
the Gram matrix b^T A^-1 b and, of few columns, the charges A^-1 b.  A small cluster is a leaf: Cholesky, A = U^T U and
Y = U^-T b.  A large one is split into two, between which the kernel is a short sum of products P C Q^T, the shorter the
wider the gap is in which they part (separated_kernel.py).  Each half serves its share of the columns, and those of P or
Q besides; with
X_1 = P^T A_1^-1 P, X_2 = Q^T A_2^-1 Q, V = [P^T A_1^-1 b; Q^T A_2^-1 b] and H = C X_2 C, block elimination gives

    b^T A^-1 b = b_1^T A_1^-1 b_1 + b_2^T A_2^-1 b_2 - V^T M V,
    M = [ -(H + H E H)     C + H E C ]      E = R (1 - R^T H R)^-1 R^T,   X_1 = R R^T,
        [   C + C E H     -C E C     ],

and A is positive definite exactly where both halves and 1 - R^T H R are.  Edge vectors live on their own patch, so that
the work grows hardly faster than the number of nodes.

Close to complete contact a uniform charge costs no energy, and A is nearly singular.  So all this is done for
A' = A + alpha 1 1^T, which is not; with g = b^T A'^-1 1 and s = 1^T A'^-1 1 the Sherman-Morrison formula leads back,

    b^T A^-1 b = b^T A'^-1 b + alpha g g^T / (1 - alpha s).

Rounding of s then acts like one of alpha on everything at once, and states of given load hardly feel it.
A layer adds waves to the kernel, A = A' - V D V^T with the signs D = +-1 and the columns V of cosines and sines: they
are columns like others, and with W = (D - V^T A'^-1 V)^-1 the formula of Woodbury,

    b^T A^-1 c = b^T A'^-1 c + (b^T A'^-1 V) W (V^T A'^-1 c),

brings them in.  Where the waves are not few beside the nodes their sum is added to the matrix of a single leaf.
Source of such factorisations: Martinsson and Rokhlin, J. Comput. Phys. 205 (2005) 1.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ParamSpec, TypeVar

import numpy as np
from scipy.linalg import lapack

from bem.elastic.separated_kernel import RANGE_STEP, modes_and_core, range_steps
from bem.elastic.skeleton import Skeleton
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.chebyshev import packed_bases
from bem.kernels import clusters

Given = ParamSpec("Given")
Value = TypeVar("Value")
Ranges = list[tuple[FloatArray, int, FloatArray] | None]

UNIFORM = 0.03  # derived: alpha; any value does, to rounding: a whole period has eigenvalues 0 and 1 / (2 n)
LARGEST_LEAF = 130  # speed: unknowns, above which a cluster of several patches is split (measured)
LEAF: tuple[IntArray, FloatArray, Ranges] = np.array([-1]), np.zeros((1, 4)), [None]  # cuts, arcs, ranges of one leaf


class IllConditionedSystemError(ArithmeticError):
    """Skeleton matrix too large, or not positive definite to rounding: contact almost complete."""


def if_solvable(evaluation: Callable[Given, Value], *inputs: Given.args, **options: Given.kwargs) -> Value | None:
    """Return the result of an evaluation; None if its system is ill-conditioned and the caller can go on without."""
    try:
        return evaluation(*inputs, **options)
    except IllConditionedSystemError:
        return None


@dataclass(frozen=True, eq=False)
class Solution:
    """Solution of the system of all patches.

    Attributes
    ----------
    compliance : (2 L, 2 L) array
        b^T A^-1 b of the edge vectors, left ones first; (0, 0) where it was not asked for.
    slope_compliance : (2 L, 2 L) array
        s^T A^-1 b of the slope vectors s, by rows, and the edge vectors b; (0, 2 L) where it was not asked for.
    gram : (k, k) array
        b^T A^-1 b of the columns.
    charges : (k, n) array
        A^-1 b of the columns.
    at_edges, slopes : (k, 2 L) arrays
        q of these charges at the edges, and sum n^2 (+-1)^n Q_n.
    """

    compliance: FloatArray
    slope_compliance: FloatArray
    gram: FloatArray
    charges: FloatArray
    at_edges: FloatArray
    slopes: FloatArray


def solve(skeleton: Skeleton, accuracy: float) -> Solution:
    """Solve the system of all patches.

    Parameters
    ----------
    skeleton : Skeleton
    accuracy : float
        Absolute, of the kernel between clusters.

    Raises
    ------
    IllConditionedSystemError
        The matrix is not positive definite.
    """
    coupling = skeleton.coupling
    waves = None if coupling is None else coupling.waves
    if waves is not None:
        skeleton = replace(skeleton, columns=np.concatenate([skeleton.columns, waves.columns]))
    solution = _solved(skeleton, accuracy)
    if solution is not None and waves is not None:
        solution = _with_waves(solution, waves.signs, skeleton)
    if solution is None:
        raise IllConditionedSystemError(f"skeleton matrix of {skeleton.x.size} unknowns is not positive definite")
    if coupling is not None and coupling.left_out is not None and solution.compliance.size:
        edge, (same, other) = np.arange(2 * skeleton.patches.count), np.tile(coupling.left_out.compliance, 2)
        solution.compliance[edge, edge] += same
        solution.compliance[edge, np.roll(edge, skeleton.patches.count)] += other
    return solution


def _with_waves(without: Solution, signs: FloatArray, skeleton: Skeleton) -> Solution | None:
    """Add the waves, the last columns, to the kernel; return the solution, None where A is not positive definite.

    With V_+ the columns of positive sign, A is positive definite exactly where 1 - V_+^T A'^-1 V_+ is.
    """
    count = without.gram.shape[0] - signs.size
    gram, adding = without.gram[count:, count:], signs > 0
    _, info = lapack.dpotrf(np.eye(int(adding.sum())) - gram[adding][:, adding])
    if info != 0:
        return None
    of_edges = skeleton.of_edges(without.charges[count:])
    seen = np.concatenate([without.gram[count:, :count], of_edges], axis=1)
    response = np.linalg.solve(np.diag(signs) - gram, seen)
    amounts, by_edges = response[:, :count].T, response[:, count:]
    compliance, bent = without.compliance, without.slope_compliance
    if compliance.size:
        compliance = compliance + of_edges.T @ by_edges
    if bent.size:
        bent = bent + without.slopes[count:].T @ by_edges
    return Solution(
        compliance=compliance,
        slope_compliance=bent,
        gram=without.gram[:count, :count] + amounts @ seen[:, :count],
        charges=without.charges[:count] + amounts @ without.charges[count:],
        at_edges=without.at_edges[:count] + amounts @ without.at_edges[count:],
        slopes=without.slopes[:count] + amounts @ without.slopes[count:],
    )


def _solved(skeleton: Skeleton, accuracy: float) -> Solution | None:
    """Return the solution on the half-space with the added matrix; None where A is not positive definite."""
    patches, coupling = skeleton.patches, skeleton.coupling
    addition = None if coupling is None else coupling.matrix
    left_out = None if coupling is None else coupling.left_out
    starts = np.zeros(patches.count + 1, np.int64)
    skeleton.modes.cumsum(out=starts[1:])
    cuts, arcs, ranges = LEAF
    if addition is None and skeleton.x.size > LARGEST_LEAF:
        cuts, arcs = clusters.splits(skeleton.x, patches.left, patches.right, starts, LARGEST_LEAF)
        ranges = [None] * cuts.size
        for place in np.flatnonzero(cuts >= 0).tolist():
            low, high = arcs[place, 2:].tolist()
            steps = range_steps((high - low) / 2)
            ranges[place] = modes_and_core(steps, accuracy)
            arcs[place, 2:] = (low + high) / 2, RANGE_STEP**steps
    solution = clusters.solved(
        skeleton.x,
        patches.half_width,
        starts,
        *packed_bases(skeleton.modes),
        skeleton.columns,
        cuts,
        arcs,
        ranges,
        UNIFORM,
        skeleton.edge_columns,
        addition,
        None if left_out is None else left_out.fields,
    )
    return None if solution is None else Solution(*solution)
