"""Page of a run that pulled off: a tension beyond it is an answer, one that no contact was there to carry a failure."""

import pytest

import bem
from validation.report.run_page import render_run
from validation.report.run_words import outcome, succeeded

PROFILE = bem.Profile.self_affine(0.01, 0.7, 50e-6, 8, 1)


@pytest.mark.parametrize(
    ("targets", "answered", "verdict"),
    [
        ([1000.0, 0.0, -5e4], True, 'class="verdict neutral">Pulled off'),
        ([-5e4, 100.0, -5e4], False, 'class="verdict deviates">✗ Unreachable'),
    ],
)
def test_a_pull_off_is_an_answer_after_a_contact(targets, answered, verdict):
    loading = {"control": "mean_pressure", "targets": targets}
    result = bem.solve(profile=PROFILE, solid=bem.Solid(1e6, 0.5), adhesion=bem.Adhesion(0.03), loading=loading)
    assert succeeded(result) == answered
    assert verdict in render_run(result)
    assert (" Why: " in outcome(result)) != answered
