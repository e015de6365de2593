"""Field inside a window of the pressure outside the window, linear in the penetration.

A window [beta, delta] of the period begins and ends in gaps.  In the coordinate u = log|sin((x - beta)/2) /
sin((x - delta)/2)| the logarithmic field of charges outside, less their sum times
m(x) = log sqrt|sin((x - beta)/2) sin((x - delta)/2)|, is analytic in |Im u| < pi (separated_kernel.py): a short
Chebyshev series on the part of the window that edges may reach.  Its samples are differences of the field of all
charges and that of the charges inside, so that those of all windows take one potential of many charges at many points.
Between points of a grid of u the series is interpolated by cubics.  Dimensionless; for bodies whose kernel is that of
the half-space.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from bem.elastic.hierarchical import IllConditionedSystemError
from bem.elastic.logarithmic_potential import LogarithmicPotential
from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import TWO_PI, Patches

REACH = 0.1  # of the half gap at an end of a window, from that end: no edge goes there
FIELD_TERMS = 48  # of the Chebyshev series; K is off by 1e-6, by 1e-5 beside gaps of 1e-4 of a window
CELLS = 256  # derived: of the grid of u; cubics leave 2e-8


@dataclass(frozen=True, eq=False)
class Arc:
    """Window of the period between two gaps.

    Attributes
    ----------
    beta, delta : float
        Beginning and end of the window, in the middles of the two gaps; beta < delta < beta + 2 pi.
    margins : (float, float)
        Half widths of the two gaps.
    """

    beta: float
    delta: float
    margins: tuple[float, float]

    @cached_property
    def outside(self) -> Patches:
        """Part of the period in which edges of the window must not be, as one patch."""
        before, behind = (REACH * margin for margin in self.margins)
        return Patches(np.array([self.delta - behind]), np.array([self.beta + TWO_PI + before]))

    def holds(self, x: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Return whether positions are inside, (n,)."""
        return np.asarray((x - self.beta) % TWO_PI < self.delta - self.beta)

    def outer_gap(self, patches: Patches) -> int:
        """Return the index of the patch behind which the outside of the window lies."""
        middle = (self.delta + self.beta + TWO_PI) / 2
        return int(np.argmin((middle - patches.right) % TWO_PI))

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Least and largest u that edges may have."""
        ends = np.array([self.beta + REACH * self.margins[0], self.delta - REACH * self.margins[1]])
        low, high = self.coordinates(ends)[0].tolist()
        return low, high

    def coordinates(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return u and m of positions, (n,) each."""
        from_beta = np.log(np.abs(np.sin((x - self.beta) / 2)))
        from_delta = np.log(np.abs(np.sin((x - self.delta) / 2)))
        return from_beta - from_delta, (from_beta + from_delta) / 2

    def nodes(self) -> FloatArray:
        """Return the positions at which the field is sampled, (FIELD_TERMS,)."""
        low, high = self.limits
        ratio, half = (
            np.exp((low + high) / 2 + (high - low) / 2 * chebyshev.basis_nodes(FIELD_TERMS)),
            (self.delta - self.beta) / 2,
        )
        return np.asarray(self.beta + 2 * np.arctan2(ratio * np.sin(half), 1 + ratio * np.cos(half)))


@dataclass(frozen=True, eq=False)
class FarField:
    """Field of the charges outside a window, -pi times their displacement, and its derivative by the penetration.

    Attributes
    ----------
    arc : Arc
    penetration : float
        Penetration of the first columns of the table.
    charge : (2,) array
        Sum of the charges outside, and its derivative by the penetration.
    table : (CELLS + 1, 4) array
        The field less charge times m, its derivative by the penetration, and how both grow by a cell of u.
    """

    arc: Arc
    penetration: float
    charge: FloatArray
    table: FloatArray

    def at(self, x: FloatArray, penetration: float) -> tuple[FloatArray, FloatArray]:
        """Return the field at positions in the window, and its derivative by the penetration, (n,) each.

        Raises
        ------
        IllConditionedSystemError
            A position is outside, or too close to an end.
        """
        u, m = self.arc.coordinates(x)
        low, high = self.arc.limits
        place = (u - low) * (CELLS / (high - low))
        if x.size and not (place.min() >= 0 and place.max() <= CELLS):
            raise IllConditionedSystemError("an edge leaves its window")
        cell = np.minimum(place.astype(np.int64), CELLS - 1)
        p = (place - cell)[:, None]
        q = 1 - p
        start, end = self.table[cell], self.table[cell + 1]
        values = start[:, :2] + p * p * (3 - 2 * p) * (end[:, :2] - start[:, :2])
        values += p * q * (q * start[:, 2:] - p * end[:, 2:])
        values += m[:, None] * self.charge
        return values[:, 0] + (penetration - self.penetration) * values[:, 1], values[:, 1]


@dataclass(frozen=True, eq=False)
class Charges:
    """Charges on the circle, (n,) each, at a penetration."""

    position: FloatArray
    charge: FloatArray
    penetration: float


def far_fields(arcs: Sequence[Arc], first: Charges, second: Charges) -> list[FarField]:
    """Return the field in each window of the charges outside the window, linear between two penetrations.

    Parameters
    ----------
    arcs : sequence of Arc
    first, second : Charges
        All charges of the period, at two penetrations.
    """
    nodes = [arc.nodes() for arc in arcs]
    x, change = np.concatenate(nodes), second.penetration - first.penetration
    both = np.stack([LogarithmicPotential(charges.position, charges.charge)(x) for charges in (first, second)])
    fields = []
    for arc, at, sampled in zip(arcs, nodes, np.split(both, len(arcs), axis=1), strict=True):
        m, outer = arc.coordinates(at)[1], np.zeros(2)
        for index, charges in enumerate((first, second)):
            inside = arc.holds(charges.position)
            sampled[index] -= LogarithmicPotential(charges.position[inside], charges.charge[inside])(at)
            outer[index] = float(charges.charge[~inside].sum())
            sampled[index] -= outer[index] * m
        series = chebyshev.coefficients(sampled)
        values, slopes = _table()
        series[1], outer[1] = (series[1] - series[0]) / change, (outer[1] - outer[0]) / change
        fields.append(
            FarField(arc, first.penetration, outer, np.concatenate([values @ series.T, slopes @ series.T], axis=1))
        )
    return fields


@lru_cache(maxsize=1)
def _table() -> tuple[FloatArray, FloatArray]:
    """Return the matrices from a series to values on the grid and to derivatives per cell, (CELLS + 1, terms)."""
    t, identity = np.linspace(-1, 1, CELLS + 1), np.eye(FIELD_TERMS)
    slopes = np.polynomial.chebyshev.chebder(identity, axis=0) * (2 / CELLS)
    values, fewer = (np.polynomial.chebyshev.chebvander(t, degree) for degree in (FIELD_TERMS - 1, FIELD_TERMS - 2))
    return np.asarray(values), np.asarray(fewer @ slopes)
