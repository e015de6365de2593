"""Hooks of pytest: options, levels, the fixture `rows`, judgement at the end of a case, who runs what.

A case is a test in test_*.py, or a scene with expected numbers (case_*.toml).  Its mark `quick`, `standard` or `full`
names the lowest level at which it runs; without a mark it runs at every level.
"""

from __future__ import annotations

import faulthandler
import inspect
import json
import signal
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from threadpoolctl import threadpool_limits

from validation.plugin import stored
from validation.plugin.case_rows import RowFailure, case_key, rows_of, stored_file
from validation.plugin.ledger import Ledger
from validation.plugin.own_cases import SceneFile
from validation.plugin.rows import Rows
from validation.plugin.verify import LEVELS, OPTIONS

FINISHED = pytest.StashKey[set[str]]()
LIMIT = 900.0  # s for a case without a mark `timeout`


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of a run."""
    group = parser.getgroup("validation")
    for name, keywords in OPTIONS.items():
        group.addoption(name, **keywords)
    group.addoption("--report", type=Path, metavar="DIR", help="write report.html, report.json and rows.jsonl")
    group.addoption("--unstored", action="store_true", help="judge without stored errors, while a case is written")
    group.addoption("--command", metavar="TEXT", default="", help="shown in the report")


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marks, limit the threads, and begin the ledger in the controller."""
    for level in LEVELS:
        config.addinivalue_line("markers", f"{level}: the lowest level at which the case runs (without: quick)")
    config.addinivalue_line("markers", f"timeout(seconds): time limit of a case (without: {LIMIT:g})")
    threadpool_limits(1)
    worker = getattr(config, "workerinput", None)
    if worker is not None:
        config.stash[FINISHED] = set(worker["validation_finished"])
        return
    if config.option.resume and not config.option.report:
        raise pytest.UsageError("--resume: needs --report DIR, the folder of the run to continue")
    if config.option.store and not config.option.reason.strip():
        raise pytest.UsageError("--store: needs --reason TEXT, why the stored numbers change")
    ledger = Ledger(config)
    config.stash[FINISHED] = set(ledger.resumed)
    config.pluginmanager.register(ledger, "validation-ledger")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect a scene with expected numbers."""
    if file_path.suffix == ".toml" and file_path.name.startswith("case_"):
        return SceneFile.from_parent(parent, path=file_path)
    return None


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect cases above the level, unless they or their file are named, and cases kept from an earlier run."""
    orphans = orphans_of(config, items)
    highest, only = LEVELS.index(config.option.level), (config.option.only or "").lower()
    named = names_files(config) or bool(config.option.keyword)
    exact = only in {item.nodeid.lower() for item in items}  # as the report names a case
    chosen, others = list[pytest.Item](), list[pytest.Item]()
    for item in items:
        runs = named or LEVELS.index(level_of(item)) <= highest
        if only:
            runs = only == item.nodeid.lower() if exact else only in item.nodeid.lower()
        (chosen if runs and item.nodeid not in config.stash[FINISHED] else others).append(item)
    if others:
        config.hook.pytest_deselected(items=others)
    items[:] = orphans + chosen


def names_files(config: pytest.Config) -> bool:
    """Return True if an argument of pytest is a file, or a case in a file."""
    return any(Path(str(argument).partition("::")[0]).is_file() for argument in config.args)


class Orphans(pytest.Item):
    """Failed case for stored numbers whose cases do not exist."""

    message = ""

    def runtest(self) -> None:
        """Fail with the message of the item."""
        raise RowFailure(self.message)


def orphans_of(config: pytest.Config, items: list[pytest.Item]) -> list[pytest.Item]:
    """Return a failed case if stored.csv has lines of a case that its folder does not have.

    The list is empty if files or names of cases were chosen, or while numbers are stored.
    """
    option = config.option
    if names_files(config) or option.keyword or option.only or option.store:
        return []
    cases: dict[Path, set[str]] = {}
    for item in items:
        if (file := stored_file(item)) is not None:
            cases.setdefault(file, set()).add(case_key(item, file))
    failed = list[pytest.Item]()
    for file, names in cases.items():
        orphans = sorted({case for case, _ in stored.read(file)} - names)
        if orphans:
            item = Orphans.from_parent(items[0].session, name="stored.csv")
            item.message = f"{file}: stored numbers of cases that do not exist: {', '.join(orphans)}; delete the lines"
            failed.append(item)
    return failed


def level_of(item: pytest.Item) -> str:
    """Return the level of a case, by its mark."""
    return next((level for level in LEVELS if item.get_closest_marker(level)), LEVELS[0])


@pytest.fixture
def rows(request: pytest.FixtureRequest) -> Rows:
    """Return the rows of a case; the case fails at its end if a row fails, with --pdb at once."""
    return rows_of(request.node)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, object, object]:
    """Limit the time of the fixtures."""
    with limited(item):
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """Limit the time of a case, and judge its rows when it ends."""
    with limited(item):
        outcome = yield
    rows_of(item).conclude()
    return outcome


@contextmanager
def limited(item: pytest.Item) -> Iterator[None]:
    """Fail after the time limit of a case; end its worker if it stays outside Python for `--grace` more seconds."""
    mark = item.get_closest_marker("timeout")
    limit = float(mark.args[0]) if mark and mark.args else LIMIT

    def stop(*_: object) -> None:
        raise RowFailure(f"{item.nodeid}: no end within its time limit of {limit:g} s")

    by_signal = hasattr(signal, "SIGALRM") and not item.config.pluginmanager.hasplugin("timeout")
    if hasattr(item.config, "workerinput"):
        faulthandler.dump_traceback_later(limit + item.config.option.grace, exit=True)
    if by_signal:
        before = signal.signal(signal.SIGALRM, stop)
        signal.setitimer(signal.ITIMER_REAL, limit)
    try:
        yield
    finally:
        if by_signal:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)
        faulthandler.cancel_dump_traceback_later()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Attach the rows to the report of the test, also where it failed half way.

    They travel as one JSON text, because a worker of xdist sends plain types only.
    """
    report = yield
    if call.when == "call" or (call.when == "setup" and not report.passed):
        file = stored_file(item)
        function: Any = getattr(item, "function", None)
        facts = rows_of(item).content() | {
            "question": (getattr(function, "__doc__", "") or "").strip() or item.name,
            "method": (getattr(getattr(item, "module", None), "__doc__", "") or "").strip(),
            "source": _source(item),
            "level": level_of(item),
            "stored_in": str(file or ""),
            "key": case_key(item, file) if file else item.nodeid,
        }
        report.user_properties.append(("validation", json.dumps(facts, default=float)))
    return report


def _source(item: pytest.Item) -> str:
    """Return the text of a case: its function, or its scene file."""
    if (function := getattr(item, "function", None)) is not None:
        return inspect.getsource(function)
    return item.path.read_text("utf-8") if item.path.is_file() else ""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give the cases of a file, which share its fixtures, to one worker, and spread cases with parameters.

    `--dist loadgroup` is no help: pytest 9.2 ignores the groups of xdist 3.8 (pytest-xdist issue 1386).
    """
    from validation.plugin.scheduler import ByFile

    return ByFile(config, log)
