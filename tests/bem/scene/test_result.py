"""Result files: bit-for-bit round trip, atomic replacement, and corruption that is named."""

import hashlib
import json
import math
import os
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stored_states import stored_state

from bem.scene import result_file
from bem.scene.result import Effect, ErrorEstimate, Event, EventError, NotFiniteError, Result, State
from bem.scene.result_file import CorruptResultError, provenance, read_result, write_result

SCENE = {"title": "é", "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.1 + 0.2}}
STATE = stored_state(
    penetration=1e-5 / 3,
    mean_pressure=-0.1,
    contact_stiffness=None,
    error_estimate=ErrorEstimate(mean_pressure=1e-9, contact_fraction=None),
)
RESULT = Result(
    scene=SCENE,
    effects=(Effect("half_space", True, "no [layer]", 1.5),),
    provenance=provenance(SCENE),
    states=(STATE, replace(STATE, target=False)),
    events=(
        Event("first_touch", 0.0, 0.0, 0.003, 1e-9, EventError(1e-15, 1e-9, 1e-16)),
        Event("pull_off", 0.0, -1.0, None, None, EventError(1e-15, None, None)),
    ),
    status="converged",
    fields={"x_0": np.linspace(0, 1, 5), "pressure_0": np.array([np.nan, 1.0]), "patch_0": np.array([0, 1])},
)


def assert_same(one, other):
    assert (one.scene, one.effects, one.provenance) == (other.scene, other.effects, other.provenance)
    assert (one.states, one.events, one.status) == (other.states, other.events, other.status)
    assert sorted(one.fields) == sorted(other.fields)
    for name, values in one.fields.items():
        np.testing.assert_array_equal(values, other.fields[name], strict=True)


def test_result_comes_back_bit_for_bit(tmp_path):
    write_result(RESULT, tmp_path / "new" / "folder")
    assert_same(read_result(tmp_path / "new" / "folder"), RESULT)


@given(value=st.floats(allow_nan=False, allow_infinity=False))
def test_any_finite_number_comes_back_exactly(value, tmp_path_factory):
    folder = tmp_path_factory.mktemp("result")
    write_result(replace(RESULT, states=(replace(STATE, penetration=value),), fields={}), folder)
    stored = read_result(folder).states[0].penetration
    assert (stored, math.copysign(1, stored)) == (value, math.copysign(1, value))


def test_json_has_no_nan_and_no_infinity(tmp_path):
    """What is open in complete contact, and an error that cannot be reported, are null."""
    unknown = ErrorEstimate(mean_pressure=math.inf)
    state = replace(STATE, mean_pressure=math.nan, status="complete_contact", error_estimate=unknown)
    write_result(replace(RESULT, states=(state,)), tmp_path)
    content = json.loads((tmp_path / "result.json").read_text(), parse_constant=pytest.fail)
    assert content["states"][0]["mean_pressure"] is None
    assert content["states"][0]["error_estimate"]["mean_pressure"] is None
    assert math.isnan(read_result(tmp_path).states[0].mean_pressure)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf], ids=str)
@pytest.mark.parametrize(
    "name", [field.name for field in fields(State) if isinstance(getattr(STATE, field.name), float)]
)
@pytest.mark.parametrize("status", ["converged", "separated", "complete_contact", "not_converged"])
def test_no_state_holds_what_is_no_number(status, name, value):
    if name == "mean_pressure" and math.isnan(value) and status == "complete_contact":
        replace(STATE, status=status, mean_pressure=value)  # any pressure would do
        return
    with pytest.raises(NotFiniteError, match=name):
        replace(STATE, status=status, **{name: value})


@pytest.mark.parametrize(
    "change",
    [
        {"edges": ((0.001, 0.002), (math.nan, 0.01))},
        {"certificate": replace(STATE.certificate, closure=math.nan)},
        {"error_estimate": ErrorEstimate(total_energy=math.nan)},
    ],
    ids=lambda change: next(iter(change)),
)
def test_no_part_of_a_state_holds_nan(change):
    with pytest.raises(NotFiniteError, match=next(iter(change))):
        replace(STATE, **change)


def test_numpy_values_are_stored_as_plain_numbers(tmp_path):
    state = replace(STATE, n_patches=np.int64(2), mean_pressure=np.float64(0.1), target=np.bool_(True))
    write_result(replace(RESULT, states=(state,)), tmp_path)
    stored = read_result(tmp_path).states[0]
    assert (stored.n_patches, stored.mean_pressure, stored.target) == (2, 0.1, True)


def test_checksum_is_that_of_the_file_without_it_keys_sorted(tmp_path):
    write_result(RESULT, tmp_path)
    content = json.loads((tmp_path / "result.json").read_text())
    stored = content.pop("checksum")
    assert stored == hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def test_keys_of_the_file(tmp_path):
    write_result(RESULT, tmp_path)
    content = json.loads((tmp_path / "result.json").read_text())
    known = {"schema", "scene", "effects", "provenance", "states", "events", "status", "failure", "checksum"}
    assert set(content) == known | {"groups", "warnings", "profile_preparation"}


def test_changed_number_is_corruption(tmp_path):
    write_result(RESULT, tmp_path)
    path = tmp_path / "result.json"
    path.write_text(path.read_text().replace('"n_patches": 2', '"n_patches": 3', 1))
    with pytest.raises(CorruptResultError, match="checksum"):
        read_result(tmp_path)


def test_truncated_file_is_corruption(tmp_path):
    write_result(RESULT, tmp_path)
    path = tmp_path / "result.json"
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(CorruptResultError, match="not JSON"):
        read_result(tmp_path)


def test_other_schema_is_refused(tmp_path):
    (tmp_path / "result.json").write_text('{"schema": "other/1"}')
    with pytest.raises(CorruptResultError, match="schema 'other/1'"):
        read_result(tmp_path)


def test_state_without_a_key_is_told(tmp_path):
    write_result(RESULT, tmp_path)
    path = tmp_path / "result.json"
    content = json.loads(path.read_text())
    del content["states"][0]["edges"], content["checksum"]
    path.write_text(json.dumps(content | {"checksum": result_file.digest(content)}))
    with pytest.raises(CorruptResultError, match=r"incomplete.*edges"):
        read_result(tmp_path)


@pytest.mark.parametrize("where", [0.1, 0.5, 0.9])
def test_flipped_byte_in_the_fields_is_corruption(where, tmp_path):
    write_result(RESULT, tmp_path)
    path = tmp_path / "fields.npz"
    content = bytearray(path.read_bytes())
    content[int(where * len(content))] ^= 1
    path.write_bytes(content)
    with pytest.raises(CorruptResultError, match=r"fields\.npz"):
        read_result(tmp_path)


def test_missing_fields_are_told(tmp_path):
    write_result(RESULT, tmp_path)
    (tmp_path / "fields.npz").unlink()
    with pytest.raises(CorruptResultError, match="missing"):
        read_result(tmp_path)


def test_fields_of_an_older_result_do_not_stay(tmp_path):
    write_result(RESULT, tmp_path)
    write_result(replace(RESULT, fields={}), tmp_path)
    assert not (tmp_path / "fields.npz").exists()


def test_write_that_fails_leaves_the_old_result_and_no_rubbish(tmp_path, monkeypatch):
    write_result(RESULT, tmp_path)

    def full_disk(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(OSError, match="No space"):
        write_result(replace(RESULT, status="unreachable"), tmp_path)
    assert_same(read_result(tmp_path), RESULT)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fields.npz", "result.json"]


def test_missing_result_is_not_corruption(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nowhere.*no result of a run there"):
        read_result(tmp_path / "nowhere")


def test_the_file_names_its_result_too(tmp_path):
    write_result(RESULT, tmp_path)
    assert_same(read_result(tmp_path / "result.json"), RESULT)


def test_provenance_holds_no_path_and_the_digest_of_the_scene(tmp_path):
    facts = provenance(SCENE)
    assert facts["scene_sha256"] == result_file.digest(SCENE)
    assert not any("/" in str(value) for value in facts.values())
