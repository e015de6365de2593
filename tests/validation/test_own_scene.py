"""The study of one's own scene: its errors against known answers, its advice, and the folder it keeps."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from browser import BROWSER
from devtools import found_at

from bem.scene.scene import parse_scene
from validation.command_line.front_door import main
from validation.harness import store
from validation.harness.execution import Ended
from validation.references.closed_forms import Sinusoid
from validation.references.one_patch import OnePatch
from validation.report.pages import ReportError
from validation.report.study_page import render_study
from validation.studies.own_scene import own_scene
from validation.studies.own_scene.findings import findings_of, finest_of, node_rate, offs
from validation.studies.own_scene.own_scene import Options, run
from validation.studies.own_scene.settings import BASE, FINEST, Setting, settings_of
from validation.studies.own_scene.solved_setting import Reading, Solved, ToSolve, solved
from validation.studies.own_scene.words import sentence

SOLID = {"youngs_modulus": 1e6, "poisson_ratio": 0.5}
MODULUS = 1e6 / 0.75
ROUGH = {
    "title": "rubber on <glass>",
    "solid": SOLID,
    "profile": {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": 8, "seed": 1},
    "adhesion": {"work_of_adhesion": 0.03},
    "loading": {"control": "separation", "targets": [6e-5, 4e-5]},
}
ROUNDING = 3e-13  # of closed forms and of the loads asked for
QUICK = Options(seeds=2, budget=600.0, quick=True)


def wave(work):
    return Sinusoid(1e-4, 0.01, 1e6, 0.5, math.sqrt(2 * MODULUS * work / 0.01) / (math.pi * MODULUS * 1e-2))


def wave_scene(work, fractions):
    """One cosine pressed to these contact fractions, and its mean pressures in closed form."""
    angles = np.pi / 2 * np.array(fractions)
    tables = {
        "solid": SOLID,
        "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-4], "phases": [0.0]},
        "loading": {"control": "penetration", "targets": wave(work).penetration(angles).tolist()},
    }
    if work:
        tables["adhesion"] = {"work_of_adhesion": work}
    return tables, dict(zip(fractions, wave(work).mean_pressure(angles).tolist(), strict=True))


def rippled_scene():
    """A wave with a ripple of its third order, pressed to two loads; contact fractions and loads in closed form."""
    patch = OnePatch(0.01, MODULUS, (1e-4, 0.0, 4e-6), 0.03)
    fractions = (0.3, 0.6)
    pressures = [float(patch.mean_pressure(math.pi * fraction)) for fraction in fractions]
    tables = {
        "solid": SOLID,
        "profile": {
            "kind": "harmonics",
            "period": 0.01,
            "orders": [1, 3],
            "amplitudes": [1e-4, 4e-6],
            "phases": [0.0, 0.0],
        },
        "adhesion": {"work_of_adhesion": 0.03},
        "loading": {"control": "mean_pressure", "targets": pressures},
        "accuracy": {"max_increment": 1.0},
    }
    return tables, dict(zip(fractions, pressures, strict=True))


KNOWN = {
    "Westergaard": lambda: wave_scene(0.0, (0.2, 0.8)),
    "Johnson": lambda: wave_scene(0.03, (0.3, 0.8)),
    "rippled wave": rippled_scene,
}


@pytest.fixture(scope="module", params=KNOWN)
def known(request, tmp_path_factory):
    """The numerical settings of a scene with a known answer, solved; contact fractions and pressures by closed form."""
    tables, exact = KNOWN[request.param]()
    places = (Path(), tmp_path_factory.mktemp("parts"))
    settings = settings_of(parse_scene(tables), tables, places, 0, quick=True)
    chosen = [one for one in settings if one.kind in ("base", "numerical") and one.tables]
    return [(one, solved(ToSolve(one.name, one.tables, ".", 60.0, one.kind == "base"))) for one in chosen], exact


def true_answer(base, exact):
    """The readings of a scene with the numbers of the closed form in their place, without errors of their own."""
    readings = []
    for reading, (fraction, pressure) in zip(base.readings, exact.items(), strict=True):
        free = reading.free_value if reading.free == "separation" else pressure
        readings.append(
            replace(reading, contact_fraction=fraction, fraction_error=0.0, free_value=free, free_error=0.0)
        )
    return replace(base, readings=tuple(readings))


def distances(answer, other):
    """Relative distances of the numbers that the closed form knows."""
    return [off for off in offs(answer, other, other) if off.quantity != "separation"]


def test_the_error_of_every_setting_is_the_true_one(known):
    answered, exact = known
    truth, (_, finest) = true_answer(answered[0][1], exact), finest_of(answered)
    floor = findings_of(answered).floor
    for setting, answer in answered:
        true, claimed = (max(off.distance for off in distances(answer, other)) for other in (truth, finest))
        assert abs(true - claimed) <= floor + ROUNDING, setting.name


def test_estimated_errors_cover_the_true_ones(known):
    answered, exact = known
    truth = true_answer(answered[0][1], exact)
    for setting, answer in answered:
        for off in distances(answer, truth):
            assert off.distance <= off.estimate + ROUNDING, setting.name


def test_nodes_converge_at_the_rate_that_is_predicted():
    """K falls like rho^-n, rho of the ellipse through the next edge, the load like rho^-2n (convergence_curves.py)."""
    tables, _ = wave_scene(0.03, (0.95,))
    answer = solved(ToSolve("as it is", tables, ".", 60.0, nodes=True))
    (curve,) = answer.nodes
    reach = 1 + 2 * 0.05 / 0.95
    rho = reach + math.sqrt(reach**2 - 1)
    assert 1 < node_rate(curve.per_patch, curve.intensity_errors) / rho < 1.05  # measured 1.017
    assert 1 < node_rate(curve.per_patch, curve.load_errors) / rho**2 < 1.2  # measured 1.077: few points above rounding


def reading(fraction, pressure, value=1.0, error=1e-9):
    return Reading(("separation", value, 1), "loading", 1, True, fraction, error, "mean_pressure", pressure, error)


def answer(fraction, pressure, evaluations=100, status="converged", error=1e-9):
    return Solved(status, "", 1.0, evaluations, 1, 1.0, 0.1, 1.0, (reading(fraction, pressure, error=error),))


def made_up():
    """Settings with a tenth, a thousandth and 1e-6 of error, a cut that changes 5 %, three realisations."""
    return [
        (Setting("base", BASE, BASE), answer(0.5 * (1 + 1e-6), 2.0, 400)),
        (Setting("numerical", FINEST, "finest"), answer(0.5, 2.0, 9000, error=1e-10)),
        (Setting("numerical", "tolerance", "0.01"), answer(0.55, 2.0, 50)),
        (Setting("numerical", "tolerance", "0.0001"), answer(0.5, 2.002, 100)),
        (Setting("numerical", "tolerance", "1e-12"), Solved("not_converged", "too fine")),
        (Setting("input", "cut", "4 harmonics"), answer(0.5, 2.1)),
        (Setting("input", "seed", "1"), answer(0.5, 2.2)),
        (Setting("input", "seed", "2"), answer(0.5, 1.8)),
    ]


def test_advice_is_the_cheapest_setting_that_is_accurate_enough():
    advice = {one.digits: one for one in findings_of(made_up()).advice}
    assert [advice[digits].setting for digits in (2, 3, 4, 6, 9)] == [
        "tolerance 0.0001",
        "tolerance 0.0001",
        "as it is",
        "as it is",
        "finest finest",
    ]
    assert [advice[digits].evaluations for digits in (2, 4, 9)] == [100, 400, 9000]
    assert advice[2].error == pytest.approx(1e-3)
    assert (advice[2].open_source, advice[2].open_share) == ("seed", pytest.approx(0.1))


def test_digits_that_the_finest_setting_does_not_resolve_are_not_promised():
    coarse = [(one, replace(found, readings=(reading(0.5, 2.0, error=1e-3),))) for one, found in made_up()]
    assert [one.setting is None for one in findings_of(coarse).advice] == [False, True, True, True, True]


def test_the_sentence_names_the_largest_uncertainty():
    said = sentence(findings_of(made_up()))
    assert "largest uncertainty is the realisation of the random phases (input): the mean pressure at a" in said
    assert "varies by 10 % (standard deviation of 3 realisations; standard error of their mean 5.8 %)" in said
    assert " The mean of more realisations (profile.seed) lowers it. The numerical error is at most " in said
    cut = sentence(findings_of(made_up()[:6]))
    assert "changes by up to 5 % with it (1 alternative). The key profile.harmonics decides it" in cut


def test_a_pressure_that_vanishes_is_measured_by_the_largest_on_the_path():
    path = replace(answer(0.5, 2.0), readings=(reading(0.5, 2.0), reading(0.4, 1e-3, value=2.0)))
    other = replace(path, readings=(reading(0.5, 2.0), reading(0.4, 3e-3, value=2.0)))
    assert max(off.distance for off in offs(other, path, path)) == pytest.approx(2e-3 / 0.2)


def test_a_page_is_amber_where_the_input_leaves_more_than_a_tenth_open(studied):
    content = json.loads((studied[1] / "study.json").read_text())
    for most, amber in ((0.09, False), (0.11, True)):
        rows = [row | {"input": most} for row in content["targets"]]
        assert ('class="verdict doubtful"' in render_study(content | {"targets": rows})) == amber


@pytest.fixture
def in_process(monkeypatch):
    """Settings are solved in this process; the names of those that were."""
    done = []

    def events(function, items, jobs, **options):
        for item in items:
            done.append(item.name)
            yield Ended(item, function(item))

    monkeypatch.setattr(store, "run_in_processes", events)
    return done


def scene_file(folder, **tables):
    path = folder / "scene.toml"
    words = {name: table for name, table in (ROUGH | tables).items() if table is not None}
    lines = [f"title = {json.dumps(words.pop('title'))}"]
    for name, table in words.items():
        lines += [f"[{name}]", *(f"{key} = {json.dumps(value)}" for key, value in table.items())]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def solved_here(function, items, jobs, **options):
    for item in items:
        yield Ended(item, function(item))


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """A study that is there: its scene file, its folder and the notes."""
    folder, notes = tmp_path_factory.mktemp("studied"), []
    path = scene_file(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "run_in_processes", solved_here)
        assert run(path, folder / "out", QUICK, notes.append) == 0
    return path, folder / "out", [note.text for note in notes]


def test_a_study_says_what_it_will_cost_and_what_it_found(studied, capsys):
    _, folder, notes = studied
    assert "settings" in notes[0] and "at most 600 s of one core" in notes[0]
    assert any("to go by the pace so far" in note for note in notes)
    content = json.loads((folder / "study.json").read_text())
    assert content["status"] == "done"
    assert {row["source"] for row in content["sources"]} == {"numerical", "cut", "seed", "slope term"}
    assert len(content["targets"]) == 4
    assert all(row["evaluations"] > 0 for row in content["settings"] if row["status"] == "converged")
    assert content["sentence"] in (folder / "study.html").read_text().replace("&#39;", "'")


def test_the_command_holds_the_options_given(studied):
    command = json.loads((studied[1] / "study.json").read_text())["command"]
    assert command == "linecontact study scene scene.toml --out out --quick --seeds 2 --budget 600"


def interrupted():
    raise KeyboardInterrupt


def test_a_study_continues_where_it_ended(studied, in_process, monkeypatch):
    path, folder, _ = studied
    before = json.loads((folder / "study.json").read_text())
    kept = sorted((folder / "answers").iterdir())
    kept[0].unlink()
    with monkeypatch.context() as patch:  # an interrupt leaves what is there
        patch.setattr(own_scene, "provenance", interrupted)
        with pytest.raises(KeyboardInterrupt):
            run(path, folder, QUICK, lambda note: None)
    assert json.loads((folder / "study.json").read_text()) == before
    assert run(path, folder, QUICK, lambda note: None) == 0
    after = json.loads((folder / "study.json").read_text())
    assert len(in_process) == 1
    assert [row["contact_fraction"] for row in after["settings"]] == [
        row["contact_fraction"] for row in before["settings"]
    ]


def test_the_study_of_another_scene_is_not_overwritten_unless_asked(studied, tmp_path, in_process):
    _, folder, _ = studied
    stored = (folder / "study.json").read_text()
    copy = tmp_path / "out"
    copy.mkdir()
    (copy / "study.json").write_text(stored)
    other = scene_file(tmp_path, title="another", adhesion=None)
    with pytest.raises(ReportError, match=r"study of another scene .*rubber on <glass>.*--overwrite"):
        run(other, copy, QUICK, lambda note: None)
    assert (copy / "study.json").read_text() == stored
    assert run(other, copy, replace(QUICK, overwrite=True, seeds=0), lambda note: None) == 0


def test_a_file_that_is_no_study_is_refused(tmp_path):
    (tmp_path / "study.json").write_text("{}")
    with pytest.raises(ReportError, match="not the study of a scene"):
        run(scene_file(tmp_path), tmp_path, QUICK, lambda note: None)


def test_what_goes_beyond_the_budget_is_left_out(tmp_path, in_process):
    assert run(scene_file(tmp_path), tmp_path / "out", replace(QUICK, budget=1e-6), lambda note: None) == 0
    content = json.loads((tmp_path / "out" / "study.json").read_text())
    assert in_process == [BASE]
    assert {row["status"] for row in content["settings"]} == {"converged", "left out", "does not apply"}
    assert "beyond the budget of 1e-06 s" in content["settings"][1]["why"]


def test_a_setting_that_the_scene_refuses_is_a_row(tmp_path, in_process):
    accuracy = {"max_increment": 60.0}  # twice that is beyond what a scene takes
    assert run(scene_file(tmp_path, accuracy=accuracy), tmp_path / "out", QUICK, lambda note: None) == 0
    rows = json.loads((tmp_path / "out" / "study.json").read_text())["settings"]
    refused = [row for row in rows if row["status"] == "refused"]
    assert [row["name"] for row in refused] == ["240"]
    assert "accuracy.max_increment = 240.0" in refused[0]["why"]


def test_a_run_that_takes_far_too_long_is_stopped():
    stopped = solved(ToSolve("", ROUGH, ".", limit=0.0))
    assert (stopped.status, stopped.good) == ("stopped", False)


def test_a_scene_that_does_not_converge_as_it_is_fails_by_name(tmp_path, in_process):
    loading = {"control": "mean_pressure", "targets": [-1e9]}
    notes = []
    assert run(scene_file(tmp_path, loading=loading), tmp_path / "out", QUICK, notes.append) == 1
    assert "does not converge as it is: unreachable" in notes[-1].text
    assert json.loads((tmp_path / "out" / "study.json").read_text())["status"] == "failed"
    assert in_process == [BASE]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        pytest.param(("scene",), "a scene file is needed", id="no file"),
        pytest.param(("scene", "none.toml"), "none.toml cannot be read", id="no such file"),
        pytest.param(("scene", "bad.toml"), "solid.poisson_ratio = 0.7", id="refused"),
        pytest.param(("scene", "bad.toml", "--peers"), "--peers: study scene does not take it", id="peers"),
        pytest.param(("scene", "bad.toml", "--executor", "dask://a:1"), "on this machine only", id="executor"),
        pytest.param(("convergence", "bad.toml"), "scene: study convergence does not take it", id="another study"),
        pytest.param(("convergence", "--budget", "5"), "budget: study convergence does not take it", id="budget"),
    ],
)
def test_bad_input_is_refused_by_name_and_nothing_is_written(words, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene_file(tmp_path, solid=SOLID | {"poisson_ratio": 0.7}).rename(tmp_path / "bad.toml")
    assert main(["study", *words, "--out", "out"]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


LOOK = """
const box = document.getElementById("verdict").getBoundingClientRect();
found.wide = document.documentElement.scrollWidth > innerWidth;
found.verdict = [box.left, box.top, innerWidth - box.right, innerHeight - box.bottom];
found.figures = [...document.querySelectorAll("figure svg")].map((svg) => [svg.getAttribute("role"),
  document.getElementById(svg.getAttribute("aria-labelledby")).textContent.length > 20]);
const targets = [...document.querySelectorAll("a[href]")].map((link) => link.getAttribute("href"));
found.lost = targets.filter((target) => !document.getElementById(target.slice(1)));
found.resources = performance.getEntriesByType("resource").map((entry) => entry.name);
"""


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_in_a_browser(studied, tmp_path, width):
    _, folder, _ = studied
    page = render_study(json.loads((folder / "study.json").read_text()))
    assert "rubber on &lt;glass&gt;" in page
    found, console = found_at(tmp_path, page, LOOK, width)
    assert (console, found["wide"], found["lost"], found["resources"]) == ([], False, [], [])
    assert min(found["verdict"]) >= 0  # on the first screen, all of it
    assert found["figures"] == [["img", True]]


def test_a_scene_without_contact_ends_in_a_page_that_says_so(tmp_path, in_process):
    loading = {"control": "separation", "targets": [3e-4]}
    path = scene_file(tmp_path, loading=loading, output=None)
    assert run(path, tmp_path / "out", QUICK, lambda note: None) == 0
    assert "There is no contact at any target. " in (tmp_path / "out" / "study.html").read_text("utf-8")
