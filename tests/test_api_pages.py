"""Pages of the interface from the docstrings, by the command of the guide for contributors: complete."""

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
OFFERED = {(getattr(bem, name).__module__, name) for name in bem.__all__}


def test_pages_are_made_without_complaint_and_have_what_is_offered(tmp_path):
    command = re.search(r"^python -m pdoc .*?[^\\]$", GUIDE, re.MULTILINE | re.DOTALL)[0]
    words = shlex.split(command.replace("\\\n", " "))[1:]
    words[words.index("-o") + 1] = str(tmp_path)
    done = subprocess.run([sys.executable, *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # pydantic annotates __init__ of its dataclasses by a name that stands in the stubs of type checkers alone
    assert [line for line in done.stderr.splitlines() if "PydanticDataclass" not in line] == []
    pages = {".".join(path.relative_to(tmp_path).with_suffix("").parts): path for path in tmp_path.rglob("*.html")}
    offered = OFFERED | {(package.__name__, name) for package in (fem_reference, persson) for name in package.__all__}
    assert [
        (module, name)
        for module, name in sorted(offered)
        if f"{module}.{name}" not in pages and f'id="{name}"' not in pages[module].read_text("utf-8")
    ] == []
