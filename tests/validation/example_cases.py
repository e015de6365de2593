"""Cases that agree, crash, die, are skipped, or count how often they ran; importable by worker processes."""

import os
import signal
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from validation.harness.case import Case, Outcome
from validation.harness.schema import Reference, Row, Tolerance


def _row(computed: float) -> Row:
    return Row(
        quantity="load",
        unit="N/m",
        reference=Reference(kind="exact", source="closed form"),
        norm="absolute",
        expected=[1.0],
        computed=[computed],
        tolerance=Tolerance(value=0.1, measured=0.04),
    )


def agree() -> Outcome:
    return Outcome(rows=(_row(1.0),), counts={"unknowns": 7})


def deviate() -> Outcome:
    return Outcome(rows=(_row(1.5),))


def wait() -> Outcome:
    """Like the solver, an interrupt ends it early with an answer, which must not be taken for the whole."""
    try:
        time.sleep(600)
    except KeyboardInterrupt:
        return agree()
    raise AssertionError("it should have been ended")


def dawdle() -> Outcome:
    time.sleep(1.5)
    return agree()


def call(compute: Callable[[], Outcome]) -> Outcome:
    return compute()


def crash() -> Outcome:
    raise ZeroDivisionError("the matrix is singular")


def leave() -> Outcome:
    raise SystemExit("gone")


def die() -> Outcome:
    os._exit(9)


def skip() -> Outcome:
    return Outcome(skipped="the extra 'peers' is not installed")


def interrupt() -> Outcome:
    raise KeyboardInterrupt


def note(folder: str) -> Outcome:
    with (Path(folder) / "runs").open("a") as stream:
        stream.write("x")
    return agree()


def threads() -> Outcome:
    import numpy  # noqa: F401  (loads the BLAS whose threads are counted)
    from threadpoolctl import threadpool_info

    return Outcome(rows=(_row(1.0),), counts={"threads": max(pool["num_threads"] for pool in threadpool_info())})


def interrupts() -> Outcome:
    return Outcome(rows=(_row(1.0),), counts={"ignored": int(signal.getsignal(signal.SIGINT) is signal.SIG_IGN)})


def case(name: str, compute: object, **changes: object) -> Case:
    plain = {
        "id": name,
        "group": "g",
        "level": "quick",
        "question": "q?",
        "equations": "e",
        "sources": ("johnson1995",),
    }
    return Case(**(plain | {"compute": compute} | changes))


def noting(folder: Path, name: str = "note") -> Case:
    return case(name, partial(note, str(folder)))
