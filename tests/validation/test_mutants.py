"""Random slips: each changes one place, and the code can be read; tests that execute it meet it; a table by package."""

import ast
import random
import subprocess
import sys

from validation.studies.mutants import COLUMNS, ROOT, all_mutants, mutants_of, read, table

STUDIES = ROOT / "validation/studies"
CODE = """def larger(a: float, b: float) -> float:
    if a > b:
        return a
    return b + 0


def unused(a: float) -> float:
    return -a
"""
TESTS = """from bem.numbers import larger
def test_one(): assert larger(2.0, 1.0) == 2.0
def test_other(): assert larger(1.0, 2.0) == 2.0
"""


def test_every_mutant_of_a_sample_is_code_and_differs_in_one_place():
    for mutant in random.Random(1).sample(all_mutants(), 200):
        text = (ROOT / mutant.file).read_bytes()
        assert text[mutant.start : mutant.stop].decode() == mutant.before != mutant.after
        changed = text[: mutant.start] + mutant.after.encode() + text[mutant.stop :]
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(text)), mutant.name
        assert int(mutant.place.split(":")[1]) in mutant.lines


def test_operators_comparisons_conditions_and_numbers_are_changed():
    files = ("bem/path/fold.py", "bem/solver.py", "persson/diffusion.py")
    changes = {(mutant.before, mutant.after) for file in files for mutant in mutants_of(file)}
    assert {("+", "-"), ("*", "/"), ("<", ">="), ("and", "or"), ("-", ""), ("0", "1")} <= changes


def test_a_sample_is_killed_survives_and_is_continued(tmp_path):
    sources = tmp_path / "out/sources"
    for file, text in {
        "bem/__init__.py": "",
        "bem/numbers.py": CODE,
        "tests/bem/test_numbers.py": TESTS,
        "validation/cases/test_none.py": "",
        "validation/plugin/hooks.py": "def pytest_addoption(parser): parser.addoption('--level')",
        "pyproject.toml": "[project]\nversion = '1'\n[tool.pytest.ini_options]\naddopts = '--import-mode=importlib'\n",
        "CITATION.cff": "",
    }.items():
        (sources / file).parent.mkdir(parents=True, exist_ok=True)
        (sources / file).write_text(text)
    for file in ("__init__.py", "plugin/pytest.ini", *(f"studies/{path.name}" for path in STUDIES.glob("*.py"))):
        (sources / "validation" / file).parent.mkdir(exist_ok=True)
        (sources / "validation" / file).write_bytes((ROOT / "validation" / file).read_bytes())
    (sources / "fem_reference").mkdir(), (sources / "persson").mkdir()
    count = len(all_mutants(sources))
    command = [sys.executable, "-m", "validation.studies.mutants", "--out", str(tmp_path / "out")]

    def run(number: int) -> str:
        words = [*command, "--count", str(number)]
        ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
        assert ended.returncode == 0, ended.stdout + ended.stderr
        return ended.stdout

    run(count)
    found = {line["change"]: line["tests"] for line in read(tmp_path / "out/mutants.csv").values()}
    assert found == {"> -> <=": "killed", "+ -> -": "survived", "0 -> 1": "killed", "- -> ": "unseen"}
    assert f"{count} of {count} drawn" in run(count)
    assert len(read(tmp_path / "out/mutants.csv")) == count


def test_equivalent_mutants_are_counted_apart():
    line = dict.fromkeys(COLUMNS, "") | {"place": "bem/a.py:1:1", "tests": "killed", "quick": "timeout"}
    lines = [line] * 9 + [line | {"tests": "survived", "quick": "unseen", "looked at": ""}]
    assert table(lines).splitlines()[-1] == "| all | 10 | 0 | 9 of 10 = 90% (59% to 98%) | 9 of 10 = 90% (59% to 98%) |"
    lines[-1] |= {"looked at": "equivalent: adds zero"}
    assert (
        table(lines).splitlines()[-1] == "| all | 10 | 1 | 9 of 9 = 100% (69% to 100%) | 9 of 9 = 100% (69% to 100%) |"
    )


def test_the_table_of_the_page_is_that_of_the_kept_answers():
    lines = read(ROOT / "validation/studies/mutants.csv").values()
    page = (ROOT / "validation/README.md").read_text("utf-8")
    assert table(lines) in page and f"the first {len(lines)} of 300" in page
    for line in lines:  # looked at, where tests did not notice
        assert line["tests"] in ("killed", "timeout") or line["looked at"], line["place"]
