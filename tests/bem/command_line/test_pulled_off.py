"""A tension beyond the pull-off is an answer; one that no contact was there to carry is a failure."""

import json

import pytest

from bem.command_line.answer_table import answer
from bem.scene.result_file import read_result
from bem.scene_commands import main

SCENE = """
[solid]
youngs_modulus = 1.0e6
poisson_ratio = 0.5
[profile]
kind = "self_affine"
period = 0.01
hurst = 0.7
rms_height = 50e-6
harmonics = 8
seed = 1
[adhesion]
work_of_adhesion = 0.03
[loading]
control = "mean_pressure"
targets = TARGETS
"""


def run_of(folder, targets, *words):
    (folder / "scene.toml").write_text(SCENE.replace("TARGETS", str(targets)))
    return main(["run", str(folder / "scene.toml"), "--out", str(folder / "out"), "--quiet", *words])


@pytest.mark.parametrize("targets", [[1000.0, 0.0, -5e4], [1000.0, -5e4, -6e4, 500.0]], ids=["last", "between"])
def test_a_completed_pull_off_is_an_answer(targets, tmp_path, capsys):
    assert run_of(tmp_path, targets) == 0
    beyond = sum(target < 0 for target in targets)
    told = f"unreachable, answered: pulled off, {beyond} of the targets being tensions beyond that: "
    assert told in capsys.readouterr().out
    result = read_result(tmp_path / "out")
    assert repr(result).startswith("<Result unreachable, answered: pulled off: ")
    assert (result.status, result.answered) == ("unreachable", True)
    assert result.to_table("targets")["target"].tolist() == targets
    assert answer(result)[0][1][1 if beyond > 1 else 2] == "-50 kPa"


def test_a_tension_before_any_contact_is_a_failure(tmp_path, capsys):
    assert run_of(tmp_path, [-5e4, 100.0, -5e4], "--json") == 1
    facts = json.loads(capsys.readouterr().out)
    assert (facts["status"], facts["answered"], len(facts["missed_targets"])) == ("unreachable", False, 2)
