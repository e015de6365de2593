"""The lowest modes of a symmetric matrix: ascending, right, and the matrix is left as it is."""

import numpy as np
import pytest

from bem.adhesive.lowest_modes import lowest_modes

STIFFEST = 100.0  # eigenvalue; Hessians of edges have up to 300
# measured on Zen 4, and as OPENBLAS_CORETYPE Haswell and Nehalem; the first in parts of the stiffest
VALUES, MODES = 2.5e-15, 1e-13  # of LAPACK: 1.1e-15 (of the stiffest), 4.7e-14


def rotated(eigenvalues):
    """A full matrix of these eigenvalues, and their modes."""
    size = len(eigenvalues)
    rows = np.arange(size, dtype=float)
    modes, _ = np.linalg.qr(np.cos(1e-3 * (size * rows[:, None] + rows) ** 2 + rows))
    matrix = modes * eigenvalues @ modes.T
    return (matrix + matrix.T) / 2, modes


def spectrum(size, lowest, second=0.7):
    return np.append(lowest, np.linspace(second, STIFFEST, size - 1))[:size]


def distance(found, mode):
    return np.linalg.norm(found * np.sign(found @ mode) - mode)


@pytest.mark.parametrize("count", [1, 2, 6, None])
def test_lowest_modes_are_ascending_and_right(count):
    eigenvalues = spectrum(40, -0.3)
    matrix, modes = rotated(eigenvalues)
    values, found = lowest_modes(matrix, count)
    assert np.abs(values - eigenvalues[:count]).max() < VALUES * STIFFEST
    assert max(distance(found[:, i], modes[:, i]) for i in range(values.size)) < MODES


def test_the_matrix_is_left_as_it_is():
    matrix, _ = rotated(spectrum(40, 0.1))
    before = matrix.copy()
    lowest_modes(matrix, 2)
    np.testing.assert_array_equal(matrix, before)
