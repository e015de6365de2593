"""Independent parts of a step, computed in one process or several; results do not depend on their number."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from importlib import import_module
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from bem.loading.workers import Workers

Part = TypeVar("Part")
Answer = TypeVar("Answer")
Shared = TypeVar("Shared")

Each = Callable[[Callable[[Any, Any], Any], Iterable[Any]], Iterator[Any]]

MANY = 6  # speed: parts of a step with which processes start


@contextmanager
def at_work(size: int, shared: Any) -> Iterator[Each]:
    """Yield each(function, parts), which yields function(shared, part) of each part, in their order.

    With a size of several, worker processes compute the parts; they end with the block, and with this process.

    Raises
    ------
    ChildProcessError
        A worker ended.
    """
    if size == 1:
        yield lambda function, parts: map(partial(function, shared), parts)
        return
    workers = import_module("bem.loading.workers").Workers(size, shared)
    try:
        yield workers.each
    finally:
        workers.end()


class Crew(AbstractContextManager["Crew"]):
    """Pool of worker processes that compute parts of a step in parallel. Close it to end the workers.

    Workers start with the first step of many parts, and take part as soon as they are ready.

    Parameters
    ----------
    size : int
        Processes at most; with one process the work is done in the calling process.

    Raises
    ------
    ValueError
        `size` is less than 1.
    """

    def __init__(self, size: int = 1) -> None:
        if size < 1:
            raise ValueError(f"jobs = {size}; allowed: an integer >= 1")
        self.size = size
        self._workers: Workers[Any] | None = None

    def each(
        self, function: Callable[[Shared, Part], Answer], shared: Shared, parts: Sequence[Part]
    ) -> Iterator[Answer]:
        """Yield function(shared, part) of each part, in their order; `shared` must be equal at every call.

        Raises
        ------
        ChildProcessError
            A worker ended.
        """
        if self._workers is None and self.size > 1 and len(parts) >= MANY:
            size = min(self.size, len(parts))
            self._workers = import_module("bem.loading.workers").Workers(size, shared)
        if self._workers is None or not self._workers.ready:
            return map(partial(function, shared), parts)
        return self._workers.each(function, parts)

    @property
    def cpu_seconds(self) -> float:
        """CPU time of the workers so far, s."""
        return 0.0 if self._workers is None else self._workers.cpu_seconds

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._workers is not None:
            self._workers.end()
