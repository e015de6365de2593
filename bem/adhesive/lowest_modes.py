"""Lowest eigenvalues of a symmetric matrix with their modes: LAPACK without the checks of a general interface.

Hessians of a hundred edges are looked at a few thousand times on a path, and checks of arguments and choices of drivers
took as long as the algebra (Parlett, Dhillon, Linear Algebra Appl. 387 (2004) 1: dsyevr).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.linalg import LinAlgError, lapack

from bem.geometry.arrays import FloatArray


def lowest_modes(matrix: FloatArray, count: int | None = None) -> tuple[FloatArray, FloatArray]:
    """Return the lowest `count` eigenvalues, ascending, and their modes as columns; all if `count` is None.

    Parameters
    ----------
    matrix : (n, n) array
        Symmetric, finite.
    count : int, optional
        At most n.

    Raises
    ------
    LinAlgError
        They do not converge.

    Examples
    --------
    >>> values, modes = lowest_modes(np.diag([3.0, 1.0, 2.0]), 1)
    >>> values.tolist(), np.abs(modes[:, 0]).tolist()
    ([1.0], [0.0, 1.0, 0.0])
    """
    size = matrix.shape[0]
    count = size if count is None else min(count, size)
    lwork, liwork = _workspace(size)
    values, modes, _, _, info = lapack.dsyevr(
        matrix, range="I", il=1, iu=count, lower=1, lwork=lwork, liwork=liwork, overwrite_a=0
    )
    if info != 0:
        raise LinAlgError(f"eigenvalues of {size} edges do not converge: dsyevr says {info}")
    return np.asarray(values[:count]), np.asarray(modes[:, :count])


@lru_cache(maxsize=4096)
def _workspace(size: int) -> tuple[int, int]:
    """Return the sizes of the work arrays of LAPACK."""
    work, iwork, _ = lapack.dsyevr_lwork(size, lower=1)
    return int(work), int(iwork)
