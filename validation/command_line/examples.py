"""Commented scenes to begin with, short scripts, and a folder of one's own cases; installed beside this file.

What a scene is about stands in its title, of a script in its first line.
"""

import ast
import tomllib
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

GUIDE, OWN = "guide", "own-cases"  # folders: of scripts, a guide in code, and of own cases
EXAMPLES = {  # in the order in which they are listed: a scene, a script or own cases, then the files that go with it
    "one-wave": ("one-wave.toml",),
    "paper-profile": ("paper-profile.toml",),
    "own-scan": ("own-scan.toml", "own-scan.csv"),
    "layer": ("layer.toml",),
    "load-control": ("load-control.toml",),
    "pull-off": ("pull-off.toml",),
    "complete-contact": ("complete-contact.toml",),
    "no-adhesion": ("no-adhesion.toml",),
    "steep-profile": ("steep-profile.toml",),
    "guide-seal": ("seal.py",),
    "guide-ensemble": ("ensemble.py",),
    "guide-map": ("map.py",),
    "guide-sweep": ("sweep.py",),
    "guide-fem": ("boundary_and_finite_elements.py",),
    OWN: tuple(f"{OWN}/{file}" for file in ("test_own_wave.py", "case_one_wave.toml", "own_solver.py")),
}
NAMES = tuple(EXAMPLES)
OWN_TITLE = "A folder with a solver, a case in Python and a case in TOML of your own"
FOLDER = resources.files("validation.command_line").joinpath("examples")


def listed() -> list[str]:
    """Return a line for each example: its name, and its title."""
    width = max(map(len, EXAMPLES))
    return [f"{name:<{width}}  {_title(first)}" for name, (first, *_) in EXAMPLES.items()]


def _title(file: str) -> str:
    text = _source(file).read_text("utf-8")
    if file.endswith(".toml"):
        return str(tomllib.loads(text)["title"])
    return OWN_TITLE if file.startswith(OWN) else f"Python: {str(ast.get_docstring(ast.parse(text))).splitlines()[0]}"


def _source(file: str) -> Traversable:
    """Return the path of an example's file in the package; scripts have a folder of their own."""
    is_script = file.endswith(".py") and not file.startswith(OWN)
    return (FOLDER.joinpath(GUIDE) if is_script else FOLDER).joinpath(file)


def write_example(name: str, folder: Path) -> list[Path]:
    """Write the files of an example, data last, and say which.

    FileExistsError if a file exists already; then nothing is written.
    """
    files = {folder / file: _source(file).read_bytes() for file in EXAMPLES[name]}
    for path in files:
        if path.exists():
            raise FileExistsError(17, "is there already, nothing is written", str(path))
    for path, content in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("xb") as file:
            file.write(content)
    return list(files)
