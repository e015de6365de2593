"""The import directions of the house, read from the source, so that the two sides of a comparison share nothing."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("bem", "fem_reference", "persson", "validation")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
ONLY_IN = {
    "pydantic": ("bem/scene/scene.py", "validation/"),
    "skfem": ("fem_reference/",),
    "meshio": ("fem_reference/",),
    "matplotlib": ("validation/", "bem/__main__.py"),
    "jinja2": ("validation/",),
}


def imported_names(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_keep_their_direction(path):
    name, imported = str(path.relative_to(ROOT)), imported_names(path)
    package = name.split("/")[0]
    if package != "validation":
        assert not imported & (set(PACKAGES) - {package}), f"{name} reaches into another package"
    for module, allowed in ONLY_IN.items():
        assert module not in imported or name.startswith(allowed), f"{name} must not import {module}"
