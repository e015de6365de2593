"""`linecontact fem`: the answer of a scene by finite elements, its files, and what is refused."""

import json

import meshio
import pytest

from bem.command_line.console import scene_text
from validation.command_line.front_door import main
from validation.routes.scenes import posed

SOFT = {"accuracy": None, "loading": {"control": "penetration", "targets": [15e-6, 45e-6]}}


def write(folder, changes, name="layer_two_crests"):
    path = folder / "scene.toml"
    path.write_text(scene_text(posed(name, **changes).resolved()), "utf-8")
    return str(path)


def answer(folder, changes, *words):
    return main(["fem", write(folder, changes), "--out", str(folder / "out"), "--elements", "P2/P1", *words])


@pytest.fixture(scope="module")
def answered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fem")
    assert answer(folder, SOFT) == 0
    return folder / "out"


def test_a_second_contact_is_found_where_the_profile_enters(answered):
    states = json.loads((answered / "result.json").read_text())["states"]
    assert [state["n_patches"] for state in states] == [1, 2]
    assert {state["status"] for state in states} == {"converged"}
    assert all(0 < state["error_estimate"]["mean_pressure"] < 1e-2 * abs(state["mean_pressure"]) for state in states)


def test_fields_are_written(answered):
    fields = meshio.read(answered / "fields.vtu")
    assert fields.cell_data["stress"][0].shape[1] == 9


def test_a_folder_that_is_not_empty_is_left_alone(answered, capsys):
    assert answer(answered.parent, SOFT) == 2
    assert "is not empty" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"layer": None}, "needs a [layer]"),
        ({"profile": {"orders": [1, 2, 300]}}, "unknowns of order 2 (harmonics up to 300"),
    ],
    ids=["half-space", "too large"],
)
def test_what_it_cannot_answer_is_told_in_one_line(tmp_path, capsys, changes, told):
    assert answer(tmp_path, SOFT | changes) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_path_through_unloading_has_every_state_and_event(tmp_path):
    changes = SOFT | {"loading": {"control": "penetration", "targets": [45e-6, 15e-6, -20e-6]}}
    assert answer(tmp_path, changes) == 0
    content = json.loads((tmp_path / "out" / "result.json").read_text())
    assert [state["status"] for state in content["states"]] == ["converged", "converged", "separated"]
    assert [state["n_patches"] for state in content["states"]] == [2, 1, 0]
    kinds = [event["kind"] for event in content["events"]]
    assert kinds == ["first_touch", "new_contact", "detachment", "pull_off"]


def test_a_target_that_no_state_meets_has_its_row_and_exit_code(tmp_path, capsys):
    changes = SOFT | {"loading": {"control": "penetration", "targets": [15e-6, 1e-3]}}
    assert answer(tmp_path, changes) == 1
    states = json.loads((tmp_path / "out" / "result.json").read_text())["states"]
    assert [state["status"] for state in states] == ["converged", "unreachable"]
    assert "unreachable: no state under this control" in capsys.readouterr().err
    assert states[1]["mean_pressure"] is None
