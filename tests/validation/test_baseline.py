"""Baselines: what moves is reported, by class; nothing becomes a baseline without a reason, a pass and a commit."""

import json
import math
import platform
from pathlib import Path

import pytest

from validation.harness import baseline
from validation.harness.baseline import BaselineError, differences, expected_seconds, orphans, read_baseline, update
from validation.harness.schema import Band, CaseRecord, Reference, Row, Tolerance

TOLERANCE = Tolerance(value=1e-3, measured=4e-4)
BAND = Band(low=1.5, high=3.0, cause="mean-field theory", source="the paper", review="2027-11-21")


@pytest.fixture(autouse=True)
def committed(monkeypatch):
    monkeypatch.setattr(baseline, "working_tree", lambda: ("0" * 40, False))


def record(value=1.0, pinned="converged", count=100, seconds=1.0, scale=2.0, band=None, **changes):
    row = Row(
        quantity="load",
        unit="N/m",
        reference=Reference(kind="exact", source="closed form"),
        norm="ratio" if band else "absolute",
        expected=[0.5 if band else value],
        computed=[value],
        scale=scale,
        tolerance=None if band else TOLERANCE,
        band=band,
        pinned=pinned,
    )
    plain = {"id": "c", "group": "g", "level": "quick", "question": "q", "equations": "e", "sources": []}
    return CaseRecord(**(plain | {"rows": [row], "counts": {"evaluations": count}, "seconds": seconds} | changes))


def moved(folder, before, after):
    update(before, "first run", folder)
    return differences(after, folder)


def test_same_numbers_are_no_difference(tmp_path):
    assert moved(tmp_path, record(), record()) == []


def test_missing_baseline_is_a_difference(tmp_path):
    assert "no baseline" in differences(record(), tmp_path)[0]


def test_case_whose_extra_is_absent_has_not_left_its_baseline(tmp_path):
    absent = record(rows=[], status="not run", message="an extra is not installed")
    assert differences(absent, tmp_path) == []
    update(record(), "first run", tmp_path)
    assert differences(absent, tmp_path) == []


@pytest.mark.parametrize(
    ("pinned", "change", "reported"),
    [
        ("exact", 0.0, False),
        ("exact", 1e-15, True),
        ("tight", 0.9e-10, False),
        ("tight", 1.1e-10, True),
        ("converged", 3.9e-3, False),  # 2 x tolerance x scale
        ("converged", 4.1e-3, True),
        ("converged", -4.1e-3, True),
        ("unconverged", 0.5, False),
    ],
)
def test_class_decides_what_may_move(tmp_path, pinned, change, reported):
    assert bool(moved(tmp_path, record(pinned=pinned), record(1.0 + change, pinned=pinned))) is reported


@pytest.mark.parametrize(("change", "reported"), [(0.019, False), (0.021, True), (-0.021, True)])
def test_value_with_a_band_may_move_by_two_per_cent(tmp_path, change, reported):
    assert bool(moved(tmp_path, record(1.0, band=BAND), record(1.0 + change, band=BAND))) is reported


@pytest.mark.parametrize(("count", "reported"), [(119, False), (81, False), (121, True), (79, True)])
def test_counts_gate_on_both_sides(tmp_path, count, reported):
    assert bool(moved(tmp_path, record(), record(count=count))) is reported


def test_seconds_never_gate(tmp_path):
    assert moved(tmp_path, record(), record(seconds=1e6)) == []


def test_value_that_is_no_number_is_a_difference(tmp_path):
    assert moved(tmp_path, record(), record(math.nan)) != []


@pytest.mark.parametrize(("before", "after", "word"), [({"n": 1}, {}, "gone"), ({}, {"n": 1}, "new")])
def test_quantities_that_come_or_go_are_told(tmp_path, before, after, word):
    assert word in moved(tmp_path, record(counts=before), record(counts=after))[0]


def test_case_that_did_not_run_differs_from_its_baseline(tmp_path):
    assert "crash" in moved(tmp_path, record(), record(status="error", message="crash"))[0]


def test_update_tells_old_and_new_and_keeps_the_reason(tmp_path):
    update(record(1.0), "first run", tmp_path)
    lines = update(record(2.0), "a finer rule", tmp_path)
    assert "c: load: 1 -> 2" in lines
    assert read_baseline("c", tmp_path).reason == "a finer rule"


def test_update_rewrites_one_case_only(tmp_path):
    update(record(id="other"), "first run", tmp_path)
    before = (tmp_path / "other.json").read_bytes()
    update(record(), "first run", tmp_path)
    assert (tmp_path / "other.json").read_bytes() == before


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (record(status="error", message="crash"), "only what passes"),
        (record(band=Band(low=3.0, high=4.0, cause="c", source="s", review="r")), "only what passes"),
        (record(math.nan), "only what passes"),
        (record(seconds=math.inf), "not a number"),
    ],
    ids=["error", "changed", "nan", "infinite"],
)
def test_what_fails_does_not_become_a_baseline(tmp_path, bad, message):
    with pytest.raises(BaselineError, match=message):
        update(bad, "first run", tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("reason", ["", "  "])
def test_update_needs_a_reason(tmp_path, reason):
    with pytest.raises(BaselineError, match="--reason"):
        update(record(), reason, tmp_path)


@pytest.mark.parametrize("tree", [None, ("0" * 40, True)], ids=["no commit", "changed"])
def test_update_needs_committed_sources(tmp_path, monkeypatch, tree):
    monkeypatch.setattr(baseline, "working_tree", lambda: tree)
    with pytest.raises(BaselineError, match="commit first"):
        update(record(), "first run", tmp_path)


def test_report_of_other_sources_is_refused():
    with pytest.raises(BaselineError, match="other sources"):
        baseline.refuse_other_sources({"sources_sha256": "of another day"})
    baseline.refuse_other_sources({"sources_sha256": baseline.sources_digest()})


@pytest.mark.parametrize(
    "damage",
    [lambda text: text[:-20], lambda _: "[]", lambda text: text.replace('"reason": "first run"', '"reason": ""')],
    ids=["cut off", "other content", "no reason"],
)
def test_malformed_baseline_is_refused(tmp_path, damage):
    update(record(), "first run", tmp_path)
    path = tmp_path / "c.json"
    path.write_text(damage(path.read_text()))
    with pytest.raises(BaselineError, match="malformed"):
        read_baseline("c", tmp_path)


def test_baseline_of_another_case_is_refused(tmp_path):
    update(record(), "first run", tmp_path)
    (tmp_path / "d.json").write_text((tmp_path / "c.json").read_text())
    with pytest.raises(BaselineError, match="baseline of case 'c'"):
        read_baseline("d", tmp_path)


def test_baseline_says_where_it_comes_from_and_names_no_folder_or_host(tmp_path):
    update(record(), "first run", tmp_path)
    text = (tmp_path / "c.json").read_text()
    assert set(json.loads(text)) == {
        *("case", "reason", "date", "commit", "versions", "blas", "blas_threads", "scene_sha256"),
        *("resolution", "quantities"),
    }
    assert str(Path.home()) not in text
    assert platform.node() not in text


def test_quantity_holds_class_tolerance_basis_and_drift(tmp_path):
    row = record().rows[0].model_copy(update={"uncertainty": 1e-4})
    update(record(rows=[row]), "first run", tmp_path)
    load = read_baseline("c", tmp_path).quantities[0]
    assert (load.kind, load.unit, load.basis, load.drift) == ("converged", "N/m", "measured", 1e-4)
    assert (load.rtol, load.atol) == (0.0, 4e-3)


def several(*values):
    row = record().rows[0].model_copy(update={"computed": list(values), "expected": list(values)})
    return record(rows=[row])


@pytest.mark.parametrize("place", [0, 1, 2])
def test_every_value_of_a_row_is_pinned(tmp_path, place):
    values = [1.0, 2.0, 3.0]
    values[place] += 0.1
    reported = moved(tmp_path, several(1.0, 2.0, 3.0), several(*values))
    assert [f"load [{place}]" in line for line in reported] == [True]


def test_long_row_is_pinned_by_its_largest_value(tmp_path):
    before = [0.1] * 20 + [-7.0]
    assert "farthest" in moved(tmp_path, several(*before), several(*[0.1] * 25, -7.1))[0]
    assert differences(several(*[0.1] * 25, -7.0), tmp_path) == []


def test_quantities_of_one_name_are_pinned_apart(tmp_path):
    twice = record(rows=[record(1.0).rows[0], record(2.0).rows[0]])
    moved_second = record(rows=[record(1.0).rows[0], record(2.1).rows[0]])
    assert ["load #2" in line for line in moved(tmp_path, twice, moved_second)] == [True]


def test_changed_scene_is_told(tmp_path):
    assert "scene" in moved(tmp_path, record(scene="a = 1"), record(scene="a = 2"))[0]


def test_baseline_without_a_case_is_told(tmp_path):
    update(record(), "first run", tmp_path)
    assert orphans(["c"], tmp_path) == []
    assert "c.json" in orphans(["d"], tmp_path)[0]


def test_expected_seconds_are_those_of_the_baseline(tmp_path):
    update(record(seconds=12.5), "first run", tmp_path)
    assert expected_seconds(["c", "d"], tmp_path) == {"c": 12.5}


@pytest.mark.parametrize("name", ["rtol", "atol"])
def test_infinite_tolerance_is_malformed(tmp_path, name):
    update(record(), "first run", tmp_path)
    path = tmp_path / "c.json"
    content = json.loads(path.read_text())
    content["quantities"][0][name] = math.inf
    path.write_text(json.dumps(content))
    with pytest.raises(BaselineError, match="malformed"):
        read_baseline("c", tmp_path)
