"""How long tests took, and another run of the quickest of them: few tests take most of the time.

`--seconds FILE` writes what every test took, set up and taken down. With `--quickest SHARE` it is read instead: tests
are run from the quickest on until they took that share of all, so that the choice does not depend on the machine's
pace; a test that is not in the file is run. bash .ci/run repeats tests in this way on other kernels.
"""

import json
from pathlib import Path

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--seconds", type=Path, metavar="FILE", help="write how long tests take; read by --quickest")
    parser.addoption("--quickest", type=float, metavar="SHARE", help="the quickest tests, which took this share")


def pytest_configure(config: pytest.Config) -> None:
    writes = config.getoption("--seconds") and config.getoption("--quickest") is None
    if writes and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Seconds(config.getoption("--seconds")))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    share = config.getoption("--quickest")
    if share is None:
        return
    taken = json.loads(config.getoption("--seconds").read_text())
    known = {item.nodeid: taken[item.nodeid] for item in items if item.nodeid in taken}
    left_out = slowest(known, share)
    config.hook.pytest_deselected(items=[item for item in items if item.nodeid in left_out])
    items[:] = [item for item in items if item.nodeid not in left_out]


def slowest(taken: dict[str, float], share: float) -> set[str]:
    """Tests without which the others, the quickest, took at most this share of the seconds of all."""
    spent, most, found = 0.0, share * sum(taken.values()), set()
    for name, seconds in sorted(taken.items(), key=lambda test: test[1]):
        spent += seconds
        if spent > most:
            found.add(name)
    return found


class Seconds:
    """Adds up what every test takes."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.taken: dict[str, float] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.taken[report.nodeid] = self.taken.get(report.nodeid, 0.0) + report.duration

    def pytest_sessionfinish(self) -> None:
        self.file.write_text(json.dumps(self.taken))
