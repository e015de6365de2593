"""All rows of a map: each as if alone, median and scatter, rows that fail, runs that continue."""

import csv
import json
import signal
import subprocess
import sys

import numpy as np
import pytest

import bem
from bem.scene_commands import main

SCENE = """
[solid]
youngs_modulus = 5e6
poisson_ratio = 0.49
[profile]
kind = "samples"
file = "map.txt"
spacing = 1e-6
unit_x = "m"
unit_h = "um"
row = ROW
[loading]
control = "mean_pressure"
targets = [1e4, 3e4]
[accuracy]
tolerance = 1e-3
max_increment = 1.0
"""
ROWS = 7


def write(folder, row='"all"', missing=None):
    rng = np.random.default_rng(1)
    orders = np.arange(1, 6)[:, None]
    lines = []
    for k in range(ROWS):
        waves = np.cos(2 * np.pi * orders * np.arange(64) / 64 + rng.uniform(0, 6, (5, 1)))
        h = (1 + 0.1 * k) * (orders[:, 0] ** -1.5) @ waves
        lines.append(" ".join("nan" if (k, i) == missing else f"{value:.5f}" for i, value in enumerate(h)))
    (folder / "map.txt").write_text("\n".join(lines) + "\n")
    path = folder / "scene.toml"
    path.write_text(SCENE.replace("ROW", row))
    return path


def run(path, folder, *words):
    return main(["run", str(path), "--out", str(folder), "--quiet", *words])


def table(folder):
    with (folder / "answer.csv").open() as file:
        return {(entry["target"], entry["quantity"]): entry for entry in csv.DictReader(file)}


def test_median_and_scatter_are_of_rows_solved_alone(tmp_path):
    path = write(tmp_path, '"all"\nevery = 2')
    assert run(path, tmp_path / "out", "--jobs", "1") == 0
    alone = []
    for row in range(0, ROWS, 2):
        result = bem.solve(write(tmp_path, str(row)))
        assert bem.read_result(tmp_path / "out" / f"row-{row:04d}").targets[1].edges == result.targets[1].edges
        alone.append(result.targets[1].contact_fraction)
    entry = table(tmp_path / "out")["30000", "contact_fraction"]
    low, median, high = np.quantile(alone, [0.16, 0.5, 0.84])
    assert (int(entry["rows"]), float(entry["median"])) == (4, median)
    assert float(entry["scatter"]) == pytest.approx((high - low) / 2, rel=1e-12)
    assert median > 0.01


def test_the_answer_is_independent_of_the_number_of_workers(tmp_path):
    path = write(tmp_path)
    for jobs in ("1", "2"):
        assert run(path, tmp_path / jobs, "--jobs", jobs) == 0
    assert (tmp_path / "1" / "answer.csv").read_bytes() == (tmp_path / "2" / "answer.csv").read_bytes()


@pytest.mark.parametrize("missing", [(0, 9), (3, 9)], ids=["the first", "another"])
def test_a_row_that_fails_is_named_and_the_others_are_answered(tmp_path, capsys, missing):
    path = write(tmp_path, missing=missing)
    assert run(path, tmp_path / "out", "--jobs", "1") == 1
    told = capsys.readouterr()
    assert f"FAILED: row {missing[0]}: profile.missing" in told.err
    assert f"{ROWS - 1} of {ROWS} rows answered, each a ridge" in told.out
    assert table(tmp_path / "out")["10000", "contact_fraction"]["rows"] == str(ROWS - 1)


def test_an_interrupted_run_continues(tmp_path, capsys):
    path = write(tmp_path)
    assert run(path, tmp_path / "whole", "--jobs", "1") == 0
    assert run(path, tmp_path / "out", "--jobs", "1") == 0
    (tmp_path / "out" / "row-0004" / "result.json").unlink()
    solved = (tmp_path / "out" / "row-0002" / "result.json").stat().st_mtime_ns
    assert run(path, tmp_path / "out", "--jobs", "1") == 2
    assert "--resume continues" in capsys.readouterr().err
    assert run(path, tmp_path / "out", "--jobs", "1", "--resume") == 0
    assert (tmp_path / "out" / "row-0002" / "result.json").stat().st_mtime_ns == solved
    assert (tmp_path / "out" / "answer.csv").read_bytes() == (tmp_path / "whole" / "answer.csv").read_bytes()


def test_check_says_that_rows_are_ridges(tmp_path, capsys):
    path = write(tmp_path, '"all"\nevery = 3')
    assert main(["check", str(path)]) == 0
    assert "3 rows of the map, 0 to 6, each solved as a ridge; above: row 0" in capsys.readouterr().out
    assert main(["check", "--json", str(path)]) == 0
    assert json.loads(capsys.readouterr().out)["rows"] == [0, 3, 6]


@pytest.mark.parametrize("every", ["0", "-1", "0.5", "true", '"all"'])
def test_a_step_between_rows_that_is_no_whole_number_is_refused(every, tmp_path, capsys):
    path = write(tmp_path, f'"all"\nevery = {every}')
    assert main(["check", str(path)]) == run(path, tmp_path / "out") == 2
    assert capsys.readouterr().err.count("; allowed: an integer >= 1") == 2


def test_warnings_of_rows_are_told_once(tmp_path, capsys):
    path = write(tmp_path, '"all"\nevery = 3')
    path.write_text(path.read_text().replace("youngs_modulus = 5e6", "youngs_modulus = 5.0"))
    run(path, tmp_path / "out", "--jobs", "1")
    (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("warning: solid")]
    assert line.endswith("(3 of 3 rows)")


def test_python_solves_rows(tmp_path):
    rows = bem.solve_rows(write(tmp_path, '"all"\nevery = 4', missing=(4, 2)))
    assert sorted(rows.results) == [0]
    assert "missing" in rows.failures[4]
    assert repr(rows) == "<RowResults: 1 rows of a map answered, 1 failed, reasons in .failures>"
    columns = rows.to_table()
    assert {len(values) for values in columns.values()} == {len(columns["quantity"])}


def test_a_scene_of_rows_is_no_scene_of_one_profile(tmp_path):
    with pytest.raises(bem.SceneError, match=r"bem\.solve_rows"):
        bem.solve(write(tmp_path))
    with pytest.raises(TypeError, match=r"bem\.solve solves it"):
        bem.solve_rows(write(tmp_path, "2"))
    with pytest.raises(bem.SceneError, match=r"profile\.every"):
        bem.solve(write(tmp_path, "2\nevery = 3"))


def test_an_interrupt_of_workers_ends_the_run_with_one_sentence(tmp_path):
    path = write(tmp_path)
    (tmp_path / "map.txt").write_text(50 * (tmp_path / "map.txt").read_text())
    command = [sys.executable, "-m", "bem", "run", path, "--out", tmp_path / "out", "--jobs", "2"]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert run.stderr.readline().startswith("row 0: answered")
    run.send_signal(signal.SIGINT)
    told = [line for line in run.communicate(timeout=60)[1].splitlines() if not line.startswith("row ")]
    assert (told, run.returncode) == (["interrupted; what was finished is kept, the same command continues"], 130)
