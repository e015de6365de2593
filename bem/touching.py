"""Contacts that form while edges move: crests of the profile that a moving edge draws into contact.

Whether a jump ends beyond a crest or on it, what the contact becomes depends on when the crest touches; and near the
end of a branch several jumps lie so close together that their order is a matter of the smallest increment.  A jump
therefore stops where a crest ahead of one of its edges touches, and goes on with the new contact.  The gap is
evaluated at the crests within a few of the shortest wavelengths ahead; those farther away wait for the equilibrium at
the end of the jump, in which every gap is looked at (gap.py).  Dimensionless.  Limits: beside an edge with K <= 0 the
surfaces interpenetrate whatever the crests are, and nothing is looked for there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem.equilibrium import Balance, System
from bem.gap import GapMinima, gap_field
from bem.patches import TWO_PI, Patches

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

REACH = 4.0  # shortest wavelengths ahead of an edge
MOVED = 1e-2  # of the shortest wavelength, by which an edge must move to be one that moves


@dataclass(frozen=True, eq=False)
class CrestsAhead:
    """Looks for crests that touch ahead of edges that moved outward.

    Attributes
    ----------
    system : System
    allowed : float
        Interpenetration that is not yet a contact, dimensionless.
    occupied : Patches, optional
        Patches beside those of the states looked at, in which no crest can touch.
    """

    system: System
    allowed: float
    occupied: Patches | None = None

    def __call__(self, before: Patches, after: Balance) -> GapMinima | None:
        """Crests in contact ahead of edges that moved outward from one set of patches to another.

        Parameters
        ----------
        before : Patches
            As many as those after.
        after : Balance
            Forces on the edges after the motion, which need not be in equilibrium.

        Returns
        -------
        GapMinima or None
            The crests that interpenetrate; None where none does.
        """
        state = after.state
        position, gap = self._ahead(before, state.patches)
        tensile = state.stress_intensity > 0
        beside = tensile[state.patches.count :] & np.roll(tensile[: state.patches.count], -1)
        position, gap = position[beside[gap]], gap[beside[gap]]
        if self.occupied is not None:
            into = (position[:, None] - self.occupied.left) % TWO_PI
            free = ~np.any(into <= self.occupied.width, axis=1)
            position, gap = position[free], gap[free]
        if position.size == 0:
            return None
        depth = gap_field(self.system.elastic, state)(position, gap)
        touching = depth < -self.allowed
        return GapMinima(position[touching], depth[touching], gap[touching]) if touching.any() else None

    def _ahead(self, before: Patches, after: Patches) -> tuple[FloatArray, IntArray]:
        """Positions of crests ahead of edges that moved, each on the turn of its gap, and their gaps, (n,) each."""
        profile, count = self.system.elastic.profile, after.count
        wavelength = TWO_PI / profile.max_order
        outward = np.concatenate([before.left - after.left, after.right - before.right])
        edge = np.flatnonzero(outward > MOVED * wavelength)
        gap = np.where(edge < count, edge - 1, edge - count) % count
        reach = np.minimum(REACH * wavelength, after.gap_after[gap])
        start = after.right[gap] + np.where(edge < count, after.gap_after[gap] - reach, 0.0)
        crests = profile.crests[0]
        around = np.concatenate([crests, crests + TWO_PI])
        turn = np.floor(start / TWO_PI) * TWO_PI
        first, last = np.searchsorted(around, np.stack([start - turn, start - turn + reach]))
        which = np.repeat(np.arange(edge.size), last - first)
        index = np.arange(which.size) - np.repeat(np.cumsum(last - first) - last, last - first)
        _, once = np.unique(index % crests.size, return_index=True)  # windows of the two edges of a gap may overlap
        return (around[index] + turn[which])[once], gap[which[once]]
