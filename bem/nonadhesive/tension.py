"""Tension inside the patches of a contact without adhesion, where there is none in the solution.

The pressure of a patch is a Chebyshev series over the root that it has at its edges; its sign is that of the series,
which is sampled at twice as many nodes as it has coefficients.  Dimensionless.
"""

from __future__ import annotations

from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.minima import TO_ROUNDING, Minima, refined
from bem.geometry.patches import PatchPressure

TENSILE = 1e-6  # speed: of the largest pressure of a patch: less splits no patch, but is a dip in the end


def dips(pressure: PatchPressure) -> dict[int, Minima]:
    """Return the minima of the series in -1 < t < 1, patch by patch, where it may fall below zero between its nodes."""
    lowest: dict[int, Minima] = {}
    for who, values in _at_nodes(pressure.charges):
        before, inner, after = values[:, :-2], values[:, 1:-1], values[:, 2:]
        bend = before - 2 * inner + after  # more than what a minimum between the nodes may lie lower
        rows, k = np.nonzero((inner < before) & (inner <= after) & (inner < bend))
        at = nodes(pressure.charges[who[0]])[k + np.arange(3)[:, None]]
        for row in np.unique(rows):
            series = partial(_series, pressure.charges[who[row]])
            lowest[int(who[row])] = refined(series, at[:, rows == row], refinements=TO_ROUNDING)
    return dict(sorted(lowest.items()))


def _series(charge: FloatArray, t: FloatArray) -> FloatArray:
    """Return a Chebyshev series at points, shape of t."""
    return np.asarray(np.polynomial.chebyshev.chebval(t, charge))


def nodes(charge: FloatArray) -> FloatArray:
    """Twice as many Chebyshev nodes as a series has coefficients, from left to right."""
    return chebyshev.basis_nodes(2 * charge.size)[::-1]


def _at_nodes(charges: tuple[FloatArray, ...]) -> list[tuple[IntArray, FloatArray]]:
    """Patches with series of equal length, and the values of these at their nodes by rows."""
    sizes = np.array([charge.size for charge in charges])
    joined, starts = np.concatenate(charges), np.cumsum(sizes) - sizes
    groups: list[tuple[IntArray, FloatArray]] = []
    for size in np.unique(sizes).tolist():
        who = np.flatnonzero(sizes == size)
        rows = joined[starts[who, None] + np.arange(size)]
        if size <= chebyshev.SMALL_TRANSFORM:
            groups.append((who, rows @ _values(size)))
            continue
        from scipy import fft  # loaded where a patch has that many nodes

        halved = np.zeros((who.size, 2 * size))
        halved[:, :size] = rows / 2
        halved[:, 0] *= 2
        groups.append((who, np.asarray(fft.dct(halved, type=3, axis=1))[:, ::-1]))
    return groups


@lru_cache(maxsize=64)
def _values(size: int) -> FloatArray:
    """T_j at the nodes of a series of this size, (size, 2 size)."""
    angle = (np.arange(2 * size)[::-1] + 0.5) * (np.pi / (2 * size))
    return np.asarray(np.cos(np.multiply.outer(np.arange(size), angle)))


def under_tension(pressure: PatchPressure, rounded: float) -> dict[int, list[tuple[int, int]]]:
    """Patches whose pressure is tensile somewhere inside: first and last nodes of the parts of each that are not."""
    compressive_parts: dict[int, list[tuple[int, int]]] = {}
    for who, values in _at_nodes(pressure.charges):
        most = values.max(axis=1)
        least = -TENSILE * most - rounded
        tensile = np.flatnonzero(~((values.min(axis=1) > least) & (most > 0)))
        compressive = values[tensile] > least[tensile, None]
        parts = compressive[:, 0] + np.count_nonzero(compressive[:, 1:] > compressive[:, :-1], axis=1)
        for k, row, count in zip(tensile.tolist(), compressive, parts.tolist(), strict=True):
            is_loaded = bool(pressure.charges[who[k]][0] > 0)
            if not (count == 1 and is_loaded and most[k] > 0):  # tension at the ends alone moves these
                compressive_parts[int(who[k])] = _compressive(row, is_loaded) if most[k] > 0 else []
    return compressive_parts


def _compressive(compressive: NDArray[np.bool_], is_loaded: bool) -> list[tuple[int, int]]:
    """First and last nodes of the parts of a patch in compression; where the patch carries a load, its ends are."""
    starts = np.flatnonzero(compressive & ~np.append(False, compressive[:-1]))
    stops = np.flatnonzero(compressive & ~np.append(compressive[1:], False))
    if is_loaded:
        starts[0], stops[-1] = 0, compressive.size - 1
    return list(zip(starts.tolist(), stops.tolist(), strict=True))
