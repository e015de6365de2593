"""The price list and the stages of the solver: digits on exact scenes, words, nothing left behind."""

from dataclasses import replace

import pytest

import bem
import bem.adhesive.equilibrium
import bem.elastic.collocation
import bem.elastic.hierarchical
from validation.corpus.effects import EFFECTS, loaded_alone, rough
from validation.studies.stages import REST, timed_stages
from validation.studies.work_precision.price_list import DIGITS, Price, digits_of, sentences

PRICE = Price("layer", "bare", 3.0, 2.0, 3.0, 39, 1e-9, 1e-7, "finite elements")
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
    reported = sentences([replace(PRICE, effect="bare", on_top_of=""), PRICE], [])
    assert reported == [
        "layer: 3.00 times the scene without it (bare), +2 s; digits: 7.0, all that the reference resolves "
        "(finite elements).",
        "Absent effects cost nothing: the bare scene loads no module of theirs.",
    ]
    assert (
        sentences([], ["bem.elastic.layer"])[-1]
        == "Absent effects are not absent: the bare scene loads bem.elastic.layer."
    )


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
