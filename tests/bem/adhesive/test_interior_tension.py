"""Tension inside a contact: that which opens a flaw, against a contact with that flaw; and the warning of a run."""

import numpy as np
import pytest
from judges import evaluate_dense
from rough_surfaces import rough_scene

from bem.adhesive.interior_tension import largest_tension, opening_tension
from bem.geometry.profile import Profile
from bem.solver import solve


def test_a_flaw_is_about_to_run_under_the_tension_that_was_there():
    """A patch held down across the valley of a wave, with and without a crack in the middle."""
    wave, flaw = Profile.from_harmonics(2 * np.pi, [1], [-1.0], [0.0]), 1e-3
    whole = evaluate_dense(wave, np.array([-2.0]), np.array([2.0]), 0.6)
    tension = largest_tension(whole.pressure, 1.0)
    edges = np.array([-2.0, flaw / 2]), np.array([-flaw / 2, 2.0])
    cracked = evaluate_dense(wave, *edges, 0.6, np.array([300, 300]))
    inner = cracked.stress_intensity[[1, 2]]  # left edge of the second patch, right edge of the first
    assert np.all(inner > 0)
    assert opening_tension(inner**2 / 4, flaw) == pytest.approx(tension, rel=1e-6)  # measured 4.1e-7


def test_tension_close_to_an_edge_is_not_looked_at():
    wave = Profile.from_harmonics(2 * np.pi, [1], [1.0], [0.0])
    pressure = evaluate_dense(wave, np.array([-1.0]), np.array([1.0]), 0.3).pressure  # pulled at its edges
    assert largest_tension(pressure, 0.0) > 0
    assert largest_tension(pressure, 0.9) == 0


@pytest.mark.parametrize(("work", "warned"), [(1e-9, 1), (0.03, 0)])
def test_a_run_warns_once_of_a_tension_that_flaws_of_atomic_size_would_not_bear(work, warned):
    result = solve(rough_scene([60e-6, 20e-6, 60e-6], adhesion=work))
    found = [caution.message for caution in result.warnings if caution.about == "interior_tension"]
    assert len(found) == warned
    assert all("open a flaw of 3e-10 m" in message for message in found)
