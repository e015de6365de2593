"""Files of a run in progress, and the stored result that a run resumes.

Every state is appended to the journal of the folder when it is found (journal.py), so that no end of the process
loses it.  For whoever watches, result.json is written without fields now and then, and takes little of the time: the
pause between two writes is at least `PAUSE` times what the last one took.  The end writes both files and removes the
journal.
"""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Protocol

from bem.scene.atomic_file import remove_remains
from bem.scene.digest import digest
from bem.scene.journal import JOURNAL_FILE, Journal
from bem.scene.result import Entry, Result
from bem.scene.result_file import FIELDS_FILE, RESULT_FILE, read_result, write_result, write_states
from bem.scene.scene import Scene
from bem.scene.state import Ending
from bem.scene.stored_json import CorruptResultError

ANSWERS = ("answer.csv", "report.html", "rows.csv", "contact_fraction.png", "separation.png", "shape_[0-9]*.png")
PAUSE = 10.0  # format: times the duration of a write of result.json until the next


class OutputFolderError(ValueError):
    """Output folder that cannot be used; nothing was written."""


def usable(folder: Path) -> None:
    """Raise OutputFolderError if the path exists and is not a folder."""
    if folder.exists() and not folder.is_dir():
        raise OutputFolderError(f"{folder}: exists and is not a folder; choose another one")


def stored_result(scene: Scene, folder: Path, resume: bool, overwrite: bool) -> Result | None:
    """Return the stored result to continue from, None to begin a new one; nothing is written.

    OutputFolderError without resume and overwrite, or if the stored result is corrupt or belongs to another scene.
    """
    if overwrite:
        return None
    if not resume:
        raise OutputFolderError(f"{folder}: exists; --resume continues from what it holds, --overwrite replaces it")
    try:
        stored = read_result(folder)
    except FileNotFoundError:
        return None
    except CorruptResultError as error:
        raise OutputFolderError(f"{error}; --overwrite computes it again") from error
    resolved = scene.resolved()
    if digest(stored.scene) != digest(resolved):
        differing = [name for name in resolved if stored.scene.get(name) != resolved[name]]
        raise OutputFolderError(
            f"{folder}: holds the result of another scene (differs in {', '.join(differing)}); "
            "choose another folder, or --overwrite replaces it"
        )
    return stored


class Kept(Protocol):
    """Record of a run (bem/record.py)."""

    @property
    def begun(self) -> Result:
        """Result without states."""
        ...

    @property
    def entries(self) -> Sequence[Entry]:
        """Entries in the order of the path."""
        ...

    def result(self, status: Ending) -> Result:
        """Return the result of all entries."""
        ...


class Checkpoint:
    """Writer of the states of a run into a folder as they are found; `clock` returns seconds."""

    def __init__(self, folder: Path, clock: Callable[[], float] = time.monotonic) -> None:
        self.journal, self.clock = Journal(folder), clock
        self.begun, self.replaces = False, holds_result(folder)
        self.shown_at, self.duration = -math.inf, 0.0

    def keep(self, record: Kept) -> None:
        """Append the last entry of a record to the journal; write result.json if the pause is over."""
        if self.begun:
            self.journal.add(record.entries[-1])
        else:
            self.journal.begin(record.begun, record.entries)
            self.begun = True
        now = self.clock()
        if now - self.shown_at >= PAUSE * self.duration:
            write_states(record.result("interrupted"), self.journal.folder)
            self.shown_at = self.clock()
            self.duration = self.shown_at - now

    def finish(self, result: Result) -> None:
        """Write the result in place of the journal; at any moment a run can continue from the files in the folder."""
        if not self.journal.path.exists():
            self.journal.begin(result, ())
        write_result(result, self.journal.folder)
        if self.replaces:
            remove_answers(self.journal.folder)
        for name in (RESULT_FILE, FIELDS_FILE, JOURNAL_FILE):
            remove_remains(self.journal.folder / name)


def holds_result(folder: Path) -> bool:
    """Return whether a folder holds a result or the journal of a run."""
    return any((folder / name).exists() for name in (RESULT_FILE, JOURNAL_FILE))


def remove_answers(folder: Path) -> None:
    """Remove the page, the table and the pictures that were made of an earlier result in a folder."""
    for pattern in ANSWERS:
        for path in folder.glob(pattern):
            path.unlink(missing_ok=True)


@contextmanager
def interruptible() -> Iterator[None]:
    """Raise KeyboardInterrupt on SIGTERM, as on Ctrl-C, within this context."""

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Ignore Ctrl-C and SIGTERM within this context, for a final write."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
