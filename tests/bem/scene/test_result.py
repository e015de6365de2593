"""Result files: bit-for-bit round trip, atomic replacement, and corruption that is named."""

import hashlib
import io
import json
import math
import os
import re
import sys
import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stored_states import stored_state

from bem.scene.journal import Journal
from bem.scene.provenance import digest, provenance
from bem.scene.result import Effect, Entry, Event, EventError, JumpEnd, LargestTension, Result, TensionError
from bem.scene.result_file import read_result, write_result
from bem.scene.scene import parse_scene
from bem.scene.state import ErrorEstimate, NotFiniteError, State
from bem.scene.stored_json import CorruptResultError

SCENE = parse_scene(
    {
        "title": "é",
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.1 + 0.2},
        "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
        "loading": {"control": "separation", "targets": [2e-5], "at_mean_pressures": [1e3]},
    }
).resolved()
STATE = stored_state(
    penetration=1e-5 / 3,
    mean_pressure=-0.1,
    contact_stiffness=None,
    error_estimate=ErrorEstimate(mean_pressure=1e-9, contact_fraction=None),
    stored=0,
    events=1,
)
ENDS = JumpEnd("separated", 0.0, 0.0), JumpEnd("converged", 0.0, -0.5, ((0.0029, 0.0031),))
RESULT = Result(
    scene=SCENE,
    effects=(Effect("half_space", True, "no [layer]", 1.5),),
    provenance=provenance(SCENE),
    states=(STATE, replace(STATE, target=False, index=None, stored=None, events=2)),
    events=(
        Event("first_touch", 0.0, 0.0, 0.003, 1e-9, EventError(1e-15, 1e-9, 1e-16), *ENDS),
        Event("pull_off", 0.0, -1.0, None, None, EventError(1e-15, 1e-9, None)),
    ),
    status="converged",
    groups={"rms_height": 7e-6, "rms_slope": 4e-3, "pressure_scale": 4e3},
    fields={
        **{name: np.linspace(0, 0.008, 5) for name in ("x_0", "displacement_0", "gap_0")},
        "pressure_0": np.array([np.nan, 1.0, 2.0, 1.0, np.nan]),
        "patch_0": np.array([-1, 0, 0, 0, -1]),
    },
    largest_tension=LargestTension(-0.3, 1e-6, 1e-5 / 3 + 1.9e-5, "fold", TensionError(1e-9)),
)


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
    with pytest.raises(CorruptResultError, match='schema is "other/1"'):
        read_result(tmp_path)


def test_a_result_of_an_earlier_version_is_refused_by_its_version(tmp_path):
    (tmp_path / "result.json").write_text('{"schema": "linecontact-result/1", "states": []}')
    with pytest.raises(CorruptResultError, match=r"linecontact 0\.2\.0, which this version does not read"):
        read_result(tmp_path)


def test_a_list_is_no_result(tmp_path):
    (tmp_path / "result.json").write_text("[]")
    with pytest.raises(CorruptResultError, match="it holds a list"):
        read_result(tmp_path)


def test_state_without_a_key_is_told(tmp_path):
    write_result(RESULT, tmp_path)
    path = tmp_path / "result.json"
    content = json.loads(path.read_text())
    del content["states"][0]["penetration"], content["checksum"]
    path.write_text(json.dumps(content | {"checksum": digest(content)}))
    with pytest.raises(CorruptResultError, match=r"states\[0\]\.penetration is missing"):
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
def stored(tmp_path):
    """Folder with a result."""
    write_result(RESULT, tmp_path)
    return tmp_path


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


def restated(folder, change):
    """A result of which `change` alters the content, under a checksum that is right."""
    write_result(RESULT, folder)
    path = folder / "result.json"
    content = json.loads(path.read_text())
    del content["checksum"]
    change(content)
    path.write_text(json.dumps(content | {"checksum": digest(content)}))


def error_of(content, value):
    """Change an estimated error of the first state."""
    content["states"][0]["error_estimate"].update(mean_pressure=value)


def gaps_of(content, peak=1.0, quantiles=(0.0,) * 5, **changes):
    """Give the first state the gaps that follow from its edges and separation, but for changes."""
    gaps = {"mean_open": 2e-5 / 0.9, "mean_cubic_root": 2.5e-5, "widest_channel": 0.0081, "open_fraction": 0.9}
    gaps["quantiles"] = dict(zip(("p10", "p25", "p50", "p75", "p90"), quantiles, strict=True))
    content["states"][0].update(peak_pressure=peak, largest_gap=4e-5, gaps=gaps | changes)


def test_gaps_that_follow_from_edges_and_separation_are_read(tmp_path):
    restated(tmp_path, gaps_of)
    assert read_result(tmp_path).states[0].gaps.widest_channel == 0.0081


WRONG = {
    "states[0] is 5": lambda c: c["states"].insert(0, 5),
    "states is {}": lambda c: c.update(states={}),
    'states[0].edges is "x"': lambda c: c["states"][0].update(edges="x"),
    "states[0].edges[0][1] is []": lambda c: c["states"][0].update(edges=[[0.1, []]]),
    'states[0].penetration is "1"': lambda c: c["states"][0].update(penetration="1"),
    "states[0].target is 1": lambda c: c["states"][0].update(target=1),
    "states[0].n_patches is 2.5": lambda c: c["states"][0].update(n_patches=2.5),
    "states[0].n_patches is 1; allowed: 2": lambda c: c["states"][0].update(n_patches=1),
    "states[0].separation is 1000": lambda c: c["states"][0].update(separation=10**400),
    "states[0].more is 1": lambda c: c["states"][0].update(more=1),
    "states[0].certificate is null": lambda c: c["states"][0].update(certificate=None),
    'states[0].status is "fine"': lambda c: c["states"][0].update(status="fine"),
    "states[0].index is 2; allowed: 0 or 1 at a target": lambda c: c["states"][0].update(index=2),
    "states[0].index is null": lambda c: c["states"][0].update(index=None),
    "states[1].events is 3; allowed: 1 to 2": lambda c: c["states"][1].update(events=3),
    "states[0].contact_fraction is 7.0; allowed: 0.1": lambda c: c["states"][0].update(contact_fraction=7.0),
    "events[0].after.edges is [[0.002, 0.001]]": lambda c: c["events"][0]["after"].update(edges=[[0.002, 0.001]]),
    "states[0].edges is [[0.002, 0.001]": lambda c: c["states"][0].update(edges=[[0.002, 0.001], [0.003, 0.004]]),
    "states[0].stored is 1; allowed: 0": lambda c: c["states"][0].update(stored=1),
    "states[0] is {": lambda c: c["states"][0].update(elastic_energy=None),  # NaN, which a converged state has not
    "events[0].kind is null": lambda c: c["events"][0].update(kind=None),
    'largest_tension.kind is "top"': lambda c: c["largest_tension"].update(kind="top"),
    "fields is no key": lambda c: c.update(fields={}),
    "states[0].error_estimate.mean_pressure is -1.0; allowed: a number >= 0": lambda c: error_of(c, -1.0),
    "events[0].error_estimate.penetration is -1.0": lambda c: c["events"][0]["error_estimate"].update(penetration=-1.0),
    "states[1].index is 0; allowed: 1 at a target": lambda c: c["states"][1].update(target=True, index=0),
    "states[1].index is 0; allowed: 1 at a target, each once and in order, else null": lambda c: c["states"][1].update(
        index=0
    ),
    "states[0].total_energy is 5.0; allowed: -1": lambda c: c["states"][0].update(total_energy=5.0),
    "states[0].certificate.ok is false": lambda c: c["states"][0]["certificate"].update(ok=False),
    "states[0].certificate.reasons is": lambda c: c["states"][0]["certificate"].update(reasons=["a failure"]),
    "largest_tension.mean_pressure is 0.3; allowed: < 0": lambda c: c["largest_tension"].update(mean_pressure=0.3),
    "largest_tension is missing": lambda c: c.pop("largest_tension"),
    "warnings is missing": lambda c: c.pop("warnings"),
    "groups is missing": lambda c: c.pop("groups"),
    "states[1].stored is missing": lambda c: c["states"][1].pop("stored"),
    'status is "converged"; allowed: another one, as target 0 has no state': lambda c: c["states"][0].update(index=1),
    'status is "unreachable"; allowed: another one, as every target is met': lambda c: c.update(
        status="unreachable", failure="no state"
    ),
    'failure is "no state"': lambda c: c.update(failure="no state"),
    "failure is null; allowed: a text": lambda c: c.update(status="not_converged"),
    'status is "separated"': lambda c: c.update(status="separated"),
    "provenance.scene_sha256 is": lambda c: c["scene"].update(title="another"),
    "provenance.fields_sha256 is null": lambda c: c["provenance"].update(fields_sha256=None),
    "provenance.fields_sha256 is false": lambda c: c["provenance"].pop("fields_sha256"),
    "scene is []": lambda c: c.update(scene=[]),
    "scene.loading is missing": lambda c: c["scene"].pop("loading"),
    'scene.loading.control = "time"': lambda c: c["scene"]["loading"].update(control="time"),
    "scene.loading.targets = 5": lambda c: c["scene"]["loading"].update(targets=5),
    "scene.profile.kind = 5": lambda c: c["scene"]["profile"].update(kind=5),
    "scene.loading.initial is missing": lambda c: c["scene"]["loading"].pop("initial"),
    "scene.profile.period is missing": lambda c: c["scene"]["profile"].pop("period"),
    "scene.title is 5": lambda c: c["scene"].update(title=5),
    "scene.solid is null": lambda c: c["scene"].update(solid=None),
    "provenance is 3": lambda c: c.update(provenance=3),
    "provenance.date is 3": lambda c: c["provenance"].update(date=3),
    "provenance.fields_sha256 is 3": lambda c: c["provenance"].update(fields_sha256=3),
    'groups.a is "b"': lambda c: c.update(groups={"a": "b"}),
    "groups.rms_height is null": lambda c: c.update(groups={"rms_height": None}),
    "states[0].penetration is 1e+300; allowed: a number below": lambda c: c["states"][0].update(penetration=1e300),
    "states[0].error_estimate.mean_pressure is 1e+300": lambda c: error_of(c, 1e300),
    "states[0].error_estimate.mean_pressure is 1000": lambda c: error_of(c, 10**400),
    "states[0].evaluations is 1000": lambda c: c["states"][0].update(evaluations=10**400),
    "events[0].position is Infinity": lambda c: c["events"][0].update(position=10**400),
    "largest_tension.separation is Infinity": lambda c: c["largest_tension"].update(separation=10**400),
    "events[0].error_estimate.mean_pressure is 1e-09; allowed: null": lambda c: c["events"][0].update(
        mean_pressure=None
    ),
    "states[0].separation is 3e-05; allowed: 2e-05, target 0": lambda c: c["states"][0].update(separation=3e-5),
    "states[1].penetration is 1e-06; allowed: 3.33333333e-06": lambda c: c["states"][1].update(penetration=1e-6),
    "largest_tension.penetration is 0.0; allowed": lambda c: c["largest_tension"].update(penetration=0.0),
    "states[0].certificate.closure is null": lambda c: c["states"][0]["certificate"].update(closure=None),
    "states[0].certificate.min_gap is -1.0": lambda c: c["states"][0]["certificate"].update(min_gap=-1.0),
    "states[0].certificate.min_eigenvalue is -1.0": lambda c: c["states"][0]["certificate"].update(min_eigenvalue=-1.0),
    "states[0].evaluations is -1; allowed: >= 0": lambda c: c["states"][0].update(evaluations=-1),
    "states[0].gaps.open_fraction is 5.0; allowed: 0.9": lambda c: gaps_of(c, open_fraction=5.0),
    "states[0].gaps.widest_channel is 0.005; allowed: 0.0081": lambda c: gaps_of(c, widest_channel=0.005),
    "states[0].gaps.mean_open is 2e-05; allowed: 2.2": lambda c: gaps_of(c, mean_open=2e-5),
    "states[0].gaps.quantiles is [0.0, 0.0, 1.0": lambda c: gaps_of(c, quantiles=[0.0, 0.0, 1.0, 0.0, 0.0]),
    "states[0].peak_pressure is -2.0; allowed: at least -1, the mean in contact": lambda c: gaps_of(c, peak=-2.0),
    "groups.rms_slope is null; allowed: a number": lambda c: c["groups"].pop("rms_slope"),
    "provenance.numpy is null; allowed: a text": lambda c: c["provenance"].pop("numpy"),
    'provenance.date is "today"': lambda c: c["provenance"].update(date="today"),
    "scene.profile.period is null": lambda c: c["scene"]["profile"].update(period=None),
    "scene.profile.hurst = 0.5": lambda c: c["scene"]["profile"].update(hurst=0.5),
    "scene.loading.targets[0] = -1": lambda c: c["scene"]["loading"].update(targets=[-1.0]),
    "status is null": lambda c: c.update(status=None),
}


@pytest.mark.parametrize("said", WRONG)
def test_a_value_of_another_type_is_named_whatever_the_checksum(said, tmp_path):
    restated(tmp_path, WRONG[said])
    with pytest.raises(CorruptResultError, match=re.escape(said)):
        read_result(tmp_path)


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"schema": "linecontact-result/2", "a": ' + "[" * 900 + "]" * 900 + "}"]
)
def test_deep_nesting_is_corruption(text, tmp_path):
    (tmp_path / "result.json").write_text(text)
    with pytest.raises(CorruptResultError):
        read_result(tmp_path)


@pytest.mark.parametrize("lacking", ["x_0", "displacement_0", "gap_0", "pressure_0", "patch_0"])
def test_a_shape_that_lacks_an_array_is_named(lacking, tmp_path):
    fields = {name: values for name, values in RESULT.fields.items() if name != lacking}
    write_result(replace(RESULT, fields=fields), tmp_path)
    with pytest.raises(CorruptResultError, match=rf"fields\.npz: fields\.{lacking} is missing"):
        read_result(tmp_path)


OTHER_ARRAYS = {
    "x_7 is an unknown name": lambda fields: {name.replace("_0", "_7"): a for name, a in fields.items()},
    "height is an unknown name": lambda fields: fields | {"height": np.ones(3)},
    "gap_0 is not finite": lambda fields: fields | {"gap_0": np.full(5, np.nan)},
    "patch_0 is of type float64": lambda fields: fields | {"patch_0": np.ones(5)},
    "x_0 is of shape (0,)": lambda fields: {name: values[:0] for name, values in fields.items()},
    "gap_0 is of 4 values; allowed: 5, as x_0 has": lambda fields: fields | {"gap_0": np.ones(4)},
    "profile_amplitude is missing": lambda fields: fields | {"profile_q": np.ones(3)},
    "x_0 has other values; allowed: rising within 0.01 m": lambda fields: fields | {"x_0": fields["x_0"][::-1].copy()},
    "gap_0 has other values": lambda fields: fields | {"gap_0": fields["gap_0"] - 1e-3},
    "patch_0 has other values; allowed: -1 to 1": lambda fields: fields | {"patch_0": fields["patch_0"] + 2},
    "pressure_0 has other values": lambda fields: fields | {"pressure_0": np.full(5, np.inf)},
    "x_0 is missing": lambda _: dict.fromkeys(("profile_q", "profile_amplitude", "profile_phase"), np.ones(3)),
}


@pytest.mark.parametrize("said", OTHER_ARRAYS)
def test_arrays_that_are_not_those_of_the_states_are_named(said, tmp_path):
    write_result(replace(RESULT, fields=OTHER_ARRAYS[said](RESULT.fields)), tmp_path)
    with pytest.raises(CorruptResultError, match=rf"fields\.npz.*{re.escape(said)}"):
        read_result(tmp_path)


def archive(**members):
    """An npz file of these members, by default not compressed."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        for name, (raw, compression) in members.items():
            file.writestr(name, raw, compression)
    return buffer.getvalue()


def npy(array):
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


PLAIN = npy(np.arange(3.0))
ARCHIVES = {
    "deflated": ({"x_0.npy": (npy(np.zeros(10**6)), zipfile.ZIP_DEFLATED)}, "compressed"),
    "lzma": ({"x_0.npy": (PLAIN, zipfile.ZIP_LZMA)}, "compressed"),
    "no array": ({"x_0.npy": (b"abc", zipfile.ZIP_STORED)}, "x_0 is of type"),
    "another dimension": (
        {"q.npy": (npy(np.ones((2, 2))), zipfile.ZIP_STORED), "C_h.npy": (npy(np.ones(4)), zipfile.ZIP_STORED)},
        "q is of shape",
    ),
    "another name": ({"../x.npy": (PLAIN, zipfile.ZIP_STORED)}, "is an unknown name"),
    "no ending": ({"x_0": (PLAIN, zipfile.ZIP_STORED)}, "is compressed or no array"),
    "a larger shape": ({"x_0.npy": (PLAIN.replace(b"(3,)", b"(9,)"), zipfile.ZIP_STORED)}, "no arrays of numbers"),
    "pickled": ({"x_0.npy": (npy(np.array([{}], dtype=object)), zipfile.ZIP_STORED)}, "Object arrays cannot be loaded"),
    "no header": ({"x_0.npy": (b"\x93NUMPY\x01\x00v\x00" + b"(" * 118, zipfile.ZIP_STORED)}, "no arrays of numbers"),
    "nothing": ({}, "holds no arrays"),
    "fewer digits": ({"x_0.npy": (npy(np.ones(5, np.float32)), zipfile.ZIP_STORED)}, "x_0 is of type float32"),
    "text": ({"x_0.npy": (npy(np.array(["a"])), zipfile.ZIP_STORED)}, "x_0 is of type"),
}


@pytest.mark.parametrize("kind", ARCHIVES)
def test_fields_are_looked_at_before_they_are_unpacked(kind, tmp_path):
    members, said = ARCHIVES[kind]
    raw = archive(**members)
    restated(tmp_path, lambda c: c["provenance"].update(fields_sha256=hashlib.sha256(raw).hexdigest()))
    (tmp_path / "fields.npz").write_bytes(raw)
    with pytest.raises(CorruptResultError, match=said):
        read_result(tmp_path)


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


def test_a_pipe_in_place_of_a_result_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "result.json")
    with pytest.raises(CorruptResultError, match=r"result\.json: is a folder, a pipe or a device"):
        read_result(tmp_path)
