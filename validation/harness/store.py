"""The one store of what was computed: an answer a file, taken again only where the same sources made it.

A file holds the key of what made it, the answer and a SHA-256 of that; it is written under a temporary name, flushed
and renamed, so that an interruption leaves the old file or the new one.  Answers are data classes, lists of them, or
pydantic models; every float comes back bit by bit, nan and infinity too.  Records of cases, tasks of studies and what
solvers of the challenge returned lie so.  An answer of other sources counts as missing; a damaged file is reported, and
computed again.  Exceptions are not kept: what failed is tried again.  Members of ensembles lie elsewhere: they are
results of the solver, in the files that its own commands read and go by their scene (ensemble.py).
"""

import hashlib
import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import TypeAdapter, ValidationError

from bem.scene.atomic_file import write_atomically
from validation.harness.execution import Ended, Listener, Note, Running, run_in_processes
from validation.harness.executors import Opener, fresh_processes
from validation.harness.provenance import sources_digest, versions
from validation.harness.schema import ID

FOLDER = "answers"
NAME_LENGTH = 60  # characters of a file name before its digest

Item = TypeVar("Item")
Kept = TypeVar("Kept")


class DamagedError(ValueError):
    """A file that is not what was written."""


@dataclass(frozen=True)
class Store:
    """Answers in a folder, which is made where it is not there.

    A task is a name, for people, and whatever else decides its answer (`decides`, by the `repr`), of which the file
    name holds a digest, so that short and full forms lie side by side.
    """

    folder: Path
    key: str  # of sources and versions; answers of another key are not taken
    report: Listener  # gets a `Note` for each damaged file, and, where `each`, for each answer that is there already
    each: bool = True

    def path(self, name: str, *decides: Any) -> Path:
        """The file of a task: its name, where that names a file and nothing else decides."""
        if not decides and re.fullmatch(ID, name):
            return self.folder / f"{name}.json"
        short = re.sub(r"[^A-Za-z0-9.]+", "-", name).strip("-")[:NAME_LENGTH]
        return self.folder / f"{short}-{hashlib.sha256(repr((name, decides)).encode()).hexdigest()[:12]}.json"

    def kept(self, form: type[Kept], name: str, *decides: Any) -> Kept | None:
        """The answer of a task, of this form, if these sources gave it."""
        try:
            answer = self._read(form, name, decides)
        except DamagedError as error:
            self.report(Note(f"{name}: {error}; computed again"))
            return None
        if answer is not None and self.each:
            self.report(Note(f"{name}: is there already"))
        return answer

    def keep(self, form: type[Kept], answer: Kept, name: str, *decides: Any) -> None:
        """Store the answer of a task; what is there stays whole where the disk is full (OSError)."""
        self.folder.mkdir(parents=True, exist_ok=True)
        content = json.loads(json.dumps(TypeAdapter(form).dump_python(answer)))
        whole = {"key": self._key(name, decides), "sha256": _digest(content), "answer": content}
        write_atomically(self.path(name, *decides), json.dumps(whole, indent=1) + "\n")

    def answers(
        self,
        form: type[Kept],
        function: Callable[[Item], Kept],
        items: Iterable[Item],
        task_of: Callable[[Item], tuple[Any, ...]],
        jobs: int = 1,
        opener: Opener = fresh_processes,
        limit: Callable[[Item], float] | None = None,
        keeps: Callable[[Kept], bool] = lambda answer: True,
    ) -> Iterator[tuple[Item, Kept | Exception, float]]:
        """Items with their answers and seconds, as they come: first those that are kept, then those of a function.

        The name of an item and what else decides its answer are `task_of(item)`; function, jobs, opener and limit are
        those of `run_in_processes`. Exceptions in place of answers are not kept, nor is what `keeps` refuses.
        """
        missing = []
        for item in items:
            known = self.kept(form, *task_of(item))
            if known is None:
                missing.append(item)
            else:
                yield item, known, 0.0
        with closing(run_in_processes(function, missing, jobs, opener=opener, limit=limit)) as events:
            for event in events:
                if isinstance(event, Ended):
                    answer = event.answer
                    if not isinstance(answer, Exception) and keeps(answer):
                        self.keep(form, answer, *task_of(event.item))
                    yield event.item, answer, event.seconds
                elif isinstance(event, Running):
                    passed = zip(event.items, event.seconds, strict=True)
                    self.report(Note("; ".join(f"{task_of(item)[0]}: {seconds:.0f} s" for item, seconds in passed)))
                else:
                    self.report(Note(f"{task_of(event.item)[0]}: started"))

    def alone(
        self, form: type[Kept], function: Callable[[Item], Kept], item: Item, name: str, *decides: Any
    ) -> Kept | Exception:
        """The answer of a task that is kept, or that of a function in a process of its own, or its exception."""
        ((_, answer, seconds),) = self.answers(form, function, [item], lambda item: (name, *decides))
        if seconds:
            self.report(Note(f"{name}: {seconds:.1f} s"))
        return answer

    def _read(self, form: type[Kept], name: str, decides: tuple[Any, ...]) -> Kept | None:
        path = self.path(name, *decides)
        try:
            content = json.loads(path.read_text("utf-8"))
            if content["key"] != self._key(name, decides):
                return None
            if content["sha256"] != _digest(content["answer"]):
                raise DamagedError(f"{path.name} is damaged")
            return TypeAdapter(form).validate_python(content["answer"])
        except FileNotFoundError:
            return None
        except (ValueError, KeyError, TypeError, ValidationError, RecursionError) as error:
            raise DamagedError(f"{path.name} is damaged") from error

    def _key(self, name: str, decides: tuple[Any, ...]) -> str:
        return hashlib.sha256(repr((self.key, name, decides)).encode()).hexdigest()


def store_in(folder: Path, report: Listener, each: bool = True) -> Store:
    """The store of these sources, and of the versions of what they run on, beside what a study writes to a folder."""
    key = hashlib.sha256((sources_digest() + json.dumps(versions(), sort_keys=True)).encode()).hexdigest()
    return Store(folder / FOLDER, key, report, each)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write JSON; nan and infinity, which do not exist there, become null."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, json.dumps(plain(dict(content)), indent=1, allow_nan=False) + "\n")


def plain(value: Any) -> Any:
    """A value as JSON holds it."""
    if isinstance(value, Mapping):
        return {name: plain(content) for name, content in value.items()}
    if isinstance(value, list | tuple):
        return [plain(content) for content in value]
    number = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(number, float) and not math.isfinite(number) else number


def _digest(plain: Any) -> str:
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()
