"""Answers of the tasks of a study, each kept on disk as soon as it is there, so that an interrupted study continues.

A task is a name and whatever else decides its answer, which lies in OUT/answers/NAME-DIGEST.json (kept.py) with the
key of the sources and of the versions they run on.  The digest in the name is that of the task, so that short and full
forms lie side by side.  An answer of other sources counts as missing; a damaged file is reported, and computed again.
Exceptions are not kept: what failed is tried again.
"""

from __future__ import annotations

import hashlib
import json
import re
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from validation.harness.execution import Ended, Running, run_alone
from validation.harness.kept import DamagedError, keep, kept
from validation.harness.provenance import sources_digest, versions
from validation.harness.runner import Listener, Note

FOLDER = "answers"
NAME_LENGTH = 60  # characters of a file name before its digest

Item = TypeVar("Item")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Answers:
    """The answers of a study in a folder."""

    folder: Path  # made where it is not there
    key: str  # of sources and versions; answers of another key are not taken
    report: Listener  # gets a `Note` for each answer that is there already, and for each damaged file

    def kept(self, form: type[Answer], name: str, *decides: Any) -> Answer | None:
        """The answer of a task if these sources gave it.

        Its form is a data class, a list of one, or the like; its name is for people, `decides` what else decides the
        answer, by the `repr`.
        """
        try:
            answer = kept(self._path(name, decides), form, self.key)
        except DamagedError as error:
            self.report(Note(f"{name}: {error}; computed again"))
            return None
        if answer is not None:
            self.report(Note(f"{name}: is there already"))
        return answer

    def keep(self, form: type[Answer], answer: Answer, name: str, *decides: Any) -> None:
        """Store the answer of a task; what is there stays whole where the disk is full (OSError)."""
        self.folder.mkdir(parents=True, exist_ok=True)
        keep(self._path(name, decides), form, answer, self.key)

    def alone(
        self, form: type[Answer], function: Callable[[Item], Answer], item: Item, name: str, *decides: Any
    ) -> Answer | Exception:
        """The answer of a task that is kept, or that of a function in a process of its own, or its exception."""
        known = self.kept(form, name, *decides)
        if known is not None:
            return known
        self.report(Note(f"{name}: started"))
        begun = time.monotonic()
        answer: Answer | Exception = RuntimeError("no answer")
        with closing(run_alone(function, item)) as events:
            for event in events:
                if isinstance(event, Running):
                    self.report(Note(f"{name}: {event.seconds[0]:.0f} s"))
                elif isinstance(event, Ended):
                    answer = event.answer
        self.report(Note(f"{name}: {time.monotonic() - begun:.1f} s"))
        if not isinstance(answer, Exception):
            self.keep(form, answer, name, *decides)
        return answer

    def _path(self, name: str, decides: tuple[Any, ...]) -> Path:
        short = re.sub(r"[^A-Za-z0-9.]+", "-", name).strip("-")[:NAME_LENGTH]
        return self.folder / f"{short}-{hashlib.sha256(repr((name, decides)).encode()).hexdigest()[:12]}.json"


def answers_in(folder: Path, report: Listener) -> Answers:
    """The answers of a study that writes to a folder."""
    key = hashlib.sha256((sources_digest() + json.dumps(versions(), sort_keys=True)).encode()).hexdigest()
    return Answers(folder / FOLDER, key, report)
