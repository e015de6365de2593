"""One interface to all that can run work elsewhere: a `concurrent.futures.Executor`, opened by a short text.

`local`               processes of this machine, started afresh (spawn), one BLAS thread each, ended with their parent
`dask://host:port`    the workers of a dask scheduler, by `Client.get_executor` of `distributed` (extra `cluster`)

Work is a function importable by name with arguments that can be pickled.  A dask worker that dies has its work done
again by another one, at most as often as the scheduler allows; a scheduler that dies is a ConnectionError; the work of
a local one ends with BrokenProcessPool, and nobody else's does.  (pebble, whose pools have time limits, was tried: work
that ends its process with exit code 0 is never reported there.)
"""

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits

from bem.loading.workers import obey_parent

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
LOCAL, DASK = "local", "dask://"
PATIENCE = 30.0  # s for a scheduler to answer and to have a worker

Item = TypeVar("Item")
Answer = TypeVar("Answer")


class ExecutorError(ValueError):
    """An executor that is unknown, not installed or out of reach."""


@dataclass(frozen=True)
class Workers:
    """An open executor, how many items it runs at once, asked anew whenever work is handed out, and how to end one."""

    executor: Executor
    capacity: Callable[[], int]
    end: Callable[[Future[Any]], None] = lambda future: None  # the process that works on it


Opener = Callable[[int], AbstractContextManager[Workers]]


def opener_of(spec: str) -> Opener:
    """The function that opens the executor of this text, given the number of local processes.

    ExecutorError where it is neither `local` nor `dask://host:port`.

    Examples
    --------
    >>> opener_of("local") is local_processes
    True
    >>> opener_of("slurm")
    Traceback (most recent call last):
    ...
    validation.harness.executors.ExecutorError: --executor 'slurm': neither 'local' nor 'dask://host:port'
    """
    if spec == LOCAL:
        return local_processes
    host, _, port = spec.removeprefix(DASK).rpartition(":")
    if spec.startswith(DASK) and host and port.isdecimal():
        return partial(_dask_workers, f"tcp://{host}:{port}")
    raise ExecutorError(f"--executor {spec!r}: neither {LOCAL!r} nor '{DASK}host:port'")


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


@contextmanager
def _dask_workers(address: str, _: int) -> Iterator[Workers]:
    """The workers of a scheduler, which stay when the connection is closed; work not finished is cancelled."""
    try:
        distributed = import_module("distributed")
    except ImportError as error:
        raise ExecutorError(f"{address}: needs the extra 'cluster' (pip install linecontact[cluster])") from error
    try:
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError) as error:
        raise ExecutorError(f"{address}: no dask scheduler answers ({error})") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise ExecutorError(f"{address}: the scheduler has no workers") from error
        executor = client.get_executor(pure=False)
        try:
            yield Workers(executor, lambda: max(1, sum(client.ncores().values())))
        except import_module("distributed.comm").CommClosedError as error:
            raise ConnectionError(f"{address}: the scheduler is gone; what was finished is kept") from error
        finally:
            executor.shutdown(wait=False)


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
