"""Figure of a comparison of boundary elements and finite elements: pressure above, signed differences below."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_reference import Result
from validation.cases.finite_elements.fem_comparison import Comparison, away_from_edges
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.schema import Figure

SHOWN = 1.5  # times the scale: the exact pressure is infinite at the edges
MIDDLE = 0.8  # of a patch, where pressures are compared node by node


def figure(identity: str, caption: str, comparison: Comparison) -> tuple[Figure, ...]:
    """Pressure along the layer by both codes above; below, their signed differences away from the edges."""
    fem, state = comparison.fem, comparison.state
    if fem is None or state is None:
        return ()
    scale, period, x = float(np.max(np.abs(fem.middle_pressure))), fem.problem.period, fem.interface.x
    inside, middle = _in_patches(fem, x, 1.0), _in_patches(fem, x, MIDDLE)
    theirs, ours = state.pressure(x[inside]), fem.interface.pressure[inside]
    shown = np.abs(theirs) < SHOWN * scale
    line = np.linspace(x[0], x[0] + period, 400)
    curve = np.nan_to_num(state.pressure(line), nan=0.0, posinf=np.inf, neginf=-np.inf)  # nothing off the contact
    displacement, points = comparison.differences[-1], x[0] + (away_from_edges(fem) - x[0]) % period
    apart = (state.pressure(x[middle]) - fem.interface.pressure[middle]) / scale
    below = (
        "pressure at the nodes of the middle 0.8 of each patch over the largest middle pressure, displacement away "
        "from the edges over the rms height."
    )
    made = drawn(
        identity, f"{caption} Below, boundary elements less finite elements: {below}",
        axes("x / mm", "pressure / kPa",
             trace("boundary elements", line * 1e3, [v / 1e3 if abs(v) < SHOWN * scale else None for v in curve]),
             marks("finite elements", x[inside][shown] * 1e3, ours[shown] / 1e3)),
        axes("x / mm", "signed difference / scale",
             marks("pressure", x[middle] * 1e3, apart),
             marks("displacement", points * 1e3, (displacement.bem - displacement.fem) / displacement.scale)),
    )  # fmt: skip
    return (made,)


def _in_patches(fem: Result, x: FloatArray, share: float) -> NDArray[np.bool_]:
    """Whether positions x, m, lie in the inner share of a patch."""
    period, inside = fem.problem.period, np.zeros(x.shape, dtype=bool)
    for a, b in fem.edges:
        distance = x - 0.5 * (a + b)
        inside |= np.abs(distance - period * np.round(distance / period)) < share * 0.5 * (b - a)
    return inside
