"""Unknowns of the system, the nodal charges of all patches, and the additions of effects to the kernel between them.

The matrix is the negated kernel between the nodes of all patches, the right-hand sides are the columns that every patch
shares, and the edge vectors of each patch.  An effect adds a matrix, or a sum of few products of waves, and the fields
of uncoupled modes at the nodes.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.chebyshev import basis
from bem.geometry.patches import Patches


@dataclass(frozen=True, eq=False)
class Waves:
    """Addition V D V^T to the kernel of the half-space at the nodes.

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
    """Response of an effect to the uncoupled modes of the edge vectors.

    Attributes
    ----------
    fields : (2, n) array
        Fields of the left and of the right edge at the nodes of their patch.
    compliance : (2, L) array
        Response at the edge itself, and at the other edge of the patch.
    """

    fields: FloatArray
    compliance: FloatArray


@dataclass(frozen=True, eq=False)
class Coupling:
    """Addition of an effect to the kernel of the half-space between the coupled modes.

    Attributes
    ----------
    matrix : (n, n) array or None
        Addition at the nodes; it requires a single leaf.
    waves : Waves or None
        Addition as a sum of few products.
    left_out : LeftOut or None
        None where the effect couples no other modes.
    """

    matrix: FloatArray | None
    waves: Waves | None
    left_out: LeftOut | None = None


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Nodes of all patches, in the order of the patches.

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
        Addition to the kernel of the half-space.
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
