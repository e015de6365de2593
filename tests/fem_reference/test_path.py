"""Path by finite elements: Johnson's loop of one wave, a wave without adhesion, changes of contact, named ends."""

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from fem_reference.continuation import Branch
from fem_reference.descent import with_patch, without_narrow
from fem_reference.jumps import locate
from fem_reference.mesh import Resolution
from fem_reference.path import TRACKING, PathError, _zero, follow, step_unit
from fem_reference.problem import Problem

AMPLITUDE, ALPHA, NU = 0.01, 0.3, 0.3
MODULUS = 1 / (1 - NU**2)
WORK = (ALPHA * np.pi * MODULUS * AMPLITUDE) ** 2 / (2 * MODULUS)
QUICK = Resolution(2, 10, 10)


def wave(work=WORK):
    """One wave on a layer of two periods, a half-space to 1e-8; heights in units of the rms height, as the path has."""
    return Problem(1.0, NU, 2.0, 1.0, [1], [AMPLITUDE], [0.7], work)


def johnson(half_width):
    """Load and penetration, in periods, at a half-width (Johnson 1995, doi:10.1016/0020-7683(94)00111-9)."""
    psi, p_star = np.pi * half_width, np.pi * AMPLITUDE * MODULUS
    s, pull = np.sin(psi) ** 2, ALPHA * np.sqrt(np.tan(psi))
    return p_star * (s - pull), AMPLITUDE * (s * (1 - np.log(s)) + pull * np.log(s))


def fold(which):
    """Half-width at which load (0) or penetration (1) of Johnson's curve is least."""
    return minimize_scalar(
        lambda a: johnson(a)[which], bounds=(0.005, 0.3), method="bounded", options={"xatol": 1e-12}
    ).x


@pytest.mark.parametrize(("kind", "which"), [("penetration", 1), ("mean_pressure", 0)])
def test_one_wave_is_pulled_off_where_johnsons_curve_turns(kind, which):
    problem = wave()
    unit = problem.unit_stress if which == 0 else problem.unit_height
    target = float(johnson(0.2)[which]) / unit
    path = follow(problem, kind, [target, -2.0 * abs(target)])
    assert [state.status for state in path.targets] == ["converged", "separated" if which else "unreachable"]
    width = float(np.diff(path.targets[0].edges)[0, 0])
    assert width == pytest.approx(0.4, rel=1e-2)  # what the coarse mesh is good for
    assert [jump.changes[-1].kind for jump in path.jumps] == ["first_touch", "pull_off"]
    at = locate(problem, kind, path.jumps[-1], step_unit(kind, [target, -2.0 * abs(target)]), QUICK)
    exact = dict(zip(("mean_pressure", "penetration"), johnson(fold(which)), strict=True))
    exact["contact_fraction"] = 2 * fold(which)
    for name, value in exact.items():
        assert abs(at.values[name] - value) < at.uncertainty[name] + 1e-7 * abs(value), name


def test_energy_released_at_first_touch_is_that_of_johnsons_state():
    problem = wave()
    path = follow(problem, "penetration", [0.0])
    at = locate(problem, "penetration", path.jumps[0], step_unit("penetration", [0.0]), QUICK)
    half = brentq(lambda a: johnson(a)[1], fold(1), 0.3)
    steps = np.linspace(fold(1), half, 4001)
    # U falls from first touch to the state by the work of the load along Johnson's curve and the energy at its fold
    loads, places = np.array([johnson(a) for a in steps]).T
    work = float(np.sum(0.5 * (loads[1:] + loads[:-1]) * np.diff(places)))
    pulled = locate(problem, "penetration", follow(problem, "penetration", [0.0, -1.0]).jumps[-1], 0.5, QUICK)
    expected = -(pulled.values["total_energy"] + work)
    allowed = at.uncertainty["energy_released"] + pulled.uncertainty["total_energy"]
    assert abs(at.values["energy_released"] - expected) < allowed + 1e-6 * abs(expected)


def test_without_adhesion_the_order_of_targets_does_not_matter():
    problem = wave(0.0)
    up, down = (follow(problem, "penetration", targets) for targets in ([0.3, 0.6], [0.6, 0.3]))
    np.testing.assert_array_equal(up.targets[0].edges, down.targets[1].edges)
    half = float(np.diff(up.targets[1].edges)[0, 0]) / 2
    s = np.sin(np.pi * half) ** 2
    assert AMPLITUDE * s * (1 - np.log(s)) == pytest.approx(0.6 * problem.unit_height, rel=1e-2)  # Westergaard


def test_two_crests_without_adhesion_touch_and_merge():
    problem = Problem(1.0, 0.3, 0.5, 1.0, [1, 2], [0.01, 0.006], [0.1, np.pi], 0.0)
    path = follow(problem, "penetration", [0.6 * problem.highest])
    kinds = [change.kind for jump in path.jumps for change in jump.changes]
    assert kinds == ["first_touch", "new_contact", "coalescence"]
    assert len(path.targets[0].edges) == 1


def test_narrow_patches_and_gaps_are_named():
    edges = np.array([[0.1, 0.3], [0.6, 0.602]])
    opening, closing = np.ones((2, 2), bool), np.zeros((2, 2), bool)
    assert [change.kind for change in without_narrow(edges, opening)[1]] == ["detachment"]
    assert [change.kind for change in without_narrow(edges[1:], opening[1:])[1]] == ["pull_off"]
    assert without_narrow(edges, closing)[1] == []
    nearly = np.array([[0.1, 1.099]])
    assert [change.kind for change in without_narrow(nearly, closing[:1])[1]] == ["complete_contact"]
    np.testing.assert_allclose(with_patch(edges, 1.4), [[0.1, 0.3], [0.399, 0.401], [0.6, 0.602]])


def test_strong_adhesion_jumps_into_complete_contact():
    path = follow(wave(100.0 * WORK), "total_displacement", [0.0, 0.1])
    assert [target.status for target in path.targets] == ["complete_contact"] * 2
    assert [change.kind for change in path.jumps[0].changes] == ["first_touch", "complete_contact"]


def test_a_point_that_no_secant_finds_is_named():
    start, end = follow(wave(), "penetration", [0.3]).points[-2:]
    branch, middle = Branch(wave(), "penetration", TRACKING, 0.5), (start.value + end.value) / 2
    with pytest.raises(PathError, match=r"the touch at penetration .* is not located: .* after 8 secants"):
        _zero(branch, start, end, lambda point: middle - point.value, 0.0, "touch")


def test_a_path_that_cannot_begin_says_why():
    flat = Problem(1.0, 0.3, 0.5, 1.0, [1], [0.0], [0.0], 1e-5)
    path = follow(flat, "penetration", [1e-3])
    assert [target.status for target in path.targets] == ["unreachable"]  # h_max is zero
    path = follow(flat, "mean_pressure", [1e-3])
    assert [target.status for target in path.targets] == ["not_converged"]
    assert "0 crests" in path.failure
