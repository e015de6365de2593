"""Faults put into the running code: a function, method or property is replaced by a wrong one, and its calls counted.

Files are never edited.  A module that took the name by `from m import f` holds the function itself, so the
replacement goes into every loaded module of the four packages, and into the tables of functions that they keep.
What is imported later finds the wrong one in the module that defines it.  A fault leaves traces (tables computed
once, objects made with it), so each is examined in a process of its own: `examine` runs there.  It does not judge:
verdicts are given where no fault is (faults.py).  Limits: constants are not replaced, since nothing would show that
they were used; a case that runs too long is cut off by a signal, on POSIX systems only.  What counts is the time of
the processor, which does not depend on what else the machine does; a case that waits is cut off by the clock.
"""

from __future__ import annotations

import inspect
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, wraps
from importlib import import_module
from types import FrameType
from typing import Any

from validation.harness.case import Case
from validation.harness.registry import registry
from validation.harness.runner import failed_record, record_of
from validation.harness.schema import CaseRecord

WAITS = 10.0  # times the limit: the time by the clock after which a case is cut off, too
PACKAGES = ("bem", "fem_reference", "persson", "validation")
Function = Callable[..., Any]


class FaultError(ValueError):
    """A fault that cannot be put into the code."""


class TooSlowError(RuntimeError):
    """A case took far longer than it does without the fault."""


@dataclass(frozen=True)
class Fault:
    """One wrong piece of code.

    Parameters
    ----------
    id : str
        Lower case words joined by hyphens.
    what : str
        What is wrong, in a few words.
    target : str
        "module:function", "module:Class.method" or "module:Class.property".
    wrong : callable
        From the right function and a size to the wrong function.
    size : str
        What size 1 means, for a fault that can be made smaller; empty when it is there or not.
    """

    id: str
    what: str
    target: str
    wrong: Callable[[Function, float], Function]
    size: str = ""


@dataclass(frozen=True)
class Task:
    """A fault of a size and the cases that are to be run under it; no fault: all targets are counted.

    Parameters
    ----------
    catalogue : str
        Module whose `CATALOGUE` holds the fault.
    fault : str or None
        Its id; None for the control.
    size : float
    cases : tuple of (str, float)
        Ids, and the seconds of the processor after which a case is cut off.
    modules : tuple of str
        Of the registry of cases; empty: all.
    """

    catalogue: str
    fault: str | None
    size: float
    cases: tuple[tuple[str, float], ...]
    modules: tuple[str, ...] = ()


@dataclass(frozen=True)
class Examined:
    """What came out of the cases, without figures, and how often the targets were called in each (by target).

    The seconds of the records are those of the processor.
    `ended` holds (case, message) where the process itself came to an end.
    """

    records: tuple[CaseRecord, ...]
    calls: dict[str, dict[str, int]]
    ended: tuple[tuple[str, str], ...] = ()


@dataclass
class Counter:
    """How often a target was called."""

    calls: int = 0


def unchanged(original: Function, size: float) -> Function:
    """The fault that is none.

    Parameters
    ----------
    original : callable
    size : float
        Of no consequence.
    """
    return original


def scaled(excess: float) -> Callable[[Function, float], Function]:
    """A fault by which the result is wrong by a factor.

    Parameters
    ----------
    excess : float
        The factor is 1 + size times this.

    Examples
    --------
    >>> scaled(1.0)(abs, 0.5)(-2.0)
    3.0
    """

    def wrong(original: Function, size: float) -> Function:
        return lambda *given, **named: original(*given, **named) * (1 + size * excess)

    return wrong


def inject(target: str, wrong: Callable[[Function, float], Function], size: float) -> Counter:
    """Replace a target everywhere; the counter of its calls.

    Parameters
    ----------
    target : str
        As of `Fault`.
    wrong : callable
        From the right function and the size to the wrong function.
    size : float
        1: the fault itself.

    Raises
    ------
    FaultError
        No such target.
    """
    module_name, _, path = target.partition(":")
    try:
        owner: Any = import_module(module_name)
        *parents, name = path.split(".")
        for parent in parents:
            owner = getattr(owner, parent)
        original = inspect.getattr_static(owner, name)
    except (ImportError, AttributeError) as error:
        raise FaultError(f"{target}: {error}") from error
    counter = Counter()

    def replaced(function: Function) -> Function:
        other = wrong(function, size)

        @wraps(function)
        def counted(*given: Any, **named: Any) -> Any:
            counter.calls += 1
            return other(*given, **named)

        return counted

    if isinstance(original, property):
        if original.fget is None:
            raise FaultError(f"{target}: a property that cannot be read")
        setattr(owner, name, property(replaced(original.fget)))
    elif isinstance(original, cached_property):
        cached = cached_property(replaced(original.func))
        cached.__set_name__(owner, name)
        setattr(owner, name, cached)
    elif isinstance(original, classmethod | staticmethod):
        setattr(owner, name, type(original)(replaced(original.__func__)))
    elif not callable(original):
        raise FaultError(f"{target}: neither function, method nor property")
    elif inspect.isclass(owner):
        setattr(owner, name, replaced(original))
    else:
        _replace_everywhere(original, replaced(original), {*PACKAGES, module_name.split(".")[0]})
    return counter


def examine(task: Task) -> Examined:
    """Run the cases of a task; in a process of its own.

    Parameters
    ----------
    task : Task

    Raises
    ------
    FaultError
        A target that does not exist.
    """
    known = {case.id: case for case in (registry(task.modules) if task.modules else registry())}
    faults: Iterable[Fault] = import_module(task.catalogue).CATALOGUE
    if task.fault is None:
        counters = {target: inject(target, unchanged, 0.0) for target in {fault.target for fault in faults}}
    else:
        chosen = next(fault for fault in faults if fault.id == task.fault)
        counters = {chosen.target: inject(chosen.target, chosen.wrong, task.size)}
    records, calls = [], {}
    for name, limit in task.cases:
        before = {target: counter.calls for target, counter in counters.items()}
        records.append(_computed(known[name], limit))
        calls[name] = {target: counter.calls - before[target] for target, counter in counters.items()}
    return Examined(tuple(records), calls)


def _computed(case: Case, limit: float) -> CaseRecord:
    begun = time.process_time()
    try:
        with _cut_off(limit):
            outcome = case.compute()
        record = record_of(case, outcome, time.process_time() - begun)
    except (Exception, SystemExit) as error:
        record = failed_record(case, f"{type(error).__name__}: {error}", time.process_time() - begun)
    return record.model_copy(update={"figures": [], "drawn": [], "tables": [], "scene": ""})


@contextmanager
def _cut_off(limit: float) -> Iterator[None]:
    """Raise `TooSlowError` in the block after `limit` seconds of the processor, `WAITS` times as many by the clock."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        told = f"{limit:.3g} s of the processor" if number == signal.SIGPROF else f"{WAITS * limit:.3g} s"
        raise TooSlowError(f"no answer in {told}")

    timers = (
        (signal.SIGPROF, signal.ITIMER_PROF, limit),
        (signal.SIGALRM, signal.ITIMER_REAL, WAITS * limit),
    )
    before = [signal.signal(number, stop) for number, _, _ in timers]
    for _, timer, seconds in timers:
        signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        for (number, timer, _), handler in zip(timers, before, strict=True):
            signal.setitimer(timer, 0)
            signal.signal(number, handler)


def _replace_everywhere(original: Function, other: Function, packages: set[str]) -> None:
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] not in packages:
            continue
        space = vars(module)
        for key, value in list(space.items()):
            if value is original:
                space[key] = other
            elif isinstance(value, dict) and key != "__builtins__":
                value.update({entry: other for entry, held in value.items() if held is original})
