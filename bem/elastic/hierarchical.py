"""The symmetric positive definite system of all patches, solved cluster by cluster.

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
from itertools import pairwise
from typing import ParamSpec, Protocol, TypeVar

import numpy as np
from scipy.linalg import lapack

from bem.compiled.kernels import mirrored
from bem.elastic.half_space import between_nodes
from bem.elastic.separated_kernel import separated_kernel
from bem.elastic.skeleton import Skeleton
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI

Inputs = ParamSpec("Inputs")
Output = TypeVar("Output")

UNIFORM = 0.03  # alpha: any value does, to rounding; the kernel of a whole period has eigenvalues 0 and 1 / (2 n)
LARGEST_LEAF = 130  # speed: unknowns, above which a cluster of several patches is split (measured)
CENTRED = 10.0  # speed: a cluster is split in a gap e times wider, if that is off its middle by less than a tenth
MOST_OFF = 0.25  # limit: and by no more than this, unless all are: clusters of clusters stay few
FEWEST_BLOCKED, BLOCK_ROWS, MOST_BLOCKS = 350, 125, 8  # speed: forward substitution by blocks of rows (measured)


class IllConditionedSystemError(ArithmeticError):
    """The skeleton matrix is too large, or not positive definite to rounding: contact almost complete."""


def if_solvable(evaluation: Callable[Inputs, Output], *inputs: Inputs.args, **options: Inputs.kwargs) -> Output | None:
    """The result of an evaluation; None where its system is ill-conditioned, a status to those who can go elsewhere."""
    try:
        return evaluation(*inputs, **options)
    except IllConditionedSystemError:
        return None


@dataclass(frozen=True)
class Splitting:
    """How a system is split.

    Parameters
    ----------
    accuracy : float
        Absolute, of the kernel between clusters.
    largest : int
        Unknowns above which a cluster of several patches is split.
    uniform : float
        alpha.
    """

    accuracy: float
    largest: int
    uniform: float


@dataclass(frozen=True, eq=False)
class Solution:
    """What the system of all patches gives.

    Attributes
    ----------
    compliance : (2 L, 2 L) array
        b^T A^-1 b of the edge vectors, left ones first; (0, 0) where it was not asked for.
    slope_compliance : (2 L, 2 L) array
        The same of the vectors of slopes, by rows, and the edge vectors; (0, 2 L) where it was not asked for.
    gram : (k, k) array
        The same of the columns.
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


class Cluster(Protocol):
    """Solved patches; the columns are those shared by all clusters above, then the edges, patch by patch."""

    @property
    def gram(self) -> FloatArray:
        """b^T A^-1 b of all columns."""
        ...

    def charges(self, amounts: FloatArray) -> FloatArray:
        """A^-1 b of the shared columns in these amounts, (n_shared, k) to (n, k)."""
        ...


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
    found = solved(skeleton, Splitting(accuracy, LARGEST_LEAF, UNIFORM))
    solution = None if found is None else Solution(*found)
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
    """The solution with waves added to the kernel, which are its last columns; None where A is not positive definite.

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


@mirrored
def solved(
    skeleton: Skeleton, splitting: Splitting
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray] | None:
    """What `Solution` holds; None where A is not positive definite."""
    count, patches = skeleton.columns.shape[0], skeleton.patches.count
    whole = if_solvable(_cluster, skeleton, 0, skeleton.patches.count, skeleton.columns.T, splitting)
    if whole is None:
        return None
    gram, charges = whole.gram, whole.charges(np.eye(count)).T
    order = np.arange(count, gram.shape[0]).reshape(patches, -1).T.ravel()  # from patch by patch to left edges first
    edges, bent = order[: 2 * patches], order[2 * patches :]
    remaining = 1 - splitting.uniform * gram[1, 1]
    if remaining <= 0:
        return None
    change = gram[1] * (splitting.uniform / remaining)
    gram = gram + np.outer(change, gram[1])
    found = charges, *skeleton.at_edges_of(charges)
    charges, at_edges, slopes = (values + np.outer(change[:count], values[1]) for values in found)
    return gram[edges[:, None], edges], gram[bent[:, None], edges], gram[:count, :count], charges, at_edges, slopes


def _cluster(skeleton: Skeleton, first: int, last: int, shared: FloatArray, splitting: Splitting) -> Cluster:
    """Patches from `first` to before `last`, with the shared columns at their nodes."""
    starts, patches = skeleton.coupled.starts, skeleton.patches
    if last - first == 1 or starts[last] - starts[first] <= splitting.largest or skeleton.addition is not None:
        return _leaf(skeleton, first, last, shared, splitting.uniform)
    off = np.abs(starts[first + 1 : last] - (starts[first] + starts[last]) / 2) / (starts[last] - starts[first])
    gap = patches.gap_after[first : last - 1]
    wider = np.minimum(np.log(gap / gap[np.argmin(off)]), CENTRED * MOST_OFF)
    middle = first + 1 + int(np.argmin(CENTRED * off - wider))
    behind = (patches.left[first] - patches.right[last - 1]) % TWO_PI
    kernel = separated_kernel(
        skeleton.x[starts[first] : starts[last]],
        patches.right[middle - 1] + patches.gap_after[middle - 1] / 2,
        patches.right[last - 1] + behind / 2,
        splitting.accuracy,
    )
    wider = np.concatenate([shared, kernel.columns], axis=1)
    split = int(starts[middle] - starts[first])
    halves = (
        _cluster(skeleton, first, middle, wider[:split], splitting),
        _cluster(skeleton, middle, last, wider[split:], splitting),
    )
    core = -kernel.core
    core[1, 1] += splitting.uniform  # the second column is 1
    return _joined(halves, core, shared.shape[1])


@dataclass(frozen=True, eq=False)
class _Leaf:
    """A cluster solved by Cholesky: U with A' = U^T U, and Y of the shared columns."""

    gram: FloatArray
    factor: FloatArray
    solved: FloatArray

    def charges(self, amounts: FloatArray) -> FloatArray:
        """A^-1 b by back substitution."""
        found, _ = lapack.dtrtrs(self.factor, self.solved @ amounts, lower=0, trans=0)
        return np.asarray(found)


def _leaf(skeleton: Skeleton, first: int, last: int, shared: FloatArray, uniform: float) -> _Leaf:
    """Patches from `first` to before `last` solved by Cholesky."""
    nodes = slice(int(skeleton.coupled.starts[first]), int(skeleton.coupled.starts[last]))
    starts = skeleton.coupled.starts[first : last + 1] - nodes.start
    x, size = skeleton.x[nodes], int(starts[-1])
    matrix = between_nodes(x)
    for (start, end), block in zip(pairwise(starts.tolist()), skeleton.within[first:last], strict=True):
        matrix[start:end, start:end] = block
    if skeleton.addition is not None:
        matrix += skeleton.addition
    np.subtract(uniform, matrix, out=matrix)
    factor, info = lapack.dpotrf(matrix.T, lower=0, clean=0, overwrite_a=1)
    if info != 0:
        raise IllConditionedSystemError(f"skeleton matrix of {size} unknowns is not positive definite")
    count, row = shared.shape[1], np.arange(size)
    begin = np.concatenate([np.zeros(count, dtype=np.int64), np.repeat(starts[:-1], skeleton.edge_columns)])
    rhs = np.zeros((size, begin.size), order="F")
    rhs[:, :count] = shared
    first_column = count + skeleton.edge_columns * np.repeat(np.arange(last - first), np.diff(starts))
    for column in range(skeleton.edge_columns):
        rhs[row, first_column + column] = skeleton.edge_vectors[column, nodes]
    gram, seen = _gram(factor, rhs, begin, count)
    return _Leaf(gram, factor, seen)


def _gram(factor: FloatArray, rhs: FloatArray, begin: IntArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Y^T Y for Y = U^-T rhs, and the first columns of Y.

    A column of Y is zero above the first entry of its right-hand side, and the columns begin one after the other: by
    blocks of rows a third of the work remains.
    """
    size = rhs.shape[0]
    if size < FEWEST_BLOCKED:
        solved, _ = lapack.dtrtrs(factor, rhs, lower=0, trans=1, overwrite_b=1)
        return solved.T @ solved, solved[:, :count]
    ends = np.linspace(0, size, min(size // BLOCK_ROWS, MOST_BLOCKS) + 1).astype(np.int64)
    gram = np.zeros((rhs.shape[1], rhs.shape[1]))
    blocks: list[FloatArray] = []
    for start, end in pairwise(ends.tolist()):
        active = int(np.searchsorted(begin, end))
        block = np.asfortranarray(rhs[start:end, :active])
        for (first, last), done in zip(pairwise(ends.tolist()), blocks, strict=False):
            block[:, : done.shape[1]] -= factor[first:last, start:end].T @ done
        block, _ = lapack.dtrtrs(factor[start:end, start:end], block, lower=0, trans=1, overwrite_b=1)
        gram[:active, :active] += block.T @ block
        blocks.append(block)
    return gram, np.concatenate([block[:, :count] for block in blocks])


@dataclass(frozen=True, eq=False)
class _Pair:
    """A cluster of two: M V of the shared columns, which go to the columns of the kernel between the halves."""

    gram: FloatArray
    halves: tuple[Cluster, Cluster]
    response: FloatArray

    def charges(self, amounts: FloatArray) -> FloatArray:
        """A^-1 b of both halves, each with what the other does to it."""
        into = -self.response @ amounts
        rank = into.shape[0] // 2
        parts = [
            half.charges(np.concatenate([amounts, part]))
            for half, part in zip(self.halves, (into[:rank], into[rank:]), strict=True)
        ]
        return np.concatenate(parts)


def _joined(halves: tuple[Cluster, Cluster], core: FloatArray, count: int) -> _Pair:
    """Two clusters with the kernel P C Q^T between them; `count` columns are shared from above."""
    found = _joined_gram(halves[0].gram, halves[1].gram, core, count)
    if found is None:
        raise IllConditionedSystemError("the skeleton matrix of two clusters is not positive definite")
    return _Pair(found[0], halves, found[1])


def _joined_gram(
    first: FloatArray, second: FloatArray, core: FloatArray, count: int
) -> tuple[FloatArray, FloatArray] | None:
    """b^T A'^-1 b of two clusters, (m, m), and M V of the columns shared from above, (2 q, count).

    None where the matrix is not positive definite.
    """
    rank = core.shape[0]
    own = slice(count, count + rank)
    edges = slice(count, first.shape[0] - rank), slice(first.shape[0] - rank, None)
    size = first.shape[0] + second.shape[0] - 2 * rank - count
    gram, seen = np.zeros((size, size)), np.zeros((2 * rank, size))
    for part, place, rows in zip((first, second), edges, (slice(0, rank), slice(rank, None)), strict=True):
        above, beyond = slice(0, count), slice(count + rank, None)
        gram[above, above] += part[above, above]
        gram[above, place] = part[above, beyond]
        gram[place, above] = part[beyond, above]
        gram[place, place] = part[beyond, beyond]
        seen[rows, above] = part[own, above]
        seen[rows, place] = part[own, beyond]
    middle = _middle(first[own, own], second[own, own], core)
    if middle is None:
        return None
    response = middle @ seen
    gram -= seen.T @ response
    return gram, response[:, :count]


def _middle(first: FloatArray, second: FloatArray, core: FloatArray) -> FloatArray | None:
    """M of two halves from X_1, X_2 and C; None where the matrix is not positive definite."""
    size = core.shape[0]
    factor, pivots, rank, _ = lapack.dpstrf(first, lower=1)
    root = np.zeros((size, rank))
    root[pivots - 1] = np.tril(factor)[:, :rank]
    turned = core @ second @ core
    factor, info = lapack.dpotrf(np.eye(rank) - root.T @ turned @ root, lower=1)
    if info != 0:
        return None
    scaled, _ = lapack.dtrtrs(factor, root.T, lower=1)
    inner = scaled.T @ scaled
    through = turned @ inner
    middle = np.empty((2 * size, 2 * size))
    middle[:size, :size] = -(turned + through @ turned)
    middle[:size, size:] = core + through @ core
    middle[size:, :size] = middle[:size, size:].T
    middle[size:, size:] = -core @ inner @ core
    return middle
