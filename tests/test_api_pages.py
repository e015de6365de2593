"""Pages of the interface from the docstrings, by the command of the guide for contributors: complete, and set."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import bem
import fem_reference
import persson

pytest.importorskip("pdoc", reason="the extra 'docs' is not installed: pip install 'linecontact[docs]'")
ROOT = Path(__file__).parents[1]
GUIDE = (ROOT / ".github" / "CONTRIBUTING.md").read_text("utf-8")
OFFERED = {
    *(f"{getattr(bem, name).__module__}.{name}" for name in bem.__all__),
    *(f"{package.__name__}.{name}" for package in (fem_reference, persson) for name in package.__all__),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The text of every page by its module, and what was said while they were made."""
    folder = tmp_path_factory.mktemp("api")
    command = re.search(r"^python -m pdoc .*?[^\\]$", GUIDE, re.MULTILINE | re.DOTALL)[0]
    words = shlex.split(command.replace("\\\n", " "))[1:]
    words[words.index("-o") + 1] = str(folder)
    done = subprocess.run([sys.executable, *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = {".".join(path.relative_to(folder).with_suffix("").parts): path for path in folder.rglob("*.html")}
    return {name: path.read_text("utf-8") for name, path in found.items()}, done.stderr


def test_they_are_made_without_complaint(pages):
    complaints = pages[1].strip().splitlines()
    # pydantic annotates __init__ of its dataclasses by a name that stands in the stubs of type checkers alone
    assert [line for line in complaints if "PydanticDataclass" not in line] == []


@pytest.mark.parametrize("name", sorted(OFFERED))
def test_what_is_offered_has_its_place(pages, name):
    module, _, item = name.rpartition(".")
    assert name in pages[0] or f'id="{item}"' in pages[0][module]
