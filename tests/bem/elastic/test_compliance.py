"""The compliance of a body with several elastic effects: what each adds, what is left out, what is refused."""

from dataclasses import dataclass

import numpy as np
import pytest
from judges import SmoothKernel, dense_nodes, evaluate_dense

from bem.elastic.collocation import Elastic, evaluate
from bem.elastic.compliance import EffectSum, compliance_of
from bem.elastic.hierarchical import IllConditionedSystemError
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import Layer, LayerEffect
from bem.geometry.chebyshev import nodes_of
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.geometry.scaling import Solid


@dataclass(frozen=True)
class Soft:
    """1 + a exp(-decay m): softer than the half-space for a > 0."""

    a: float
    decay: float
    mean_compliance: float | None = None
    says: float | None = None

    @property
    def strip(self):
        return self.says or self.decay

    @property
    def relative_effect(self):
        return np.abs(self.deficit(1.0))

    def ratio(self, orders):
        return 1 - self.deficit(orders)

    def deficit(self, orders):
        return -self.a * np.exp(-self.decay * np.asarray(orders))


LAYER, SOFT = LayerEffect(0.4, 0.3, 2e-9), Soft(0.8, 0.15)
M = np.arange(1.0, 200.0)


def test_one_effect_alone_is_not_touched():
    assert compliance_of([LAYER]).kernel.effect is LAYER


def test_effects_add_what_each_changes():
    both = compliance_of([LAYER, SOFT]).kernel
    # measured 3e-16
    np.testing.assert_allclose(1 - both.ratio(M), LAYER.deficit(M) + SOFT.deficit(M), rtol=0, atol=1e-15)


def test_kernel_of_a_sum_is_the_sum_of_kernels():
    x = np.linspace(-3.0, 3.0, 50)
    parts = sum(kernel_series(effect, 1e-15).smooth(x) for effect in (LAYER, SOFT))
    # measured 6e-15
    np.testing.assert_allclose(compliance_of([LAYER, SOFT]).kernel.smooth(x), parts, rtol=0, atol=2e-14)


@pytest.mark.parametrize("effects", [[SOFT], [LAYER, SOFT], [LAYER, Soft(-0.5, 0.15)]], ids=["soft", "both", "stiff"])
def test_waves_of_either_sign_are_the_matrix(effects):
    kernel, patches = compliance_of(effects).kernel, Patches(np.array([0.5, 1.9]), np.array([1.2, 2.2]))
    modes = kernel.modes_of_kernel(patches.width, 1e-14).astype(np.int64)
    x = np.repeat(patches.center, modes) + np.repeat(patches.half_width, modes) * nodes_of(modes)
    matrix, waves = (kernel.coupling(x, patches, modes, 1e-14, few) for few in (False, True))
    pairs = kernel.smooth(np.subtract.outer(x, x))
    product = (waves.waves.columns.T * waves.waves.signs) @ waves.waves.columns
    # measured 4e-15
    np.testing.assert_allclose(matrix.matrix, pairs, rtol=0, atol=1e-14)
    np.testing.assert_allclose(product, pairs, rtol=0, atol=1e-14)


@pytest.mark.parametrize("effects", [[SOFT], [LAYER, SOFT]], ids=["softer", "both"])
def test_evaluation_is_the_dense_one(effects):
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 40, 0).scaled()
    patches = Patches(np.array([0.5, 1.9, 4.0]), np.array([1.2, 2.2, 5.5]))
    compliance = compliance_of(effects)
    state = evaluate(Elastic(profile, compliance), patches, 1.0, 1e-4)
    nodes = np.maximum(
        dense_nodes(profile, patches.left, patches.right),
        compliance.kernel.modes_of_kernel(patches.width, 1e-14).astype(np.int64),
    )
    smooth = SmoothKernel(compliance.kernel.smooth, compliance.kernel.slope)
    dense = evaluate_dense(profile, patches.left, patches.right, 1.0, nodes, smooth)
    # measured 5.4e-10 of the largest
    np.testing.assert_allclose(
        state.stress_intensity, dense.stress_intensity, rtol=0, atol=1.5e-9 * np.abs(dense.stress_intensity).max()
    )


@pytest.mark.parametrize(
    ("thickness", "tolerance", "left_out"),
    [(0.02, 1e-6, True), (0.02, 1e-10, False), (0.01, 1e-6, False), (1.0, 1e-12, True)],
    ids=["thick", "thick but strict", "one period", "very thick"],
)
def test_effects_below_the_tolerance_are_left_out_and_kept_for_the_estimates(thickness, tolerance, left_out):
    effect = Layer(thickness).effect(Solid(1e6, 0.3), 0.01)
    found = compliance_of([effect], tolerance)
    assert (found.kernel is None, found.left_out is not None) == (left_out, left_out)
    assert found.mean == effect.mean_compliance


def test_each_effect_is_judged_by_itself():
    found = compliance_of([LAYER, Soft(1e-9, 0.5)], 1e-6)
    assert (found.kernel.effect, found.left_out.effect) == (LAYER, Soft(1e-9, 0.5))


@pytest.mark.parametrize(
    ("effects", "mean"), [([SOFT], None), ([LAYER, SOFT], 2e-9), ([LAYER, Soft(1.0, 1.0, 5e-9)], 7e-9)], ids=str
)
def test_mean_compliances_add_where_there_are_any(effects, mean):
    assert compliance_of(effects).mean == mean


def test_a_half_space_has_no_kernel():
    elastic = Elastic(Profile.from_harmonics(2 * np.pi, [1], [1.0]))
    assert (elastic.compliance, elastic.kernel, elastic.left_out) == (None, None, None)


def test_effects_that_leave_no_compliance_together_are_refused_by_name():
    with pytest.raises(IllConditionedSystemError, match="without compliance"):
        EffectSum((LAYER, Soft(-0.9, 0.1))).ratio(M)


def test_a_series_that_does_not_decay_as_it_says_is_refused():
    with pytest.raises(ValueError, match="strip: 2"):
        kernel_series(Soft(0.5, 0.1, says=2.0), 1e-12)
