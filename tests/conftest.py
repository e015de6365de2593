"""Options shared by all tests: processes, slow tests on demand, seeds of property tests, BLAS threads, interrupts."""

import signal
from collections.abc import Generator

import pytest
import scipy.linalg  # noqa: F401  (with NumPy's, all BLAS that one_blas_thread has to find loaded)
from hypothesis import settings
from threadpoolctl import threadpool_limits

pytest_plugins = ["quickest", "pytester"]
settings.register_profile("reproducible", derandomize=True, deadline=None)
settings.load_profile("reproducible")
SLOW = "slow: run with --run-slow"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--run-slow", action="store_true", help="also run the tests marked slow")
    parser.addoption("--no-skips", action="store_true", help="what is absent fails a test; only slow ones are skipped")


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """Files and tests that are named run in this process, which begins at once; folders on all processors."""
    return 0 if config.args and all(".py" in name for name in config.args) else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--run-slow"):
        return
    skip = pytest.mark.skip(reason=SLOW)
    for item in items:
        if "slow" in item.keywords:
            item.add_marker(skip)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """With --no-skips a test that is skipped, but for being slow, fails."""
    report = yield
    skipped = report.skipped and not hasattr(report, "wasxfail")
    if skipped and call.excinfo and item.config.getoption("--no-skips") and SLOW not in str(call.excinfo.value):
        report.outcome, report.longrepr = "failed", f"skipped in spite of --no-skips: {call.excinfo.value}"
    return report


@pytest.fixture(autouse=True, scope="session")
def one_blas_thread():
    with threadpool_limits(limits=1):
        yield


@pytest.fixture(autouse=True, scope="session")
def interrupts_are_heard():
    """A shell starts what runs in the background with SIGINT ignored, and programs under test would inherit that."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
