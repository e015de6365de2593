"""Cases outside the package: folders and entry points, what is refused and how, and a user's way from a wheel on."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from validation import __main__ as command_line
from validation.__main__ import main
from validation.harness.case import CaseError
from validation.harness.entry_points import cases, solvers
from validation.harness.entry_points.own_cases import own_cases

ROOT = Path(__file__).parents[2]
CASE = """
from beside import VALUE
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared
from validation.harness.schema import Reference

exact = Reference(kind="exact", source="known")
CASES = [Case("{name}", "own", "quick", "q?", "e", ("A. Author, A title (2025)",),
    lambda: Outcome((compared("load", "N", exact, [1.0], [VALUE], 0.1, 0.04),)))]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with one case, which takes its value from a module beside it."""
    made = tmp_path / "mine"
    made.mkdir()
    (made / "beside.py").write_text("VALUE = 1.01\n")
    (made / "cases.py").write_text(CASE.format(name="fine"))
    monkeypatch.setattr(sys, "path", sys.path.copy())
    yield made
    for name in ("beside", "cases_of_someone"):
        sys.modules.pop(name, None)


@pytest.fixture(autouse=True)
def suite(monkeypatch):
    """A small suite in place of the whole."""
    small = command_line.registry(["validation.cases.suite.harness"])
    monkeypatch.setattr(command_line, "registry", lambda: small)


def package(folder, name, group, value, offered="mine"):
    """What an installed package with an entry point leaves in a folder of the search path."""
    made = folder / f"{name}-1.0.dist-info"
    made.mkdir(parents=True)
    (made / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (made / "entry_points.txt").write_text(f"[{group}]\n{offered} = {value}\n")


def verify(*words, jobs="1"):
    return main(["run", "--jobs", jobs, *map(str, words)])


def test_own_cases_run_are_kept_and_are_compared_again(folder, tmp_path, capsys):
    out = tmp_path / "out"
    assert verify("--cases", folder, "--out", out) == 0
    assert "1 case: 1 agrees" in capsys.readouterr().out
    assert "A. Author, A title (2025)" in (out / "report.html").read_text()
    check = ["baseline", "check", "--cases", str(folder), "--out", str(out)]
    assert main(check) == 1
    assert "fine: no baseline" in capsys.readouterr().err
    update = ["baseline", "update", "fine", "--reason", "first", "--cases", str(folder), "--out", str(out)]
    assert main(update) == 0
    assert main(check) == 0
    (folder / "baselines" / "gone.json").write_text("{}")
    capsys.readouterr()
    assert main(check) == 1
    assert "gone.json: no case of this name" in capsys.readouterr().err


def test_what_cases_import_from_beside_is_not_taken_from_an_earlier_run(folder, tmp_path, capsys):
    words = ("--cases", folder, "--out", tmp_path / "out")
    assert verify(*words) == 0
    (folder / "beside.py").write_text("VALUE = 1.5\n")
    assert verify(*words) == 1
    assert "load: deviates" in capsys.readouterr().err


def test_a_report_of_other_files_updates_nothing(folder, tmp_path, capsys):
    out = str(tmp_path / "out")
    verify("--cases", folder, "--out", out)
    update = ["baseline", "update", "fine", "--reason", "first", "--out", out]
    capsys.readouterr()
    assert main([*update, "--baselines", str(tmp_path)]) == 2
    assert "--cases has to name them" in capsys.readouterr().err
    (folder / "beside.py").write_text("VALUE = 1.02\n")
    assert main([*update, "--cases", str(folder)]) == 2
    assert "other sources" in capsys.readouterr().err
    assert not (folder / "baselines").exists()


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("cases.py", "1 / 0", "cases.py: ZeroDivisionError: division by zero"),
        ("cases.py", "import sys; sys.exit(3)", "cases.py: SystemExit: 3"),
        ("cases.py", "CASES = (", "cases.py: SyntaxError"),
        ("cases.py", "", "cases.py: no list CASES"),
        ("cases.py", "CASES = [1]", "cases.py: CASES holds 1, which is no Case"),
        ("more_cases.py", CASE.format(name="fine"), "cases of the same name: fine"),
        ("more_cases.py", CASE.format(name="harness"), "the suite has cases of these names: harness"),
        ("more_cases.py", CASE.format(name="a/b"), "case 'a/b': the id names files"),
        ("cases.py", CASE.format(name="fine").replace('"A. Author, A title (2025)"', '"author"'),
         "sources not in the bibliography: author"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_file_is_told_before_anything_runs(folder, tmp_path, capsys, file, text, said):
    (folder / file).write_text(text)
    assert verify("--cases", folder, "--out", tmp_path / "out") == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_folder_that_is_missing_or_empty_is_told(folder, tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    for words, said in (
        (["--cases", "nowhere"], "--cases nowhere: no such folder, and no entry point"),
        (["--cases", tmp_path / "empty"], "no file *cases.py there"),
        (["--cases", folder, "--baselines", tmp_path / "nowhere"], "nowhere: no such folder"),
    ):
        assert verify(*words, "--out", tmp_path / "out") == 2
        assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_cases_of_an_entry_point(folder, tmp_path, monkeypatch, capsys):
    package(tmp_path / "site", "someone", "linecontact.cases", "cases_of_someone")
    (folder / "cases.py").rename(tmp_path / "site" / "cases_of_someone.py")
    monkeypatch.setattr(sys, "path", [str(tmp_path / "site"), str(folder), *sys.path])
    assert cases() == {"mine": "cases_of_someone"}
    assert [case.id for case in own_cases(Path("mine")).cases] == ["fine"]
    assert verify("--cases", "mine", "--out", tmp_path / "out") == 2
    assert "need --baselines DIR" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("nothing_like_it", "ModuleNotFoundError: No module named 'nothing_like_it'"),
        ("json", "no list CASES"),
        ("not a module", "ModuleNotFoundError"),
    ],
)
def test_a_broken_entry_point_is_named(tmp_path, monkeypatch, value, said):
    package(tmp_path, "someone", "linecontact.cases", value)
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(CaseError, match=f"entry point mine = {value} of linecontact.cases: {said}"):
        own_cases(Path("mine"))


def test_solvers_are_listed_without_being_imported(tmp_path, monkeypatch):
    package(tmp_path / "a", "a", "linecontact.solvers", "broken_module:solve", "first")
    package(tmp_path / "b", "b", "linecontact.solvers", "another:solve", "second")
    for name in "ab":
        monkeypatch.syspath_prepend(str(tmp_path / name))
    assert solvers() == {"first": "broken_module:solve", "second": "another:solve"}
    package(tmp_path / "c", "c", "linecontact.solvers", "other:solve", "second")
    monkeypatch.syspath_prepend(str(tmp_path / "c"))
    with pytest.raises(CaseError, match=r"'second' of linecontact\.solvers is offered twice"):
        solvers()


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """What a user has: the wheel, installed into a folder of its own, and another folder to work in, without git."""
    made = tmp_path_factory.mktemp("user")
    source = made / "source"
    source.mkdir()
    for name in ("bem", "fem_reference", "persson", "validation"):
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__", "*.so"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source / name)
    work, site = made / "work", made / "site"
    work.mkdir()
    plain = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    user = plain | {"CC": "false", "PYTHONPATH": str(site)}  # no kernels in C: seconds less

    def run(*words):
        return subprocess.run([sys.executable, *words], cwd=work, env=user, capture_output=True, text=True, check=False)

    def install(folder):
        for words in (("wheel", "--wheel-dir", "wheels"), ("install", "--no-index", "--find-links", "wheels")):
            last = (str(folder),) if words[0] == "wheel" else ("--target", str(site), folder.name)
            done = run("-m", "pip", *words, "--no-deps", "--quiet", *last)
            assert done.returncode == 0, done.stderr

    (made / "linecontact").symlink_to(source)
    install(made / "linecontact")
    return work, run, install


def front_door(installed, *words):
    done = installed[1]("-m", "validation.command_line.front_door", *words)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_user_keeps_cases_of_their_own(installed):
    work, run, install = installed
    place = run("-c", "import bem, validation; print(bem.__file__, validation.__file__)").stdout
    assert place.count(str(work.parent / "site")) == 2
    assert front_door(installed, "example", "own-cases")[0] == 0
    solver, own = work / "own-cases" / "own_solver.py", ("--cases", "own-cases", "--out", "report")
    assert front_door(installed, "verify", "--jobs", "1", *own)[1].startswith("1 case: 1 agrees")
    assert front_door(installed, "baseline", "check", *own)[0] == 0
    solver.write_text(solver.read_text().replace("2 / pi * asin", "2.00001 / pi * asin"))
    assert front_door(installed, "verify", "--jobs", "1", *own)[0] == 1
    code, _, said = front_door(installed, "baseline", "check", *own)
    assert (code, "contact fraction [0] was 0.140239" in said) == (1, True)
    solver.write_text(solver.read_text().replace("2.00001", "2"))
    install(work / "own-cases")
    (work / "baselines").mkdir()
    by_name = ("--cases", "own", "--baselines", "baselines", "--out", "by-name")
    assert front_door(installed, "verify", "--jobs", "1", *by_name)[0] == 0
    assert front_door(installed, "baseline", "update", "own-one-wave", "--reason", "first", *by_name)[0] == 0
    listed = run("-c", "from validation.harness.entry_points import solvers; print(solvers())")
    assert listed.stdout == "{'own': 'own_solver:solve'}\n"
