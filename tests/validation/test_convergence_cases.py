"""Cases of convergence and of the paper's method: rows that judge, and what makes them fail."""

from dataclasses import replace

import numpy as np
import pytest

from validation.cases.rough_profiles import paper_method_audit
from validation.cases.rough_profiles.paper_method_audit import Limit
from validation.cases.suite import convergence_rates
from validation.corpus.convergence_curves import paper_method_curve
from validation.harness.case import gathered
from validation.harness.verdict import verdict_of


def test_rate_off_on_either_side_deviates():
    curve = paper_method_curve((8, 16, 32))
    for order, verdict in ((2.0, "agrees"), (1.7, "deviates"), (2.4, "deviates")):
        made = replace(curve, errors=tuple(n**-order for n in curve.sizes))
        assert [verdict_of(row) for row in convergence_rates._rate_rows([made], {made.id: 0.033})] == [verdict]


def test_extrapolation_of_second_order_is_exact_for_it():
    grids = [np.array([1.0 + 0.3 / n**2]) for n in (8, 16, 32)]
    found = Limit.of(*grids)
    assert found.value == pytest.approx(1.0, rel=1e-14)
    assert found.uncertainty < 1e-14


def test_extrapolation_tells_its_own_error():
    grids = [np.array([1.0 + 0.3 / n**2 + 0.2 / n**3]) for n in (8, 16, 32)]
    found = Limit.of(*grids)
    assert abs(found.value[0] - 1.0) < found.uncertainty < 20 * abs(found.value[0] - 1.0)


def test_edges_are_listed_from_the_start_of_the_period():
    listed = paper_method_audit._listed(np.array([[-0.2, 0.1], [1.4, 1.6], [0.2, 0.3]]), 1.0)
    assert listed == pytest.approx(np.array([[0.2, 0.3], [0.4, 0.6], [0.8, 1.1]]), abs=1e-14)


def test_audit_agrees_and_notices_a_shifted_edge(monkeypatch):
    assert {verdict_of(row) for row in gathered(paper_method_audit._layer).rows} == {"agrees"}
    solved = paper_method_audit._solved

    def shifted(posed):
        state = solved(posed)
        (left, right), second = state.edges
        return replace(state, edges=((left, right + 2e-7), second), contact_fraction=state.contact_fraction + 2e-5)

    monkeypatch.setattr(paper_method_audit, "_solved", shifted)
    verdicts = {row.quantity: verdict_of(row) for row in gathered(paper_method_audit._layer).rows}
    assert verdicts["contact fraction"] == verdicts["edges over the period"] == "deviates"
    assert verdicts["mean pressure over E* h'_rms / 2"] == "agrees"
