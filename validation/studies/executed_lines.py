"""Plugin of pytest: which tests execute which lines, and the CPU seconds of each test (for mutants.py).

FOLDER in the environment receives the data of coverage, whose contexts are tests; JUDGED lists the folders of the code.
Lines of fixtures have the file of the tests as their context, because all tests of the file use them.
"""

import json
import os
from collections.abc import Generator
from pathlib import Path
from typing import Any

import coverage
import pytest

FOLDER = Path(os.environ["FOLDER"])
SOURCE = [str(Path.cwd() / name) for name in os.environ["JUDGED"].split()]
RECORDER = coverage.Coverage(str(FOLDER / "part"), config_file=False, source=SOURCE)
SECONDS: dict[str, float] = {}  # of the tests that passed
RECORDER.start()


def cpu() -> float:
    """Return the CPU seconds of this process and its children."""
    return sum(os.times()[:4])


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Measure a test."""
    begun = cpu()
    SECONDS[item.nodeid] = 0.0
    result = yield
    RECORDER.switch_context("")
    if item.nodeid in SECONDS:
        SECONDS[item.nodeid] = round(cpu() - begun, 3)
    return result


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Give lines of fixtures to the file."""
    RECORDER.switch_context(item.nodeid.partition("::")[0])


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call(item: pytest.Item) -> None:
    """Give lines to the test."""
    RECORDER.switch_context(item.nodeid)


def pytest_runtest_logreport(report: Any) -> None:
    """Leave out tests that fail or are skipped."""
    if not report.passed:
        SECONDS.pop(report.nodeid, None)


def pytest_sessionfinish() -> None:
    """Write what was measured."""
    RECORDER.stop()
    RECORDER.save()
    (FOLDER / "part.json").write_text(json.dumps(SECONDS), "utf-8")
