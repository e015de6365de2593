"""The README's snippets work as they stand."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from bem.scene.scene import parse_scene
from validation.studies import STUDIES

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.toml").write_text(blocks("toml")[0])
    return tmp_path


def test_there_are_two_commands_first():
    commands = [line for block in blocks("sh") for line in block.splitlines() if line and not line.startswith("#")]
    assert "validation run --level standard" in commands[0]
    assert commands[1].endswith("python -m pytest")


def test_scene_is_toml():
    assert tomllib.loads(blocks("toml")[0])["profile"]["harmonics"] == 60


def test_scan_is_taken_as_shown(folder):
    x, h = np.arange(100) * 0.01, np.cos(np.arange(100) / 5)
    np.savetxt(folder / "scan.csv", np.column_stack([x, h]), delimiter=";")
    scene, scan = map(tomllib.loads, blocks("toml")[:2])
    steps = parse_scene(scene | scan, folder).preparation()
    asked = {step["step"]: step.get("method") for step in steps}
    assert (asked["outliers"], asked["missing"], asked["detrend"]) == ("replace", "interpolate", "line")
    assert (asked["periodic"], steps[-1]["harmonics"]) == ("mirror", 99)


def test_scene_commands_run(folder):
    for line in blocks("sh")[2].splitlines():
        command = [sys.executable, *line.split("#")[0].split()[1:]]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert (folder / "result" / "result.json").exists()


def run_block(text, folder):
    """Run the lines of a block of commands `linecontact ...`."""
    for line in text.splitlines():
        command = [sys.executable, "-m", "validation.command_line.front_door", *line.split("#")[0].split()[1:]]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_commands_from_a_scene_to_a_page_run(tmp_path):
    run_block(blocks("sh")[3], tmp_path)
    assert (tmp_path / "result" / "report.html").exists()


def test_commands_for_a_scan_run(tmp_path):
    run_block(blocks("sh")[4], tmp_path)
    assert "as prepared" in (tmp_path / "scan" / "report.html").read_text("utf-8")


@pytest.mark.slow
def test_the_study_of_a_scene_runs(tmp_path):
    run_block(f"linecontact example pull-off\n{blocks('sh')[5]}", tmp_path)
    page = (tmp_path / "sure" / "study.html").read_text("utf-8")
    assert "largest uncertainty" in page


def test_python_lines_run(folder):
    done = subprocess.run([sys.executable, "-c", blocks("python")[0]], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) >= 3


def test_pictures_exist():
    for name in re.findall(r"!\[.*?\]\((.*?)\)", README):
        assert (ROOT / name).exists(), name


def test_every_study_is_listed():
    lines = [line.split() for block in blocks("sh") for line in block.splitlines()]
    named = [words[4] for words in lines if words[:4] == ["python", "-m", "validation", "study"]]
    assert sorted(named) == sorted(STUDIES)
