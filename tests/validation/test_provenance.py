"""Provenance: it holds the commit, changed sources are not changed stored errors, and it names no folder or host."""

import json
import platform
import shutil
import subprocess
from pathlib import Path

import pytest

from validation.harness import provenance as module
from validation.harness.provenance import fingerprint, provenance

needs_git = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


def git(root, *words):
    identity = ("-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false")
    subprocess.run(["git", *identity, *words], cwd=root, check=True, capture_output=True)


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A project tree of two files, of which the module believes to be part."""
    for name in ("bem/solver.py", "validation/harness/provenance.py", "validation/cases/stored.csv"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("one")
    monkeypatch.setattr(module, "__file__", str(tmp_path / "validation" / "harness" / "provenance.py"))
    return tmp_path


@pytest.fixture
def checkout(tree):
    git(tree, "init", "-q")
    git(tree, "add", ".")
    git(tree, "commit", "-q", "-m", "first")
    return tree


@pytest.mark.parametrize(
    "name", ["commit", "system", "processor", "cores", "blas", "date", "python", "numpy", "linecontact"]
)
def test_fact_is_there(name):
    assert provenance()[name]


@pytest.mark.parametrize("private", [str(Path.cwd()), str(Path.home()), platform.node()])
def test_no_folder_or_host_is_named(private):
    assert private not in json.dumps(provenance())


def test_outside_a_checkout_the_commit_is_not_known(tree):
    assert provenance()["commit"] == "not a checkout"


@needs_git
@pytest.mark.parametrize(
    ("name", "changed"),
    [("bem/solver.py", True), ("bem/new.py", True), ("validation/cases/stored.csv", False), ("notes.txt", False)],
)
def test_changed_sources_are_told_from_changed_stored_errors(checkout, name, changed):
    (checkout / name).write_text("two")
    assert provenance()["commit"].endswith("with changes") is changed


@pytest.mark.parametrize(
    ("name", "moves"), [("bem/solver.py", True), ("bem/new.toml", True), ("bem/n.pyc", False), ("report/a.json", False)]
)
def test_fingerprint_follows_sources_only(tree, name, moves):
    (tree / "report").mkdir()
    before = fingerprint([tree], tree / "report")
    (tree / name).write_text("two")
    assert (fingerprint([tree], tree / "report") != before) is moves
