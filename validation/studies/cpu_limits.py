"""Plugin of pytest: a test that takes more CPU seconds than limits.json says ends the run (for mutants.py).

Seconds of the clock would depend on what else the machine does.
"""

import json
import resource
import time
from pathlib import Path

import pytest

LIMITS: dict[str, float] = json.loads(Path("limits.json").read_text("utf-8"))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Set the limit of a test; beyond it SIGXCPU ends the process."""
    limit = int(time.process_time() + LIMITS[item.nodeid]) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.getrlimit(resource.RLIMIT_CPU)[1]))
