"""Commented scenes to begin with, short scripts, and a folder of one's own cases; installed beside this file.

What a scene is about stands in its title, of a script in its first line.
"""

import ast
import tomllib
from importlib import resources
from importlib.resources.abc import Traversable
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
SCRIPTS = {  # a guide in code: a script of the folder `guide`, and its data
    "guide-seal": ("seal.py",),
    "guide-pull-off": ("pull_off.py",),
    "guide-ensemble": ("ensemble.py",),
    "guide-own-scan": ("own_scan.py", "own-scan.csv"),
    "guide-fem": ("boundary_and_finite_elements.py",),
}
OWN = "own-cases"  # a folder
OWN_TITLE = "A folder with a solver, a case, its baseline and the entry points of your own"
OWN_FILES = ("own_cases.py", "own_solver.py", "pyproject.toml", "baselines/own-one-wave.json")
NAMES = (*DATA, *SCRIPTS, OWN)
FOLDER = resources.files("validation.command_line").joinpath("examples")


def listed() -> list[str]:
    """One line for each example: its name, and its title."""
    width = max(map(len, NAMES))
    titles = {name: tomllib.loads(FOLDER.joinpath(f"{name}.toml").read_text("utf-8"))["title"] for name in DATA}
    for name, (script, *_) in SCRIPTS.items():
        said = ast.get_docstring(ast.parse(_source(script).read_text("utf-8"))) or ""
        titles[name] = f"Python: {said.splitlines()[0]}"
    return [f"{name:<{width}}  {title}" for name, title in (titles | {OWN: OWN_TITLE}).items()]


def _source(file: str) -> Traversable:
    """Where a file to be written is; scripts stand in a folder of their own."""
    in_guide = any(file == script for script, *_ in SCRIPTS.values())
    return (FOLDER.joinpath("guide") if in_guide else FOLDER).joinpath(file)


def write_example(name: str, folder: Path) -> list[Path]:
    """Write one of `NAMES`: a scene or script and its data, or the folder of one's own cases; the files, data last.

    FileExistsError where one of the files is there already; then nothing is written.
    """
    if name == OWN:
        names = [f"{OWN}/{file}" for file in OWN_FILES]
    else:
        names = list(SCRIPTS[name]) if name in SCRIPTS else [f"{name}.toml", *DATA[name]]
    files = {folder / file: _source(file).read_bytes() for file in names}
    for path in files:
        if path.exists():
            raise FileExistsError(17, "is there already, nothing is written", str(path))
    for path, content in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("xb") as file:
            file.write(content)
    return list(files)
