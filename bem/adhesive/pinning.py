"""Shortest wave of the roughness that may pin an edge, so that the edge snaps from wave to wave.

Full contact with a wave h cos(q x + phi) has the pressure q h cos(q x + phi); where the contact ends, that adds
h sqrt(2 q) cos(phi') to K, and with K = 2 sqrt(w) a part h sqrt(2 q/w) of the work of adhesion to G.  An edge is pinned
where G grows by this faster along q than it falls as the contact grows, which is by about itself over an edge scale:

    edge scale * q * h sqrt(2 q / w) > 1.

Waves of all orders from one on act together; their phases being any, squares add.  Dimensionless (orders are wave
numbers).  Limits: an estimate of sizes, for waves short beside the edge scale and the thickness of a layer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI
from bem.geometry.profile import Profile

PINS = 0.03  # of the strength at which waves pin an edge on its own: modes of several are softer


@dataclass(frozen=True, eq=False)
class PinningWaves:
    """Waves of a profile with the strength at which they pin edges.

    Attributes
    ----------
    orders : (n,) int array
        Of the harmonics, ascending.
    strength : (n,) array
        q h sqrt(2 q) of all waves at least as short, descending.
    """

    orders: IntArray
    strength: FloatArray

    @classmethod
    def of(cls, profile: Profile) -> PinningWaves:
        """Return the waves of a dimensionless profile."""
        ascending = np.argsort(profile.orders)
        orders, amplitudes = profile.orders[ascending], profile.amplitudes[ascending]
        squares = 2 * amplitudes**2 * orders.astype(float) ** 3
        return cls(orders, np.sqrt(np.cumsum(squares[::-1])[::-1]))

    def shortest(self, work: FloatArray, edge_scale: FloatArray) -> FloatArray:
        """Return the length of the shortest wave that may pin each edge; inf where none does.

        Parameters
        ----------
        work, edge_scale : (2 L,) arrays
            Work of adhesion at the edges, and their edge scales.
        """
        count = np.searchsorted(-self.strength, -PINS * np.sqrt(work) / edge_scale, side="right")
        return np.where(count > 0, TWO_PI / self.orders[np.maximum(count - 1, 0)], np.inf)
