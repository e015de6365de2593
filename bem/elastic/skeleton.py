"""What is solved for: the nodal charges of all patches, and what an effect adds to the kernel between them.

The matrix is the negated kernel between the nodes of all patches, the right-hand sides are the columns that every patch
shares, and the edge vectors of each patch.  An effect adds a matrix, or a sum of few products of waves, and what modes
that are not coupled do at the nodes.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bem.elastic.half_space import within_patch
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.chebyshev import BySize, basis, by_size
from bem.geometry.patches import Patches


@dataclass(frozen=True, eq=False)
class Waves:
    """V D V^T, what is added to the kernel of the half-space at the nodes.

    Attributes
    ----------
    columns : (k, n) array
        V^T.
    signs : (k,) array
        D, 1 or -1.
    """

    columns: FloatArray
    signs: FloatArray


@dataclass(frozen=True, eq=False)
class LeftOut:
    """What an effect makes of those modes of the edge vectors that are not coupled.

    Attributes
    ----------
    fields : (2, n) array
        Of the left and of the right edge at the nodes of their patch.
    compliance : (2, L) array
        Felt by the edge that they belong to, and by the other edge of the patch.
    """

    fields: FloatArray
    compliance: FloatArray


@dataclass(frozen=True, eq=False)
class Coupling:
    """What an effect adds to the kernel of the half-space between the coupled modes.

    Attributes
    ----------
    matrix : (n, n) array or None
        At the nodes; it asks for a single leaf.
    waves : Waves or None
        The same as a sum of few products.
    left_out : LeftOut or None
        None where it couples no others.
    """

    matrix: FloatArray | None
    waves: Waves | None
    left_out: LeftOut | None = None


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The nodes of all patches, in their order.

    Attributes
    ----------
    patches : Patches
    modes : (L,) int array
        Nodes of each patch.
    x : (n,) array
        Positions.
    columns : (k, n) array
        Right-hand sides: the force, 1, and others.
    coupling : Coupling or None
        What is added to the half-space.
    edge_columns : int
        Columns that b has for each patch: none; 2, the edge vectors; or 4, those of slopes at the edges as well.
    """

    patches: Patches
    modes: IntArray
    x: FloatArray
    columns: FloatArray
    coupling: Coupling | None = None
    edge_columns: int = 2

    @cached_property
    def coupled(self) -> BySize:
        """The patches by their numbers of modes."""
        return by_size(self.modes)

    @cached_property
    def within(self) -> list[FloatArray]:
        """Kernel within each patch, L of (p_i, p_i)."""
        blocks: list[FloatArray] = [np.empty((0, 0))] * self.patches.count
        for modes, members in self.coupled.classes:
            together = within_patch(self.patches.half_width[members], basis(modes))
            for i, block in zip(members, together, strict=True):
                blocks[i] = block
        return blocks

    @cached_property
    def at_edges(self) -> FloatArray:
        """What takes nodal charges to q and to sum n^2 (+-1)^n Q_n at the edges of their patch, left first, (4, n)."""
        tables = [basis(modes) for modes in self.modes.tolist()]
        return np.concatenate([np.concatenate([one.at_edges, one.slopes_at_edges]) for one in tables], axis=1)

    @property
    def addition(self) -> FloatArray | None:
        """To the matrix, (n, n)."""
        return None if self.coupling is None else self.coupling.matrix

    @cached_property
    def edge_vectors(self) -> FloatArray:
        """`at_edges`, with what modes that are not coupled do at the nodes added to the edge vectors, (4, n)."""
        if self.coupling is None or self.coupling.left_out is None:
            return self.at_edges
        return np.concatenate([self.at_edges[:2] + self.coupling.left_out.fields, self.at_edges[2:]])

    def at_edges_of(self, charges: FloatArray) -> tuple[FloatArray, FloatArray]:
        """q of nodal charges, (k, n), at the edges, and sum n^2 (+-1)^n Q_n, (k, 2 L) each, left edges first."""
        sums = np.add.reduceat(charges[:, None] * self.at_edges, self.coupled.starts[:-1], axis=2)
        return sums[:, :2].reshape(len(charges), -1), sums[:, 2:].reshape(len(charges), -1)

    def of_edges(self, charges: FloatArray) -> FloatArray:
        """Products of the edge vectors with nodal charges, (k, n) to (k, 2 L), left edges first."""
        sums = np.add.reduceat(charges[:, None] * self.edge_vectors[:2], self.coupled.starts[:-1], axis=2)
        return np.asarray(sums.reshape(len(charges), -1))
