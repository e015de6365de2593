"""Where a gap closes on a crest: the condition gap(y) = 0, y its lowest place.

What a motion a of the edges does to the gap at y follows from reciprocity: the gap is a load with the weight
f = -log|2 sin((x - y)/2)|/pi, so that like the load itself d gap / d a = K K_f / 2, where K_f are the stress
intensities by heights of the shape f; and these are those of a point charge at y.  They come with the evaluation of the
state: of charges where the gap was least before, and at neighbouring places; between, they are linear in y.
Source of the derivative: Rice, Int. J. Solids Struct. 21 (1985) 781.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.relaxation import interpenetration
from bem.elastic.collocation import Evaluation
from bem.elastic.gap import GapMinima, gap_field, minima_near
from bem.geometry.arrays import FloatArray
from bem.loading.increments import MAXIMUM_ITERATIONS
from bem.path.locating import LOCATED, Condition, Located, Refused, Start, locate
from bem.path.span import Span
from bem.path.stand import SHORT, Row


@dataclass(frozen=True, eq=False)
class Touch:
    """A state in which gaps have just closed, and where; `place` is its parameter on the span."""

    at: Located
    touching: GapMinima
    place: float


@dataclass(eq=False)
class GapCloses(Condition):
    """The lowest of some gaps vanishes.

    Attributes
    ----------
    places : ((n,) array, (n,) array)
        Where charges probe the gaps.
    lowest : GapMinima
        Where they are least in the last state, and what they are there.
    """

    system: System
    lowest: GapMinima
    width: FloatArray
    places: tuple[FloatArray, FloatArray] = field(init=False)

    def asked(self, system: System) -> System:
        """Evaluations know what charges at the places do, and at neighbouring ones."""
        self.places = self.lowest.position, self.lowest.position + self.width
        probes = (*self.places[0].tolist(), *self.places[1].tolist())
        return replace(system, elastic=replace(system.elastic, probes=probes))

    def row(self, here: Balance, value: float) -> Row:
        """Depth of the lowest gap."""
        lowest = minima_near(gap_field(self.system.elastic, here.state), self.lowest.position, self.lowest.gap)
        deepest = int(np.argmin(lowest.depth))
        share = float((lowest.position[deepest] - self.places[0][deepest]) / self.width[deepest])
        self.lowest = lowest
        return Row(float(lowest.depth[deepest]), *self._rates(here, deepest, share))

    def _rates(self, here: Balance, place: int, share: float) -> tuple[FloatArray, float]:
        """How a gap opens by outward motions of the edges, (2 L,), and by the control.

        A share of the way from the place probed to the neighbouring one.
        """
        state, control = here.state, self.system.control
        intensity, load = (
            (1 - share) * values[place] + share * values[place + len(values) // 2]
            for values in (state.intensity_by_probes, state.load_by_probes)
        )
        by_edges = state.stress_intensity * intensity / 2
        far, outside = self.system.elastic.far, 0.0
        if far is not None:  # what the penetration changes of the field of patches outside the window
            at = (1 - share) * self.places[0][place] + share * self.places[1][place]
            outside = float(far.at(np.array([at]), state.penetration)[1][0]) / np.pi
        by_control = (load - 1 - outside) * control.rate(state)
        return by_edges - control.load_weight * by_control * here.load_gradient, by_control


def locate_touch(
    system: System, span: Span, end: tuple[Evaluation, float], found: GapMinima, tolerance: float
) -> Touch | Refused:
    """Where the first of some gaps closes on a span of the curve.

    Parameters
    ----------
    system : System
    span : Span
    end : (Evaluation, float)
        A state on the span, or at its end, in which the gaps are closed, and its parameter.
    found : GapMinima
        These gaps there.
    tolerance : float
    """
    first = span.first.balance.state
    last, reach = end
    for _ in range(MAXIMUM_ITERATIONS):
        behind = first.patches.right[found.gap]
        if not np.all((found.position > behind) & (found.position < behind + first.patches.gap_after[found.gap])):
            return Refused.UNCLEAR
        open_gap, closed = (gap_field(system.elastic, state)(found.position, found.gap) for state in (first, last))
        share = np.min(np.where(closed < 0, open_gap / np.where(closed < 0, open_gap - closed, 1.0), 1.0))
        patches, value = span.at(reach * float(np.clip(share, 0.0, 1.0)))
        closes = GapCloses(system, found, SHORT * first.patches.gap_after[found.gap])
        at = locate(system, Start(patches, first.penetration, value), closes, tolerance)
        if isinstance(at, Refused):
            return at
        if not span.holds(at.patches, at.numbers.value) or at.balance.factor is None:
            return Refused.FAR
        state, left = at.balance.state, float(closes.lowest.depth.min())
        earlier = interpenetration(system, state, LOCATED - min(left, 0.0))
        if earlier.position.size == 0:
            tied = closes.lowest.depth <= left + LOCATED
            touching = GapMinima(closes.lowest.position[tied], np.zeros(int(tied.sum())), closes.lowest.gap[tied])
            return Touch(at, touching, span.parameter(at.patches))
        found, last, reach = earlier, state, span.parameter(state.patches)
    return Refused.UNCLEAR
