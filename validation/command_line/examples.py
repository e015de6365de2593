"""Commented scenes to begin with, short scripts, and a folder of one's own cases; installed beside this file.

What a scene is about stands in its title, of a script in its first line.
"""

import ast
import tomllib
from importlib import resources
from pathlib import Path

GUIDE = "guide/"  # where scripts lie, a guide in code; they are written without it
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
    "guide-seal": ("guide/seal.py",),
    "guide-pull-off": ("guide/pull_off.py",),
    "guide-ensemble": ("guide/ensemble.py",),
    "guide-own-scan": ("guide/own_scan.py", "own-scan.csv"),
    "guide-fem": ("guide/boundary_and_finite_elements.py",),
    "own-cases": tuple(
        f"own-cases/{file}"
        for file in ("own_cases.py", "own_solver.py", "pyproject.toml", "baselines/own-one-wave.json")
    ),
}
NAMES = tuple(EXAMPLES)
OWN_TITLE = "A folder with a solver, a case, its baseline and the entry points of your own"
FOLDER = resources.files("validation.command_line").joinpath("examples")


def listed() -> list[str]:
    """One line for each example: its name, and its title."""
    width = max(map(len, EXAMPLES))
    return [f"{name:<{width}}  {_title(first)}" for name, (first, *_) in EXAMPLES.items()]


def _title(file: str) -> str:
    text = FOLDER.joinpath(file).read_text("utf-8")
    if file.endswith(".toml"):
        return str(tomllib.loads(text)["title"])
    if file.startswith(GUIDE):
        return f"Python: {(ast.get_docstring(ast.parse(text)) or '').splitlines()[0]}"
    return OWN_TITLE


def write_example(name: str, folder: Path) -> list[Path]:
    """Write the files of an example, data last, and say which.

    FileExistsError where one of the files is there already; then nothing is written.
    """
    files = {folder / file.removeprefix(GUIDE): FOLDER.joinpath(file).read_bytes() for file in EXAMPLES[name]}
    for path in files:
        if path.exists():
            raise FileExistsError(17, "is there already, nothing is written", str(path))
    for path, content in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("xb") as file:
            file.write(content)
    return list(files)
