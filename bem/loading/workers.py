"""Worker processes for the parts of a step (crew.py): what all parts share is sent once, to each process."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context, parent_process
from typing import Any, Generic, TypeVar

from threadpoolctl import threadpool_limits

Part = TypeVar("Part")
Answer = TypeVar("Answer")
Shared = TypeVar("Shared")

ENDED = "a worker process ended: it was killed, memory ran out, or a script asks for jobs outside of `__main__`"

_kept: Any = None  # in a worker: what the parts share


class Workers(Generic[Shared]):
    """Processes that keep what all parts share.

    Attributes
    ----------
    cpu_seconds : float
        Of their work so far.
    """

    def __init__(self, size: int, shared: Shared) -> None:
        self.cpu_seconds = 0.0
        self._executor = ProcessPoolExecutor(size, get_context("spawn"), _begin, (shared,))
        self._beginning = [self._executor.submit(os.getpid) for _ in range(size)]

    @property
    def ready(self) -> bool:
        """Whether all have begun."""
        return all(one.done() for one in self._beginning)

    def each(self, function: Callable[[Shared, Part], Answer], parts: Iterable[Part]) -> Iterator[Answer]:
        """Yield function(shared, part) of each part, in their order.

        Raises
        ------
        ChildProcessError
            A worker was killed.
        """
        try:
            for answer, seconds in self._executor.map(partial(_at_work, function), parts):
                self.cpu_seconds += seconds
                yield answer
        except BrokenProcessPool as error:
            raise ChildProcessError(ENDED) from error

    def end(self) -> None:
        """End them."""
        self._executor.shutdown(cancel_futures=True)


def obey_parent() -> None:
    """In a worker: an interrupt is its parent's to handle, and it ends with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A worker whose parent was killed would wait for ever for work that nobody hands out."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _begin(shared: object) -> None:
    """Begin a worker, on one BLAS thread."""
    global _kept
    _kept = shared
    threadpool_limits(limits=1, user_api="blas")
    obey_parent()


def _at_work(function: Callable[[Any, Part], Answer], part: Part) -> tuple[Answer, float]:
    """What a part comes to in a worker, and the seconds it took."""
    begun = time.process_time()
    return function(_kept, part), time.process_time() - begun
