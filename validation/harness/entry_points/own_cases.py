"""Cases of a group, kept outside the installed package: the files *cases.py of a folder, or a module's entry point.

A file holds a list `CASES`, as a module of the suite does, and finds what lies beside it by a plain import.  Workers
load it again by its path, so that `Case.compute` may be any function of it.  A case may not have the name of one of the
suite.  The digest covers the files beside the cases, not what they import from elsewhere; therefore cases of one's own
are always computed again.
"""

import hashlib
import sys
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from validation.harness.case import Case, CaseError, Outcome, checked
from validation.harness.entry_points import cases as offered

FILES = "*cases.py"
BASELINES = "baselines"


@dataclass(frozen=True)
class OwnCases:
    """Cases, where their baselines lie unless told otherwise (None: that has to be told), and the files they are in."""

    cases: tuple[Case, ...]
    baselines: Path | None
    files: tuple[Path, ...]

    def digest(self) -> str:
        """SHA-256 of the files, names and contents."""
        made = hashlib.sha256()
        for path in self.files:
            made.update(path.name.encode() + b"\0" + path.read_bytes())
        return made.hexdigest()


def own_cases(where: Path, suite: Iterable[str] = ()) -> OwnCases:
    """The cases of a folder, or else of the entry point of this name; names of the suite are taken.

    CaseError where it is neither; a file cannot be imported or holds no cases; a case is incomplete; two have one name,
    or one that of another in the suite.
    """
    found = _of_folder(where.resolve()) if where.is_dir() else _of_entry_point(str(where))
    taken = sorted({case.id for case in found.cases} & set(suite))
    if taken:
        raise CaseError(f"--cases {where}: the suite has cases of these names: {', '.join(taken)}")
    return found


def compute_of(path: Path, name: str) -> Outcome:
    """In a worker: the outcome of a case of a file."""
    return next(case for case in _cases(_loaded(path), str(path)) if case.id == name).compute()


def _of_folder(folder: Path) -> OwnCases:
    paths = sorted(folder.glob(FILES))
    if not paths:
        raise CaseError(f"--cases {folder}: no file {FILES} there")
    found = [
        replace(case, compute=partial(compute_of, path, case.id))
        for path in paths
        for case in _cases(_loaded(path), str(path))
    ]
    return OwnCases(checked(found), folder / BASELINES, _files(folder))


def _of_entry_point(name: str) -> OwnCases:
    known = offered()
    if name not in known:
        listed = ", ".join(sorted(known)) or "none is installed"
        raise CaseError(f"--cases {name}: no such folder, and no entry point linecontact.cases of this name ({listed})")
    label = f"entry point {name} = {known[name]} of linecontact.cases"
    try:
        module = import_module(known[name])
    except (Exception, SystemExit) as error:
        raise CaseError(f"{label}: {type(error).__name__}: {error}") from error
    found, file = checked(_cases(module, label)), Path(str(module.__file__))
    return OwnCases(found, None, _files(file.parent) if hasattr(module, "__path__") else (file,))


def _files(folder: Path) -> tuple[Path, ...]:
    """The files of a folder, those of folders in it (baselines, reports) left out."""
    return tuple(sorted(path for path in folder.iterdir() if path.is_file() and not path.name.startswith(".")))


def _loaded(path: Path) -> ModuleType:
    """The module of a file, which finds those beside it as a script does."""
    if str(path.parent) not in sys.path:
        sys.path.insert(0, str(path.parent))
    name = f"own:{path.stem}"  # which no import statement finds
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise CaseError(f"{path}: not a Python file")
    module = sys.modules[name] = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise CaseError(f"{path}: {type(error).__name__}: {error}") from error
    return module


def _cases(module: ModuleType, label: str) -> tuple[Case, ...]:
    """The list CASES of a module."""
    listed = getattr(module, "CASES", None)
    if not isinstance(listed, tuple | list) or not listed:
        raise CaseError(f"{label}: no list CASES of cases in it")
    for case in listed:
        if not isinstance(case, Case):
            raise CaseError(f"{label}: CASES holds {case!r}, which is no Case")
    return tuple(listed)
