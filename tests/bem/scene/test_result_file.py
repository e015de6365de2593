"""Files of a result: bit-for-bit round trip, atomic replacement, journals, and damage that is named."""

import hashlib
import json
import math
import re
import sys
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stored_results import RESULT, SCENE, STATE

from bem.scene.digest import digest
from bem.scene.journal import Journal
from bem.scene.provenance import provenance
from bem.scene.result import Entry
from bem.scene.result_file import read_result, write_result
from bem.scene.state import ErrorEstimate, NotFiniteError, State
from bem.scene.stored_json import CorruptResultError


@pytest.fixture
def stored(tmp_path):
    """Folder with a result."""
    write_result(RESULT, tmp_path)
    return tmp_path


def assert_same(one, other):
    assert (one.scene, one.effects, one.provenance) == (other.scene, other.effects, other.provenance)
    assert (one.states, one.events, one.status) == (other.states, other.events, other.status)
    assert one.largest_tension == other.largest_tension
    assert sorted(one.fields) == sorted(other.fields)
    for name, values in one.fields.items():
        np.testing.assert_array_equal(values, other.fields[name], strict=True)


def test_result_comes_back_bit_for_bit(tmp_path):
    write_result(RESULT, tmp_path / "new" / "folder")
    assert_same(read_result(tmp_path / "new" / "folder"), RESULT)


@given(value=st.floats(-1e149, 1e149))
def test_any_finite_number_comes_back_exactly(value, tmp_path_factory):
    folder = tmp_path_factory.mktemp("result")
    write_result(
        replace(RESULT, states=(replace(STATE, elastic_energy=value, total_energy=value - 2, stored=None),), fields={}),
        folder,
    )
    stored = read_result(folder).states[0].elastic_energy
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


def test_checksum_is_that_of_the_file_without_it_keys_sorted(tmp_path):
    write_result(RESULT, tmp_path)
    content = json.loads((tmp_path / "result.json").read_text())
    stored = content.pop("checksum")
    assert stored == hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def test_keys_of_the_file(tmp_path):
    write_result(RESULT, tmp_path)
    content = json.loads((tmp_path / "result.json").read_text())
    known = {"schema", "scene", "effects", "provenance", "states", "events", "status", "failure", "checksum"}
    known |= {"groups", "warnings", "profile_preparation", "largest_tension"}
    assert set(content) == known


DAMAGE = {  # of the text of result.json
    "checksum": lambda text: text.replace('"n_patches": 2', '"n_patches": 3', 1),
    "not JSON": lambda text: text[:-100],
    'schema is "other/1"': lambda _: '{"schema": "other/1"}',
    "linecontact 0.2.0, which this version does not read": lambda _: '{"schema": "linecontact-result/1", "states": []}',
    "it holds a list": lambda _: "[]",
    "not JSON as it was written": lambda _: "[" * 100_000,
    "corrupt": lambda _: '{"schema": "linecontact-result/2", "a": ' + "[" * 900 + "]" * 900 + "}",
}


@pytest.mark.parametrize("said", DAMAGE)
def test_a_damaged_file_is_refused_with_what_is_damaged(said, stored):
    path = stored / "result.json"
    path.write_text(DAMAGE[said](path.read_text()))
    with pytest.raises(CorruptResultError, match=re.escape(said)):
        read_result(stored)


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
    write_result(replace(RESULT, states=(), fields={}), tmp_path)
    assert not (tmp_path / "fields.npz").exists()


@pytest.fixture
def small_files():
    """Limit files that this process writes to 100 bytes, as a full disk does."""
    resource = pytest.importorskip("resource")
    limits, sys.dont_write_bytecode = resource.getrlimit(resource.RLIMIT_FSIZE), True
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, limits[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    sys.dont_write_bytecode = False


@pytest.fixture
def unwritable(stored, small_files):
    """Folder with a result, to which nothing can be written any more."""
    return stored


def test_write_that_fails_leaves_the_old_result_and_no_rubbish(unwritable):
    with pytest.raises(OSError, match="File too large"):
        write_result(replace(RESULT, status="unreachable"), unwritable)
    assert_same(read_result(unwritable), RESULT)
    assert sorted(path.name for path in unwritable.iterdir()) == ["fields.npz", "result.json"]


def test_missing_result_is_not_corruption(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nowhere.*no result of a run there"):
        read_result(tmp_path / "nowhere")


def test_the_file_names_its_result_too(tmp_path):
    write_result(RESULT, tmp_path)
    assert_same(read_result(tmp_path / "result.json"), RESULT)


def test_provenance_holds_no_path_and_the_digest_of_the_scene(tmp_path):
    facts = provenance(SCENE)
    assert facts["scene_sha256"] == digest(SCENE)
    assert not any("/" in str(value) for value in facts.values())


def test_a_journal_is_the_result_of_its_folder_but_for_a_line_cut_off(tmp_path):
    journal = Journal(tmp_path)
    shared = dict.fromkeys(("profile_q", "profile_amplitude", "profile_phase"), np.arange(2.0))
    journal.begin(replace(RESULT, fields=shared), [Entry((), replace(STATE, events=0), RESULT.fields)])
    tension = replace(RESULT.largest_tension, mean_pressure=-0.2)
    journal.add(
        Entry(RESULT.events, replace(STATE, index=1, mean_pressure=1e3, events=2, stored=None), tension=tension)
    )
    kept = read_result(tmp_path)
    assert (kept.status, len(kept.states), kept.events) == ("interrupted", 2, RESULT.events)
    assert set(kept.fields) == {*RESULT.fields, *shared}
    assert kept.largest_tension == tension
    journal.path.write_bytes(journal.path.read_bytes()[:-9])
    assert len(read_result(tmp_path).states) == 1


def test_a_damaged_line_of_a_journal_is_named(tmp_path):
    journal = Journal(tmp_path)
    journal.begin(replace(RESULT, fields={}), [Entry((), replace(STATE, stored=None))] * 3)
    raw = journal.path.read_bytes().split(b"\n")
    journal.path.write_bytes(b"\n".join([*raw[:2], raw[2].replace(b"0.1", b"0.2"), *raw[3:]]))
    with pytest.raises(CorruptResultError, match=r"line 3.*checksum"):
        read_result(tmp_path)


def test_lines_of_a_journal_that_do_not_match_are_told(tmp_path):
    journal = Journal(tmp_path)
    journal.begin(replace(RESULT, fields={}), [Entry((), replace(STATE, stored=None, events=0))] * 2)
    with pytest.raises(CorruptResultError, match=r"journal\.jsonl: states\[1\]\.index is 0; allowed: 1 at a target"):
        read_result(tmp_path)


def test_a_journal_with_arrays_that_are_no_text_is_told(tmp_path):
    journal = Journal(tmp_path)
    journal.begin(replace(RESULT, fields={}), [])
    content = json.loads(journal.path.read_text())
    del content["checksum"]
    content["fields"] = 3
    journal.path.write_text(json.dumps(content | {"checksum": digest(content)}) + "\n")
    with pytest.raises(CorruptResultError, match=r"line 1: fields is 3.*no text of base64"):
        read_result(tmp_path)
