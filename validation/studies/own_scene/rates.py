"""Geometric rate at which an error falls, error = C rate^-size, fitted above its plateau and after its start."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ABOVE_PLATEAU = 30.0  # times the plateau: nearer to it, it adds to the error
BEFORE = 0.01  # relative error above which nothing has converged yet
FEWEST = 3


class RateError(ValueError):
    """Too few points fall between the start and the plateau to fit a rate."""


@dataclass(frozen=True)
class Rate:
    """Fitted rate."""

    value: float  # factor by which the error falls for each unit of size
    pairwise: tuple[float, ...]  # the same between neighbours of all points, one fewer than the points
    used: tuple[int, ...]  # indices of the points fitted
    plateau: float  # the error below which nothing falls


def geometric(sizes: Sequence[float], errors: Sequence[float]) -> Rate:
    """Return the factor rho of error = C rho^-size; the plateau is the largest error from where errors no longer fall.

    The least error will not do: at rounding it may be zero by chance, and points of the plateau are then fitted.

    Examples
    --------
    >>> found = geometric([4, 6, 8, 10, 12, 14], [1e-4, 1e-6, 1e-8, 1e-18, 1e-16, 1e-17])
    >>> round(found.value, 12), found.used, found.plateau
    (10.0, (0, 1, 2), 1e-16)
    """
    size, error = _arrays(sizes, errors)
    rises = (error[:-1] < BEFORE) & (error[1:] >= error[:-1])
    plateau = float(np.max(error[np.argmax(np.append(rises, True)) :]))
    falling = (error > ABOVE_PLATEAU * plateau) & (error < BEFORE)
    first_flat = int(np.argmax(error <= ABOVE_PLATEAU * plateau))
    used = np.flatnonzero(falling[:first_flat])
    _enough(used)
    slope = np.polyfit(size[used], np.log(error[used]), 1)[0]
    pairs = np.exp(-np.diff(np.log(error)) / np.diff(size))
    return Rate(float(np.exp(-slope)), tuple(pairs.tolist()), tuple(int(i) for i in used), plateau)


def _arrays(sizes: Sequence[float], errors: Sequence[float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return sizes and errors as arrays; RateError unless sizes increase and errors are finite and positive."""
    size, error = np.asarray(sizes, dtype=np.float64), np.asarray(errors, dtype=np.float64)
    if size.shape != error.shape or size.size < FEWEST or np.any(np.diff(size) <= 0):
        raise RateError(f"{size.size} sizes and {error.size} errors: at least {FEWEST} of each, sizes increasing")
    if not np.all(np.isfinite(error) & (error > 0)):
        raise RateError(f"errors must be finite and positive, not {error.tolist()}")
    return size, error


def _enough(used: NDArray[np.int64]) -> None:
    if used.size < FEWEST:
        raise RateError(f"only {used.size} points between the start and the plateau, {FEWEST} are needed")
