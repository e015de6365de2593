"""Runs a function over items in worker processes, one BLAS thread each, and loses no item.

Items are handed out one by one, so that what is reported as running does run.  A worker that dies (out of memory, a
signal) breaks its whole pool: the items that ran there are run again, each alone, so that only the guilty one fails,
and the rest continues in a new pool.  An interrupt ends the workers at once; Ctrl-C in a terminal reaches the parent
only, which decides.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, closing
from dataclasses import dataclass
from typing import Generic, TypeVar

from validation.harness.executors import Opener, local_processes, on_one_thread

PULSE = 5.0  # s between signs of life
TURN = 0.2  # s for which each of several processes is listened to in turn

Item = TypeVar("Item")
Answer = TypeVar("Answer")


class WorkerDiedError(RuntimeError):
    """The process that ran an item ended without an answer."""


@dataclass(frozen=True)
class Started(Generic[Item]):
    """An item was handed to a free worker."""

    item: Item


@dataclass(frozen=True)
class Ended(Generic[Item, Answer]):
    """An item has its answer, or the exception that came in its place."""

    item: Item
    answer: Answer | Exception


@dataclass(frozen=True)
class Running(Generic[Item]):
    """Nothing ended for a while: what runs, and since when (s)."""

    items: tuple[Item, ...]
    seconds: tuple[float, ...]


def run_in_processes(
    function: Callable[[Item], Answer],
    items: Iterable[Item],
    jobs: int,
    pulse: float = PULSE,
    opener: Opener = local_processes,
) -> Generator[Started[Item] | Ended[Item, Answer] | Running[Item], None, None]:
    """Events of all items, which start in the order given and end in any; `Running` ones every `pulse` seconds.

    The function is importable by name, or a `functools.partial` of such a one; items can be pickled. An opener
    (executors.py) with workers of its own ignores `jobs`, the workers at a time. KeyboardInterrupt is raised after
    workers are ended; answers of events already given are the caller's.
    """
    waiting, suspects = deque(items), list[Item]()
    while waiting:
        for event in _one_pool(function, waiting, min(jobs, len(waiting)), pulse, opener):
            if isinstance(event, Ended) and isinstance(event.answer, WorkerDiedError):
                suspects.append(event.item)
            else:
                yield event
    for item in suspects:
        yield from _one_pool(function, deque([item]), 1, pulse, opener)


def run_alone(
    function: Callable[[Item], Answer], item: Item
) -> Generator[Started[Item] | Ended[Item, Answer] | Running[Item], None, None]:
    """Events of one item in a process of its own, so that its memory and time are its own."""
    yield from _one_pool(function, deque([item]), 1, PULSE, local_processes)


def run_in_turn(
    function: Callable[[Item], Answer], items: Iterable[Item], limit: Callable[[Item], float], pulse: float = PULSE
) -> Generator[tuple[Started[Item] | Ended[Item, Answer] | Running[Item], float], None, None]:
    """Events of items one after another in one process, each with the seconds of its item so far.

    An item that reaches its limit, in seconds and looked at every pulse, ends with `TimeoutError`; it and one whose
    process dies cost the others nothing but the start of another process.
    """
    waiting = list(items)
    while waiting:
        begun = time.monotonic()
        with closing(run_in_processes(function, tuple(waiting), 1, pulse)) as events:
            for event in events:
                passed = 0.0 if isinstance(event, Started) else time.monotonic() - begun
                begun = time.monotonic() if isinstance(event, Started) else begun
                if isinstance(event, Running) and passed > limit(event.items[0]):
                    event = Ended(event.items[0], TimeoutError(f"no answer in {passed:.0f} s"))
                yield event, passed
                if isinstance(event, Ended):
                    waiting.remove(event.item)
                    if isinstance(event.answer, TimeoutError):
                        break


def run_each_alone(
    function: Callable[[Item], Answer], items: Iterable[Item], jobs: int
) -> Generator[Started[Item] | Ended[Item, Answer], None, None]:
    """Events of all items, each in a new process of its own, up to `jobs` at a time; an interrupt ends these first.

    For functions that change the code they run in, whose traces the next item must not find.
    """
    waiting = deque(items)
    with ExitStack() as stack:
        active: list[Generator[Started[Item] | Ended[Item, Answer] | Running[Item], None, None]] = []
        while waiting or active:
            while waiting and len(active) < jobs:
                active.append(_one_pool(function, deque([waiting.popleft()]), 1, TURN, local_processes))
                stack.callback(active[-1].close)
            for events in tuple(active):
                event = next(events, None)
                if event is None:
                    active.remove(events)
                elif not isinstance(event, Running):
                    yield event


def _one_pool(
    function: Callable[[Item], Answer], waiting: deque[Item], workers: int, pulse: float, opener: Opener
) -> Generator[Started[Item] | Ended[Item, Answer] | Running[Item], None, None]:
    """Events until nothing waits, or until the pool breaks; then all that ran ends with `WorkerDiedError`."""
    running: dict[Future[Answer], tuple[Item, float]] = {}
    broken = False
    with opener(workers) as pool:
        while running or (waiting and not broken):
            while waiting and not broken and len(running) < pool.capacity():
                try:
                    future = pool.executor.submit(on_one_thread, function, waiting[0])
                except BrokenProcessPool:
                    broken = True
                    break
                running[future] = waiting.popleft(), time.monotonic()
                yield Started(running[future][0])
            finished, _ = wait(running, timeout=pulse, return_when=FIRST_COMPLETED)
            if running and not finished:
                now = time.monotonic()
                yield Running(
                    tuple(item for item, _ in running.values()),
                    tuple(now - begun for _, begun in running.values()),
                )
            for future in finished:
                item, _ = running.pop(future)
                answer = _answer(future)
                broken = broken or isinstance(answer, WorkerDiedError)
                yield Ended(item, answer)


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
