"""The import directions of the house, read from the source: between packages, between folders, between files.

Packages that are compared share nothing.  Folders of a package stand in an order, and import from themselves and from
those before them.  Imports inside functions, for type checkers, and by `import_module("name")` count like any other;
the registry of cases and the table of studies name their modules as data, which does not.

The solver asks a path only what every path answers, never which one it is.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("bem", "fem_reference", "persson", "validation")
SOURCES = dict.fromkeys(sorted(p.relative_to(ROOT) for package in PACKAGES for p in (ROOT / package).rglob("*.py")))
FOLDERS = sorted({path.parent for path in SOURCES})
ONLY_IN = {
    "pydantic": ("bem/geometry/table.py", "bem/scene/", "bem/command_line/keys.py", "validation/"),
    "skfem": ("fem_reference/",),
    "meshio": ("fem_reference/",),
    "matplotlib": (
        "validation/report/",
        "validation/command_line/examples/guide/map.py",
        "bem/scene/plots.py",
        "bem/scene/result_views.py",
    ),
    "jinja2": ("validation/report/",),
}
ORDER = (
    "bem/kernels",
    "bem/geometry",
    "bem/audit",
    "bem/elastic",
    "bem/loading",
    "bem/adhesive",
    "bem/path",
    "bem/windows",
    "bem/nonadhesive",
    "bem/observables",
    "bem/scans",
    "bem/scene",
    "bem/command_line",
    "bem",
    "fem_reference",
    "persson/mathematics",
    "persson",
    "validation/harness",
    "validation/report",
    "validation/references",
    "validation/paper",
    "validation/plugin",
    "validation/routes",
    "validation/corpus",
    "validation/challenge",
    "validation/cases",
    "validation/studies",
    "validation/fits",
    "validation",
    "validation/command_line",
    "validation/command_line/examples/guide",
    "validation/command_line/examples/own-cases",
)
APART = {  # besides the order: folders that these do not import from either
    "bem/observables": ("bem/adhesive", "bem/path", "bem/nonadhesive", "bem/elastic"),
    "bem/nonadhesive": ("bem/adhesive", "bem/path"),
    "bem/scene": ("bem/path", "bem/nonadhesive"),
    "validation/studies": ("validation/cases",),
    "validation/paper": ("validation/cases",),
}
ONE_PATH = ("bem/solver.py", "bem/recorder.py")  # ask a path only what bem/loading/loading_path.py says


def named(path: Path) -> Iterator[str]:
    """Everything that a file imports, by its dotted name, be it a module or something in one."""
    for node in ast.walk(ast.parse((ROOT / path).read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relative to itself"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and "import_module" in vars(node.func).values():  # its id, or attr
            yield from (word.value for word in node.args if isinstance(word, ast.Constant))


def file_of(name: str) -> Path | None:
    """The file of ours that a dotted name is in."""
    place = Path(*name.split("."))
    while place.parts:
        for path in (place.with_suffix(".py"), place / "__init__.py"):
            if path in SOURCES:
                return path
        place = place.parent
    return None


@cache
def imports() -> dict[Path, set[str]]:
    return {path: set(named(path)) for path in SOURCES}


@cache
def files() -> dict[Path, set[Path]]:
    """Files of ours that each imports."""
    return {
        path: {found for name in names if (found := file_of(name)) not in (None, path)}
        for path, names in imports().items()
    }


def imported_by(path: Path) -> set[str]:
    """Packages that a file imports from."""
    return {name.split(".")[0] for name in imports()[path]}


@pytest.mark.parametrize("package", PACKAGES[:-1])
def test_packages_that_are_compared_share_nothing(package):
    others = set(PACKAGES) - {package}
    assert [str(path) for path in SOURCES if path.parts[0] == package and imported_by(path) & others] == []


def test_tests_of_the_solver_import_nothing_of_the_comparison():
    tests = [path.relative_to(ROOT) for path in (ROOT / "tests" / "bem").rglob("*.py")]
    assert len(tests) > 50
    assert [str(path) for path in tests if any(name.split(".")[0] == "validation" for name in named(path))] == []


def test_references_share_nothing_with_the_codes_that_they_judge():
    references = [path for path in SOURCES if path.is_relative_to("validation/references")]
    assert [str(path) for path in references if imported_by(path) & set(PACKAGES[:-1])] == []


@pytest.mark.parametrize("module", ONLY_IN)
def test_libraries_are_imported_in_their_places_only(module):
    importing = [str(path) for path in SOURCES if module in imported_by(path)]
    assert [path for path in importing if not path.startswith(ONLY_IN[module])] == []


def test_every_folder_has_its_place():
    assert sorted(ORDER) == [str(folder) for folder in FOLDERS]


@pytest.mark.parametrize("folder", ORDER)
def test_imports_between_folders_go_one_way(folder):
    before = ORDER[: ORDER.index(folder) + 1]
    imports = [(path, other) for path in SOURCES if str(path.parent) == folder for other in files()[path]]
    assert [f"{path} imports {other}" for path, other in imports if str(other.parent) not in before] == []


@pytest.mark.parametrize("folder", APART)
def test_folders_that_need_nothing_of_each_other_do_not_import_each_other(folder):
    imports = [(path, other) for path in SOURCES if path.is_relative_to(folder) for other in files()[path]]
    assert [f"{path} imports {other}" for path, other in imports if any(map(other.is_relative_to, APART[folder]))] == []


def circle_of(graph: dict[Path, set[Path]]) -> list[Path]:
    """Files each of which imports the next one, the first being the last."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1][::-1]
    return []


def test_no_circle_of_files():
    circle = circle_of(files())
    assert not circle, " imports ".join(map(str, circle))


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_names_a_kind_of_arrays_once(package):
    texts = ((ROOT / path).read_text() for path in SOURCES if path.parts[0] == package)
    named = Counter(name for text in texts for name in re.findall(r"^(\w+) = NDArray\[", text, re.MULTILINE))
    assert {name: count for name, count in named.items() if count > 1} == {}


@pytest.mark.parametrize("path", ONE_PATH)
def test_the_solver_does_not_ask_which_path_it_holds(path):
    source = (ROOT / path).read_text()
    asked = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Match)]
    asked += [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Name) and node.id == "isinstance"]
    assert not asked, f"{path}:{asked[0].lineno} asks for a type"
