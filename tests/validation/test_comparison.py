"""`linecontact compare`: results and reports by their uncertainties, and what cannot be compared."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from stored_states import stored_state

import bem
from bem.scene.result_file import write_result
from bem.scene.state import ErrorEstimate
from validation.command_line.comparison import LIMIT, Apart, _numbers, compare_reports, compare_results
from validation.command_line.front_door import main
from validation.plugin.content import content_of
from validation.plugin.rows import Code, Quantity, Rows
from validation.plugin.study_report import Part
from validation.report.pages import ReportError

SCENE = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": 8, "seed": 1},
    "adhesion": {"work_of_adhesion": 0.03},
    "loading": {"control": "separation", "targets": [6e-5, 4e-5, 9e-5]},
}


@pytest.fixture(scope="module")
def result():
    return bem.solve(SCENE)


def moved(result, **changes):
    """The result with the first target changed: numbers by that many of their combined uncertainties."""
    place = next(k for k, state in enumerate(result.states) if state.target)
    state = result.states[place]
    new = dict(changes)
    for name, times in changes.items():
        if isinstance(times, float):
            new[name] = getattr(state, name) + 2 * times * getattr(state.error_estimate, name)
    return replace(result, states=(*result.states[:place], replace(state, **new), *result.states[place + 1 :]))


def test_another_accuracy_agrees_within_the_uncertainties(result):
    found = compare_results(result, bem.solve({**SCENE, "accuracy": {"tolerance": 1e-9, "max_increment": 0.03}}))
    assert found.differing == []
    assert 0 < max(number.ratio for number in found.numbers) < LIMIT
    assert found.notes[0] == "the scenes differ in accuracy.tolerance: 1e-06 and 1e-09"


def test_another_physics_differs_far_beyond_them(result):
    found = compare_results(result, bem.solve({**SCENE, "adhesion": {"work_of_adhesion": 0.0300001}}))
    worst = {number.quantity: number.ratio for number in found.worst()}
    assert worst["mean pressure"] > 100


def test_largest_tensions_are_compared_by_their_errors(result):
    tension = result.largest_tension
    doubt = tension.error_estimate.mean_pressure
    other = replace(result, largest_tension=replace(tension, mean_pressure=tension.mean_pressure - 5 * doubt))
    assert compare_results(result, other).differing[0].startswith("largest tension: mean pressure")
    without = compare_results(result, replace(result, largest_tension=None))
    assert without.differing == ["only in A: largest tension"]


@pytest.mark.parametrize(("times", "differs"), [(1.9, False), (2.1, True)])
def test_numbers_differ_beyond_twice_the_combined_uncertainty(result, times, differs):
    found = compare_results(result, moved(result, mean_pressure=times))
    assert bool(found.differing) is differs
    assert max(number.ratio for number in found.numbers) == pytest.approx(times, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda r: moved(r, n_patches=7), "n patches"),
        (lambda r: moved(r, status="not_converged"), "status converged and not_converged"),
        (lambda r: replace(r, states=r.states[: r.states.index(r.targets[-1])]), "only in A: separation 9e-05"),
        (lambda r: replace(r, events=r.events[:-1]), "events: "),
        (lambda r: moved(r, mean_pressure=math.nan, status="unreachable"), "mean pressure"),
    ],
    ids=["patches", "status", "target", "events", "nan"],
)
def test_what_is_no_matter_of_uncertainty_is_told(result, change, said):
    assert any(said in line for line in compare_results(result, change(result)).differing)


def test_results_of_another_control_are_not_comparable(result):
    other = bem.solve({**SCENE, "loading": {"control": "mean_pressure", "targets": [1000.0]}})
    with pytest.raises(ReportError, match=r"loading.control is 'separation' and 'mean_pressure'"):
        compare_results(result, other)


def test_results_without_a_common_target_are_not_comparable(result):
    other = bem.solve({**SCENE, "loading": {"control": "separation", "targets": [7e-5]}})
    with pytest.raises(ReportError, match="not comparable: no target of separation in common"):
        compare_results(result, other)


@pytest.mark.parametrize(
    ("a", "b", "ratio"), [(1.0, 1.0, 0.0), (math.nan, math.nan, 0.0), (1.0, math.nan, math.inf), (1.0, 2.0, math.inf)]
)
def test_a_difference_without_uncertainty(a, b, ratio):
    assert Apart("x", "here", a, b, 0.0).ratio == ratio


def report_of(uncertainty=1e-3, **measured):
    """The content of a report with one case for each name, with the value that it measured."""
    parts = []
    for name, value in measured.items():
        rows = Rows()
        rows.compare("area", value, 1.0, of=Code.BEM, by=Code.EXACT, quantity=Quantity.AREA, uncertainty=uncertainty)
        parts.append(Part(name, "?", rows))
    run = {"level": "quick", "command": "", "seconds": 0.0, "not_run": [], "provenance": {}}
    return content_of(run | {"cases": [part.case() for part in parts]})


def test_reports_agree_within_the_uncertainties_of_both():
    found = compare_reports(report_of(one=1.0), report_of(one=1.0008))
    assert found.differing == []
    assert max(number.ratio for number in found.numbers) == pytest.approx(0.8 / 2**0.5)


def test_reports_differ_in_numbers_verdicts_and_rows():
    found = compare_reports(report_of(one=1.0, two=1.0), report_of(one=1.5, three=1.0))
    assert [line.split(":")[0] for line in found.others] == ["only in A", "only in B", "one"]
    assert any("one: area [bem, closed form] 1 and 1.5" in line for line in found.differing)


def written(folder, content):
    """A folder that holds a result or a report."""
    folder.mkdir()
    if isinstance(content, dict):
        (folder / "report.json").write_text(json.dumps(content))
    else:
        write_result(content, folder)
    return str(folder)


def test_exit_codes_and_one_summary_line(result, tmp_path, capsys):
    a, b = written(tmp_path / "a", result), written(tmp_path / "b", moved(result, mean_pressure=5.0))
    assert main(["compare", a, a]) == 0
    told = capsys.readouterr().out
    assert told.count("\n") == 1
    assert "numbers compared: they agree" in told
    assert main(["compare", a, b]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[0].startswith("DIFFERS separation 6e-05 (loading): mean pressure ")
    assert "5 times the combined uncertainty" in told[0]
    assert told[-1].endswith("numbers compared: 1 differ, and 0 other differences")


def test_folders_of_two_kinds_are_told_in_one_line(result, tmp_path, capsys):
    run, report = written(tmp_path / "run", result), written(tmp_path / "report", report_of(one=1.0))
    assert main(["compare", run, report]) == 2
    assert (
        capsys.readouterr().err
        == f"error: not comparable: {run} holds a result, {report} holds a verification report\n"
    )
    assert main(["compare", report, report]) == 0


def test_numbers_that_differ_by_rounding_are_equal():
    one = stored_state(mean_pressure=2e6, error_estimate=ErrorEstimate(mean_pressure=7e-12))
    other = stored_state(mean_pressure=np.nextafter(2e6, 3e6), error_estimate=ErrorEstimate(mean_pressure=7e-12))
    (number,) = _numbers(one, other, ErrorEstimate, "here")
    assert number.a != number.b
    assert not number.differs
