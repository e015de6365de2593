"""The README's snippets work as they stand."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from bem.scene.scene import parse_scene
from validation.command_line import front_door

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.toml").write_text(blocks("toml")[1])
    return tmp_path


def test_it_is_short():
    assert len(README.splitlines()) <= 150


def test_there_are_two_commands_first():
    commands = [line for block in blocks("sh") for line in block.splitlines() if line and not line.startswith("#")]
    assert "linecontact verify --level standard" in commands[0]
    assert commands[1].endswith("python -m pytest")


def test_scene_is_toml():
    assert tomllib.loads(blocks("toml")[1])["profile"]["harmonics"] == 60


def test_scan_is_taken_as_shown(folder):
    x, h = np.arange(100) * 0.01, np.cos(np.arange(100) / 5)
    np.savetxt(folder / "scan.csv", np.column_stack([x, h]), delimiter=";")
    scan, scene = map(tomllib.loads, blocks("toml")[:2])
    steps = parse_scene(scene | scan, folder).preparation()
    asked = {step["step"]: step.get("method") for step in steps}
    assert (asked["outliers"], asked["missing"], asked["detrend"]) == ("replace", "interpolate", "line")
    assert (asked["periodic"], steps[-1]["harmonics"]) == ("mirror", 99)


PROGRAMS = {"linecontact": front_door.main}


@pytest.fixture
def run_block(tmp_path, monkeypatch):
    """Runs the lines of a block of commands in an empty folder; each ends with exit code 0."""
    monkeypatch.chdir(tmp_path)

    def run(text):
        for line in text.splitlines():
            program, main = next((name, main) for name, main in PROGRAMS.items() if line.startswith(f"{name} "))
            assert main(line.split("#")[0].removeprefix(program).split()) == 0, line

    return run


def test_scene_commands_run(run_block, folder):
    run_block(blocks("sh")[2])
    assert (folder / "result" / "report.html").exists()


def test_files_of_a_run_are_named(folder, monkeypatch):
    """Those of the scene at the top, drawn and reported."""
    monkeypatch.chdir(folder)
    assert front_door.main(["run", "scene.toml", "--out", "result", "--plot", "--quiet"]) == 0
    assert front_door.main(["report", "result"]) == 0
    names = {re.sub(r"_\d+", "_N", path.name) for path in (folder / "result").iterdir()}
    assert len(names) == 7  # result.json, fields.npz, drawings of three kinds, report.html, answer.csv
    assert {name for name in names if f"`{name}`" not in README} == set()


def test_commands_from_a_trace_to_a_page_run(run_block, tmp_path):
    run_block(blocks("sh")[1])
    pages = [(tmp_path / name / "report.html").read_text("utf-8") for name in ("seal", "again")]
    assert all("as prepared" in page for page in pages)


@pytest.mark.slow
def test_the_study_of_a_scene_runs(run_block, tmp_path):
    run_block(f"linecontact example pull-off\n{blocks('sh')[3]}")
    page = (tmp_path / "sure" / "study.html").read_text("utf-8")
    assert "How far each answer moves" in page


def test_python_lines_run(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    exec(compile(blocks("python")[0], "README.md", "exec"), {"__name__": "__main__"})
    assert len(capsys.readouterr().out.splitlines()) >= 3


def test_pictures_exist():
    for name in re.findall(r"!\[.*?\]\((.*?)\)", README):
        assert (ROOT / name).exists(), name
