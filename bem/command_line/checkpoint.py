"""What converged is kept: results written during a run, and the stored result a run resumes.

States are written at once while writing takes little of the time: the pause between two writes is at least
`PAUSE` times the last one took, and never longer than the next increment.  A run that is killed so loses
at most what converged within that pause.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import FrameType

from bem.scene.effects import effects_of
from bem.scene.result import FINAL_STATUSES, Result
from bem.scene.result_file import CorruptResultError, digest, provenance, read_result, write_result
from bem.scene.scene import Scene

PAUSE = 10.0
SECONDS_BETWEEN_INCREMENTS = 2.0  # between writes of states that are not targets


class OutputFolderError(ValueError):
    """An output folder that cannot be used; nothing was written."""


def usable(folder: Path) -> None:
    """Refuse what exists and is not a folder, by an OutputFolderError."""
    if folder.exists() and not folder.is_dir():
        raise OutputFolderError(f"{folder}: exists and is not a folder; choose another one")


def stored_result(scene: Scene, folder: Path, resume: bool, overwrite: bool) -> Result | None:
    """The result of an existing folder to continue from, None to begin; nothing is written.

    OutputFolderError where neither resume nor overwrite is asked for; its result is corrupt or that of another scene.
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
        raise OutputFolderError(f"{error}; nothing to continue from, --overwrite computes it again") from error
    resolved = scene.resolved()
    if digest(stored.scene) != digest(resolved):
        differing = [name for name in resolved if stored.scene.get(name) != resolved[name]]
        raise OutputFolderError(
            f"{folder}: holds the result of another scene (differs in {', '.join(differing)}); "
            "choose another folder, or --overwrite replaces it"
        )
    if stored.status not in FINAL_STATUSES and any(state.events is None for state in stored.states):
        raise OutputFolderError(
            f"{folder}: holds a result of an earlier version, which did not store the events before each state; "
            "--overwrite computes it again"
        )
    return stored


class Checkpoint:
    """Writes the states found so far, as an interrupted result; those of the result that the run resumes come first.

    The clock counts seconds.
    """

    def __init__(
        self, scene: Scene, folder: Path, stored: Result | None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        resolved = scene.resolved()
        begun = Result(resolved, effects_of(scene), provenance(resolved), (), (), "interrupted")
        self.result = begun if stored is None else replace(stored, status="interrupted")
        self.folder, self.clock = folder, clock
        self.unsaved = False
        self.target_unsaved = False
        self.saved_at, self.duration = -SECONDS_BETWEEN_INCREMENTS, 0.0

    def keep(self, partial: Result) -> None:
        """Take over all that is kept so far; write it if it is time."""
        self.result = partial
        self.unsaved = True
        self.target_unsaved = self.target_unsaved or partial.states[-1].target
        self.save_when_due()

    def save_when_due(self) -> None:
        """Write what is unsaved unless the last write was just done."""
        waited = self.clock() - self.saved_at
        pause = PAUSE * self.duration if self.target_unsaved else SECONDS_BETWEEN_INCREMENTS
        if self.unsaved and waited >= pause:
            self.save()

    def save(self) -> None:
        """Write what is unsaved."""
        if not self.unsaved:
            return
        begun = self.clock()
        write_result(self.result, self.folder)
        self.saved_at = self.clock()
        self.duration = self.saved_at - begun
        self.unsaved = self.target_unsaved = False


@contextmanager
def interruptible() -> Iterator[None]:
    """Within this context SIGTERM interrupts like Ctrl-C, with KeyboardInterrupt."""

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Within this context neither Ctrl-C nor SIGTERM is heard: for a final write."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
