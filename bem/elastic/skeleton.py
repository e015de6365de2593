"""What is solved for: the nodal charges of all patches, and what an effect adds to the kernel between them.

The matrix is the negated kernel between the nodes of all patches, the right-hand sides are the columns that every patch
shares, and the edge vectors of each patch.  An effect adds a matrix, or a sum of few products of waves, and what modes
that are not coupled do at the nodes.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.chebyshev import basis
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

    def of_edges(self, charges: FloatArray) -> FloatArray:
        """Return products of the edge vectors with nodal charges, (k, n) to (k, 2 L), left edges first."""
        vectors = np.concatenate([basis(modes).at_edges for modes in self.modes.tolist()], axis=1)
        if self.coupling is not None and self.coupling.left_out is not None:
            vectors = vectors + self.coupling.left_out.fields
        starts = np.cumsum(self.modes) - self.modes
        sums = np.add.reduceat(charges[:, None] * vectors, starts, axis=2)
        return np.asarray(sums.reshape(len(charges), -1))
