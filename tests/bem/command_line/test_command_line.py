"""The command line: exit codes, what is written and what is never lost, progress, resuming, figures."""

import io
import json
import resource
import shutil
import signal
import subprocess
import sys
from dataclasses import replace

import pytest
from scene_files import run, written_scene
from stored_states import stored_state

from bem.command_line.checkpoint import Checkpoint
from bem.command_line.console import LineReporter, TimeLeft, reporter
from bem.record import Record
from bem.scene.progress import Progress
from bem.scene.result_file import read_result
from bem.scene.scene import load_scene
from bem.scene_commands import main

PROGRESS = Progress(1e3, 0.1, 3, 10, 1, 40, 0, 3)


@pytest.fixture
def scene(tmp_path):
    return written_scene(tmp_path)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Folder of a finished run of the scene."""
    folder = tmp_path_factory.mktemp("finished")
    assert run(written_scene(folder), folder / "out", "--quiet") == 0
    return folder / "out"


@pytest.fixture
def out(finished, tmp_path):
    """Copy of the folder of a finished run."""
    return shutil.copytree(finished, tmp_path / "out")


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_check_prints_scene_effects_and_memory(scene, capsys):
    assert main(["check", str(scene)]) == 0
    printed = capsys.readouterr().out
    for part in ("hurst = 0.7", "slope_term", "GB of memory"):
        assert part in printed


def test_check_as_json(scene, capsys):
    assert main(["check", str(scene), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["scene"] == load_scene(scene).resolved()
    assert 1e8 < content["memory"] < 2e8
    assert content["unknowns"] > 0


def test_run_prints_progress_and_one_line_and_writes_the_result(scene, tmp_path, capsys):
    before = signal.getsignal(signal.SIGTERM)
    assert run(scene, tmp_path / "out", "--plot") == 0
    printed = capsys.readouterr()
    assert printed.out.count("\n") == 1
    assert printed.out.startswith("converged: 3 states")
    assert "towards target 1 of 3" in printed.err
    pictures = ["contact_fraction.png", "separation.png", "shape_0.png"]
    assert sorted(files(tmp_path / "out")) == sorted(["fields.npz", "result.json", *pictures])
    assert all((tmp_path / "out" / name).read_bytes().startswith(b"\x89PNG") for name in pictures)
    assert [state.separation for state in read_result(tmp_path / "out").targets] == [6e-5, 5e-5, 4e-5]
    assert signal.getsignal(signal.SIGTERM) is before


def test_run_as_json_and_quiet(scene, tmp_path, capsys):
    assert run(scene, tmp_path / "out", "--json", "--quiet") == 0
    printed = capsys.readouterr()
    facts, states = json.loads(printed.out), read_result(tmp_path / "out").states
    assert (facts["status"], facts["targets"]) == ("converged", 3)
    assert facts["states"] == facts["certified"] == len(states)
    assert facts["evaluations"] == sum(state.evaluations for state in states)
    assert printed.err == ""


@pytest.mark.parametrize("words", [["check"], ["run", "--out", "out"]], ids=["check", "run"])
@pytest.mark.parametrize(
    ("changes", "mistakes"),
    [
        ({"0.5\n": "0.7\n", "0.03": "nan"}, ["solid.poisson_ratio", "adhesion.work_of_adhesion"]),
        (
            {
                '"separation"': '"mean_pressure"',
                "60e-6, 50e-6, 40e-6": "3e7",
                "harmonics = 20": "harmonics = 1000000",
                "[output]\nshapes = [50e-6]\n": "",
            },
            ["profile.harmonics 1000000 need about "],
        ),
    ],
    ids=["every mistake", "memory"],
)
def test_a_scene_that_is_refused_writes_nothing(words, changes, mistakes, scene, tmp_path, monkeypatch, capsys):
    text = scene.read_text()
    for old, new in changes.items():
        text = text.replace(old, new)
    scene.write_text(text)
    monkeypatch.chdir(tmp_path)
    assert main([words[0], "scene.toml", *words[1:]]) == 2
    told = capsys.readouterr().err
    assert all(mistake in told for mistake in mistakes)
    assert not (tmp_path / "out").exists()


def test_a_folder_that_exists_is_refused_and_kept(scene, out, tmp_path, capsys):
    before = files(out)
    assert run(scene, out) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert files(out) == before
    (tmp_path / "empty").mkdir()
    assert run(scene, tmp_path / "empty") == 2


def test_overwrite_replaces_what_a_run_wrote_and_keeps_other_files(out, tmp_path):
    for name in ("notes.txt", "answer.csv", "report.html", "shape_0.png"):
        (out / name).write_text("before")
    other = written_scene(tmp_path, targets="70e-6, 50e-6", name="other.toml")
    assert run(other, out, "--overwrite") == 0
    assert read_result(out).scene["loading"]["targets"] == [70e-6, 50e-6]
    assert sorted(files(out)) == ["fields.npz", "notes.txt", "result.json"]


def test_overwrite_of_a_folder_without_a_result_keeps_all_files(scene, tmp_path):
    (tmp_path / "mine").mkdir()
    for name in ("answer.csv", "report.html", "shape_0.png"):
        (tmp_path / "mine" / name).write_text("mine")
    assert run(scene, tmp_path / "mine", "--overwrite") == 0
    assert {(tmp_path / "mine" / name).read_text() for name in ("answer.csv", "report.html", "shape_0.png")} == {"mine"}


@pytest.mark.parametrize("words", [["--resume", "--overwrite"], ["--jobs", "0"], ["--jobs", "two"]])
def test_options_that_mean_nothing_are_bad_input(words, scene, tmp_path):
    with pytest.raises(SystemExit, match="2"):
        run(scene, tmp_path / "out", *words)


def test_resume_of_a_finished_run_changes_nothing(scene, out):
    before = files(out)
    assert run(scene, out, "--resume") == 0
    assert files(out) == before


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        (lambda text: text.replace('"n_patches": ', '"n_patches": 1'), "corrupt"),
        (lambda text: '{"schema": "linecontact-result/1"}', "a result of linecontact 0.2.0"),
    ],
    ids=["corrupt", "earlier version"],
)
def test_a_result_that_cannot_be_read_is_refused_and_kept(damage, told, scene, out, capsys):
    path = out / "result.json"
    path.write_text(damage(path.read_text()))
    before = files(out)
    assert run(scene, out, "--resume") == 2
    assert told in capsys.readouterr().err
    assert files(out) == before


def test_a_result_of_another_scene_is_refused_and_kept(out, tmp_path, capsys):
    before = files(out)
    assert run(written_scene(tmp_path, harmonics=21, name="other.toml"), out, "--resume") == 2
    assert "another scene (differs in profile)" in capsys.readouterr().err
    assert files(out) == before


def test_a_target_that_is_missed_ends_with_exit_code_1_and_keeps_the_others(scene, tmp_path, capsys):
    text = scene.read_text().partition("[output]")[0].replace('"separation"', '"mean_pressure"')
    scene.write_text(text.replace("60e-6, 50e-6, 40e-6", "-1e9, 1e4"))
    assert run(scene, tmp_path / "out") == 1
    assert capsys.readouterr().out.startswith("unreachable")
    assert [state.status for state in read_result(tmp_path / "out").targets] == ["unreachable", "converged"]


def small_files():
    """Let the process write files of 100 bytes at most."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_full_disk_is_an_error_and_not_a_traceback(scene, tmp_path):
    # -B: bytecode that this process wrote would be cut off, and break every process after it
    command = [sys.executable, "-B", "-m", "bem", "run", str(scene), "--out", str(tmp_path / "out"), "--quiet"]
    process = subprocess.run(command, preexec_fn=small_files, capture_output=True, text=True, check=False)
    assert process.returncode == 1
    assert process.stderr.startswith("error: ")
    assert process.stderr.count("\n") == 1


def test_lines_are_throttled():
    stream, times = io.StringIO(), iter([0.0, 1.0, 6.0, 6.1, 6.9])
    report = LineReporter(stream, clock=lambda: next(times))
    shown = []
    for target in (0, 0, 0, 1, 1):
        report(replace(PROGRESS, target_index=target))
        shown.append(stream.getvalue().count("\n"))
    assert shown == [1, 1, 2, 2, 3]


def test_the_time_left_is_that_of_the_way_left_at_the_pace_so_far():
    times = iter([0.0, 1.0, 3.0])
    left = TimeLeft((2e-5, 4e-5, 0.0), clock=lambda: next(times))
    values = (0, 0.0), (0, 2e-5), (2, 2e-5)
    told = [left.words(replace(PROGRESS, target_index=index, value=value)) for index, value in values]
    assert told == ["", ", about 3 s to go", ", about 1 s to go"]


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_terminal_gets_a_bar():
    stream = Terminal()
    bar = reporter(stream, quiet=False)
    bar(replace(PROGRESS, target_index=2))
    bar.close()
    assert "2/3" in stream.getvalue()


def test_every_state_is_in_the_journal_and_now_and_then_in_the_result(scene, tmp_path):
    """A write of result.json takes 0.1 s here, so that the next one comes a second later."""
    times = iter([0.0, 0.1, 0.5, 1.0, 1.2, 1.3])
    checkpoint, record = Checkpoint(tmp_path, clock=lambda: next(times)), Record(load_scene(scene))
    kept, shown = [], []
    for separation in (6e-5, 5.8e-5, 5.6e-5, 5.4e-5):
        between = {"target": False, "index": None, "events": 0}
        record.add(stored_state(separation=separation, penetration=1e-4 - separation, **between), {})
        checkpoint.keep(record)
        kept.append(len(read_result(tmp_path).states))
        shown.append(len(json.loads((tmp_path / "result.json").read_text())["states"]))
    assert (kept, shown) == ([1, 2, 3, 4], [1, 1, 1, 4])


@pytest.mark.parametrize("words", [["run"], ["run", "--out", "out"], ["check"]])
@pytest.mark.parametrize("content", [b"x [mm];h [um]\n0,0;1,5\n0,1;1,25\n", b"# map\n1.5\n2.5\n", b"\x93NUMPY\x01\x00"])
def test_a_trace_in_place_of_a_scene_is_told_the_command_that_solves_it(words, content, tmp_path, capsys):
    (tmp_path / "trace.csv").write_bytes(content)
    try:
        code = main([words[0], str(tmp_path / "trace.csv"), *words[1:]])
    except SystemExit as error:
        code = error.code
    assert code == 2
    told = f"{tmp_path / 'trace.csv'} is a measured trace, no scene; allowed: a TOML file; a trace is solved by: "
    assert f"{told}linecontact answer {tmp_path / 'trace.csv'} --youngs-modulus E " in capsys.readouterr().err
