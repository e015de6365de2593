"""Workers that end, at any moment, end the run with one sentence; nobody waits for ever."""

import operator
import os
import signal
import subprocess
import sys
import time

import psutil
import pytest

from bem.loading.crew import MANY, Crew

SHARED = bytes(10_000_000)  # more than a pipe holds
PARTS = tuple(range(MANY))
SCRIPT = """
import operator
from bem.loading.crew import Crew
shared = bytes(10_000_000)
with Crew(2) as crew:
    while not crew.cpu_seconds:
        answers = list(crew.each(operator.getitem, shared, range(6)))
print(answers)
"""


def test_a_script_needs_no_main_guard(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60)
    assert (run.returncode, run.stdout, run.stderr) == (0, "[0, 0, 0, 0, 0, 0]\n", "")


def workers(parent):
    """Return the process numbers of the workers of a process."""
    children = psutil.Process(parent).children()
    return [child.pid for child in children if any("popen_loky" in word for word in child.cmdline())]


@pytest.mark.parametrize("moment", ["start", "work"])
def test_a_killed_worker_ends_the_run_with_its_reason(moment):
    limit = time.monotonic() + 60
    with Crew(2) as crew, pytest.raises(ChildProcessError, match="it was killed"):
        list(crew.each(operator.getitem, SHARED, PARTS))
        while moment == "work" and not crew._workers.ready:
            time.sleep(0.01)
        while not workers(os.getpid()):
            assert time.monotonic() < limit, "no worker was started"
        os.kill(workers(os.getpid())[0], signal.SIGKILL)
        while time.monotonic() < limit:
            list(crew.each(operator.getitem, SHARED, PARTS))


@pytest.mark.parametrize("delay", [0.0, 2.0], ids=["start", "work"])
def test_workers_end_with_a_parent_that_is_killed(tmp_path, delay):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.replace("while not crew.cpu_seconds", "while True"))
    parent = subprocess.Popen([sys.executable, script])
    limit = time.monotonic() + 60
    while len(children := workers(parent.pid)) < 2:
        assert time.monotonic() < limit, "no worker was started"
    time.sleep(delay)
    parent.kill()
    parent.wait()
    while any(psutil.pid_exists(child) for child in children):
        assert time.monotonic() < limit, "a worker outlives its parent"


def test_answers_do_not_depend_on_the_number_of_processes():
    shared = tuple(range(100, 200))
    with Crew(2) as crew:
        alone = list(crew.each(operator.getitem, shared, PARTS))
        while not crew._workers.ready:
            time.sleep(0.01)
        assert list(crew.each(operator.getitem, shared, PARTS)) == alone
        assert crew.cpu_seconds > 0
