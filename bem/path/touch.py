"""Gap that closes on a crest: the condition gap(y) = 0, y its lowest place.

The change of the gap at y by a motion a of the edges follows from reciprocity: the gap is a load with the weight
f = -log|2 sin((x - y)/2)|/pi, so that like the load itself d gap / d a = K K_f / 2, where K_f are the stress
intensities by heights of the shape f, which are the stress intensities of a point charge at y.  They come with the
evaluation of the state, for charges where the gap was least before and at neighbouring places; between these places
they are linear in y.
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
from bem.path.locating import LOCATED, Condition, Located, Refused, locate
from bem.path.span import Span
from bem.path.stand import SHORT, Row


@dataclass(frozen=True, eq=False)
class Touch:
    """State in which gaps have just closed, and their places; `place` is the parameter of the state on the span."""

    at: Located
    touching: GapMinima
    place: float


@dataclass(eq=False)
class GapCloses(Condition):
    """Condition that the lowest of some gaps vanishes.

    Attributes
    ----------
    places : ((n,) array, (n,) array)
        Positions of the charges that probe the gaps.
    lowest : GapMinima
        Minima of the gaps in the last state: positions and values.
    """

    system: System
    lowest: GapMinima
    width: FloatArray
    places: tuple[FloatArray, FloatArray] = field(init=False)

    def asked(self, system: System) -> System:
        """Return the system whose evaluations hold the effects of charges at the places, and at neighbouring ones."""
        self.places = self.lowest.position, self.lowest.position + self.width
        probes = (*self.places[0].tolist(), *self.places[1].tolist())
        return replace(system, elastic=replace(system.elastic, probes=probes))

    def row(self, balance: Balance, value: float) -> Row:
        """Return the depth of the lowest gap, and its derivatives."""
        lowest = minima_near(gap_field(self.system.elastic, balance.state), self.lowest.position, self.lowest.gap)
        deepest = int(np.argmin(lowest.depth))
        share = float((lowest.position[deepest] - self.places[0][deepest]) / self.width[deepest])
        self.lowest = lowest
        return Row(float(lowest.depth[deepest]), *self._rates(balance, deepest, share))

    def _rates(self, balance: Balance, place: int, share: float) -> tuple[FloatArray, float]:
        """Return the rates at which a gap opens by outward motions of the edges, (2 L,), and by the control.

        The rates belong to a position a share of the way from the place probed to the neighbouring place.
        """
        state, control = balance.state, self.system.control
        intensity, load = (
            (1 - share) * values[place] + share * values[place + len(values) // 2]
            for values in (state.intensity_by_probes, state.load_by_probes)
        )
        by_edges = state.stress_intensity * intensity / 2
        far, outside = self.system.elastic.far, 0.0
        if far is not None:  # change by the penetration of the field of patches outside the window
            at = (1 - share) * self.places[0][place] + share * self.places[1][place]
            outside = float(far.at(np.array([at]), state.penetration)[1][0]) / np.pi
        by_control = (load - 1 - outside) * control.rate(state)
        return by_edges - control.load_weight * by_control * balance.load_gradient, by_control


def locate_touch(
    system: System, span: Span, end: tuple[Evaluation, float], gaps: GapMinima, tolerance: float
) -> Touch | Refused:
    """Locate the touch of the first of some gaps that closes on a span of the curve.

    Parameters
    ----------
    system : System
    span : Span
    end : (Evaluation, float)
        A state on the span, or at its end, in which the gaps are closed, and its parameter.
    gaps : GapMinima
        The closed gaps in this state.
    tolerance : float
    """
    first = span.first.balance.state
    last, reach = end
    for _ in range(MAXIMUM_ITERATIONS):
        behind = first.patches.right[gaps.gap]
        if not np.all((gaps.position > behind) & (gaps.position < behind + first.patches.gap_after[gaps.gap])):
            return Refused.UNCLEAR
        open_gap, closed = (gap_field(system.elastic, state)(gaps.position, gaps.gap) for state in (first, last))
        share = np.min(np.where(closed < 0, open_gap / np.where(closed < 0, open_gap - closed, 1.0), 1.0))
        start = replace(span.at(reach * float(np.clip(share, 0.0, 1.0))), penetration=first.penetration)
        closes = GapCloses(system, gaps, SHORT * first.patches.gap_after[gaps.gap])
        at = locate(system, start, closes, tolerance)
        if isinstance(at, Refused):
            return at
        if not span.holds(at.patches, at.numbers.value) or at.balance.factor is None:
            return Refused.FAR
        state, deepest = at.balance.state, float(closes.lowest.depth.min())
        earlier = interpenetration(system, state, LOCATED - min(deepest, 0.0))
        if earlier.position.size == 0:
            tied = closes.lowest.depth <= deepest + LOCATED
            touching = GapMinima(closes.lowest.position[tied], np.zeros(int(tied.sum())), closes.lowest.gap[tied])
            return Touch(at, touching, span.parameter(at.patches))
        gaps, last, reach = earlier, state, span.parameter(state.patches)
    return Refused.UNCLEAR
