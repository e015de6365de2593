"""The command `linecontact`: examples that run, the commands of solver and harness."""

import re
import runpy
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

import bem
import validation.__main__ as validation_main
from bem import scene_commands as bem_main
from validation.command_line.examples import EXAMPLES
from validation.command_line.front_door import main

ROOT = Path(__file__).parents[2]
SCENES = [name for name, (first, *_) in EXAMPLES.items() if first.endswith(".toml")]
COMMANDS = ["check", "run", "keys", "schema", "report", "compare", "verify", "study", "replicate", "challenge"]
COMMANDS += ["answer", "docs", "example", "fem"]


def exit_code(*words):
    """Exit code, also where argparse ends the program."""
    try:
        return main(words)
    except SystemExit as error:
        return error.code


@pytest.mark.parametrize("door", [main, bem_main.main, validation_main.main], ids=["linecontact", "bem", "validation"])
def test_version(door, capsys):
    """The one of pyproject.toml, as installed, by every door."""
    with pytest.raises(SystemExit) as ended:
        door(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"linecontact {metadata.version('linecontact')}\n"


@pytest.mark.parametrize("words", [["check"], ["run", "--quiet", "--out", "result"]])
def test_commands_of_a_scene_do_without_the_harness(words, tmp_path):
    scene = ROOT / "validation/command_line/examples/one-wave.toml"
    code = """if True:
        import atexit, gc, sys
        from validation.command_line import front_door
        loaded = lambda: sorted(name for name in sys.modules if name.split(".")[0] == "validation")
        atexit.register(lambda: print(gc.isenabled(), gc.get_freeze_count() > 1000, loaded()))
        sys.exit(front_door.main())
    """
    words = [sys.executable, "-c", code, *words, str(scene)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, cwd=tmp_path)
    alone = ["validation", "validation.command_line", "validation.command_line.front_door"]
    assert done.stdout.splitlines()[-1] == f"True True {alone}"


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command, capsys):
    assert exit_code(command, "--help") == 0
    assert capsys.readouterr().out.startswith(f"usage: linecontact {command}")


def test_examples_are_listed_by_name(capsys):
    assert exit_code("example") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(EXAMPLES)
    assert len(lines) >= 8
    folder = ROOT / "validation" / "command_line" / "examples"
    files = {
        f"guide/{file}" if name in GUIDE and file.endswith(".py") else file
        for name, files in EXAMPLES.items()
        for file in files
    }
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert {name for name in there if "__pycache__" not in name} == files


@pytest.mark.parametrize("name", SCENES)
def test_an_example_is_written_explained_and_solved(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert exit_code("example", name) == 0
    assert capsys.readouterr().out.splitlines() == [f"{name}.toml", *EXAMPLES[name][1:]]
    assert (tmp_path / f"{name}.toml").read_text().count("# ") >= 5
    assert exit_code("check", f"{name}.toml") == 0
    assert exit_code("run", f"{name}.toml", "--out", "result", "--quiet") == 0
    result = bem.read_result(tmp_path / "result")
    assert result.targets
    assert all(state.certificate.ok for state in result.states)


def test_the_closed_form_that_an_example_names_holds():
    result = bem.solve(ROOT / "validation/command_line/examples/one-wave.toml")
    modulus, period, height, work = 1e6 / 0.75, 0.01, 1e-4, 0.03
    psi = np.pi / 2 * np.array([state.contact_fraction for state in result.targets])
    expected = np.pi * modulus * height / period * np.sin(psi) ** 2 - np.sqrt(2 * modulus * work / period * np.tan(psi))
    computed = [state.mean_pressure for state in result.targets]
    assert computed == pytest.approx(expected, abs=6e-9)  # measured 2.4e-9 Pa of 700 to 24000 Pa


GUIDE = {  # what each script prints: words, and a number behind them with what it may be off by
    "guide-seal": (r"0\.2 MPa: touches on ([\d.]+) of the face in 24 strips", 0.7039, 6e-5),  # four digits are printed
    "guide-ensemble": (r"20 kPa: contact fraction ([\d.]+) \+- 0\.0079", 0.6558, 6e-5),
    "guide-map": (r"H = 0\.3: ([\d.]+) Pa", 104.0, 6e-2),  # four digits are printed
    "guide-sweep": (r"200000\.0 +([\d.]+)", 0.8980, 6e-5),
    "guide-fem": (r"mean_pressure: [\d.]+ \+- \S+ and [\d.]+ \+- \S+, ([\d.]+) of both", 0.0, 1.0),  # measured 0.12
}


@pytest.mark.parametrize("name", GUIDE)
def test_a_script_of_the_guide_is_written_and_runs(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert exit_code("example", name) == 0
    script, *data = capsys.readouterr().out.splitlines()
    assert EXAMPLES[name] == (script, *data)
    runpy.run_path(script, run_name="__main__")
    words, number, off = GUIDE[name]
    assert float(re.search(words, capsys.readouterr().out)[1]) == pytest.approx(number, abs=off)
    assert len((tmp_path / script).read_text().splitlines()) <= 60


def test_what_is_there_is_not_written_over(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("own-scan.csv").write_text("mine")
    assert exit_code("example", "own-scan") == 2
    assert capsys.readouterr().err == "error: own-scan.csv: is there already, nothing is written\n"
    assert [path.name for path in tmp_path.iterdir()] == ["own-scan.csv"]
    assert Path("own-scan.csv").read_text() == "mine"


def test_an_unknown_example_is_told_with_those_there_are(capsys):
    assert exit_code("example", "torsion") == 2
    said = capsys.readouterr().err
    assert "'torsion'" in said
    assert "paper-profile" in said


def test_a_command_with_a_slip_is_told_what_was_meant(capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["anwser"])
    assert "did you mean answer; allowed: " in capsys.readouterr().err


@pytest.mark.parametrize("words", [["no.toml"], ["scene", "no.toml"]])
def test_a_study_is_of_one_scene(words, tmp_path, capsys):
    assert main(["study", *words, "--out", str(tmp_path / "out")]) == 2
    assert "no.toml cannot be read" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="2"):
        main(["study", *words, "other.toml", "--out", str(tmp_path)])


def test_names_of_bem_are_listed_without_importing_what_they_name():
    code = "import sys, bem; print(*dir(bem)); print(*sorted(m for m in sys.modules if m.startswith('bem')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names, modules = done.stdout.splitlines()
    assert {"solve", "read_result", "parse_scene", "Profile", "__version__"} <= set(names.split())
    assert modules == "bem"
