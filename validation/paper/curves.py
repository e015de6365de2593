"""Curves of an ensemble: every realisation, their mean with its standard error, means over bands of orders."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray
from validation.harness.figure_data import Series, trace
from validation.paper.ensemble import estimate

Curve = tuple[Sequence[float], Sequence[float]]


def scattered(
    curves: Sequence[Curve], x: Sequence[float], values: ArrayLike, name: str = "", hue: int | None = None
) -> list[Series]:
    """Return series of every realisation, thin, and of mean and standard error of `values` (n_realisations, n) at x."""
    mean, error = estimate(values)
    return [
        trace(f"{name}realisations", *joined(curves), "thin", hue=hue),
        trace(f"{name}mean and standard error", x, mean - error, "band", hue or 0, mean + error),
        trace(f"{name}mean", x, mean, "points", hue or 0),
    ]


def joined(curves: Sequence[Curve]) -> tuple[list[float | None], list[float | None]]:
    """Join curves to one series, with gaps between them."""
    x: list[float | None] = []
    y: list[float | None] = []
    for a, b in curves:
        x += [*map(float, a), None]
        y += [*map(float, b), None]
    return x[:-1], y[:-1]


def banded(values: FloatArray, bands: int = 24) -> tuple[list[float], list[float]]:
    """Return means over bands of orders equal in ln q: central orders and values."""
    edges = np.geomspace(1, values.size + 1, bands + 1)
    order = np.arange(1, values.size + 1)
    inside = [(order >= low) & (order < high) for low, high in pairwise(edges)]
    filled = [mask for mask in inside if mask.any()]
    centres = [float(np.exp(np.mean(np.log(order[mask])))) for mask in filled]
    return centres, [float(np.mean(values[mask])) for mask in filled]
