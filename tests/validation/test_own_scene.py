"""Study of a scene: its answers against closed forms, what is varied, and the folder that it keeps."""

import csv
import json
import math
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest
from rough_scene import ROUGH

from bem.loading.workers import ENDED
from bem.scene.digest import digest
from bem.scene.scene import parse_scene
from validation.command_line.front_door import main
from validation.references.closed_forms import Sinusoid
from validation.report.pages import ReportError
from validation.studies.own_scene import Answer, Solved, in_turn, left_out, moves_of, run, solve_settings
from validation.studies.scene_settings import BASE, SEED, TOLERANCE, Setting, settings_of

SOLID = {"youngs_modulus": 1e6, "poisson_ratio": 0.5}
MODULUS = 1e6 / 0.75
RANDOM = {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": 8, "seed": 1}
SCENE = {
    "title": "rubber on <glass>",
    "solid": SOLID,
    "profile": RANDOM,
    "adhesion": {"work_of_adhesion": 0.03},
    "loading": {"control": "separation", "targets": [6e-5, 4e-5]},
}


def scene_file(folder, scene, name="scene.toml", encoding="utf-8"):
    lines = [f"title = {json.dumps(scene.get('title', ''))}"]
    for table, keys in scene.items():
        if table != "title":
            lines += [f"[{table}]", *(f"{key} = {json.dumps(value)}" for key, value in keys.items())]
    (folder / name).write_text("\n".join(lines) + "\n", encoding)
    return folder / name


def quiet(text):
    """Listen to nothing."""


def studied(folder, scene):
    assert run(scene_file(folder, scene), folder / "out", quiet, quick=True) == 0
    return json.loads((folder / "out" / "study.json").read_text())


def test_answers_and_their_numerical_uncertainty_are_those_of_johnson(tmp_path):
    work, fractions = 0.03, (0.3, 0.8)
    alpha = math.sqrt(2 * MODULUS * work / 0.01) / (math.pi * MODULUS * 1e-2)
    wave = Sinusoid(1e-4, 0.01, 1e6, 0.5, alpha)
    angles = np.pi / 2 * np.array(fractions)
    scene = {
        "title": "one wave",
        "solid": SOLID,
        "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-4], "phases": [0.0]},
        "adhesion": {"work_of_adhesion": work},
        "loading": {"control": "penetration", "targets": wave.penetration(angles).tolist()},
    }
    rows = studied(tmp_path, scene)["answers"]
    pressures = wave.mean_pressure(angles)
    for target, fraction in enumerate(fractions):
        exact = {"contact fraction": fraction, "mean pressure": float(pressures[target])}
        for row in rows:
            if row["target"] == target and row["quantity"] in exact:
                off = abs(row["value"] / exact[row["quantity"]] - 1)
                assert off <= row["moved"]["numerical"] + 3e-13


def outcome(fraction, pressure, error=1e-9, status="converged"):
    answers = [
        Answer(0, "loading", "contact fraction", fraction, error),
        Answer(0, "loading", "mean pressure", pressure, error),
    ]
    return Solved("", status, "", 1.0, answers)


MADE_UP = {
    Setting(BASE, BASE).title: outcome(0.5, 2.0),
    Setting(TOLERANCE, "1e-9").title: outcome(0.5 * (1 + 1e-6), 2.0),
    Setting("cut", "4 harmonics").title: outcome(0.5, 2.1),
    Setting("cut", "16 harmonics").title: outcome(0.52, 1.96),
    Setting(SEED, "1").title: outcome(0.5, 2.2),
    Setting(SEED, "2").title: outcome(0.5, 1.8),
    Setting("length", "true").title: outcome(0.9, 9.0, status="not_converged"),
}
SETTINGS = [
    Setting(BASE, BASE),
    Setting(TOLERANCE, "1e-9"),
    Setting("cut", "4 harmonics"),
    Setting("cut", "16 harmonics"),
    Setting(SEED, "1"),
    Setting(SEED, "2"),
    Setting("length", "true"),
]


def test_each_answer_has_its_own_moves_and_uncertainty():
    (fraction, pressure), (tolerance,) = moves_of(SETTINGS, MADE_UP)
    assert fraction["moved"] == pytest.approx({"numerical": 1e-6, "cut": 0.04, "seed": 0.0}, rel=1e-9)
    assert pressure["moved"] == pytest.approx({"numerical": 5e-10, "cut": 0.05, "seed": 0.1}, rel=1e-9)
    assert fraction["uncertainty"] == pytest.approx(0.02, rel=1e-6)
    assert pressure["uncertainty"] == pytest.approx(2.0 * math.hypot(0.05, 0.1), rel=1e-9)
    assert tolerance["moved"] == {"contact fraction": 0.0, "mean pressure": 0.0}


def test_an_answer_that_vanishes_is_measured_by_the_largest_on_the_path():
    base = replace(
        outcome(0.5, 2.0), answers=[Answer(k, "loading", "mean pressure", p, None) for k, p in ((0, 2.0), (1, 0.0))]
    )
    other = replace(base, answers=[Answer(k, "loading", "mean pressure", p, None) for k, p in ((0, 2.0), (1, 0.01))])
    rows, _ = moves_of([Setting(BASE, BASE), Setting("cut", "4")], {BASE: base, "cut: 4": other})
    assert rows[1]["moved"]["cut"] == pytest.approx(0.01 / 0.2)


def settings(scene, folder, seeds=2):
    return settings_of(parse_scene(scene, folder), scene, folder, folder / "parts", seeds)


def named(scene, folder):
    """Names of the settings that can be solved, and reasons of the others, by source."""
    names = {}
    for one in settings(scene, folder):
        names.setdefault(one.source, []).append(one.reason or one.name)
    return names


def test_settings_of_a_random_profile(tmp_path):
    names = named(SCENE, tmp_path)
    assert names[TOLERANCE] == ["0.001", "1e-06", "1e-09"]
    assert names["cut"] == ["4 harmonics", "16 harmonics"]
    assert names[SEED] == ["2", "3"]
    assert names["length"] == ["adhesion on the true length"]
    assert not {"detrending", "window", "part", "row", "noise"} & set(names)


def scan(folder, heights, **keys):
    """Scene of a scan with so many heights in um, 1 um apart."""
    np.savetxt(folder / "scan.csv", np.column_stack([np.arange(len(heights)), heights]))
    profile = {"kind": "samples", "file": "scan.csv", "unit_x": "um", "unit_h": "um"} | keys
    return SCENE | {"profile": profile, "loading": {"control": "mean_pressure", "targets": [1e4]}}


def rough(count, tilt=0.0, seed=0):
    x, rng = np.arange(count), np.random.default_rng(seed)
    waves = sum(rng.normal() * np.cos(2 * np.pi * m * x / count + rng.uniform(0, 6)) / m for m in range(1, 20))
    return waves + tilt * x / count


def shortest(setting, folder):
    profile = parse_scene(setting.tables, folder).profile
    return profile.period / profile.harmonics


def test_settings_of_a_scan_keep_its_shortest_wave(tmp_path):
    scene = scan(tmp_path, rough(64), harmonics=16, detrend="line", periodic="mirror")
    names = named(scene, tmp_path)
    assert names["cut"] == ["8 harmonics", "32 harmonics", "none, 63 harmonics"]
    own = shortest(settings(scene, tmp_path)[0], tmp_path)
    recut = [one for one in settings(scene, tmp_path) if one.source in ("part", "window") and one.tables]
    assert {one.source for one in recut} == {"part", "window"}
    for one in recut:
        assert shortest(one, tmp_path) == pytest.approx(own, rel=0.04)  # a whole number of waves
    first, second = (parse_scene(one.tables, tmp_path).scan for one in recut if one.source == "part")
    whole = parse_scene(scene, tmp_path).scan
    assert np.array_equal(np.concatenate([first.measured.h, second.measured.h]), whole.measured.h)


def test_a_half_whose_ends_part_is_followed_by_its_mirror_image(tmp_path):
    wave = 10 * np.sin(2 * np.pi * np.arange(256) / 256) + rough(256)
    scene = scan(tmp_path, wave, harmonics=20, detrend="none", periodic="as_is")
    parts = [one for one in settings(scene, tmp_path) if one.source == "part"]
    assert [one.name for one in parts] == [f"{k} half, then its mirror image" for k in ("first", "second")]
    assert {parse_scene(one.tables, tmp_path).profile.periodic for one in parts} == {"mirror"}


def test_a_mirrored_row_of_256_points_has_all_its_settings(tmp_path):
    scene = scan(tmp_path, rough(256), harmonics="all", detrend="line", periodic="mirror")
    for one in settings(scene, tmp_path):
        assert "allowed" not in one.reason, one
        if one.tables:
            parse_scene(one.tables, tmp_path)


def test_detrending_that_leaves_a_tilt_and_ends_that_do_not_meet_are_no_alternative(tmp_path):
    names = named(scan(tmp_path, rough(256, tilt=40.0), harmonics=20, detrend="line", periodic="mirror"), tmp_path)
    assert [reason.split()[0] for reason in names["detrending"]] == ["leaves", "leaves", "quadratic", "cubic"]
    tilted = named(scan(tmp_path, rough(256, tilt=40.0), harmonics=20, detrend="mean", periodic="mirror"), tmp_path)
    assert tilted["window"][0] == "the ends of the scan do not meet"


def test_the_cut_that_the_scene_has_is_varied(tmp_path):
    names = named(scan(tmp_path, rough(256), cutoff_short=2e-5), tmp_path)
    assert names["cut"] == ["cutoff_short 1e-05 m", "cutoff_short 4e-05 m", "none, 127 harmonics"]


def test_roughness_that_no_setting_has_is_told(tmp_path):
    scene = scan(tmp_path, rough(256), cutoff_short=2e-5)  # 19 waves
    every, good = settings(scene, tmp_path), outcome(0.5, 2.0)
    solved = {one.title: good for one in every}
    (of_adhesion,) = left_out(parse_scene(scene, tmp_path), tmp_path, every, solved)
    assert "nor the work of adhesion, by which the pull-off goes" in of_adhesion
    solved["cut: none, 127 harmonics"] = replace(good, status="stopped", answers=[])
    _, sentence = left_out(parse_scene(scene, tmp_path), tmp_path, every, solved)
    assert f"waves shorter than {256 / 19:.3g} µm" in sentence
    solved = {name: answer for name, answer in solved.items() if not name.startswith("window")}
    assert "the choice of window:" in left_out(parse_scene(scene, tmp_path), tmp_path, every, solved)[0]


def test_rows_of_a_map_are_varied(tmp_path):
    np.savetxt(tmp_path / "map.txt", [rough(64, seed=k) for k in range(8)])
    profile = {
        "kind": "samples",
        "file": "map.txt",
        "unit_x": "um",
        "unit_h": "um",
        "spacing": 1e-6,
        "row": 2,
        "harmonics": 10,
    }
    scene = SCENE | {"profile": profile, "loading": {"control": "mean_pressure", "targets": [1e4]}}
    rows = [one for one in settings(scene, tmp_path) if one.source == "row"]
    assert [(one.name, bool(one.tables)) for one in rows] == [("4", True), ("6", True), ("0", True)]


def test_noise_of_the_floor_of_the_scan_is_added(tmp_path):
    noise = np.random.default_rng(1).normal(0.0, 0.05, 1024)
    scene = scan(tmp_path, rough(1024) + noise, harmonics=30)
    (setting,) = (one for one in settings(scene, tmp_path) if one.source == "noise")
    added = parse_scene(setting.tables, tmp_path).scan.measured.h - parse_scene(scene, tmp_path).scan.measured.h
    assert np.std(added) == pytest.approx(5e-8, rel=0.2)


def test_a_study_continues_and_its_page_is_written(tmp_path):
    notes = []
    path = scene_file(tmp_path, SCENE, encoding="utf-8-sig")  # with a byte order mark
    assert run(path, tmp_path / "out", notes.append, quick=True) == 0
    assert len(notes) == 9
    stored = json.loads((tmp_path / "out" / "study.json").read_text())
    assert {row["quantity"] for row in stored["answers"]} >= {"contact fraction", "mean open gap", "peak pressure"}
    assert [row["tolerance"] for row in stored["tolerances"]] == ["0.001", "1e-06", "1e-09"]
    assert all(row["cpu_seconds"] > 0 for row in stored["tolerances"])
    page = (tmp_path / "out" / "study.html").read_text()
    assert "rubber on &lt;glass&gt;" in page
    columns = re.findall(r'<th scope="col">(.*?)</th>', page.partition("</thead>")[0])
    assert columns == ["target", "answer", "value and ±", "numerical", "cut", "seed", "length"]
    del stored["solved"]["cut: 4 harmonics"], stored["checksum"]
    (tmp_path / "out" / "study.json").write_text(json.dumps(stored | {"checksum": digest(stored)}))
    again = []
    assert run(path, tmp_path / "out", again.append, quick=True) == 0
    assert [note.split(":")[0] for note in again] == [BASE, "cut"]
    after = json.loads((tmp_path / "out" / "study.json").read_text())
    assert after["answers"] == stored["answers"]


def answer(content, **changes):
    """Give the unchanged scene of a study one answer with changes."""
    good = {"target": 0, "branch": "loading", "quantity": "mean pressure", "value": 1.0, "error": None}
    content["solved"][BASE].update(answers=[good | changes])


def test_a_study_whose_content_does_not_match_its_checksum_is_refused(tmp_path):
    (tmp_path / "study.json").write_text(json.dumps({"schema": "linecontact-scene-study/3", "checksum": "0"}))
    with pytest.raises(ReportError, match=r"study\.json: corrupt, its checksum does not match.*--overwrite"):
        run(scene_file(tmp_path, SCENE), tmp_path, quiet, quick=True)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda content: content["solved"][BASE].update(cpu_seconds="long"),
            r"study\.json: solved\.as it is\.cpu_seconds: ",
        ),
        (lambda content: content["solved"][BASE].update(answers=7), r"solved\.as it is\.answers: "),
        (lambda content: content.pop("scene_sha256"), "scene_sha256: Field required"),
        (lambda content: content.update(scene_sha256="0"), "scene_sha256: the study of another scene"),
        (lambda content: content.update(schema="other"), "schema: 'other', not"),
        (lambda content: content.clear(), "schema: Field required"),
        (lambda content: answer(content, error=1e300), r"solved\.as it is\.answers\.0\.error: "),
        (lambda content: answer(content, value=10**400), r"solved\.as it is\.answers\.0\.value: "),
        (lambda content: answer(content, quantity="x"), r"solved\.as it is\.answers\.0\.quantity: "),
    ],
)
def test_a_study_that_is_foreign_or_changed_is_refused_by_file_and_key(change, words, tmp_path):
    (tmp_path / "out").mkdir()
    content = {
        "schema": "linecontact-scene-study/3",
        "scene_sha256": "1",
        "title": "a",
        "solved": {BASE: {"sha256": "1", "status": "converged", "reason": "", "cpu_seconds": 1.0, "answers": []}},
    }
    change(content)
    (tmp_path / "out" / "study.json").write_text(json.dumps(content | {"checksum": digest(content)}))
    with pytest.raises(ReportError, match=words):
        run(scene_file(tmp_path, SCENE), tmp_path / "out", quiet, quick=True)


def test_a_file_that_is_no_json_is_refused_and_overwritten_where_asked(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "study.json").write_text("{")
    with pytest.raises(ReportError, match=r"study\.json: corrupt, not JSON.*--overwrite"):
        run(scene_file(tmp_path, SCENE), tmp_path / "out", quiet, quick=True)
    assert run(scene_file(tmp_path, SCENE), tmp_path / "out", quiet, quick=True, overwrite=True) == 0


def test_settings_beyond_the_budget_are_left_out(tmp_path):
    first, *others = [outcome for _, outcome in solve_settings(settings(SCENE, tmp_path), {}, tmp_path, 1, 1e-9)]
    assert first.status == "converged"
    assert all(outcome.status == "left out" and "beyond the budget" in outcome.reason for outcome in others)


def test_a_study_beside_its_run_refreshes_the_page_and_the_table_of_the_run(tmp_path, capsys):
    path, out = (
        scene_file(tmp_path, SCENE | {"loading": {"control": "mean_pressure", "targets": [2e4]}}),
        tmp_path / "out",
    )
    assert main(["run", str(path), "--out", str(out), "--quiet"]) == 0
    assert main(["study", "scene", str(path), "--quick", "--out", str(out), "--jobs", "1"]) == 0
    told = capsys.readouterr().out
    assert told.splitlines()[-1] == str(out / "report.html")
    stored = json.loads((out / "study.json").read_text())
    assert stored["command"] == f"linecontact study scene {path} --quick --out {out}"
    (row,) = csv.DictReader((out / "answer.csv").read_text().splitlines())
    (fraction,) = (answer for answer in stored["answers"] if answer["quantity"] == "contact fraction")
    left_open = math.hypot(*(move for source, move in fraction["moved"].items() if source != "numerical"))
    assert fraction["input"] == pytest.approx(left_open * fraction["value"], rel=1e-6)
    assert float(row["input_uncertainty_contact_fraction"]) == fraction["input"]
    assert float(row["input_uncertainty_mean_cubic_root / m"]) > 0
    assert "contact fraction at 20 kPa, loading: 0." in told
    assert float(row["input_uncertainty_separation / m"]) > 0
    assert "% input" in (out / "report.html").read_text()


def test_an_interrupt_ends_a_study_and_the_same_command_goes_on(tmp_path, monkeypatch):
    path, count = scene_file(tmp_path, SCENE), 0

    def told(line):
        nonlocal count
        count += 1
        if count == 3:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run(path, tmp_path / "out", told, quick=True)
    assert (count, (tmp_path / "out" / "study.html").exists()) == (3, False)
    assert run(path, tmp_path / "out", quiet, quick=True) == 0


def test_targets_that_are_met_have_their_uncertainty_where_another_is_not(tmp_path, capsys):
    scene = SCENE | {"loading": {"control": "mean_pressure", "targets": [2e4, -1e9]}}
    scene["adhesion"] = {"work_of_adhesion": 1e-3}
    code = run(scene_file(tmp_path, scene), tmp_path / "out", quiet, quick=True)
    assert code == 0  # pulled off
    (target,) = {row["target"] for row in json.loads((tmp_path / "out" / "study.json").read_text())["answers"]} - {None}
    assert target == 0


def test_one_setting_of_each_choice_is_solved_first_and_tolerances_last(tmp_path):
    order = [one.source for one in in_turn(settings(scan(tmp_path, rough(256), harmonics=20), tmp_path)[1:])]
    first = list(dict.fromkeys(order))
    assert order[: len(first) - 1] == first[:-1]
    assert first[-1] == TOLERANCE and set(order[-3:]) == {TOLERANCE}


def test_a_scene_that_does_not_converge_as_it_is_fails(tmp_path, capsys):
    scene = SCENE | {"loading": {"control": "mean_pressure", "targets": [-1e9]}}
    assert run(scene_file(tmp_path, scene), tmp_path / "out", quiet, quick=True) == 1
    assert "does not converge as it is" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        pytest.param(("scene", "none.toml"), "none.toml", id="no such file"),
        pytest.param(("scene", "--quick", "none.toml"), "none.toml cannot be read", id="an option before the file"),
        pytest.param(("scene", "bad.toml"), "solid.poisson_ratio = 0.7", id="refused"),
    ],
)
def test_bad_input_is_refused_by_name_and_nothing_is_written(words, message, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene_file(tmp_path, ROUGH | {"solid": SOLID | {"poisson_ratio": 0.7}}, "bad.toml")
    assert main(["study", *words, "--out", "out"]) == 2
    assert message in capsys.readouterr().err
    assert not Path("out").exists()


def begun(folder):
    """Return the process of a study that two workers share, and the workers as they start."""
    command = ["study", "scene", scene_file(folder, SCENE), "--out", folder / "out", "--jobs", "2", "--quick"]
    study = subprocess.Popen(
        [sys.executable, "-m", "validation", *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    assert study.stderr.readline().startswith(f"{BASE}: converged")
    limit = time.monotonic() + 60
    workers = []
    while len(workers) < 2:
        assert time.monotonic() < limit, "no worker was started"
        children = psutil.Process(study.pid).children()
        workers = [child for child in children if any("popen_loky" in word for word in child.cmdline())]
    return study, workers


def test_a_killed_worker_ends_a_study_with_one_sentence(tmp_path):
    study, workers = begun(tmp_path)
    workers[0].kill()
    assert study.communicate(timeout=60)[1] == f"error: {ENDED}\n"
    assert study.returncode == 1


def test_workers_of_a_study_end_with_it(tmp_path):
    study, workers = begun(tmp_path)
    study.kill()
    study.communicate()
    assert not psutil.wait_procs(workers, timeout=10)[1]
