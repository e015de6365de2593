"""Stubs of the kernels have the signatures that were compiled."""

import ast
import inspect
from importlib import import_module
from pathlib import Path

import pytest

import bem

FOLDER = Path(bem.__file__).parent / "kernels"
STUBS = sorted(path.stem for path in FOLDER.glob("*.pyi"))


def test_each_kernel_has_a_stub():
    assert sorted(path.stem for path in FOLDER.glob("*.pyx")) in (STUBS, [])  # an installation has the stubs alone
    assert STUBS


@pytest.mark.parametrize("name", STUBS)
def test_signatures_are_those_of_the_stub(name):
    functions = [node for node in ast.parse((FOLDER / f"{name}.pyi").read_text("utf-8")).body if hasattr(node, "args")]
    stubs = {node.name: [argument.arg for argument in node.args.args] for node in functions}
    module = import_module(f"bem.kernels.{name}")
    compiled = {
        key: list(inspect.signature(value).parameters)
        for key, value in vars(module).items()
        if callable(value) and not isinstance(value, type) and not key.startswith("_")
    }
    assert compiled == stubs
