"""One interface to all that can run work elsewhere: a `concurrent.futures.Executor`, opened by a short text.

`local`               processes of this machine, started afresh (spawn), one BLAS thread each, ended with their parent
`dask://host:port`    the workers of a dask scheduler, by `Client.get_executor` of `distributed` (extra `cluster`)

Work is a function importable by name with arguments that can be pickled.  A dask worker that dies has its work done
again by another one, at most as often as the scheduler allows; a scheduler that dies is a ConnectionError; a local
worker breaks its pool, which execution.py mends.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from typing import TypeVar

from threadpoolctl import threadpool_limits

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
LOCAL, DASK = "local", "dask://"
PATIENCE = 30.0  # s for a scheduler to answer and to have a worker

Item = TypeVar("Item")
Answer = TypeVar("Answer")


class ExecutorError(ValueError):
    """An executor that is unknown, not installed or out of reach."""


@dataclass(frozen=True)
class Workers:
    """An open executor and how many items it runs at once, asked anew whenever work is handed out."""

    executor: Executor
    capacity: Callable[[], int]


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
def local_processes(workers: int) -> Iterator[Workers]:
    """Processes of this machine; an exception, an interrupt among them, ends them at once."""
    others = set(multiprocessing.active_children())
    context = multiprocessing.get_context("spawn")
    with _one_thread_each(), ProcessPoolExecutor(workers, mp_context=context, initializer=_begin_worker) as pool:
        try:
            yield Workers(pool, lambda: workers)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in set(multiprocessing.active_children()) - others:
                process.terminate()
            raise


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


def _begin_worker() -> None:
    """In a new process: an interrupted solver would hand back a part of its path as if it were the whole."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A worker whose parent was killed would wait for ever for work that nobody hands out."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


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
