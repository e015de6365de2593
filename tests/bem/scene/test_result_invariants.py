"""Results whose parts contradict one another, under checksums that are right: one key of each rule is named."""

import hashlib
import io
import re
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from stored_results import RESULT, restated

from bem.scene.result_file import read_result, write_result
from bem.scene.result_invariants import judged
from bem.scene.stored_json import CorruptResultError


def state_of(content, **changes):
    content["states"][0].update(changes)


def certificate_of(content, **changes):
    content["states"][0]["certificate"].update(changes)


def scene_of(content, table, **changes):
    content["scene"][table].update(changes)


def gaps_of(content, peak=1.0, quantiles=(0.0,) * 5, **changes):
    """Give the first state the gaps that follow from its edges and separation, but for changes."""
    gaps = {"mean_open": 2e-5 / 0.9, "mean_cubic_root": 2.5e-5, "widest_channel": 0.0081, "open_fraction": 0.9}
    gaps["quantiles"] = dict(zip(("p10", "p25", "p50", "p75", "p90"), quantiles, strict=True))
    content["states"][0].update(peak_pressure=peak, largest_gap=4e-5, gaps=gaps | changes)


def test_gaps_that_follow_from_edges_and_separation_are_read(tmp_path):
    restated(tmp_path, gaps_of)
    assert read_result(tmp_path).states[0].gaps.widest_channel == 0.0081


WRONG = {
    # types, keys and ranges
    "states[0] is 5": lambda c: c["states"].insert(0, 5),
    'states[0].penetration is "1"': lambda c: state_of(c, penetration="1"),
    "states[0].more is 1": lambda c: state_of(c, more=1),
    "states[0].penetration is missing": lambda c: c["states"][0].pop("penetration"),
    "largest_tension is missing": lambda c: c.pop("largest_tension"),
    "fields is no key": lambda c: c.update(fields={}),
    "states[0] is {": lambda c: state_of(c, elastic_energy=None),  # NaN, which a converged state has not
    'states[0].status is "fine"': lambda c: state_of(c, status="fine"),
    "states[0].separation is 1e+300; allowed: < 1e+150": lambda c: state_of(c, separation=1e300),
    "states[0].evaluations is -1; allowed: >= 0": lambda c: state_of(c, evaluations=-1),
    "states[0].evaluations is 1000": lambda c: state_of(c, evaluations=10**400),
    # scene and provenance
    "scene.loading is null; allowed: a table": lambda c: c["scene"].pop("loading"),
    "scene.title is 5": lambda c: c["scene"].update(title=5),
    'scene.loading.control = "time"': lambda c: scene_of(c, "loading", control="time"),
    "scene.loading.initial is null": lambda c: c["scene"]["loading"].pop("initial"),
    "scene.profile.period is null": lambda c: c["scene"]["profile"].pop("period"),
    "scene.profile.hurst = 0.5": lambda c: scene_of(c, "profile", hurst=0.5),
    "scene.loading.targets[0] = -1": lambda c: scene_of(c, "loading", targets=[-1.0]),
    "groups.rms_slope is null; allowed: a number": lambda c: c["groups"].pop("rms_slope"),
    "provenance.numpy is null; allowed: a text": lambda c: c["provenance"].pop("numpy"),
    'provenance.date is "today"': lambda c: c["provenance"].update(date="today"),
    "provenance.fields_sha256 is null": lambda c: c["provenance"].update(fields_sha256=None),
    "provenance.fields_sha256 is 3": lambda c: c["provenance"].update(fields_sha256=3),
    # order of the path
    "states[0].index is 2; allowed: 0 or 1 at a target": lambda c: state_of(c, index=2),
    "states[1].index is 0; allowed: 1 at a target": lambda c: c["states"][1].update(target=True, index=0),
    "states[1].events is 3; allowed: 1 to 2": lambda c: c["states"][1].update(events=3),
    "states[0].stored is 1; allowed: 0": lambda c: state_of(c, stored=1),
    'status is "converged"; allowed: another one, as target 0 has no state': lambda c: state_of(c, index=1),
    # numbers that follow from others
    "provenance.scene_sha256 is": lambda c: c["scene"].update(title="another"),
    "states[0].n_patches is 1; allowed: 2": lambda c: state_of(c, n_patches=1),
    "states[0].contact_fraction is 7.0; allowed: 0.1": lambda c: state_of(c, contact_fraction=7.0),
    "states[0].total_energy is 5.0; allowed: -1": lambda c: state_of(c, total_energy=5.0),
    "states[0].certificate.ok is false; allowed: true": lambda c: certificate_of(c, ok=False, reasons=["a failure"]),
    "states[0].separation is 3e-05; allowed: 2e-05": lambda c: state_of(c, separation=3e-5),
    "states[1].penetration is 1e-06; allowed: 3.33333333e-06": lambda c: c["states"][1].update(penetration=1e-6),
    "largest_tension.penetration is 0.0; allowed": lambda c: c["largest_tension"].update(penetration=0.0),
    "states[0].gaps.open_fraction is 5.0; allowed: 0.9": lambda c: gaps_of(c, open_fraction=5.0),
    "states[0].gaps.widest_channel is 0.005; allowed: 0.0081": lambda c: gaps_of(c, widest_channel=0.005),
    "states[0].gaps.mean_open is 2.1e-05; allowed: 2.2": lambda c: gaps_of(c, mean_open=2.1e-5),
    # what bounds one another
    "events[0].after.edges is [[0.002, 0.001]]": lambda c: c["events"][0]["after"].update(edges=[[0.002, 0.001]]),
    "states[0].edges is [[0.002, 0.001]": lambda c: state_of(c, edges=[[0.002, 0.001], [0.003, 0.004]]),
    "events[0].error_estimate.mean_pressure is 1e-09; allowed: null": lambda c: c["events"][0].update(
        mean_pressure=None
    ),
    "states[0].certificate.reasons is": lambda c: certificate_of(c, reasons=["a failure"]),
    "states[0].certificate.closure is null": lambda c: certificate_of(c, closure=None),
    "states[0].certificate.min_gap is -1.0": lambda c: certificate_of(c, min_gap=-1.0),
    "states[0].certificate.min_eigenvalue is -1.0": lambda c: certificate_of(c, min_eigenvalue=-1.0),
    "states[0].certificate.hessian_asymmetry is 1.0": lambda c: certificate_of(c, hessian_asymmetry=1.0),
    "states[0].gaps.quantiles is [0.0, 0.0, 1.0": lambda c: gaps_of(c, quantiles=[0.0, 0.0, 1.0, 0.0, 0.0]),
    "states[0].peak_pressure is -2.0; allowed: at least -1, the mean in contact": lambda c: gaps_of(c, peak=-2.0),
    "largest_tension.mean_pressure is 0.3; allowed: < 0": lambda c: c["largest_tension"].update(mean_pressure=0.3),
    'status is "unreachable"; allowed: another one, as every target is met': lambda c: c.update(
        status="unreachable", failure="no state"
    ),
    "failure is null; allowed: a text": lambda c: c.update(status="not_converged"),
}


@pytest.mark.parametrize("said", WRONG)
def test_a_content_that_contradicts_itself_is_named_whatever_the_checksum(said, tmp_path):
    restated(tmp_path, WRONG[said])
    with pytest.raises(CorruptResultError, match=re.escape(said)):
        read_result(tmp_path)


OTHER_ARRAYS = {
    "x_7 is an unknown name": lambda fields: {name.replace("_0", "_7"): a for name, a in fields.items()},
    "height is an unknown name": lambda fields: fields | {"height": np.ones(3)},
    "gap_0 is not finite": lambda fields: fields | {"gap_0": np.full(5, np.nan)},
    "patch_0 is of type float64": lambda fields: fields | {"patch_0": np.ones(5)},
    "x_0 is of shape (0,)": lambda fields: {name: values[:0] for name, values in fields.items()},
    "gap_0 is of 4 values; allowed: 5, as x_0 has": lambda fields: fields | {"gap_0": np.ones(4)},
    "gap_0 is missing": lambda fields: {name: values for name, values in fields.items() if name != "gap_0"},
    "profile_amplitude is missing": lambda fields: fields | {"profile_q": np.ones(3)},
    "x_0 is [0.008, 0.006, 0.004]; allowed: rising": lambda fields: fields | {"x_0": fields["x_0"][::-1].copy()},
    "gap_0 is [-0.001": lambda fields: fields | {"gap_0": fields["gap_0"] - 1e-3},
    "patch_0 is [1, 2, 2]; allowed: -1 to 1": lambda fields: fields | {"patch_0": fields["patch_0"] + 2},
    "pressure_0 is [Infinity": lambda fields: fields | {"pressure_0": np.full(5, np.inf)},
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
}


@pytest.mark.parametrize("kind", ARCHIVES)
def test_fields_are_looked_at_before_they_are_unpacked(kind, tmp_path):
    members, said = ARCHIVES[kind]
    raw = archive(**members)
    restated(tmp_path, lambda c: c["provenance"].update(fields_sha256=hashlib.sha256(raw).hexdigest()))
    (tmp_path / "fields.npz").write_bytes(raw)
    with pytest.raises(CorruptResultError, match=said):
        read_result(tmp_path)


def test_a_computed_result_that_contradicts_itself_keeps_its_states_and_says_so(tmp_path):
    states = (replace(RESULT.states[0], n_patches=1), *RESULT.states[1:])
    result = judged(replace(RESULT, states=states))
    assert (result.status, result.states) == ("not_converged", states)
    assert result.failure.endswith(
        "states[0].n_patches is 1; allowed: 2, which follows from other numbers of the result"
    )
    write_result(result, tmp_path)
    assert read_result(tmp_path).failure == result.failure
    assert judged(RESULT) is RESULT
