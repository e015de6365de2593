"""Random slips: each changes one place into code that can be read; a sample is made by its seed; a report by module."""

import ast
import json
import random

from validation.studies.mutants import ROOT, all_mutants, mutants_of, report, suite_of


def test_every_mutant_of_a_sample_is_code_and_differs_in_one_place():
    for mutant in random.Random(1).sample(all_mutants(), 200):
        text = (ROOT / mutant.file).read_bytes()
        assert text[mutant.start : mutant.stop].decode() == mutant.before != mutant.after
        changed = text[: mutant.start] + mutant.after.encode() + text[mutant.stop :]
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(text)), mutant.name


def test_operators_comparisons_conditions_and_numbers_are_changed():
    files = ("bem/path/fold.py", "bem/solver.py", "persson/diffusion.py")
    changes = {(mutant.before, mutant.after) for file in files for mutant in mutants_of(file)}
    assert {("+", "-"), ("*", "/"), ("<", ">="), ("and", "or"), ("-", ""), ("0", "1")} <= changes


def test_suite_of_a_file_is_that_of_its_folder():
    assert suite_of("bem/path/fold.py") == ["tests/bem/path"]
    assert suite_of("validation/references/paper_method/cells.py") == ["tests/validation"]
    assert suite_of("bem/solver.py")[0] == "tests/bem" and "--ignore=tests/bem/path" in suite_of("bem/solver.py")


def test_equivalent_mutants_are_counted_apart(tmp_path):
    line = {"module": "bem", "tests": "killed", "quick": "killed"}
    lines = [line | {"name": str(k)} for k in range(9)] + [
        line | {"name": "9", "tests": "survived", "quick": "survived"}
    ]
    assert report(tmp_path, lines) == 0  # nine of ten
    assert report(tmp_path, [line | {"tests": "survived"} for line in lines]) == 1
    (tmp_path / "equivalent.txt").write_text("9\n")
    assert report(tmp_path, lines) == 0
    rows = json.loads((tmp_path / "report.json").read_text())["rows"]
    assert [row["value"] for row in rows] == [1.0, 1.0]
