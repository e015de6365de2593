"""The examples in docstrings give what they say."""

import doctest
from importlib import import_module
from pkgutil import walk_packages

import pytest

PACKAGES = ("bem", "fem_reference", "persson", "validation")
OF_EXTRAS = {  # modules that need a package which is not always there
    "validation.routes.tamaas_grid": "tamaas",
}


def modules():
    for package in map(import_module, PACKAGES):
        yield package.__name__
        found = walk_packages(package.__path__, f"{package.__name__}.")
        yield from (module.name for module in found if not module.name.endswith("__main__"))


@pytest.mark.parametrize("name", tuple(modules()))
def test_the_examples_of_a_module_hold(name):
    if name in OF_EXTRAS:
        pytest.importorskip(OF_EXTRAS[name], exc_type=ImportError)
    outcome = doctest.testmod(import_module(name))
    assert outcome.failed == 0


def test_there_are_examples():
    finder = doctest.DocTestFinder(exclude_empty=True)
    assert (
        sum(
            bool(found.examples)
            for name in set(modules()) - set(OF_EXTRAS)
            for found in finder.find(import_module(name))
        )
        > 90
    )
