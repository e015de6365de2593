"""Runs of small cases through pytest with the plugin: each way to fail, levels, stored errors, resumption, own scenes.

Cases are written into a folder and run in this process, without the solver; workers are in test_case_workers.py.
"""

import csv
import json
import re
import subprocess
import textwrap
from pathlib import Path

import pytest

from validation.plugin import stored

HEAD = """
import math
import pytest
from validation.plugin.rows import Code, Quantity

PAIR = {"of": Code.BEM, "by": Code.FEM, "quantity": Quantity.AREA, "uncertainty": (1e-3, 0.0)}
"""
AGREES = 'rows.compare("area", 1.0, 1.0001, **PAIR)'
TITLES = "case,row,value,error,unit,reason\n"


@pytest.fixture
def run(pytester):
    """Write a file of cases, run them with the plugin, and return the result with what report.json holds."""

    def run_cases(body, *options, name="test_a"):
        (pytester.path / f"{name}.py").write_text(HEAD + textwrap.dedent(body))
        return again(*options)

    def again(*options):
        words = ("-p", "validation.plugin.hooks", "-p", "no:cacheprovider", "--report", "out", *options)
        result = pytester.runpytest_inprocess(*words)
        report = pytester.path / "out" / "report.json"
        result.report = json.loads(report.read_text()) if report.exists() else None
        return result

    run_cases.again = again
    return run_cases


def case(body, name="test_one"):
    return f"def {name}(rows):\n    '''Is it so?'''\n" + textwrap.indent(textwrap.dedent(body), "    ") + "\n"


def verdicts(result):
    return [row["verdict"] for row in result.report["rows"]]


def test_the_case_of_the_page_passes_and_fails_as_the_page_says(run, pytester):
    page = (Path(__file__).parents[2] / "validation" / "README.md").read_text("utf-8")
    code = re.search(r"```python\n(.*?)```", page, re.DOTALL)[1]
    (pytester.path / "test_own_wave.py").write_text(code)
    run.again().assert_outcomes(passed=2)
    (pytester.path / "test_own_wave.py").write_text(code.replace("* 50e-6 /", "* 51e-6 /"))
    result = run.again()
    result.assert_outcomes(failed=2)
    said = re.search(r"```\n(1 of 2 rows.*?)\n```", page, re.DOTALL)[1].splitlines()
    result.stdout.fnmatch_lines([said[0], f"*{said[1]}", *(f"*{line}*" for line in said[2:4])])


def test_a_case_that_agrees_passes_and_its_row_is_in_the_report(run):
    result = run(case(AGREES))
    result.assert_outcomes(passed=1)
    (row,) = result.report["rows"]
    assert row["case"] == "test_a.py::test_one"
    assert (row["routes"], row["quantity"], row["verdict"]) == (["bem", "fem"], "contact fraction", "agrees")
    assert (row["value"], row["reference"], row["value_uncertainty"]) == (1.0, 1.0001, 1e-3)
    assert result.report["counts"]["accuracy"] == {"agrees": 1}
    assert result.report["cases"][0]["question"] == "Is it so?"


@pytest.mark.parametrize(
    ("body", "found", "message"),
    [
        ('rows.compare("area", 1.0, 1.1, **PAIR)', ["deviates"], "area: deviates"),
        ('rows.compare("area", math.nan, 1.1, **PAIR)', ["error"], "area: error"),
        ('rows.not_converged("area", "no fold", of="bem", by="fem", quantity="energy")', ["not converged"], "no fold"),
        ("pass", ["error"], "a case without a row compares nothing"),
        (AGREES + "\nraise OSError('half way')", ["agrees", "error"], "OSError: half way"),
        (AGREES + "\n" + AGREES, ["agrees", "error"], "a second row of this name"),
    ],
)
def test_what_fails_a_case(run, body, found, message):
    result = run(case(body))
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([f"*{message}*"])
    assert verdicts(result) == found
    assert result.report["failed"] == 1


def test_a_fixture_that_fails_is_a_case_that_failed(run):
    result = run(
        "@pytest.fixture\ndef broken():\n    raise OSError('no fixture')\n" + "def test_one(rows, broken):\n    pass\n"
    )
    result.assert_outcomes(errors=1)
    assert verdicts(result) == ["error"]
    assert "no fixture" in result.report["rows"][0]["reason"]


def test_a_file_that_cannot_be_imported_is_a_case_that_failed(run):
    result = run("import a_module_that_is_not_there\n")
    assert result.ret != 0
    assert "a_module_that_is_not_there" in result.report["rows"][0]["reason"]


def test_a_case_that_is_not_run_says_why_and_is_counted(run):
    result = run(case("pytest.importorskip('a_peer_that_is_not_here')") + case(AGREES, "test_two"))
    assert result.ret == 0
    assert verdicts(result) == ["not run", "agrees"]
    assert "a_peer_that_is_not_here" in result.report["rows"][0]["reason"]


LEVELS = "".join(f"@pytest.mark.{level}\n" + case(AGREES, f"test_{level}") for level in ("quick", "standard", "full"))


@pytest.mark.parametrize(
    ("options", "ran"),
    [((), 1), (("--level", "standard"), 2), (("--level", "full"), 3), (("-k", "full"), 1), (("test_a.py",), 3)],
)
def test_a_level_runs_its_cases_and_those_below_and_a_pattern_any(run, options, ran):
    result = run(LEVELS, *options)
    result.assert_outcomes(passed=ran, deselected=3 - ran)


class TestStoredErrors:
    """Lines of stored.csv beside the cases."""

    def write(self, pytester, *lines):
        (pytester.path / stored.FILE).write_text(TITLES + "".join(line + "\n" for line in lines))
        stored.read.cache_clear()

    def read(self, pytester):
        with (pytester.path / stored.FILE).open() as file:
            return {line["row"]: line for line in csv.DictReader(file) if line["row"] != stored.SECONDS}

    def test_a_row_whose_error_is_not_stored_fails(self, run, pytester):
        self.write(pytester)
        result = run(case(AGREES))
        result.assert_outcomes(failed=1)
        result.stdout.fnmatch_lines(["*stored      nothing: run the case with --store*"])

    def test_a_row_that_is_worse_than_stored_fails(self, run, pytester):
        self.write(pytester, 'test_a.py::test_one,"area [bem, fem]",1,1e-06,,first')
        assert verdicts(run(case(AGREES))) == ["changed"]

    def test_a_stored_row_that_is_gone_fails(self, run, pytester):
        self.write(
            pytester,
            'test_a.py::test_one,"area [bem, fem]",1,1e-04,,first',
            'test_a.py::test_one,"load [bem, fem]",1,1e-04,,first',
        )
        result = run(case(AGREES))
        result.assert_outcomes(failed=1)
        result.stdout.fnmatch_lines(["*stored rows are gone: load [[]bem, fem[]]*"])
        assert result.report["failed"] == 1

    def test_a_stored_case_that_is_gone_is_refused(self, run, pytester):
        self.write(pytester, 'test_a.py::test_two,"area [bem, fem]",1,1e-04,,first')
        result = run(case(AGREES))
        result.assert_outcomes(failed=2)  # test_one is not stored
        result.stdout.fnmatch_lines(["*cases that do not exist: test_a.py::test_two*"])
        assert verdicts(result) == ["error", "error"]

    def test_storing_rewrites_the_lines_of_what_ran_and_prints_old_and_new(self, run, pytester, capfd):
        self.write(pytester, 'test_a.py::test_one,"area [bem, fem]",1,1e-06,,first', "test_b.py::test_x,row,1,1,,first")
        run(case(AGREES), "--store", "--reason", "a new mesh").assert_outcomes(passed=1)
        assert "area [bem, fem]: 1e-06 -> 0.0001" in capfd.readouterr().err
        lines = self.read(pytester)
        assert lines["area [bem, fem]"] == {
            "case": "test_a.py::test_one",
            "row": "area [bem, fem]",
            "value": "1",
            "error": "0.0001",
            "unit": "",
            "reason": "a new mesh",
        }
        assert lines["row"]["reason"] == "first"

    def test_storing_the_worst_keeps_the_larger_error(self, run, pytester):
        self.write(pytester, 'test_a.py::test_one,"area [bem, fem]",1,0.0005,,first')
        run(case(AGREES), "--store", "worst", "--reason", "another BLAS").assert_outcomes(passed=1)
        assert self.read(pytester)["area [bem, fem]"]["error"] == "0.0005"
        run.again("--store", "--reason", "anew").assert_outcomes(passed=1)
        assert self.read(pytester)["area [bem, fem]"]["error"] == "0.0001"

    def test_what_fails_is_not_stored(self, run, pytester):
        self.write(pytester, 'test_a.py::test_one,"area [bem, fem]",1,1e-04,,first')
        before = (pytester.path / stored.FILE).read_text()
        run(case('rows.compare("area", math.nan, 1.1, **PAIR)'), "--store", "--reason", "x").assert_outcomes(failed=1)
        assert (pytester.path / stored.FILE).read_text() == before

    def test_storing_needs_a_reason_and_a_tree_without_changes(self, run, pytester):
        self.write(pytester)
        result = run(case(AGREES), "--store")
        result.stderr.fnmatch_lines(["*--store: needs --reason TEXT*"])
        for words in (
            ["init", "-q"],
            ["add", "-A"],
            ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "a"],
        ):
            subprocess.run(["git", *words], cwd=pytester.path, check=True)
        (pytester.path / "out").mkdir(exist_ok=True)
        (pytester.path / "test_a.py").write_text(HEAD + case(AGREES) + "\n")
        result = run.again("--store", "--reason", "x")
        assert result.ret == pytest.ExitCode.USAGE_ERROR
        result.stderr.fnmatch_lines(["*files with changes (*; commit them first*"])


class TestResumption:
    """A run that continues another one."""

    TWO = case(AGREES) + case("import pathlib\nassert pathlib.Path('there').exists()\n" + AGREES, "test_two")

    def test_it_keeps_what_passed_and_repeats_what_failed(self, run, pytester):
        run(self.TWO).assert_outcomes(passed=1, failed=1)
        (pytester.path / "there").touch()
        run.again("--resume").assert_outcomes(passed=1, deselected=1)
        assert verdicts(run.again("--resume")) == ["agrees", "agrees"]

    def test_a_torn_last_line_is_left_out(self, run, pytester):
        run(case(AGREES))
        record = pytester.path / "out" / "rows.jsonl"
        record.write_text(record.read_text()[:-20])
        run.again("--resume").assert_outcomes(passed=1)

    @pytest.mark.parametrize("name", ["test_a.py", "data.toml", "numbers.json"])
    def test_whatever_a_row_depends_on_begins_anew(self, run, pytester, name):
        run(case(AGREES))
        path = pytester.path / name
        path.write_text((path.read_text() if path.exists() else "") + "\n")
        run.again("--resume").assert_outcomes(passed=1)


SCENE = """
title = "dry wave"
[solid]
youngs_modulus = 1e6
poisson_ratio = 0.5
[profile]
kind = "harmonics"
period = 0.01
orders = [1]
amplitudes = [5e-5]
phases = [0.0]
[loading]
control = "mean_pressure"
targets = [5235.987755982988, 10471.975511965977]
"""


class TestScenes:
    """Scenes with expected numbers, case_*.toml: Westergaard's contact fractions at a quarter and half of the load."""

    def run(self, run, pytester, expected):
        (pytester.path / "case_wave.toml").write_text(SCENE + expected)
        return run.again()

    @pytest.mark.parametrize(
        ("value", "found"),
        [
            ("0.5", "agrees"),
            ("0.5001", "deviates"),
            ("[0.3333333333333333, 0.5]", "agrees"),
            ("[0.5, 0.5]", "deviates"),
        ],
    )
    def test_targets_are_compared_with_expected_numbers(self, run, pytester, value, found):
        expected = f'[expected.contact_fraction]\nvalue = {value}\nuncertainty = 1e-5\nsource = "mine"\n'
        result = self.run(run, pytester, expected)
        assert verdicts(result) == [found]
        assert result.report["rows"][0]["source"] == "mine"

    @pytest.mark.parametrize(
        ("expected", "message"),
        [
            ("", "needs a table [expected]"),
            ("[expected.weight]\nvalue = 1.0\nuncertainty = 1.0", "expected.weight: not a quantity of a state"),
            ("[expected.penetration]\nvalue = 1.0", "write value = ..., uncertainty = ..."),
            ('[expected.penetration]\nvalue = "1"\nuncertainty = 1.0', "'1' is not a number"),
            ("[expected", "case_wave.toml: Expected ']'"),
        ],
    )
    def test_a_mistake_is_one_sentence(self, run, pytester, expected, message):
        result = self.run(run, pytester, expected)
        assert result.ret != 0
        assert message in result.stdout.str()
        assert "Traceback" not in result.stdout.str()

    def test_a_scene_that_is_refused_names_its_key(self, run, pytester):
        (pytester.path / "case_wave.toml").write_text(
            SCENE.replace("5e-5", '"high"') + "[expected.penetration]\nvalue = 1.0\nuncertainty = 1.0\n"
        )
        result = run.again()
        assert verdicts(result) == ["error"]
        assert (
            'case_wave.toml: 1 mistake in the scene:   profile.amplitudes[0] = "high"'
            in result.report["rows"][0]["reason"]
        )
