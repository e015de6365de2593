"""What documents, docstrings and comments name exists: files, folders, modules and what packages offer.

A bare file name may be anywhere in the house, a path is one from the root or from the package whose text names it.
"""

import re
import tomllib
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("bem", "fem_reference", "persson", "validation")
FOLDERS = (*PACKAGES, "tests", ".ci", ".github")
KEPT = {path for folder in FOLDERS for path in (ROOT / folder).rglob("*")} | set(ROOT.iterdir())
NAMES = {path.name for path in KEPT}
TEXTS = sorted(
    path
    for path in KEPT
    if (path.suffix == ".md" and path.name != "CHANGELOG.md")  # which names what is gone
    or (path.suffix == ".py" and "tests" not in path.parts)
)
FILE = re.compile(r"(?<![\w./*-])((?:[\w.-]+/)*[\w-]+\.(?:py|md))(?![\w/])")
FOLDER = re.compile(rf"(?<![\w./*-])((?:{'|'.join(map(re.escape, FOLDERS))})/[\w./*-]*(?:/|\.\w+))")
MODULE = re.compile(rf"(?<![\w./*-])({'|'.join(PACKAGES)})\.([a-z]\w*)(?![\w/])")


def missing(text: str, package: str) -> list[str]:
    """What a text of a package names and nobody finds."""
    files = {name for name in FILE.findall(text) if not _is_file(name, package)}
    folders = {name.rstrip("/.") for name in FOLDER.findall(text)}
    modules = {f"{home}.{name}" for home, name in MODULE.findall(text) if not _is_offered(home, name)}
    return sorted(files | {name for name in folders if not any(ROOT.glob(name))} | modules)


def _is_file(name: str, package: str) -> bool:
    return name in NAMES if "/" not in name else not KEPT.isdisjoint({ROOT / name, ROOT / package / name})


def _is_offered(package: str, name: str) -> bool:
    """Whether a package has a module or a public name of this name, or a folder with such a file (page.json)."""
    return find_spec(f"{package}.{name}") is not None or hasattr(import_module(package), name)


def test_what_is_named_exists():
    texts = {str(path.relative_to(ROOT)): path.read_text("utf-8") for path in TEXTS}
    lost = {name: missing(text, name.split("/")[0]) for name, text in texts.items()}
    assert {name: names for name, names in lost.items() if names} == {}


def test_version_is_the_same_wherever_it_stands():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.findall(r"^## ([\d.]+)", (ROOT / "CHANGELOG.md").read_text(), re.M)[0] == version
