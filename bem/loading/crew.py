"""Independent parts of a step, in one process or several; what comes of them depends neither on order nor number."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from functools import partial
from importlib import import_module
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from bem.loading.workers import Workers

Part = TypeVar("Part")
Answer = TypeVar("Answer")
Shared = TypeVar("Shared")

MANY = 6  # speed: parts of a step with which processes start


class Crew(AbstractContextManager["Crew"]):
    """Those that work at parts of steps, to be closed.

    Worker processes start with the first step of many parts, and work as soon as they are ready.

    Parameters
    ----------
    size : int
        Processes at most; with one the work is done where it is asked for.

    Raises
    ------
    ValueError
        No process.
    """

    def __init__(self, size: int = 1) -> None:
        if size < 1:
            raise ValueError(f"jobs = {size}; allowed: an integer >= 1")
        self.size = size
        self._workers: Workers[Any] | None = None

    def each(
        self, function: Callable[[Shared, Part], Answer], shared: Shared, parts: Sequence[Part]
    ) -> Iterator[Answer]:
        """What function(shared, part) is for each part, in their order; `shared` is the same at every call.

        ChildProcessError where a worker is killed.
        """
        if self._workers is None and self.size > 1 and len(parts) >= MANY:
            size = min(self.size, len(parts))
            self._workers = import_module("bem.loading.workers").Workers(size, shared)
        if self._workers is None or not self._workers.ready:
            return map(partial(function, shared), parts)
        return self._workers.each(function, parts)

    @property
    def cpu_seconds(self) -> float:
        """What the work took in other processes."""
        return 0.0 if self._workers is None else self._workers.cpu_seconds

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._workers is not None:
            self._workers.end()
