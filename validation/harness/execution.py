"""Runs a function over items in worker processes, one BLAS thread each, and loses no item.

Items are handed out one by one, so that what is reported as running does run.  An item whose worker died (out of
memory, a signal) is run again, alone, after all others, so that only the guilty one fails.  An interrupt ends the
workers at once; Ctrl-C in a terminal reaches the parent only, which decides.
"""

import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar

from validation.harness.executors import Opener, local_processes, on_one_thread

PULSE = 5.0  # s between signs of life

Item = TypeVar("Item")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Note:
    """A line of progress."""

    text: str


Listener = Callable[[Note], None]


class WorkerDiedError(RuntimeError):
    """The process that ran an item ended without an answer."""


@dataclass(frozen=True)
class Started(Generic[Item]):
    """An item was handed to a free worker."""

    item: Item


@dataclass(frozen=True)
class Ended(Generic[Item, Answer]):
    """An item has its answer, or the exception that came in its place, after some seconds."""

    item: Item
    answer: Answer | Exception
    seconds: float = 0.0


@dataclass(frozen=True)
class Running(Generic[Item]):
    """Nothing ended for a while: what runs, and since when (s)."""

    items: tuple[Item, ...]
    seconds: tuple[float, ...]


Event = Started[Item] | Ended[Item, Answer] | Running[Item]


@dataclass(frozen=True)
class _Run(Generic[Item]):
    """An item that a worker has, since when, and whether a worker has died of it before."""

    item: Item
    begun: float
    again: bool

    @property
    def seconds(self) -> float:
        """So far."""
        return time.monotonic() - self.begun


def run_in_processes(
    function: Callable[[Item], Answer],
    items: Iterable[Item],
    jobs: int,
    pulse: float = PULSE,
    opener: Opener = local_processes,
    limit: Callable[[Item], float] | None = None,
) -> Generator[Event[Item, Answer], None, None]:
    """Events of all items, which start in the order given and end in any; `Running` ones every `pulse` seconds.

    The function is importable by name, or a `functools.partial` of such a one; items can be pickled. An opener
    (executors.py) with workers of its own ignores `jobs`, the workers at a time. An item that reaches its limit in
    seconds ends with `TimeoutError`, and its process with it; on processes of this machine alone.
    KeyboardInterrupt is raised after workers are ended; answers of events already given are the caller's.
    """
    waiting, suspects = deque((item, False) for item in items), deque[Item]()
    running: dict[Future[Answer], _Run[Item]] = {}
    if not waiting:
        return
    with opener(min(jobs, len(waiting))) as pool:
        while waiting or running or suspects:
            if not waiting and not running:
                waiting.append((suspects.popleft(), True))  # alone: it may be guilty of nothing
            while waiting and len(running) < pool.capacity():
                item, again = waiting.popleft()
                future = pool.executor.submit(on_one_thread, function, item)
                running[future] = _Run(item, time.monotonic(), again)
                if not again:
                    yield Started(item)
            left = {future: limit(run.item) - run.seconds for future, run in running.items()} if limit else {}
            finished, _ = wait(running, max(0.0, min([pulse, *left.values()])), FIRST_COMPLETED)
            late = [f for f, run in running.items() if limit and f not in finished and run.seconds > limit(run.item)]
            if not finished and not late:
                yield Running(tuple(r.item for r in running.values()), tuple(r.seconds for r in running.values()))
            for future in late:
                pool.end(future)
            for future in (*finished, *late):
                run = running.pop(future)
                answer: Answer | Exception = TimeoutError(f"no answer in {run.seconds:.0f} s")
                if future not in late:
                    answer = _answer(future)
                if isinstance(answer, WorkerDiedError) and not run.again:
                    suspects.append(run.item)
                else:
                    yield Ended(run.item, answer, run.seconds)


def answers_in_order(function: Callable[[Item], Answer], items: Sequence[Item], jobs: int) -> list[Answer | Exception]:
    """Answers of all items, or exceptions in their place, in the order of the items; by processes of this machine."""
    found = dict[int, Answer | Exception]()
    with closing(run_in_processes(partial(_at, function), enumerate(items), jobs)) as events:
        for event in events:
            if isinstance(event, Ended):
                found[event.item[0]] = event.answer
    return [found[place] for place in range(len(items))]


def _at(function: Callable[[Item], Answer], placed: tuple[int, Item]) -> Answer:
    return function(placed[1])


def _answer(future: Future[Answer]) -> Answer | Exception:
    """The answer of a finished future, or its exception; an interrupt is raised."""
    try:
        return future.result()
    except BrokenProcessPool:
        return WorkerDiedError("the worker process ended without an answer")
    except SystemExit as error:
        return RuntimeError(f"SystemExit: {error}")
    except Exception as error:
        return error
