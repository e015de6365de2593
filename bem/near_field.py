"""Elimination of the Chebyshev modes of contact patches that only near patches share.

Mode n of patch i feels patch j like rho_ij^-n, where rho_ij is the Bernstein ellipse of patch i that reaches to j, and
what modes n and m do to one another falls like rho_ij^-n rho_ji^-m.  So of the p_i modes that couple at all, the high
ones, n >= m_i with rho^-m_i the root of the tolerance, feel only a few near patches, and one another not at all: the
matrix of the high modes is the diagonal D of the logarithm, and

    [S] = A_FF - B^T D^-1 B,    b' = b_F - B^T D^-1 b_N,    b^T A^-1 b = b'^T S^-1 b' + b_N^T D^-1 b_N

is a system for the m_i low modes alone, half as many unknowns.  Low modes are kept as charges at m_i nodes, which is
all that far patches see of them; between near patches (those that feel mode m_i) they are carried to the p_i nodes, by
E_i, together with the high modes, by N_i: block X_i^T K_ij X_j with X = [E | N].

Source: the discretisation of collocation.py; elimination is that of block Gauss, exact but for what is below the
tolerance.  Dimensionless.  Limits: half-space (a layer couples high modes of all patches); matrix of the high modes
with all low ones in memory.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bem import chebyshev
from bem.patches import TWO_PI, Patches

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SHARE = 0.01  # of the tolerance: couplings dropped; what that changes is less than what p_i leaves out (measured)
WORTHWHILE = 600  # cube root of the unknowns cubed that must be saved: what the work with pairs costs (measured)
PADDED_RATIO = 1.5  # steps of the sizes to which blocks of pairs are filled up


@dataclass(frozen=True, eq=False)
class Elimination:
    """What is left out of a system of low modes, and how it comes back.

    Attributes
    ----------
    patches : Patches
    modes, kept : (L,) int arrays
        p_i and m_i.
    near : (L, L) bool array
        Pairs of patches whose high modes matter to either; symmetric, no patch is near to itself.
    """

    patches: Patches
    modes: IntArray
    kept: IntArray
    near: NDArray[np.bool_]

    @property
    def is_worthwhile(self) -> bool:
        """Whether the factorisation that is saved takes longer than the elimination."""
        return float(self.modes.sum()) ** 3 - float(self.kept.sum()) ** 3 > WORTHWHILE**3

    def reduce(self, matrix: FloatArray, rhs: FloatArray, series: tuple[FloatArray, ...]) -> Reduced:
        """Eliminate in place.

        Parameters
        ----------
        matrix : (n, n) array
            -log|2 sin| between charges at the kept nodes; only the lower triangle is brought up to date.
        rhs : (n, 2 L + 2) array
            Edge vectors, R and 1 at those nodes.
        series : tuple of L arrays
            Coefficients C_n of R.
        """
        count = self.patches.count
        low = np.concatenate([[0], np.cumsum(self.kept)])
        high = np.concatenate([[0], np.cumsum(self.modes - self.kept)])
        coupling = np.zeros((int(high[-1]), int(low[-1])))
        self._add_near_pairs(matrix, coupling, low, high)
        counts = self.modes - self.kept
        owner = np.repeat(np.arange(count), counts)
        order = np.arange(owner.size) - (high[:-1] - self.kept)[owner]
        roots = np.sqrt(2.0 * order) / np.pi  # D^-1/2, D = pi^2 / (2 n)
        amplitude = np.concatenate([part[m:p] for part, m, p in zip(series, self.kept, self.modes, strict=True)])
        forces = np.stack([np.where(order % 2 == 0, roots, -roots), roots, (np.pi / 2) * roots * amplitude], axis=1)
        coupling *= roots[:, None]
        for i in np.flatnonzero((counts > 0) & self.near.any(axis=1)).tolist():
            around = np.flatnonzero(self.near[i])
            first, last = int(around[0]), int(around[-1])
            if last - first < count // 2:
                part: slice | IntArray = slice(low[first], low[last + 1])
                square: tuple[slice | IntArray, slice | IntArray] = (part, part)
            else:  # across the end of the period
                part = np.concatenate([np.arange(low[j], low[j + 1]) for j in around])
                square = (part[:, None], part)
            rows = slice(high[i], high[i + 1])
            block = coupling[rows][:, part]
            matrix[square] -= block.T @ block
            at_edges = block.T @ forces[rows, :2]
            rhs[part, i] -= at_edges[:, 0]
            rhs[part, count + i] -= at_edges[:, 1]
        rhs[:, -2] -= forces[:, 2] @ coupling
        return Reduced(self, coupling, roots, forces[:, 2], self._gram_of(forces, owner))

    def _gram_of(self, forces: FloatArray, owner: IntArray) -> FloatArray:
        """b_N^T D^-1 b_N, (2 L + 2, 2 L + 2), from the rows of D^-1/2 b_N at the edges of their patches and R."""
        count = self.patches.count
        place = np.arange(count)
        gram = np.zeros((2 * count + 2, 2 * count + 2))
        columns = (place, count + place, np.full(count, 2 * count))
        for a in range(3):
            for b in range(3):
                products = np.bincount(owner, forces[:, a] * forces[:, b], count)
                np.add.at(gram, (columns[a], columns[b]), products)
        return gram

    def _add_near_pairs(self, matrix: FloatArray, coupling: FloatArray, low: IntArray, high: IntArray) -> None:
        """Replace the kernel between near patches, and set what their high modes do to low ones."""
        patches, modes, kept = self.patches, self.modes, self.kept
        first, second = np.nonzero(np.triu(self.near))
        if first.size == 0:
            return
        padded = chebyshev.rounded_up(np.maximum(modes[first], modes[second]).astype(np.float64), PADDED_RATIO)
        sizes = np.stack([modes, kept], axis=1)
        kinds, kind = np.unique(sizes, axis=0, return_inverse=True)
        kind = kind.ravel()
        most = int(padded.max())
        bases, nodes = np.zeros((len(kinds), most, most)), np.zeros((len(kinds), most))
        for k, (p, m) in enumerate(kinds):
            if p > most:  # in no pair
                continue
            bases[k, :p, :p] = _basis(int(p), int(m))
            nodes[k, :p] = chebyshev.basis_nodes(int(p))
        x = (patches.center[:, None] + patches.half_width[:, None] * nodes[kind]) / 2
        sine, cosine = np.sin(x), np.cos(x)
        flat, flat_coupling = matrix.reshape(-1), coupling.reshape(-1)
        for size in np.unique(padded):
            pairs = padded == size
            i, j = first[pairs], second[pairs]
            kernel = sine[j, :size, None] * cosine[i, None, :size] - cosine[j, :size, None] * sine[i, None, :size]
            np.abs(kernel, out=kernel)
            kernel *= 2
            np.log(kernel, out=kernel)
            block = -(bases[kind[j], :size, :size].transpose(0, 2, 1) @ kernel @ bases[kind[i], :size, :size])
            place = np.arange(size)
            low_i, low_j = place < kept[i, None], place < kept[j, None]
            high_i, high_j = (place < modes[i, None]) & ~low_i, (place < modes[j, None]) & ~low_j
            at_i, at_j = low[i, None] + place, low[j, None] + place
            over_i, over_j = high[i, None] + place - kept[i, None], high[j, None] + place - kept[j, None]
            width = matrix.shape[0]
            here = low_j[:, :, None] & low_i[:, None, :]
            flat[(at_j[:, :, None] * width + at_i[:, None, :])[here]] = block[here]
            here = high_j[:, :, None] & low_i[:, None, :]
            flat_coupling[(over_j[:, :, None] * width + at_i[:, None, :])[here]] = block[here]
            here = low_j[:, :, None] & high_i[:, None, :]
            flat_coupling[(over_i[:, None, :] * width + at_j[:, :, None])[here]] = block[here]


@dataclass(frozen=True, eq=False)
class Reduced:
    """An elimination carried out: B D^-1/2, D^-1/2, R of the high modes over the root of D, and their share of G."""

    elimination: Elimination
    coupling: FloatArray
    roots: FloatArray
    force: FloatArray
    gram: FloatArray

    def expanded(self, charges: FloatArray) -> FloatArray:
        """Charges at all p_i nodes from those at the kept ones, for R and 1; (n, 2) to (unknowns, 2)."""
        of = self.elimination
        amplitudes = -(self.coupling @ charges)
        amplitudes[:, 0] += self.force
        amplitudes *= self.roots[:, None]
        result = np.empty((int(of.modes.sum()), charges.shape[1]))
        start = low = high = 0
        for p, m in zip(of.modes.tolist(), of.kept.tolist(), strict=True):
            both = np.concatenate([charges[low : low + m], amplitudes[high : high + p - m]])
            result[start : start + p] = _basis(p, m) @ both
            start, low, high = start + p, low + m, high + p - m
        return result


def elimination(patches: Patches, modes: IntArray, tolerance: float) -> Elimination:
    """Which modes of these patches can be eliminated, at a tolerance of the coupling.

    Parameters
    ----------
    patches : Patches
    modes : (L,) int array
        Modes p_i that couple at all.
    tolerance : float
        As of an evaluation.
    """
    dropped = -np.log(SHARE * tolerance)
    width, count = patches.width, patches.count
    nearest = _decay(width, np.minimum(patches.gap_before, patches.gap_after))
    wanted = (dropped / 2 - np.log(-np.expm1(-nearest))) / nearest + 2.0  # all modes from m_i on together
    itself = dropped / _decay(width, TWO_PI - width) + 2.0  # what a patch feels of its own images
    kept = np.minimum(np.ceil(np.maximum(wanted, itself)).astype(np.int64), modes)
    behind = (patches.left - patches.right[:, None]) % TWO_PI
    decay = _decay(width[:, None], np.minimum(behind, behind.T))
    feels = (decay * (kept[:, None] - 1) < dropped) & (kept < modes)[:, None]
    feels[np.arange(count), np.arange(count)] = False
    return Elimination(patches, modes, kept, feels | feels.T)


def _decay(width: FloatArray, distance: FloatArray) -> FloatArray:
    """log rho of the Bernstein ellipse of patches that reaches to a distance from their edges."""
    z = 2 * distance / width
    return np.asarray(np.log1p(z + np.sqrt(z * (2 + z))))


@lru_cache(maxsize=1024)
def _basis(modes: int, kept: int) -> FloatArray:
    """X = [E | N], from charges at the kept nodes and high modes to charges at all nodes, (modes, modes)."""
    values = chebyshev.basis(modes).values * (np.pi / modes)
    weight = np.where(np.arange(kept) == 0, 1.0, 2.0) / np.pi
    carried = (values[:, :kept] * weight) @ chebyshev.basis(kept).values.T
    return np.concatenate([carried, values[:, kept:]], axis=1)
