"""The process of its own in which a solver is called: problem on stdin, what it returned in a file.

`python -m validation.challenge.worker MODULE:FUNCTION FILE [BYTES]` writes JSON with `status` ("answered", "not
offered", "crashed", "out of memory"), `message`, `values`, `seconds` and `cpu_seconds`; without a problem on stdin
only the solver is looked up.  BYTES is the address space that the process, and each that it starts, may fill.  Imports
nothing of the suite but for a route, MODULE:FUNCTION@SETTING: a solver is measured alone.
"""

import json
import os
import signal
import sys
import threading
import time
import tomllib
import traceback
from ast import literal_eval
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import psutil

PULSE = 0.5  # s between looks at whether the judge lives
LONGEST = 400  # characters of a text of a solver that are kept
GIGABYTE = 10**9  # bytes
MARK = "LINECONTACT_JUDGED"  # variable of the environment by which processes of a call are known


def main(spec: str, file: Path, memory: int | None = None) -> None:
    """Call the solver and store what came back."""
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    sys.path.insert(0, str(Path.cwd()))
    text = sys.stdin.read()
    if memory is not None:
        _limit_memory(memory)
    try:
        solver = solver_of(spec)
        found = called(solver, tomllib.loads(text)) if text else {"status": "found"}
    except MemoryError as error:
        _limit_memory(None)  # to say so
        limit = "" if memory is None else f"more than {memory / GIGABYTE:g} GB; "
        found = {"status": "out of memory", "message": f"{limit}{_said(error)}{_place(error)}"}
    file.write_text(json.dumps(found), "utf-8")
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)  # threads that the solver left do not keep its answers


def solver_of(spec: str) -> Callable[[dict[str, Any]], Any]:
    """The function that `package.module:function` names, or the route that it does at the setting behind an @.

    ValueError where it names none, or the setting is no Python literal.
    """
    module, _, named = spec.partition(":")
    name, _, setting = named.partition("@")
    solver: Any = import_module(module)
    for part in name.split("."):
        solver = getattr(solver, part, None)
    if not callable(solver):
        raise ValueError(f"solver {spec!r}: {module} has no function {name!r}")
    if not setting:
        return solver  # type: ignore[no-any-return]
    behind_the_door = import_module("validation.harness.route").behind_the_door
    return behind_the_door(solver, literal_eval(setting))  # type: ignore[no-any-return]


def called(solver: Callable[[dict[str, Any]], Any], problem: dict[str, Any]) -> dict[str, Any]:
    """What a solver says to a problem, and how long it took; a MemoryError is the caller's."""
    given = with_arrays(problem)
    wall, cpu = time.perf_counter(), _cpu_seconds()
    try:
        answers = solver(given)
    except NotImplementedError as error:
        return {"status": "not offered", "message": cut(str(error)) or "not offered"}
    except MemoryError:
        raise
    except Exception as error:
        return {"status": "crashed", "message": f"{_said(error)}{_place(error)}"}
    spent = {"seconds": time.perf_counter() - wall, "cpu_seconds": _cpu_seconds() - cpu}
    if not isinstance(answers, dict):
        return spent | {"status": "crashed", "message": f"a dictionary is needed, it returned {type(answers).__name__}"}
    return spent | {"status": "answered", "values": {cut(str(name)): plain(value) for name, value in answers.items()}}


def cut(text: str) -> str:
    """The first `LONGEST` characters of a text, and three dots where there are more."""
    return text if len(text) <= LONGEST else text[:LONGEST] + "..."


def end_marked(mark: str) -> None:
    """End all processes whose environment has the mark, but this one, in whatever session they are.

    One that was started with another environment is found by its process group alone, if at all.
    """
    ended = True
    while ended:  # until none was started meanwhile
        ended = False
        for process in psutil.process_iter():
            with suppress(psutil.Error, OSError):
                if process.pid != os.getpid() and process.environ().get(MARK) == mark:
                    process.kill()
                    ended = True


def _limit_memory(most: int | None) -> None:
    """Of the address space, in bytes; None: as much as the system allows."""
    try:
        import resource
    except ImportError:  # which the judge has refused
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    allowed = hard if most is None or 0 <= hard < most else most
    resource.setrlimit(resource.RLIMIT_AS, (allowed, hard))


def _said(error: Exception) -> str:
    """Kind and text of an exception."""
    return cut(f"{type(error).__name__}: {error}".removesuffix(": "))


def _place(error: Exception) -> str:
    """File and line of the last frame in the package of the solver; empty where its call itself failed."""
    frames = [one for one in traceback.walk_tb(error.__traceback__) if one[0].f_code.co_filename != __file__]
    packages = [frame.f_globals.get("__name__", "").partition(".")[0] for frame, _ in frames]
    ours = [found for found, package in zip(frames, packages, strict=True) if package == packages[0]]
    if not ours:
        return ""
    frame, line = ours[-1]
    file = Path(frame.f_code.co_filename)
    return f" ({file.relative_to(Path.cwd()) if file.is_relative_to(Path.cwd()) else file}:{line})"


def _end_with(parent: int) -> None:
    """End this process and those that it started when the judge is killed."""
    while os.getppid() == parent:
        time.sleep(PULSE)
    end_marked(os.environ[MARK])
    if hasattr(os, "killpg"):
        os.killpg(os.getpgrp(), signal.SIGKILL)
    os._exit(1)


def _cpu_seconds() -> float:
    """Of this process and of those that it started and that have ended."""
    return time.process_time() + sum(os.times()[2:4])


def with_arrays(data: Any) -> Any:
    """The same with lists of numbers as arrays: what a solver gets."""
    if isinstance(data, dict):
        return {name: with_arrays(value) for name, value in data.items()}
    return np.array(data) if isinstance(data, list) else data


def plain(value: Any) -> Any:
    """A value as JSON holds it; what is no number stays visible as text, an integer beyond all doubles too."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, int) and value.bit_length() > sys.float_info.max_exp:
        return f"an integer of {value.bit_length()} bits"
    return value if value is None or isinstance(value, int | float) else cut(str(value))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), *map(int, sys.argv[3:]))
