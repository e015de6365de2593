"""The price list and the stages of the solver: digits on exact scenes, words, nothing left behind."""

from dataclasses import replace
from itertools import count
from types import SimpleNamespace

import pytest

import bem
import bem.adhesive.equilibrium
import bem.elastic.collocation
import bem.elastic.hierarchical
from validation.cases.suite import costs as priced
from validation.corpus import effects
from validation.corpus.accuracy_costs import CostPoint, stored
from validation.corpus.effects import EFFECTS, Cost, Times, costs_of, loaded_alone, rough
from validation.harness.case import gathered
from validation.studies.stages import REST, timed_stages
from validation.studies.work_precision.price_list import DIGITS, Price, digits_of, sentences

PRICE = Price("layer", "bare", 3.0, Times(3.0, 0.02), 39, 1e-9, 1e-7, "finite elements")
EXACT = [name for name in DIGITS if name not in ("layer", "error estimate")]


@pytest.mark.parametrize("name", EXACT)
def test_effect_holds_its_digits_on_the_sinusoid(name):
    error, _, _ = DIGITS[name]()
    assert error < 2e-14  # at most 6.7e-15, over the kernels that OpenBLAS has for five processors


def test_estimated_error_is_above_the_true_one():
    _, _, reported = DIGITS["error estimate"]()
    estimated, true = (float(part.split()[1].rstrip(";")) for part in reported.split(":")[1].split(", "))
    assert true < estimated < 1e-13  # at most 2.4e-15 and 2.7e-14, over the kernels of five processors


@pytest.mark.slow
def test_layer_agrees_with_finite_elements():
    error, floor, _ = DIGITS["layer"]()
    assert error < floor < 1e-5  # 8.9e-8, 8.9e-7


def test_every_effect_is_priced_against_one_before_it():
    names = [effect.name for effect in EFFECTS]
    assert all(effect.on_top_of in names[: names.index(effect.name)] for effect in EFFECTS[1:])
    assert set(names) | {"error estimate"} == set(DIGITS)


def test_digits_end_where_the_reference_does():
    assert digits_of(PRICE) == "7.0, all that the reference resolves"
    assert digits_of(replace(PRICE, error=1e-3)) == "3.0"
    assert digits_of(replace(PRICE, error=float("nan"))) == "no exact answer"


def test_list_in_words():
    reported = sentences([replace(PRICE, effect="bare", on_top_of="", times=None), PRICE], [])
    assert reported == [
        "layer, times the scene without it (bare): 3.00 ± 0.02; digits: 7.0, all that the reference resolves "
        "(finite elements).",
        "Absent effects cost nothing: the bare scene loads no module of theirs.",
    ]
    assert (
        sentences([], ["bem.elastic.layer"])[-1]
        == "Absent effects are not absent: the bare scene loads bem.elastic.layer."
    )


def test_scenes_run_in_alternation_and_the_quickest_run_counts(monkeypatch):
    order, clock = [], count()
    ended = SimpleNamespace(states=[SimpleNamespace(evaluations=2), SimpleNamespace(evaluations=3)])

    def ran(scene):
        order.append(scene)
        for _ in range(10 // len(order)):  # the first runs are slow
            next(clock)
        return ended

    monkeypatch.setattr(effects, "solved", ran)
    monkeypatch.setattr(effects.time, "process_time", lambda: float(next(clock)))
    found = costs_of({"bare": "one", "layer": "two"}, 3)
    assert order == ["one", "two"] * 3
    assert found == {"bare": Cost((11.0, 4.0, 3.0), 5), "layer": Cost((6.0, 3.0, 2.0), 5)}
    assert (found["bare"].least, found["bare"].noise) == (3.0, pytest.approx(1 / 3))


def test_ratio_is_told_with_what_repetition_changes_of_it():
    times = Times.of(Cost((6.3, 6.0, 9.0), 1), Cost((2.0, 2.1, 4.0), 1))
    assert str(times) == "3.0 ± 0.3"  # 5 % of each
    assert times.noise == pytest.approx(0.3)


@pytest.mark.parametrize("seconds", [(0.8, 0.8, 0.81), (1.05, 1.15, 1.2), (1.0, 1.0, 1.0)])
def test_no_price_is_told_of_an_effect_that_takes_no_longer(seconds, monkeypatch):
    costs = {effect.name: Cost((1.0, 1.0, 1.0), 7) for effect in EFFECTS} | {"slope term": Cost(seconds, 6)}
    monkeypatch.setattr(priced, "costs_of", lambda scenes, runs: costs)
    (table,) = gathered(priced._prices).tables
    lines = {str(line[0]): dict(zip(table.columns, line, strict=True)) for line in table.rows}
    assert str(lines["slope term"]["times the scene without it"]).startswith("no more, ± ")
    assert all(not isinstance(cell, float | int) or cell >= 0 for line in table.rows for cell in line)


def point(route, setting, seconds):
    return CostPoint("rough", route, setting, 100, seconds, 1e-3, 1e-9, "another code")


def test_a_route_with_one_point_is_left_out_with_a_sentence():
    points = [point("bem", "1e-2", 1.0), point("bem", "1e-4", 2.0), point("fft, c = 8", "1024", 3.0)]
    points += [point("fem", "(2, 4, 4)", 4.0), point("fem", "(4, 4, 6)", 5.0), point("fem", "(4, 4, 8)", 6.0)]
    curves, sentence = priced.curves_of(points)
    assert [curve.label for curve in curves if curve.label] == ["boundary elements", "finite elements, P4"]
    alone = "finite elements, P2, FFT grid, cohesion along 8 spacings"
    assert sentence == f" Left out, as one point is no curve: {alone}."
    assert priced.curves_of(points[:2])[1] == ""


def test_both_orders_of_finite_elements_are_drawn_on_the_rough_profile():
    curves, _ = priced.curves_of(point for point in stored().points if point.scene == "rough")
    assert {"finite elements, P2", "finite elements, P4"} <= {curve.label for curve in curves}
    assert all(len(curve.x) > 1 for curve in curves)


def test_bare_scene_loads_no_module_of_absent_effects():
    assert loaded_alone(10) == []


def test_stages_add_up_to_the_whole():
    with timed_stages() as times:
        bem.solve(rough({}, 10))
    shares = times.shares()
    assert sum(shares.values()) == pytest.approx(times.total, rel=1e-12)
    assert min(shares.values()) >= 0
    assert times.calls["factorisation"] >= times.calls["Newton, rest"] > 0
    assert times.whole["evaluation, rest"] > times.own["evaluation, rest"]
    assert shares[REST] < 0.5 * times.total  # 5 %


def test_solver_is_as_before_afterwards():
    before = (
        bem.adhesive.equilibrium.evaluate,
        bem.adhesive.equilibrium.lowest_modes,
        bem.elastic.hierarchical.lapack,
        bem.elastic.collocation.evaluate,
    )
    with pytest.raises(ZeroDivisionError), timed_stages():
        assert bem.adhesive.equilibrium.evaluate is not before[0]
        raise ZeroDivisionError
    after = (
        bem.adhesive.equilibrium.evaluate,
        bem.adhesive.equilibrium.lowest_modes,
        bem.elastic.hierarchical.lapack,
        bem.elastic.collocation.evaluate,
    )
    assert all(a is b for a, b in zip(after, before, strict=True))
