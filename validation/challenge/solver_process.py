"""A solver called on a problem in a process of its own, with a time limit: whatever it does, the judge goes on.

The solver starts with one BLAS thread, the current folder first on its path, and what it prints kept as text.  At the
time limit, and when it has answered, it is ended with all processes that it started, in a session of their own or not.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import uuid
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from validation.challenge.problem import ChallengeError
from validation.challenge.worker import GIGABYTE, MARK, end_marked
from validation.harness.executors import THREAD_VARIABLES
from validation.harness.route import Answer

TAIL = 400  # characters of what a process that died had printed
LOOK_UP = 120.0  # s for the import of a solver


def look_up(spec: str) -> None:
    """Make sure that a solver can be imported; else ChallengeError with the last line of what was printed."""
    module, _, name = spec.partition(":")
    if not module or not name:
        raise ChallengeError(f"solver {spec!r}: package.module:function is needed")
    found = returned(spec, "", LOOK_UP)
    if found.status != "found":
        last = found.message.strip().splitlines()[-1:] or [found.status]
        raise ChallengeError(f"solver {spec!r}: {last[0]}")


def returned(spec: str, problem: str, limit: float, memory: float | None = None) -> Answer:
    """What a solver returns for the text of a problem within a limit in s, and one in GB for each of its processes."""
    mark = uuid.uuid4().hex
    with tempfile.TemporaryDirectory() as folder:
        file, printed = Path(folder) / "returned.json", Path(folder) / "printed.txt"
        command = [sys.executable, "-m", "validation.challenge.worker", spec, str(file)]
        command += [] if memory is None else [str(int(memory * GIGABYTE))]
        with printed.open("wb") as log:
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=log,
                stderr=subprocess.STDOUT,
                env=_environment() | {MARK: mark},
                start_new_session=True,
            )
            try:
                process.communicate(problem.encode(), limit)
            except subprocess.TimeoutExpired:
                return Answer("timed out", f"no answer in {limit:g} s")
            finally:
                _end(process, mark)
        if not file.exists():
            text = printed.read_bytes().decode("utf-8", "replace")[-TAIL:]
            return Answer("crashed", ": ".join(filter(None, (_ending(process.returncode), text.strip()))))
        content: Mapping[str, Any] = json.loads(file.read_text("utf-8"))
        return Answer(**content)


def _ending(code: int) -> str:
    if code >= 0:
        return f"the process ended with code {code}"
    named = {one.value: one.name for one in signal.Signals}
    return f"the process was ended by {named.get(-code, f'signal {-code}')}"


def _environment() -> dict[str, str]:
    """Ours, with one BLAS thread, and this package where it lies."""
    root = str(Path(__file__).parents[2])
    path = os.pathsep.join(filter(None, (os.environ.get("PYTHONPATH"), root)))
    return {**os.environ, **dict.fromkeys(THREAD_VARIABLES, "1"), "PYTHONPATH": path}


def _end(process: subprocess.Popen[bytes], mark: str) -> None:
    """End a process and those that it started: of its group, and with its mark."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()
    end_marked(mark)
