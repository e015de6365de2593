"""Commented scenes to begin with, installed beside this file: what each is about stands in its title."""

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
FOLDER = resources.files("validation.command_line").joinpath("examples")


def listed() -> list[str]:
    """One line for each scene: its name, and its title."""
    width = max(map(len, DATA))
    titles = {name: tomllib.loads(FOLDER.joinpath(f"{name}.toml").read_text("utf-8"))["title"] for name in DATA}
    return [f"{name:<{width}}  {title}" for name, title in titles.items()]


def write_example(name: str, folder: Path) -> list[Path]:
    """Write a scene and its data into a folder.

    Parameters
    ----------
    name : str
        One of `DATA`.
    folder : Path

    Returns
    -------
    list of Path
        What was written, the scene first.

    Raises
    ------
    FileExistsError
        One of the files is there already; nothing is written.
    """
    files = {folder / file: FOLDER.joinpath(file).read_bytes() for file in (f"{name}.toml", *DATA[name])}
    for path in files:
        if path.exists():
            raise FileExistsError(17, "is there already, nothing is written", str(path))
    for path, content in files.items():
        with path.open("xb") as file:
            file.write(content)
    return list(files)
