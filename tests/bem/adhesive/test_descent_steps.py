"""Descents end in the nearest minimum: no step leaps over the barrier that a short wave puts in the way."""

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.descent import descend
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.strides import Steps
from bem.elastic.collocation import Elastic
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl
from bem.loading.increments import Accuracy

TOLERANCE, RESIDUAL = 1e-8, 1e-8
RIPPLES = {  # orders, height of the ripple, work of adhesion, penetration, half width from which the edges start
    "start beside a barrier": (100, 0.004, 0.01, 0.2, 0.5),
    "two minima within reach": (100, 0.004, 0.01, 0.4, 0.4),
    "high ripple": (40, 0.02, 0.03, 0.4, 0.5),
    "interpenetrating start": (100, 0.008, 0.03, 0.4, 0.3),
}


def rippled(order, ripple, work):
    profile = Profile.from_harmonics(TWO_PI, [1, order], [1.0, ripple])
    return System(Elastic(profile), UniformLaw(work), DisplacementControl())


def symmetric(half_width):
    return Patches(np.array([-half_width]), np.array([half_width]))


@pytest.mark.parametrize("step", [0.1, 0.4], ids=["local step", "global step"])
@pytest.mark.parametrize("name", RIPPLES)
def test_no_minimum_lies_between_start_and_end(name, step):
    """All the way K stays below its critical value, so that the edges cannot have been at rest before the end."""
    order, ripple, work, target, start = RIPPLES[name]
    system = rippled(order, ripple, work)
    end = descend(system, symmetric(start), target, target, Accuracy(TOLERANCE, RESIDUAL), Steps(step))
    assert end.status == "converged"
    reached = float(end.patches.right[0])
    assert reached > start + 0.2 * TWO_PI / order
    between = np.linspace(start, reached, 302)[1:-1]
    states = [balance(system, symmetric(half), target, target, TOLERANCE).state for half in between]
    assert max(state.stress_intensity.max() for state in states) < 2 * np.sqrt(work)
