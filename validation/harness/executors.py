"""Worker processes of this machine: started afresh (spawn), one BLAS thread each, ended with their parent.

Work is a function importable by name with arguments that can be pickled.  The work of a process that dies ends with
BrokenProcessPool, and nobody else's does.
"""

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits

from bem.loading.workers import obey_parent

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

Item = TypeVar("Item")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Workers:
    """An open executor, how many items it runs at once, asked anew whenever work is handed out, and how to end one."""

    executor: Executor
    capacity: Callable[[], int]
    end: Callable[[Future[Any]], None] = lambda future: None  # the process that works on it


Opener = Callable[[int], AbstractContextManager[Workers]]


@contextmanager
def local_processes(workers: int, fresh: bool = False) -> Iterator[Workers]:
    """Processes of this machine, for each item a new one where `fresh`; an exception, an interrupt too, ends them."""
    with _one_thread_each():
        processes = Processes(fresh)
        try:
            yield Workers(processes, lambda: workers, processes.end)
        except BaseException:
            processes.end_all()
            raise
        finally:
            processes.shutdown()


fresh_processes: Opener = partial(local_processes, fresh=True)  # so that memory, time and traces are those of an item


class Processes(Executor):
    """Processes of this machine, each behind an executor of its own: one that dies takes nobody else's work with it."""

    def __init__(self, fresh: bool) -> None:
        self._fresh = fresh
        self._idle: list[ProcessPoolExecutor] = []
        self._busy: dict[Future[Any], ProcessPoolExecutor] = {}
        self._process: dict[ProcessPoolExecutor, set[BaseProcess]] = {}

    def submit(self, function: Callable[..., Answer], /, *args: Any, **named: Any) -> Future[Answer]:
        """Work for a process that is idle, or for a new one."""
        for future in [future for future in self._busy if future.done()]:
            self._set_free(future)
        while self._idle:
            slot = self._idle.pop()
            with suppress(BrokenProcessPool):  # it died while nothing was asked of it
                return self._given(slot, slot.submit(function, *args, **named))
        context = multiprocessing.get_context("spawn")
        others, slot = (
            set(multiprocessing.active_children()),
            ProcessPoolExecutor(1, mp_context=context, initializer=obey_parent),
        )
        future = self._given(slot, slot.submit(function, *args, **named))
        self._process[slot] = set(multiprocessing.active_children()) - others
        return future

    def end(self, future: Future[Any]) -> None:
        """End the process that works on it."""
        for process in self._process.get(self._busy[future], ()):
            process.kill()

    def end_all(self) -> None:
        """End all processes that still work."""
        for future in self._busy:
            self.end(future)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Wait for the processes, and let them go."""
        for slot in (*self._idle, *self._busy.values()):
            slot.shutdown(wait, cancel_futures=cancel_futures)

    def _given(self, slot: ProcessPoolExecutor, future: Future[Answer]) -> Future[Answer]:
        self._busy[future] = slot
        return future

    def _set_free(self, future: Future[Any]) -> None:
        slot = self._busy.pop(future)
        if self._fresh or isinstance(future.exception(), BrokenProcessPool):
            slot.shutdown(wait=False)
            del self._process[slot]
        else:
            self._idle.append(slot)


def on_one_thread(function: Callable[[Item], Answer], item: Item) -> Answer:
    """In a worker: libraries loaded before the limit, such as by unpickling, are limited too."""
    threadpool_limits(limits=1)
    return function(item)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """The environment that new processes inherit, with one BLAS thread; put back at the end."""
    before = {name: os.environ.get(name) for name in THREAD_VARIABLES}
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
