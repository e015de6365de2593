"""The lowest mode of a symmetric matrix next to a guess: right where it is given, and none where it is uncertain."""

import numpy as np
import pytest

from bem.adhesive.lowest_modes import known_mode, lowest_modes

STIFFEST = 100.0  # eigenvalue; Hessians of edges have up to 300
SIZES = (1, 2, 5, 40, 190)
# measured on Zen 4, and as OPENBLAS_CORETYPE Haswell and Nehalem; in parts of the stiffest where not of the mode
VALUE, MODE, RESIDUAL = 2e-16, 1.2e-12, 1e-15  # 7.3e-17, 5.2e-13, 4.0e-16
OTHER_VALUES, OTHER_MODES = 2.5e-15, 1e-13  # of LAPACK: 1.1e-15 (of the stiffest), 4.7e-14


def rotated(eigenvalues):
    """A full matrix of these eigenvalues, and their modes."""
    size = len(eigenvalues)
    rows = np.arange(size, dtype=float)
    modes, _ = np.linalg.qr(np.cos(1e-3 * (size * rows[:, None] + rows) ** 2 + rows))
    matrix = modes * eigenvalues @ modes.T
    return (matrix + matrix.T) / 2, modes


def spectrum(size, lowest, second=0.7):
    return np.append(lowest, np.linspace(second, STIFFEST, size - 1))[:size]


def near(mode, off):
    return 3.0 * mode + 3.0 * off * np.cos(np.arange(mode.size)) / np.sqrt(mode.size)


def distance(found, mode):
    return np.linalg.norm(found * np.sign(found @ mode) - mode)


@pytest.mark.parametrize("off", [0.0, 1e-4, 1e-2])
@pytest.mark.parametrize("lowest", [-1e-2, -1e-6, 1e-6, 0.1, 0.6])
@pytest.mark.parametrize("size", SIZES)
def test_a_known_mode_is_the_lowest_to_rounding(size, lowest, off):
    matrix, modes = rotated(spectrum(size, lowest))
    values, found = known_mode(matrix, near(modes[:, 0], off))
    assert values.shape == (1,) and found.shape == (size, 1)
    assert abs(values[0] - lowest) < VALUE * STIFFEST
    assert distance(found[:, 0], modes[:, 0]) < MODE
    assert found[:, 0] @ modes[:, 0] > 0


@pytest.mark.parametrize("apart", [0.0, 1e-15, 1e-12, 1e-10, 1e-9, 1e-8, 1e-6, 1e-3])
@pytest.mark.parametrize("lowest", [-1e-3, 0.0, 0.1])
def test_of_two_modes_almost_as_soft_the_lowest_is_known_or_none(lowest, apart):
    matrix, modes = rotated(spectrum(40, lowest, lowest + apart))
    low, other = modes[:, 0], modes[:, 1]
    for guess in (low, other, low + other, near(low, 1e-4), other + 1e-6 * low, other + 1e-5 * low):
        known = known_mode(matrix, guess)
        if known is not None:
            assert lowest + apart > -VALUE * STIFFEST
            assert abs(known[0][0] - lowest) < VALUE * STIFFEST
            assert np.linalg.norm(matrix @ known[1][:, 0] - known[0][0] * known[1][:, 0]) < RESIDUAL * STIFFEST


@pytest.mark.parametrize("second", [-0.5, -1e-6])
def test_a_mode_is_not_known_where_another_is_unstable_too(second):
    matrix, modes = rotated(spectrum(40, -1.0, second))
    assert known_mode(matrix, modes[:, 0]) is None


@pytest.mark.parametrize("lowest", [-1.0, 0.1])
def test_a_guess_of_another_symmetry_does_not_hide_the_softer_mode(lowest):
    matrix, modes = rotated(spectrum(40, lowest, 0.2))
    assert known_mode(matrix, modes[:, 1]) is None


@pytest.mark.parametrize("matrix", [np.zeros((1, 1)), np.zeros((3, 3)), np.diag([0.0, 1.0, 0.0])], ids=str)
def test_of_several_modes_without_stiffness_none_is_known(matrix):
    assert known_mode(matrix, np.eye(len(matrix))[0]) is None


def test_a_row_of_zeros_is_a_mode():
    values, modes = known_mode(np.diag([1.0, 0.0, 2.0]), np.array([1e-3, 1.0, 1e-3]))
    assert abs(values[0]) < 2e-39  # 7.6e-40
    np.testing.assert_allclose(np.abs(modes[:, 0]), [0.0, 1.0, 0.0], rtol=0, atol=7e-20)  # 2.8e-20


@pytest.mark.parametrize("matrix", [np.full((2, 2), np.nan), np.diag([np.inf, 1.0])], ids=["nan", "inf"])
@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_what_is_not_finite_has_no_known_mode(matrix):
    assert known_mode(matrix, np.ones(2)) is None


@pytest.mark.parametrize("count", [1, 2, 6, None])
def test_lowest_modes_are_ascending_and_right(count):
    eigenvalues = spectrum(40, -0.3)
    matrix, modes = rotated(eigenvalues)
    values, found = lowest_modes(matrix, count)
    assert np.abs(values - eigenvalues[:count]).max() < OTHER_VALUES * STIFFEST
    assert max(distance(found[:, i], modes[:, i]) for i in range(values.size)) < OTHER_MODES


def test_the_matrix_is_left_as_it_is():
    matrix, modes = rotated(spectrum(40, 0.1))
    before = matrix.copy()
    known_mode(matrix, modes[:, 0])
    lowest_modes(matrix, 2)
    np.testing.assert_array_equal(matrix, before)
