"""The convergence study: verdicts from manufactured curves, failures kept, the curves of each code, its files."""

import json
import pickle
from dataclasses import replace

import pytest
from carried import carried, failing

from validation.corpus.convergence_curves import (
    Curve,
    bem_curves,
    ensemble_curve,
    fem_curve,
    paper_method_curve,
    persson_curves,
)
from validation.harness.verdict import verdict_of
from validation.studies import convergence
from validation.studies.convergence import figures_of, rate_rows

SIZES = (4.0, 8.0, 16.0, 32.0)
SECOND = Curve(
    id="second", code="none", quantity="error", knob="cells", sizes=SIZES, errors=tuple(n**-2.0 for n in SIZES),
    law="algebraic", predicted=2.0, low=1.9, high=2.1, why="made so", kind="manufactured", reference="a power law",
)  # fmt: skip
FALLING = tuple(max(1e-3 * 2.0**-n, 1e-15) for n in range(40))
TWICE = replace(
    SECOND, id="twice", law="geometric", sizes=tuple(float(n) for n in range(40)), errors=FALLING, predicted=2.0
)


def study(folder, *curves, increments=(0.05, 0.05)):
    parts = {curve.id: lambda curve=curve: curve for curve in curves}
    return carried(convergence, folder, parts=parts, increments=increments)


def met(curve):
    return all(verdict_of(row) == "agrees" for row in rate_rows(curve))


@pytest.mark.parametrize(
    ("curve", "good"),
    [
        (SECOND, True),
        (replace(SECOND, errors=tuple(n**-1.5 for n in SIZES)), False),
        (replace(SECOND, errors=tuple(n**-2.5 for n in SIZES)), False),
        (TWICE, True),
        (replace(TWICE, errors=tuple(max(e, 1e-10) for e in FALLING)), False),
        (replace(SECOND, errors=(0.1, 0.1, float("nan"), 0.1)), False),
    ],
    ids=["right", "too-slow", "too-fast", "geometric", "plateau-too-high", "no-number"],
)
def test_verdict_of_a_manufactured_curve(curve, good):
    assert met(curve) is good


def test_study_writes_rows_figures_and_numbers(here, tmp_path, monkeypatch):
    monkeypatch.setattr(convergence, "path_targets", lambda harmonics, increment: ([0.1], 3))
    report = study(tmp_path, SECOND, TWICE)
    assert failing(report) == []
    stored = json.loads((tmp_path / "convergence.json").read_text())
    assert [curve["rate"]["value"] for curve in stored["curves"]] == pytest.approx([2.0, 2.0], rel=1e-9)
    assert report.cases[0].tables[1].caption.startswith("The path (self-convergence: no digits)")
    names = ("convergence-geometric", "convergence-others")
    assert [figure.id for figure in report.cases[0].figures] == list(names)
    assert all((tmp_path / "figures" / f"{name}.svg").is_file() for name in names)


def test_curve_that_fails_is_a_row_and_fails_the_study(here, tmp_path, monkeypatch):
    monkeypatch.setattr(convergence, "path_targets", lambda harmonics, increment: ([0.1], 3))

    def broken():
        raise ArithmeticError("singular")

    report = carried(convergence, tmp_path, parts={"broken": broken, "second": lambda: (SECOND,)}, increments=(0.05,))
    assert failing(report) == ["broken: answered (1: yes): error, ArithmeticError: singular"]
    assert [curve["id"] for curve in json.loads((tmp_path / "convergence.json").read_text())["curves"]] == ["second"]


@pytest.mark.parametrize(("change", "good"), [(0.9e-6, True), (1.1e-6, False)])
def test_path_that_depends_on_its_increments_fails_the_study(here, tmp_path, monkeypatch, change, good):
    def targets(harmonics, increment):  # against the finest
        return [0.1 + change * (increment == 0.2)], 3

    monkeypatch.setattr(convergence, "path_targets", targets)
    assert (failing(study(tmp_path, SECOND, increments=(0.2, 0.05))) == []) is good


def test_path_that_does_not_converge_is_told(here, tmp_path, monkeypatch):
    def lost(harmonics, increment):
        raise ArithmeticError("not_converged")

    monkeypatch.setattr(convergence, "path_targets", lost)
    assert failing(study(tmp_path, SECOND)) == ["path: answered (1: yes): error, ArithmeticError: not_converged"]


def test_parts_of_the_study_reach_other_processes():
    for quick in (True, False):
        parts = convergence.curves_of(quick)
        assert repr(pickle.loads(pickle.dumps(parts))) == repr(parts)


@pytest.mark.parametrize(
    "curves",
    [
        lambda: bem_curves(0.9, range(4, 49, 4)),
        lambda: (fem_curve(2, (4, 8, 16), True),),
        lambda: (fem_curve(2, (8, 16, 32), False),),
        lambda: persson_curves((25, 50, 100, 200), (6, 12, 25, 50)),
        lambda: (paper_method_curve((8, 16, 32)),),
    ],
    ids=["bem", "fem-graded", "fem-uniform", "persson", "paper-method"],
)
def test_rates_of_the_codes_are_those_predicted(curves):
    assert all(map(met, curves()))


def test_graded_meshes_win_back_what_the_edges_cost():
    uniform, graded = (fem_curve(2, sizes, kind) for sizes, kind in (((8, 16, 32), False), ((4, 8, 16), True)))
    assert graded.rate.value > uniform.rate.value + 2  # 4.4 against 1.2
    assert graded.errors[-1] < 0.01 * uniform.errors[-1]  # 4e-6 against 1.6e-3


def test_ensemble_groups_are_of_independent_realisations(monkeypatch):
    import numpy as np

    from validation.corpus import convergence_curves

    normal = np.random.default_rng(0).normal(1.0, 0.1, 4096)
    monkeypatch.setattr(convergence_curves, "_area", lambda harmonics, seed: float(normal[seed]))
    curve = ensemble_curve(10, 4096)
    assert curve.rate.value == pytest.approx(0.5, abs=0.05)  # 0.50
    assert curve.errors[0] == pytest.approx(0.1, rel=0.03)
    assert curve.samples == tuple(normal.tolist())


def test_figures_of_every_kind_of_curve():
    spread = replace(SECOND, id="ensemble-area", samples=(0.1, 0.2, 0.3))
    names = [figure.id for figure in figures_of([SECOND, TWICE, spread])]
    assert names == [f"convergence-{name}" for name in ("geometric", "others", "ensemble", "mean-area")]


def test_rows_carry_the_source_of_the_reference():
    assert (
        "manufactured" in rate_rows(SECOND)[0].reference.source
        and "a power law" in rate_rows(SECOND)[0].reference.source
    )
