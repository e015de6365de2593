"""Route assembled by scikit-fem's forms against the fast sums on one mesh: loads, energies, G, fields."""

import numpy as np
import pytest

from fem_reference.by_forms import layer_state
from fem_reference.closure import Control, evaluate
from fem_reference.mesh import Resolution, layer_mesh
from fem_reference.problem import Problem
from fem_reference.result import strain_energy

EDGES = np.array([[0.42, 0.58], [0.85, 1.07]])


@pytest.mark.parametrize(("ratio", "order"), [(0.3, 2), (0.499999, 2), (-0.5, 2), (0.3, 4), (0.5, 4)])
def test_forms_and_fast_sums_agree_to_ten_digits(ratio, order):
    problem = Problem(1.0, ratio, 0.5, 1.0, [1, 2, 3], [0.004, 0.01, 0.002], [0.3, -0.4, 1.0])
    resolution = Resolution(order, 4 if order == 4 else 6, 4)
    mesh = layer_mesh(problem.depth, EDGES, resolution, problem.highest_order)
    fast = evaluate(problem, mesh, resolution, Control("total_displacement", 0.9))
    profile = [lambda x, f=f: f(mesh.seam + x) for f in (problem.height, problem.slope)]
    left = mesh.local_edges[:, :1]
    edges = left + np.hstack([0.0 * left, np.diff(EDGES)])
    forms = layer_state(mesh.triangles, 1.0, ratio, tuple(profile), edges, 0.9 - problem.highest, order)
    assert forms.load == pytest.approx(fast.load, rel=1e-10)  # measured 3e-12
    assert forms.strain_energy == pytest.approx(strain_energy(fast), rel=1e-10)  # measured 4e-13
    np.testing.assert_allclose(forms.release_rate, fast.values.release_rate, rtol=1e-10)  # measured 6e-11
    n, _ = fast.states.spaces.sizes
    field = fast.states.fields[0] + fast.load * fast.states.fields[1]
    for component, indices in enumerate(forms.basis.split_indices()):
        ours = field[component * n : (component + 1) * n]
        np.testing.assert_allclose(forms.displacement[indices], ours, atol=1e-10 * np.abs(field[: 2 * n]).max())
