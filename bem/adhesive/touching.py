"""Contacts that form while edges move: crests of the profile that a moving edge draws into contact.

Whether a jump ends beyond a crest or on it, what the contact becomes depends on when the crest touches; and near the
end of a branch several jumps lie so close together that their order is a matter of the smallest increment.  A jump
therefore stops where a crest ahead of one of its edges touches, and continues with the new contact.  The gap is
evaluated at the crests within a few of the shortest wavelengths ahead; those farther away wait for the equilibrium at
the end of the jump, in which every gap is looked at (gap.py).  Dimensionless.  Limits: minima of the gap beside a
crest wait as well; beside an edge with K <= 0 the surfaces interpenetrate whatever the crests are, and nothing is
looked for until K > 0; between patches in a frozen field and those that make it, the gap has the accuracy of a
skeleton (1e-6 of the rms height at a tenth of the gap from them, 2e-4 at a hundredth).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.adhesive.equilibrium import Balance, System
from bem.elastic.gap import GapMinima, gap_field
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches

REACH = 4.0  # shortest wavelengths ahead of an edge
MOVED = 1e-2  # of the shortest wavelength, by which an edge must have moved to be looked ahead of again


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

    def __call__(self, seen: Patches, after: Balance) -> tuple[GapMinima | None, Patches]:
        """Crests in contact ahead of edges that moved outward since they were last looked ahead of.

        Parameters
        ----------
        seen : Patches
            Where each edge was then; as many patches as those after.
        after : Balance
            Forces on the edges now, which need not be in equilibrium.

        Returns
        -------
        touching : GapMinima or None
            The crests that interpenetrate; None where none does.
        seen : Patches
            The same with the edges that have been looked ahead of now.
        """
        state = after.state
        edge, position, gap = self._ahead(seen, after)
        seen = _moved_along(seen, state.patches, edge)
        if self.occupied is not None:
            into = (position[:, None] - self.occupied.left) % TWO_PI
            free = ~np.any(into <= self.occupied.width, axis=1)
            position, gap = position[free], gap[free]
        if position.size == 0:
            return None, seen
        depth = gap_field(self.system.elastic, state)(position, gap)
        touching = depth < -self.allowed
        return (GapMinima(position[touching], depth[touching], gap[touching]) if touching.any() else None), seen

    def _ahead(self, seen: Patches, after: Balance) -> tuple[IntArray, FloatArray, IntArray]:
        """Edges that moved, of gaps with tension at both ends; crests ahead, on the turn of their gap; these gaps."""
        profile, patches, count = self.system.elastic.profile, after.state.patches, seen.count
        wavelength = TWO_PI / profile.max_order
        outward = np.concatenate([seen.left - patches.left, patches.right - seen.right])
        edge = np.flatnonzero(outward > MOVED * wavelength)
        gap = np.where(edge < count, edge - 1, edge - count) % count
        tensile = after.state.stress_intensity > 0
        at_both_ends = tensile[count + gap] & tensile[(gap + 1) % count]
        edge, gap = edge[at_both_ends], gap[at_both_ends]
        if edge.size == 0:
            return edge, np.empty(0), gap
        reach = np.minimum(REACH * wavelength, patches.gap_after[gap])
        start = patches.right[gap] + np.where(edge < count, patches.gap_after[gap] - reach, 0.0)
        crests = profile.crests[0]
        around = np.concatenate([crests, crests + TWO_PI])
        turn = np.floor(start / TWO_PI) * TWO_PI
        first, last = np.searchsorted(around, np.stack([start - turn, start - turn + reach]))
        which = np.repeat(np.arange(edge.size), last - first)
        index = np.arange(which.size) - np.repeat(np.cumsum(last - first) - last, last - first)
        _, once = np.unique(index % crests.size, return_index=True)  # windows of the two edges of a gap may overlap
        return edge, (around[index] + turn[which])[once], gap[which[once]]


def _moved_along(patches: Patches, to: Patches, edge: IntArray) -> Patches:
    """Patches with some of their edges, in the order of edge vectors, where they are in others."""
    looked = np.zeros(2 * to.count, dtype=bool)
    looked[edge] = True
    left, right = looked[: to.count], looked[to.count :]
    return Patches(np.where(left, to.left, patches.left), np.where(right, to.right, patches.right))
