"""Realistic faults as changes of the text of a source file: a slip of the pen, a lost factor, a forgotten case.

They stand in tables (`TABLES`) beside this file.  A change must fit: the text `before` occurs exactly
once in its file, inside a function, whose calls show which cases run what is changed.  Where the code has moved, the
test of fit names fault and file: `before` and `after` move with the code, so that what is wrong stays the same.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from validation.harness.case import CaseError
from validation.harness.provenance import SOURCES

FOLDER = Path(__file__).parent
TABLES = tuple(FOLDER / f"{name}.toml" for name in ("bem", "paths", "references", "harness"))
SIZE = "SIZE"


class FaultError(CaseError):
    """A fault that does not fit the sources, or that no case is there to notice."""


@dataclass(frozen=True)
class Fault:
    """One wrong piece of code."""

    id: str  # lower case words joined by hyphens
    what: str  # is wrong, in a few words
    file: str  # path below the folder of the packages
    before: str  # the right text
    after: str  # the wrong one; `SIZE` in it stands for the size, 1 for the slip itself
    case: str  # of the quick level, that must notice it at size 1
    size: str = ""  # what size 1 means, for a fault that can be made smaller; empty when it is there or not
    quick: bool = False  # whether it belongs to the short form of the study

    def changed(self, text: str, size: float) -> str:
        """The text of the file with the fault; FaultError where the right text is not there, or several times."""
        found = text.count(self.before)
        if found != 1:
            raise FaultError(f"{self.id}: {self.file} holds {self.before!r} {found} times, exactly once is needed")
        return text.replace(self.before, self.after.replace(SIZE, repr(size)))

    def function(self, text: str) -> str:
        """Outermost function of the file around the right text, such as `Class.method`; FaultError where none is."""
        line = text.count("\n", 0, text.index(self.before)) + 1
        names = []
        for node in ast.walk(ast.parse(text)):  # outer ones first
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.lineno <= line <= (node.end_lineno or 0):
                names.append(node.name)
                if isinstance(node, ast.FunctionDef):
                    return ".".join(names)
        raise FaultError(f"{self.id}: {self.before!r} of {self.file} is in no function: nothing would show its use")


@dataclass(frozen=True)
class Studied:
    """Faults, the folder of the packages that have them, which of these are copied, and modules of cases."""

    faults: tuple[Fault, ...]
    root: Path = FOLDER.parents[2]
    packages: tuple[str, ...] = SOURCES
    modules: tuple[str, ...] | None = None

    def functions(self) -> dict[str, tuple[str, str]]:
        """File and function of each fault, by its id; FaultError for one that does not fit."""
        found = {}
        for fault in self.faults:
            try:
                text = (self.root / fault.file).read_text("utf-8")
            except OSError as error:
                raise FaultError(f"{fault.id}: {fault.file}: {error.strerror}") from error
            fault.changed(text, 1.0)
            found[fault.id] = fault.file, fault.function(text)
        return found


def faults_in(tables: Iterable[Path] = TABLES) -> tuple[Fault, ...]:
    """The faults of tables, in their order; FaultError for a malformed one, naming file and fault."""
    found: list[Fault] = []
    for path in tables:
        for file, faults in tomllib.loads(path.read_text("utf-8")).items():
            for name, content in faults.items():
                try:
                    found.append(TypeAdapter(Fault).validate_python({"id": name, "file": file, **content}))
                except ValidationError as error:
                    raise FaultError(f"{path.name}: {name}: {error}") from error
    return tuple(found)
