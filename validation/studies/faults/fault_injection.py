"""Realistic faults as changes of the text of a source file, put into a copy of the sources, and cases run there.

Faults are a slip of the pen, a lost factor, a forgotten case, and stand in tables (`TABLES`) beside this file.  A
change must fit: the text `before` occurs exactly once in its file, inside a function, whose calls show which cases run
what is changed.  Where the code has moved, the test of fit names fault and file: `before` and `after` move with it, so
that what is wrong stays the same.

The packages are copied, one file of the copy is changed, and the copy stands first on the path while the cases are
imported and run: every module, table of functions and worker process has the fault, the sources are never touched.
`examine` does not judge: verdicts are given where no fault is (faults.py).  Calls of the functions that faults change
are counted; one that keeps what it computed (lru_cache) counts only what it computes.  Limits: a case that runs too
long is cut off by a signal, on POSIX systems only.  What counts is the time of the processor, which does not depend
on what else the machine does; a case that waits is cut off by the clock.
"""

import ast
import os
import shutil
import signal
import sys
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.util import cache_from_source
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bem.compiled.kernels import VARIABLE
from validation.harness.case import CaseError
from validation.harness.provenance import SOURCES
from validation.harness.schema import CaseRecord

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


WAITS = 10.0  # times the limit: the time by the clock after which a case is cut off, too


class TooSlowError(RuntimeError):
    """A case took far longer than it does without the fault."""


@dataclass(frozen=True)
class Exposure:
    """A fault of a size and ids of cases, with the seconds of the processor after which each is cut off.

    Without a fault, calls are counted for all faults: the control.
    """

    fault: Fault | None
    size: float
    cases: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Examined:
    """What came out of the cases, without figures, and how often each called what the faults change (by fault).

    The seconds of the records are those of the processor.
    `ended` holds (case, message) where the process itself came to an end.
    """

    records: tuple[CaseRecord, ...]
    calls: dict[str, dict[str, int]]
    ended: tuple[tuple[str, str], ...] = ()


def examine(studied: Studied, folder: Path, task: Exposure) -> Examined:
    """Run the cases of a task in a copy of the sources, made in a folder and removed again.

    In a process of its own: libraries may keep traces of a fault.  FaultError where the fault does not fit.
    """
    places: defaultdict[tuple[str, str], list[str]] = defaultdict(list)
    with TemporaryDirectory(dir=folder) as name:
        tree = Path(name)
        shown = studied if task.fault is None else replace(studied, faults=(task.fault,))
        for fault, (file, function) in shown.functions().items():
            places[str(tree / file), function].append(fault)
        for package in studied.packages:
            shutil.copytree(studied.root / package, tree / package)
        if task.fault is not None:
            changed = tree / task.fault.file
            changed.write_text(task.fault.changed(changed.read_text("utf-8"), task.size), "utf-8")
            Path(cache_from_source(str(changed))).unlink(missing_ok=True)
        records, calls = [], {}
        with _imported_from(tree, studied.packages):
            known = {case.id: case for case in import_module("validation.harness.case").registry(studied.modules)}
            for case, limit in task.cases:
                with _counted(places) as counter:
                    record = _computed(known[case], limit)
                records.append(CaseRecord.model_validate(record.model_dump()))  # of our class, not of the copy's
                calls[case] = dict(counter)
    return Examined(tuple(records), calls)


@contextmanager
def _imported_from(tree: Path, packages: tuple[str, ...]) -> Iterator[None]:
    """In the block, the packages are imported from a copy, with kernels in NumPy; behind it, they are as before."""

    def taken_out() -> dict[str, Any]:
        return {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] in packages}

    before, asked = taken_out(), os.environ.get(VARIABLE)
    os.environ[VARIABLE] = "numpy"  # compiled ones do not see what was changed
    sys.path.insert(0, str(tree))
    try:
        for package in packages:
            found = import_module(package).__file__
            if found is None or not Path(found).is_relative_to(tree):
                raise FaultError(f"{package} is imported from {found}, not from the copy {tree}")
        yield
    finally:
        sys.path.remove(str(tree))
        if asked is None:
            del os.environ[VARIABLE]
        else:
            os.environ[VARIABLE] = asked
        taken_out()
        sys.modules.update(before)


@contextmanager
def _counted(places: Mapping[tuple[str, str], list[str]]) -> Iterator[Counter[str]]:
    """In the block, calls of the functions at these places (file, qualified name) are counted, by the names given."""
    counter: Counter[str] = Counter()

    def count(frame: FrameType, event: str, argument: Any) -> None:
        code = frame.f_code
        for name in places.get((code.co_filename, code.co_qualname), ()):
            counter[name] += 1

    before = sys.gettrace()
    sys.settrace(count)
    try:
        yield counter
    finally:
        sys.settrace(before)


def _computed(case: Any, limit: float) -> Any:
    """Record of a case of the copy, made by the copy."""
    runner = import_module("validation.harness.runner")
    begun = time.process_time()
    try:
        with _cut_off(limit):
            outcome = case.compute()
        record = runner.record_of(case, outcome, time.process_time() - begun)
    except (Exception, SystemExit) as error:
        record = runner.failed_record(case, f"{type(error).__name__}: {error}", time.process_time() - begun)
    return record.model_copy(update={"figures": [], "drawn": [], "tables": [], "scene": ""})


@contextmanager
def _cut_off(limit: float) -> Iterator[None]:
    """Raise `TooSlowError` in the block after `limit` seconds of the processor, `WAITS` times as many by the clock."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        reported = f"{limit:.3g} s of the processor" if number == signal.SIGPROF else f"{WAITS * limit:.3g} s"
        raise TooSlowError(f"no answer in {reported}")

    timers = (
        (signal.SIGPROF, signal.ITIMER_PROF, limit),
        (signal.SIGALRM, signal.ITIMER_REAL, WAITS * limit),
    )
    before = [signal.signal(number, stop) for number, _, _ in timers]
    for _, timer, seconds in timers:
        signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        for (number, timer, _), handler in zip(timers, before, strict=True):
            signal.setitimer(timer, 0)
            signal.signal(number, handler)
