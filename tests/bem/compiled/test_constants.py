"""Constants of the kernels in C are those of the modules that their comments name."""

import re
from importlib import import_module
from pathlib import Path

import pytest

BEM = Path(__file__).parents[3] / "bem"
NAMED = re.compile(r"^#define \w+ (\S+) +/\* (?:\w+ )*?(\w+)\.(_?[A-Z_]+) \*/$", re.MULTILINE)
FOUND = [
    (module, name, value)
    for path in sorted((BEM / "compiled").glob("*.[ch]"))
    for value, module, name in NAMED.findall(path.read_text("utf-8"))
]


def test_constants_are_found():
    assert len(FOUND) >= 30


@pytest.mark.parametrize(("module", "name", "value"), FOUND)
def test_a_constant_in_c_is_that_of_its_module(module, name, value):
    (path,) = BEM.rglob(f"{module}.py")
    here = getattr(import_module(".".join(path.relative_to(BEM.parent).with_suffix("").parts)), name)
    assert str(here) == value.strip('"') if isinstance(here, str) else here == float(value.strip("()"))
