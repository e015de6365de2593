"""Worker processes for the parts of a step (crew.py).

Workers of loky do not run the script of their parent again, so that a script needs no main guard.  Data that all parts
share goes to the workers once, through a file.  Through a pipe, a worker that ends while it starts would leave the
parent waiting for ever, because nobody reads the pipe and the data may be more than it holds.
"""

from __future__ import annotations

import os
import pickle
import signal
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from pathlib import Path
from typing import Any, Generic, TypeVar

import psutil
from loky import ProcessPoolExecutor
from threadpoolctl import threadpool_limits

Part = TypeVar("Part")
Answer = TypeVar("Answer")
Shared = TypeVar("Shared")

ENDED = "a worker process ended: it was killed, or memory ran out"
LOOK = 0.5  # speed: s between looks of a worker at its parent

_shared: Any = None  # in a worker: data that all parts share


class Workers(Generic[Shared]):
    """Worker processes that hold the data shared by all parts; end() ends the processes.

    Attributes
    ----------
    cpu_seconds : float
        CPU time of the workers so far.
    """

    def __init__(self, size: int, shared: Shared) -> None:
        self.cpu_seconds = 0.0
        descriptor, name = tempfile.mkstemp(prefix="linecontact-")
        self._file = Path(name)
        with os.fdopen(descriptor, "wb") as file:
            pickle.dump(shared, file, pickle.HIGHEST_PROTOCOL)
        self._executor = ProcessPoolExecutor(size, initializer=_begin, initargs=(name, os.getpid()))
        self._beginning = [self._executor.submit(os.getpid) for _ in range(size)]

    @property
    def ready(self) -> bool:
        """True if all workers have started, or failed to start."""
        return all(start.done() for start in self._beginning)

    def each(self, function: Callable[[Shared, Part], Answer], parts: Iterable[Part]) -> Iterator[Answer]:
        """Yield function(shared, part) of each part, in their order.

        Raises
        ------
        ChildProcessError
            A worker ended.
        """
        try:
            begun = deque(self._executor.submit(_at_work, function, part) for part in parts)
            while begun:  # none is cancelled: ending workers with cancelled parts, loky prints a traceback
                answer, seconds = begun.popleft().result()
                self.cpu_seconds += seconds
                yield answer
        except BrokenProcessPool as error:
            raise ChildProcessError(ENDED) from error

    def end(self) -> None:
        """End the workers."""
        self._executor.shutdown(kill_workers=True)
        self._file.unlink(missing_ok=True)


def _end_with(parent: int) -> None:
    """End this worker when its parent ends, because the worker would wait for ever for new work.

    A parent that has ended stays a zombie as long as whoever started it reads the output that its workers hold open.
    """
    with suppress(psutil.NoSuchProcess):
        process = psutil.Process(parent)
        while process.is_running() and process.status() != psutil.STATUS_ZOMBIE:
            time.sleep(LOOK)
    os._exit(1)


def _begin(shared: str, parent: int) -> None:
    """Start a worker of a parent on one BLAS thread with the contents of the file `shared`.

    The worker leaves interrupts to its parent and ends with it, also if that ended while the worker was starting.
    """
    global _shared
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
    _shared = pickle.loads(Path(shared).read_bytes())  # written by the parent
    threadpool_limits(limits=1, user_api="blas")


def _at_work(function: Callable[[Any, Part], Answer], part: Part) -> tuple[Answer, float]:
    """Return function(shared, part), computed in a worker, and its CPU seconds."""
    begun = time.process_time()
    return function(_shared, part), time.process_time() - begun
