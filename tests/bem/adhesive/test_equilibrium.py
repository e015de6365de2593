"""Equilibrium of the edges: Johnson's branch and fold, Newton that stays on its branch, descent that finds the next."""

from dataclasses import replace

import johnson_wave
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from johnson_wave import patch_of

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.descent import descend
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.strides import Steps
from bem.adhesive.trust_region import trust_region_step
from bem.adhesive.vanishing import pull_off_half_width
from bem.elastic.collocation import Elastic, resolve
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy

WAVE = Profile.from_harmonics(2 * np.pi, [1], [1.0])
ALPHA = 0.3
WORK = np.pi * ALPHA**2 / 2
SYSTEM = System(Elastic(WAVE), UniformLaw(WORK), DisplacementControl())
UNDER_LOAD = System(Elastic(WAVE), UniformLaw(WORK), LoadControl())


def penetration_of(fraction):
    return johnson_wave.penetration_of(fraction, ALPHA)


def load_of(fraction):
    return johnson_wave.load_of(fraction, ALPHA)


def slope(function, at, step=1e-5):
    return (8 * (function(at + step) - function(at - step)) - (function(at + 2 * step) - function(at - 2 * step))) / (
        12 * step
    )


def fold(function):
    """Where a quantity is least along the branch."""
    fraction = np.linspace(0.01, 0.9, 200_001)
    return float(fraction[np.argmin(function(fraction))])


@settings(max_examples=50)
@given(
    gradient=st.lists(st.floats(0.01, 1), min_size=3, max_size=3),
    entries=st.lists(st.floats(-1, 1), min_size=9, max_size=9),
    radius=st.floats(0.01, 10),
)
def test_trust_region_step_is_the_best_in_the_ball(gradient, entries, radius):
    g, matrix = np.array(gradient), np.array(entries).reshape(3, 3)
    hessian = matrix + matrix.T
    step = trust_region_step(g, hessian, radius)
    assert np.linalg.norm(step) <= radius * (1 + 1e-6)
    directions = np.random.default_rng(0).normal(size=(500, 3))
    directions *= radius / np.linalg.norm(directions, axis=1)[:, None]
    trials = np.concatenate([directions * size for size in (0.1, 0.4, 0.7, 1.0)])

    def model(s):
        return s @ g + 0.5 * np.einsum("...i,ij,...j->...", s, hessian, s)

    scale = radius * np.linalg.norm(g) + radius**2 * np.abs(hessian).max()
    assert model(step) <= model(trials).min() + 1e-6 * scale


def test_trust_region_step_stays_in_the_ball_with_hardly_any_force_on_the_soft_mode():
    step = trust_region_step(np.array([0.0, 0.0, 1e-10]), np.array([[0.0, 0, 0], [0, 0, 1], [0, 1, 0]]), 1.0)
    assert np.linalg.norm(step) <= 1 + 1e-6


@pytest.mark.parametrize("force", [0.1, 0.0])
def test_trust_region_step_takes_a_mode_without_stiffness_or_force(force):
    step = trust_region_step(np.array([0.0, force]), np.diag([0.0, 1.0]), 1.0)
    np.testing.assert_allclose(step, [0.0, -force], atol=1e-9)


def test_trust_region_step_leaves_a_saddle_without_force():
    step = trust_region_step(np.zeros(2), np.diag([1.0, -1.0]), 0.5)
    np.testing.assert_allclose(np.abs(step), [0.0, 0.5], atol=1e-6)


@pytest.mark.parametrize("times", [0.97, 1.03])
def test_smallest_eigenvalue_changes_sign_at_the_fold(times):
    fraction = times * fold(penetration_of)
    target = float(penetration_of(fraction))
    here = balance(SYSTEM, patch_of(fraction), target, target, 1e-13)
    assert np.sign(here.smallest_eigenvalue) == np.sign(times - 1)


@pytest.mark.parametrize("times", [0.97, 1.03])
def test_stability_at_fixed_load_changes_at_the_maximum_tension(times):
    fraction = times * fold(load_of)
    target = float(penetration_of(fraction))
    here = balance(SYSTEM, patch_of(fraction), target, target, 1e-13)
    assert here.stable_at_fixed_load == (times > 1)
    under_load = balance(UNDER_LOAD, patch_of(fraction), target, float(load_of(fraction)), 1e-13)
    assert (under_load.smallest_eigenvalue > 0) == here.stable_at_fixed_load


@pytest.mark.parametrize("fraction", [0.2, 0.5, 0.9])
def test_stiffness_is_the_slope_of_johnsons_branch(fraction):
    target = float(penetration_of(fraction))
    here = balance(SYSTEM, patch_of(fraction), target, target, 1e-13)
    exact = slope(load_of, fraction, 1e-4) / slope(penetration_of, fraction, 1e-4)
    assert here.stiffness == pytest.approx(exact, rel=1e-8)  # measured 1e-10


def test_residual_measures_the_release_rate():
    """At K twice the critical one G is four times w."""
    law = UniformLaw(WORK / 4)
    target = float(penetration_of(0.4))
    here = balance(System(Elastic(WAVE), law, DisplacementControl()), patch_of(0.4), target, target, 1e-13)
    assert here.residual == pytest.approx(3.0, rel=1e-11)
    assert here.is_equilibrium(3.1)
    assert not here.is_equilibrium(2.9)


def test_what_is_within_the_rounding_of_k_is_no_residual():
    """Of some thousand edges one always has more than one rounding left; the certificate allows three."""
    target = float(penetration_of(0.3))
    here = balance(SYSTEM, patch_of(0.3), target, target, 1e-12)
    missing = here.rounding / np.sqrt(here.work)
    assert replace(here, gradient=2.9 * missing * here.work).is_equilibrium(0.0)
    assert not replace(here, gradient=3.1 * missing * here.work).is_equilibrium(0.0)


@pytest.mark.parametrize("start", [0.15, 0.3, 0.7], ids=lambda f: f"from {f}")
@pytest.mark.parametrize("goal", [0.4, 0.6])
def test_descent_ends_in_johnsons_contact(start, goal):
    target = float(penetration_of(goal))
    end = descend(SYSTEM, patch_of(start), target, target, Accuracy(1e-12, 1e-10), Steps(0.4))
    assert (end.status, end.changes) == ("converged", ())
    assert end.balance.state.patches.contact_fraction == pytest.approx(goal, abs=1e-9)


def test_descent_leaves_the_unstable_branch_downwards():
    fraction = 0.5 * fold(penetration_of)
    target = float(penetration_of(fraction))
    end = descend(SYSTEM, patch_of(fraction * 1.01), target, target, Accuracy(1e-12, 1e-10), Steps(0.4))
    assert end.status == "converged"
    assert end.balance.state.patches.contact_fraction > fold(penetration_of)


def test_descent_separates_beyond_pull_off():
    target = float(penetration_of(fold(penetration_of))) - 0.02
    end = descend(SYSTEM, patch_of(0.1), target, target, Accuracy(1e-6, 1e-6), Steps(0.4))
    assert end.status == "separated"
    assert [change.kind for change in end.changes] == ["detachment"]
    assert abs((end.changes[0].position + np.pi) % (2 * np.pi) - np.pi) < 1e-6


def test_descent_closes_the_last_gap_under_a_load_that_no_branch_carries():
    """Johnson: at 1.0 p* the branch ends in complete contact."""
    end = descend(UNDER_LOAD, patch_of(0.9), 1.0, 2 * np.pi * 1.0, Accuracy(1e-6, 1e-6), Steps(0.4))
    assert end.status == "complete_contact"
    assert [change.kind for change in end.changes] == ["complete_contact"]
    assert end.changes[-1].position == pytest.approx(np.pi, abs=1e-3)


def test_narrow_gap_between_two_patches_coalesces():
    profile = Profile.from_harmonics(2 * np.pi, [1, 2], [1.0, 0.01])
    system = System(Elastic(profile), UniformLaw(0.3), DisplacementControl())
    halves = Patches(np.array([-1.5, 0.01]), np.array([-0.01, 1.5]))
    end = descend(system, halves, 0.5, 0.5, Accuracy(1e-8, 1e-8), Steps(0.4))
    assert end.status == "converged"
    assert [change.kind for change in end.changes] == ["coalescence"]
    assert end.patches.count == 1
    # beside a patch that is frozen it stays as finely resolved; else K of one that merged was -19 critical ones
    frozen = Patches(np.array([1.51]), np.array([2.0]))
    beside = descend(system, halves, 0.5, 0.5, Accuracy(1e-8, 1e-8), Steps(0.4, frozen))
    assert [change.kind for change in beside.changes] == ["coalescence"]
    whole = resolve(system.elastic, frozen.joined(beside.patches), 1e-8)
    modes = [there.balance.state.resolution.modes for there in (beside, end)]
    assert modes[0].min() >= whole.modes.max() > 2 * modes[1].max()


def test_pull_off_width_is_that_of_an_isolated_cylinder():
    """The fold of Johnson's branch under load at tiny alpha is that of the cylinder (Barquins 1988)."""
    system = System(Elastic(WAVE), UniformLaw(1e-6), DisplacementControl())
    found = pull_off_half_width(system, np.zeros(1))[0]
    alpha = np.sqrt(2e-6 / np.pi)
    psi = np.geomspace(1e-4, 0.5, 400_001)
    load = np.sin(psi) ** 2 - alpha * np.sqrt(np.tan(psi))
    assert found == pytest.approx(2 * psi[np.argmin(load)], rel=1e-3)


def test_a_gap_closes_to_the_same_contact_however_long_the_steps():
    profile = Profile.from_harmonics(2 * np.pi, [1, 2], [1.0, 0.01])
    system = System(Elastic(profile), UniformLaw(0.3), DisplacementControl())
    halves = Patches(np.array([-1.5, 0.1]), np.array([-0.1, 1.5]))
    fast, slow = (descend(system, halves, 1.0, 1.0, Accuracy(1e-8, 1e-8), Steps(size)) for size in (0.4, 0.05))
    assert [change.kind for change in fast.changes] == ["coalescence"]
    np.testing.assert_allclose(fast.patches.right, slow.patches.right, rtol=0, atol=1e-8)
