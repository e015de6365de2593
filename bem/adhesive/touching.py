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

import math
from dataclasses import dataclass

import numpy as np

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.vanishing import ABOUT_TO_GO
from bem.elastic.gap import GapMinima, gap_field
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches

AHEAD = 4.0  # shortest wavelengths ahead of an edge


@dataclass(frozen=True, eq=False)
class CrestsAhead:
    """Search for crests that touch ahead of edges that moved outward.

    Attributes
    ----------
    system : System
    allowed : float
        Interpenetration that is not yet a contact, dimensionless.
    occupied : Patches, optional
        Patches outside the states examined, in which no crest can touch.
    """

    system: System
    allowed: float
    occupied: Patches | None = None

    def __call__(self, seen: Patches, after: Balance) -> tuple[GapMinima | None, Patches]:
        """Return the crests in contact ahead of edges that moved outward since the last search ahead of them.

        Parameters
        ----------
        seen : Patches
            Edges at the last search; as many patches as in `after`.
        after : Balance
            Forces on the edges now, which need not be in equilibrium.

        Returns
        -------
        touching : GapMinima or None
            The crests that interpenetrate; None where none does.
        seen : Patches
            `seen` with the edges searched ahead of in this call at their new positions.
        """
        state = after.state
        edges, position, gap = self._ahead(seen, after)
        seen = _moved_along(seen, state.patches, edges)
        if self.occupied is not None:
            into = (position[:, None] - self.occupied.left) % TWO_PI
            free = ~np.any(into <= self.occupied.width, axis=1)
            position, gap = position[free], gap[free]
        if position.size == 0:
            return None, seen
        depth = gap_field(self.system.elastic, state)(position, gap)
        touching = depth < -self.allowed
        return (GapMinima(position[touching], depth[touching], gap[touching]) if touching.any() else None), seen

    def _ahead(self, seen: Patches, after: Balance) -> tuple[list[int], FloatArray, IntArray]:
        """Return moved edges of gaps in tension at both ends; crests ahead, on the turn of their gap; and the gaps."""
        profile, patches, count = self.system.elastic.profile, after.state.patches, seen.count
        wavelength = TWO_PI / profile.max_order
        outward = np.concatenate([seen.left - patches.left, patches.right - seen.right])
        tensile, crests = (after.state.stress_intensity > 0).tolist(), profile.crests[0]
        edges: list[int] = []
        ahead: dict[int, tuple[float, int]] = {}  # of each crest: windows of the two edges of a gap may overlap
        for edge in np.flatnonzero(outward > ABOUT_TO_GO * wavelength).tolist():
            gap = (edge - 1 if edge < count else edge) % count
            if not (tensile[count + gap] and tensile[(gap + 1) % count]):
                continue
            edges.append(edge)
            width = float(patches.gap_after[gap])
            reach = min(AHEAD * wavelength, width)
            start = float(patches.right[gap]) + (width - reach if edge < count else 0.0)
            turn = math.floor(start / TWO_PI) * TWO_PI
            for part in (turn, turn + TWO_PI):
                first, last = crests.searchsorted((start - part, start - part + reach)).tolist()
                ahead |= {crest: (crests[crest] + part, gap) for crest in range(first, last)}
        where = [ahead[crest] for crest in sorted(ahead)]
        return edges, np.array([x for x, _ in where]), np.array([gap for _, gap in where], dtype=np.int64)


def _moved_along(patches: Patches, to: Patches, edges: list[int]) -> Patches:
    """Return `patches` with the edges of the given indices (order of edge vectors) at their positions in `to`."""
    looked = np.zeros(2 * to.count, dtype=bool)
    looked[edges] = True
    left, right = looked[: to.count], looked[to.count :]
    return Patches(np.where(left, to.left, patches.left), np.where(right, to.right, patches.right))
