"""The lowest eigenvalues of a symmetric matrix with their modes: LAPACK without what a general interface adds.

Hessians of a hundred edges are looked at a few thousand times on a path, and checks of arguments and choices of drivers
took as long as the algebra (Parlett, Dhillon, Linear Algebra Appl. 387 (2004) 1: dsyevr).  Where the lowest mode is
nearly known, one Cholesky factor leads to it, and proves that it is the lowest (`known_mode`).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.linalg import LinAlgError, blas, lapack

from bem.geometry.arrays import FloatArray

CORRECTIONS = 8  # of a mode by one factor; none to three do near a fold
RESOLVED = 2e-15  # of the stiffest entry: residual of a mode; that of dsyevr is 5e-16 of it
APART = 1e-12  # the same, of a mode and the second: above the rounding of factors


def lowest_modes(matrix: FloatArray, count: int | None = None) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues, ascending, and modes, one a column: the lowest `count` of them, or all.

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


def known_mode(matrix: FloatArray, guess: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """The lowest eigenvalue, (1,), and its mode, (n, 1), where a guess of that is good and all others are positive.

    With the guess w, s a little above w . H w and 0, and c large, M = H - s + c w w^T is positive definite only if at
    most one eigenvalue of H is s or less: changes of rank one interlace eigenvalues.  What is found below s is then the
    lowest.  The factor that shows it also corrects a mode v, by M^-1 (mu - H) v: that leaves of its error |mu - s| over
    the distance from s to the second eigenvalue.
    Source: Parlett, The Symmetric Eigenvalue Problem (1998), sections 4.6 and 10.1.

    Parameters
    ----------
    matrix : (n, n) array
        Symmetric, finite.
    guess : (n,) array
        Not zero.

    Returns
    -------
    tuple or None
        None where that is not certain: ask `lowest_modes`.

    Examples
    --------
    >>> values, modes = known_mode(np.diag([3.0, 0.1, 2.0]), np.array([0.1, 1.0, 0.0]))
    >>> values.round(12).tolist(), np.abs(modes[:, 0]).round(12).tolist()
    ([0.1], [0.0, 1.0, 0.0])
    >>> known_mode(np.diag([3.0, -1.0, -2.0]), np.array([0.0, 0.0, 1.0])) is None
    True
    """
    guess = guess / np.sqrt(guess @ guess)
    mode, pulled = guess, matrix @ guess
    value = float(guess @ pulled)
    lift = abs(value) + float(np.abs(matrix.diagonal()).max())
    shift = max(value, 0.0) + APART * lift
    lifted = blas.dsyr(lift, guess, a=matrix.T.copy("F"), lower=1, overwrite_a=1)
    lifted.ravel("F")[:: guess.size + 1] -= shift
    factor, info = lapack.dpotrf(lifted, lower=1, clean=0, overwrite_a=1)
    if info != 0:
        return None
    for _ in range(CORRECTIONS + 1):
        missing = value * mode - pulled
        if value < shift and np.sqrt(missing @ missing) <= RESOLVED * lift:
            return np.array([value]), mode[:, None]
        mode = mode + lapack.dpotrs(factor, missing, lower=1)[0]
        mode /= np.sqrt(mode @ mode)
        pulled = matrix @ mode
        value = float(mode @ pulled)
    return None


@lru_cache(maxsize=4096)
def _workspace(size: int) -> tuple[int, int]:
    """Sizes that LAPACK wants."""
    work, iwork, _ = lapack.dsyevr_lwork(size, lower=1)
    return int(work), int(iwork)
