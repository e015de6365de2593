"""Pages of the interface from the docstrings: the command of the guide for contributors makes them without complaint."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("pdoc", reason="the extra 'docs' is not installed: pip install 'linecontact[docs]'")
ROOT = Path(__file__).parents[1]
GUIDE = (ROOT / ".github" / "CONTRIBUTING.md").read_text("utf-8")


def test_pages_of_all_packages_are_made_without_complaint(tmp_path):
    command = re.search(r"^python -m pdoc .*?[^\\]$", GUIDE, re.MULTILINE | re.DOTALL)[0]
    words = shlex.split(command.replace("\\\n", " "))[1:]
    words[words.index("-o") + 1] = str(tmp_path)
    done = subprocess.run([sys.executable, *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # pydantic annotates __init__ of its dataclasses by a name that stands in the stubs of type checkers alone
    assert [line for line in done.stderr.splitlines() if "PydanticDataclass" not in line] == []
    pages = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.html")}
    assert {"bem.html", "bem/solver.html", "fem_reference.html", "persson.html"} <= pages
