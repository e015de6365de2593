"""The command line: exit codes, what is written and what is never lost, progress, resuming, figures."""

import io
import json
import os
import shutil
import signal
from dataclasses import replace

import numpy as np
import pytest
from scene_files import SCENE, run, written_scene
from stored_states import stored_state

from bem import scene_commands as command_line
from bem.audit import certificate
from bem.command_line.checkpoint import Checkpoint
from bem.command_line.console import LineReporter, TimeLeft, reporter, summary, summary_line
from bem.record import Record, entries_of
from bem.scene.result import Progress, Result
from bem.scene.result_file import read_result
from bem.scene.scene import load_scene

PROGRESS = Progress(1e3, 0.1, 3, 10, 1, 40, 0, 3)


def fake_state(separation, evaluations=10):
    return stored_state(
        penetration=1e-4 - separation,
        separation=separation,
        mean_pressure=1e3,
        n_patches=1,
        edges=((0.001, 0.002),),
        evaluations=evaluations,
        events=0,
    )


class FakeSolver:
    """Visits the targets of a scene without computing; may be stopped at one of them."""

    def __init__(self, stop_at=None, how="interrupted"):
        self.stop_at, self.how, self.visited = stop_at, how, []

    def __call__(self, scene, progress=None, on_state=None, resume=None, jobs=None):
        self.jobs = jobs
        record = Record(scene)
        if resume is not None:
            record.entries = list(entries_of(resume, record.begun))
        targets, x = scene.loading.targets, np.linspace(0, 0.01, 5)
        shape = {"x_0": x, "displacement_0": x, "gap_0": x, "pressure_0": x, "patch_0": np.zeros(5, dtype=int)}
        status = "converged"
        for index in range(len(record.entries), len(targets)):
            if index == self.stop_at:
                if isinstance(self.how, BaseException):
                    raise self.how
                status = self.how
                break
            progress(replace(PROGRESS, target_index=index, n_targets=len(targets)))
            self.visited.append(targets[index])
            record.add(fake_state(targets[index]), {} if index else shape, index=index)
            on_state(record)
        return record.result(status)


@pytest.fixture
def scene(tmp_path):
    return written_scene(tmp_path)


@pytest.fixture
def solver(monkeypatch):
    def install(**options):
        fake = FakeSolver(**options)
        monkeypatch.setattr(command_line, "solve", fake)
        return fake

    return install


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_check_prints_scene_effects_and_memory(scene, capsys):
    assert command_line.main(["check", str(scene)]) == 0
    printed = capsys.readouterr().out
    assert "hurst = 0.7" in printed
    assert "slope_term" in printed
    assert "GB of memory" in printed


def test_check_as_json(scene, capsys):
    assert command_line.main(["check", str(scene), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["scene"] == load_scene(scene).resolved()
    assert 8e7 < content["memory"] < 1e8
    assert content["unknowns"] > 0


def test_check_lists_every_mistake(scene, capsys):
    scene.write_text(scene.read_text().replace("0.5", "0.7").replace("0.03", "nan"))
    assert command_line.main(["check", str(scene)]) == 2
    said = capsys.readouterr().err
    assert "solid.poisson_ratio" in said
    assert "adhesion.work_of_adhesion" in said


def test_run_writes_the_result_and_one_line(scene, tmp_path, solver, capsys):
    solver()
    assert run(scene, tmp_path / "out") == 0
    printed = capsys.readouterr()
    assert printed.out.count("\n") == 1
    assert printed.out.startswith("converged: 3 states")
    assert sorted(files(tmp_path / "out")) == ["fields.npz", "result.json"]
    assert len(read_result(tmp_path / "out").states) == 3


def test_run_as_json(scene, tmp_path, solver, capsys):
    solver()
    run(scene, tmp_path / "out", "--json")
    facts = json.loads(capsys.readouterr().out)
    assert (facts["status"], facts["targets"], facts["certified"], facts["evaluations"]) == ("converged", 3, 3, 30)


def test_bad_scene_writes_nothing(scene, tmp_path, solver):
    solver()
    scene.write_text(scene.read_text().replace("harmonics = 20", "harmonics = -20"))
    assert run(scene, tmp_path / "out") == 2
    assert not (tmp_path / "out").exists()


def test_existing_folder_is_refused_and_kept(scene, tmp_path, solver, capsys):
    solver()
    run(scene, tmp_path / "out")
    before = files(tmp_path / "out")
    assert run(scene, tmp_path / "out") == 2
    assert "--overwrite" in capsys.readouterr().err
    assert files(tmp_path / "out") == before


def test_empty_folder_is_refused_too(scene, tmp_path, solver):
    solver()
    (tmp_path / "out").mkdir()
    assert run(scene, tmp_path / "out") == 2
    assert files(tmp_path / "out") == {}


@pytest.mark.parametrize("flag", [(), ("--resume",), ("--overwrite",)], ids=["plain", "resume", "overwrite"])
def test_file_in_place_of_the_folder_is_refused(flag, scene, tmp_path, solver):
    solver()
    (tmp_path / "out").write_text("precious")
    assert run(scene, tmp_path / "out", *flag) == 2
    assert (tmp_path / "out").read_text() == "precious"


def test_overwrite_replaces_the_result_and_keeps_other_files(scene, tmp_path, solver):
    solver()
    run(scene, tmp_path / "out", "--plot")
    for name in ("notes.txt", "answer.csv", "report.html"):
        (tmp_path / "out" / name).write_text("before")
    other = written_scene(tmp_path, targets="70e-6, 50e-6", name="other.toml")
    assert run(other, tmp_path / "out", "--overwrite") == 0
    assert read_result(tmp_path / "out").scene["loading"]["targets"] == [70e-6, 50e-6]
    assert sorted(files(tmp_path / "out")) == ["fields.npz", "notes.txt", "result.json"]


def test_what_was_drawn_of_an_unfinished_run_goes_when_it_is_finished(scene, tmp_path, solver):
    solver(stop_at=2)
    run(scene, tmp_path / "out", "--plot")
    (tmp_path / "out" / "report.html").write_text("of two states")
    solver()
    run(scene, tmp_path / "out", "--resume")
    assert sorted(files(tmp_path / "out")) == ["fields.npz", "result.json"]


def test_resume_and_overwrite_exclude_one_another(scene, tmp_path, capsys):
    with pytest.raises(SystemExit) as caught:
        run(scene, tmp_path / "out", "--resume", "--overwrite")
    assert caught.value.code == 2


def test_interrupted_run_saves_what_converged(scene, tmp_path, solver):
    solver(stop_at=2)
    assert run(scene, tmp_path / "out") == 130
    stored = read_result(tmp_path / "out")
    assert (stored.status, len(stored.states)) == ("interrupted", 2)


@pytest.mark.parametrize(("words", "jobs"), [((), os.cpu_count()), (("--jobs", "3"), 3)], ids=["all cores", "three"])
def test_a_scene_is_solved_by_so_many_processes(words, jobs, scene, tmp_path, solver):
    fake = solver()
    assert run(scene, tmp_path / "out", *words) == 0
    assert fake.jobs == jobs


@pytest.mark.parametrize("jobs", ["0", "-1", "two", "1.5"])
def test_a_number_of_processes_is_whole(jobs, scene, tmp_path, capsys):
    with pytest.raises(SystemExit, match="2"):
        run(scene, tmp_path / "out", "--jobs", jobs)
    assert f"argument --jobs: {jobs!r}: an integer >= 1 is needed" in capsys.readouterr().err


def test_resume_visits_only_what_is_missing(scene, tmp_path, solver):
    solver(stop_at=2)
    run(scene, tmp_path / "out")
    again = solver()
    assert run(scene, tmp_path / "out", "--resume") == 0
    assert again.visited == [40e-6]
    assert len(read_result(tmp_path / "out").states) == 3


def test_resume_of_a_complete_result_computes_nothing(scene, tmp_path, solver):
    solver()
    run(scene, tmp_path / "out")
    before = files(tmp_path / "out")
    again = solver()
    assert run(scene, tmp_path / "out", "--resume") == 0
    assert again.visited == []
    assert files(tmp_path / "out") == before


@pytest.mark.parametrize("folder_exists", [True, False])
def test_resume_without_a_result_begins(folder_exists, scene, tmp_path, solver):
    solver()
    if folder_exists:
        (tmp_path / "out").mkdir()
    assert run(scene, tmp_path / "out", "--resume") == 0


def test_result_of_another_scene_is_refused_and_kept(scene, tmp_path, solver, capsys):
    solver(stop_at=1)
    run(scene, tmp_path / "out")
    before = files(tmp_path / "out")
    other = written_scene(tmp_path, harmonics=21, name="other.toml")
    assert run(other, tmp_path / "out", "--resume") == 2
    assert "another scene (differs in profile)" in capsys.readouterr().err
    assert files(tmp_path / "out") == before


def test_corrupt_result_is_refused_and_kept(scene, tmp_path, solver, capsys):
    solver(stop_at=1)
    run(scene, tmp_path / "out")
    path = tmp_path / "out" / "result.json"
    path.write_text(path.read_text().replace('"n_patches": 1', '"n_patches": 2'))
    before = files(tmp_path / "out")
    assert run(scene, tmp_path / "out", "--resume") == 2
    assert "corrupt" in capsys.readouterr().err
    assert files(tmp_path / "out") == before


def test_resume_of_an_earlier_version_is_refused(scene, tmp_path, capsys):
    """Its states do not name their targets."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "result.json").write_text('{"schema": "linecontact-result/1"}')
    assert run(scene, tmp_path / "out", "--resume") == 2
    assert "a result of linecontact 0.2.0, which this version does not read" in capsys.readouterr().err


@pytest.mark.parametrize("status", ["unreachable", "not_converged"])
def test_failed_run_keeps_what_converged(status, scene, tmp_path, solver, capsys):
    solver(stop_at=1, how=status)
    assert run(scene, tmp_path / "out") == 1
    assert capsys.readouterr().out.startswith(status)
    assert len(read_result(tmp_path / "out").states) == 1


def test_crash_of_the_solver_keeps_what_converged(scene, tmp_path, solver):
    solver(stop_at=2, how=ZeroDivisionError("singular"))
    with pytest.raises(ZeroDivisionError):
        run(scene, tmp_path / "out")
    assert len(read_result(tmp_path / "out").states) == 2


def test_interrupt_the_solver_does_not_catch_keeps_what_converged(scene, tmp_path, solver):
    solver(stop_at=2, how=KeyboardInterrupt())
    assert run(scene, tmp_path / "out") == 130
    assert len(read_result(tmp_path / "out").states) == 2


def test_full_disk_is_an_error_and_not_a_traceback(scene, tmp_path, solver, monkeypatch, capsys):
    solver()

    def full_disk(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    assert run(scene, tmp_path / "out") == 1
    assert "No space left on device" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_sigterm_handler_is_put_back(scene, tmp_path, solver):
    solver()
    before = signal.getsignal(signal.SIGTERM)
    run(scene, tmp_path / "out")
    assert signal.getsignal(signal.SIGTERM) is before


def test_progress_goes_to_stderr_and_can_be_silenced(scene, tmp_path, solver, capsys):
    solver()
    run(scene, tmp_path / "loud")
    said = capsys.readouterr().err
    assert "towards target 1 of 3" in said
    assert "3 patches, 10 increments (1 rejected)" in said
    run(scene, tmp_path / "quiet", "--quiet")
    assert capsys.readouterr().err == ""


def test_lines_are_throttled():
    stream, times = io.StringIO(), iter([0.0, 1.0, 6.0, 6.1, 6.9])
    report = LineReporter(stream, clock=lambda: next(times))
    shown = []
    for target in (0, 0, 0, 1, 1):
        report(replace(PROGRESS, target_index=target))
        shown.append(stream.getvalue().count("\n"))
    assert shown == [1, 1, 2, 2, 3]


def test_terminal_gets_a_bar(monkeypatch):
    stream = io.StringIO()
    monkeypatch.setattr(stream, "isatty", lambda: True)
    bar = reporter(stream, quiet=False)
    bar(replace(PROGRESS, target_index=2))
    bar.close()
    assert "2/3" in stream.getvalue()
    assert "contact fraction 0.1" in stream.getvalue()


def test_plots_are_drawn_when_asked_for(scene, tmp_path, solver):
    solver()
    run(scene, tmp_path / "out", "--plot")
    drawn = {name: content for name, content in files(tmp_path / "out").items() if name.endswith(".png")}
    assert sorted(drawn) == ["contact_fraction.png", "separation.png", "shape_0.png"]
    assert all(content.startswith(b"\x89PNG") for content in drawn.values())


def test_every_state_is_in_the_journal_and_now_and_then_in_the_result(scene, tmp_path):
    """A write of result.json takes 0.1 s here, so that the next one comes a second later."""
    times = iter([0.0, 0.1, 0.5, 1.0, 1.2, 1.3])
    checkpoint, record = Checkpoint(tmp_path, clock=lambda: next(times)), Record(load_scene(scene))
    kept, shown = [], []
    for separation in (6e-5, 5.8e-5, 5.6e-5, 5.4e-5):
        record.add(fake_state(separation), {})
        checkpoint.keep(record)
        kept.append(len(read_result(tmp_path).states))
        shown.append(len(json.loads((tmp_path / "result.json").read_text())["states"]))
    assert (kept, shown) == ([1, 2, 3, 4], [1, 1, 1, 4])


@pytest.mark.parametrize(
    ("pressure", "failure", "said"),
    [
        (np.nan, None, "last at any pressure, contact fraction 1; "),
        (1.0, "2 of 3 states are not certified", "converged (2 of 3 states are not certified): 1 states"),
    ],
    ids=["open pressure", "failure"],
)
def test_summary_tells(pressure, failure, said):
    state = replace(fake_state(0.0), status="complete_contact", mean_pressure=pressure, contact_fraction=1.0)
    facts = summary(Result({}, (), {}, (state,), (), "converged", failure=failure), "out", 1)
    assert said in summary_line(facts)
    assert json.loads(json.dumps(facts, allow_nan=False))["failure"] == failure


def test_what_is_not_certified_ends_with_exit_code_1(scene, tmp_path, monkeypatch, capsys):
    refuse = replace(certificate.Demands(), interpenetration=-1.0)
    monkeypatch.setattr(certificate, "Demands", lambda **limits: refuse)
    assert run(scene, tmp_path / "out") == 1
    assert capsys.readouterr().out.startswith("not_converged (")
    assert "not_converged" in {state.status for state in read_result(tmp_path / "out").states}


def test_a_folder_that_is_removed_while_a_run_writes_there_is_one_error(scene, tmp_path, solver, monkeypatch, capsys):
    fake, out = solver(), tmp_path / "out"

    def removing(scene, progress=None, on_state=None, resume=None, jobs=None):
        def keep(record):
            on_state(record)
            shutil.rmtree(out)

        return fake(scene, progress, keep, resume)

    monkeypatch.setattr(command_line, "solve", removing)
    assert run(scene, out, "--quiet") == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "journal.jsonl" in said


@pytest.mark.parametrize("words", [["check"], ["run", "--out", "out"]])
def test_a_scene_that_needs_more_memory_than_there_is_is_refused(words, tmp_path, monkeypatch, capsys):
    pressed = SCENE.format(harmonics=100_000, targets="3e7").replace('"separation"', '"mean_pressure"')
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(pressed.replace("[output]\nshapes = [50e-6]\n", ""))
    assert command_line.main([words[0], "scene.toml", *words[1:]]) == 2
    assert "profile.harmonics 100000 need about " in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_time_left_is_that_of_the_way_left_at_the_pace_so_far():
    times = iter([0.0, 1.0, 3.0])
    left = TimeLeft((2e-5, 4e-5, 0.0), clock=lambda: next(times))
    values = (0, 0.0), (0, 2e-5), (2, 2e-5)
    said = [left.words(replace(PROGRESS, target_index=index, value=value)) for index, value in values]
    assert said == ["", ", about 3 s to go", ", about 1 s to go"]


def test_check_and_run_refuse_the_same_flaw(tmp_path, capsys):
    scene = SCENE.format(harmonics=20, targets="60e-6").replace("50e-6\n", "3.1e-7\nseed = 1192680793\n", 1)
    scene = scene.replace("[output]\nshapes = [50e-6]\n", "").replace("0.7", "0.3206928286489916")
    scene = scene.replace("1.0e6", "503989810615.0363").replace("0.5\n", "0.49\n").replace("0.01\n", "1.678e-5\n")
    scene = scene.replace("0.03", "5.7555e-19").replace('"separation"', '"mean_pressure"').replace("60e-6", "2.1e7")
    (tmp_path / "scene.toml").write_text(scene + 'initial = "complete_contact"\nflaw = 2.6827e-08\n')
    said = []
    for words in (["check"], ["run", "--out", str(tmp_path / "out")]):
        assert command_line.main([words[0], str(tmp_path / "scene.toml"), *words[1:]]) == 2
        said.append(capsys.readouterr().err.splitlines()[-1])
    assert said[0] == said[1]
    assert "the pressure would hold a part of it closed" in said[0]
