"""Commented scenes to begin with, and a folder of one's own cases; installed beside this file.

What a scene is about stands in its title.
"""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path

DATA = {  # files of a scene besides its own, in the order in which scenes are listed
    "one-wave": (),
    "paper-profile": (),
    "own-scan": ("own-scan.csv",),
    "layer": (),
    "load-control": (),
    "pull-off": (),
    "complete-contact": (),
    "no-adhesion": (),
    "steep-profile": (),
}
OWN = "own-cases"  # a folder
OWN_TITLE = "A folder with a solver, a case, its baseline and the entry points of your own"
OWN_FILES = ("own_cases.py", "own_solver.py", "pyproject.toml", "baselines/own-one-wave.json")
NAMES = (*DATA, OWN)
FOLDER = resources.files("validation.command_line").joinpath("examples")


def listed() -> list[str]:
    """One line for each example: its name, and its title."""
    width = max(map(len, NAMES))
    titles = {name: tomllib.loads(FOLDER.joinpath(f"{name}.toml").read_text("utf-8"))["title"] for name in DATA}
    return [f"{name:<{width}}  {title}" for name, title in (titles | {OWN: OWN_TITLE}).items()]


def write_example(name: str, folder: Path) -> list[Path]:
    """Write one of `NAMES`, a scene and its data or the folder of one's own cases; the files, scene or cases first.

    FileExistsError where one of the files is there already; then nothing is written.
    """
    names = [f"{OWN}/{file}" for file in OWN_FILES] if name == OWN else [f"{name}.toml", *DATA[name]]
    files = {folder / file: FOLDER.joinpath(file).read_bytes() for file in names}
    for path in files:
        if path.exists():
            raise FileExistsError(17, "is there already, nothing is written", str(path))
    for path, content in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("xb") as file:
            file.write(content)
    return list(files)
