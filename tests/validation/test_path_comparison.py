"""Comparison of paths of random scenes at other increments: the same scenes again, one line for each difference."""

import json

from validation.command_line import path_comparison
from validation.command_line.path_comparison import scenes


def test_scenes_of_a_seed_are_the_same_and_have_adhesion():
    (first, one), (second, two) = scenes(57, 2)
    assert [name for name, _ in scenes(57, 2)] == [first, second]
    assert first != second
    assert all("adhesion" in tables and "output" not in tables for tables in (one, two))


def test_differences_are_counted_by_setting(tmp_path, monkeypatch, capsys):
    words = ["path_comparison", "--count", "1", "--tolerances", "1e-6", "--out", str(tmp_path)]
    monkeypatch.setattr("sys.argv", words)
    code = path_comparison.main()
    ((setting, counts),) = json.loads((tmp_path / "comparison.json").read_text()).items()
    assert setting == "increment 1, tolerance 1e-06"
    assert counts["numbers"] > 3
    assert code == int(bool(counts["apart"] or counts["other"]))
    assert "DIFFERS" not in capsys.readouterr().out
