"""Controller's part of a run: what was planned and found, rows.jsonl, progress, stored errors, the report.

Every finished case is appended to DIR/rows.jsonl at once, so that a run that was killed continues with --resume.  The
first line of rows.jsonl is the fingerprint of everything that a row depends on.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from validation.harness.provenance import fingerprint, provenance
from validation.plugin import stored
from validation.plugin.content import content_of
from validation.plugin.rows import PASSING, Row

RECORD = "rows.jsonl"
EMPTY: dict[str, Any] = dict.fromkeys(("question", "method", "source", "level", "stored_in", "key"), "")
EMPTY |= {name: [] for name in ("rows", "figures", "tables", "costs")} | {"statements": {}}
CASES = Path(__file__).parents[1] / "cases"
INTERRUPTED = 2  # exit status of pytest


class Ledger:
    """Record of a run; registered as a plugin of pytest in the controller alone."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.folder: Path | None = config.option.report
        self.begun = time.monotonic()
        self.cases: dict[str, dict[str, Any]] = {}
        self.planned: list[str] = []
        self.setups: dict[str, float] = {}  # seconds of fixtures, by case
        places = [Path(str(argument).partition("::")[0]) for argument in config.args]
        self.whole = CASES in places and not config.option.only  # the verification, no part of it and no other cases
        self.fingerprint = fingerprint(places, without=self.folder)
        self.resumed = self._kept() if config.option.resume else {}
        if config.option.store:
            try:
                stored.refuse_changes(config.rootpath)
            except stored.StoreError as error:
                raise pytest.UsageError(str(error)) from error
        if self.folder and not config.option.collectonly:
            self.folder.mkdir(parents=True, exist_ok=True)
            lines = [{"fingerprint": self.fingerprint}, *self.resumed.values()]
            (self.folder / RECORD).write_text("".join(json.dumps(line) + "\n" for line in lines), "utf-8")

    def _kept(self) -> dict[str, dict[str, Any]]:
        """Return the cases that passed in an earlier run with the present sources; a torn last line is left out."""
        assert self.folder is not None
        path, lines = self.folder / RECORD, list[dict[str, Any]]()
        for text in path.read_text("utf-8").splitlines() if path.exists() else []:
            try:
                line = json.loads(text)
            except ValueError:
                continue
            if isinstance(line, dict):
                lines.append(line)
        if not lines or lines[0].get("fingerprint") != self.fingerprint:
            return {}
        return {line["case"]: line for line in lines[1:] if line.get("outcome") == "passed"}

    @pytest.hookimpl(optionalhook=True)
    def pytest_configure_node(self, node: Any) -> None:
        """Send every worker, also a replacement of a dead worker, the finished cases, so that all collect alike."""
        node.workerinput["validation_finished"] = list(self.resumed)

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Record the planned cases of a run without workers."""
        self.planned = self.planned or [item.nodeid for item in session.items]

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_node_collection_finished(self, node: Any, ids: list[str]) -> None:
        """Record the planned cases as a worker collected them."""
        self.planned = list(ids)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Record a file that cannot be imported or read as a case that failed."""
        if report.failed:
            case = {"case": report.nodeid, "outcome": "error", "seconds": 0.0, "message": report.longreprtext}
            self._record(EMPTY | case | {"question": report.nodeid})

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Record a case that ended, could not begin, or killed its worker."""
        text: Any = dict(report.user_properties).get("validation")
        if report.when == "teardown" and report.failed and report.nodeid in self.cases:
            self._record(self.cases[report.nodeid] | {"outcome": "error", "message": report.longreprtext})
        if report.when == "setup":
            self.setups[report.nodeid] = report.duration
        if report.when == "teardown" or (text is None and not report.failed):
            return
        facts = json.loads(text) if text else EMPTY | {"question": report.nodeid.rpartition("::")[2]}
        failing = any(Row(**row).verdict not in PASSING for row in facts["rows"])
        outcome = report.outcome if not report.failed else "deviates" if failing else "error"
        message = "" if report.passed else report.longreprtext
        if isinstance(report.longrepr, tuple):  # of a case that is skipped: file, line, reason
            message = str(report.longrepr[2])
        seconds = report.duration + (self.setups.get(report.nodeid, 0.0) if report.when == "call" else 0.0)
        self._record({"case": report.nodeid, "outcome": outcome, "seconds": seconds, "message": message, **facts})

    def _record(self, case: dict[str, Any]) -> None:
        self.cases[case["case"]] = case
        if self.folder:
            with (self.folder / RECORD).open("a", encoding="utf-8") as file:
                file.write(json.dumps(case) + "\n")
        self._tell(case)

    def _tell(self, case: dict[str, Any]) -> None:
        """Print the case and the time left on stderr, where no terminal reporter does."""
        if self.config.pluginmanager.hasplugin("terminalreporter"):
            return
        number, many = len(self.cases) + len(self.resumed), len(self.planned) + len(self.resumed)
        left = self._seconds_left()
        ahead = "" if left is None else f", about {left:.0f} s left"
        print(
            f"[{number}/{max(many, number)}{ahead}] {case['case']}: {case['outcome']} ({case['seconds']:.1f} s)",
            file=sys.stderr,
            flush=True,
        )
        if case["outcome"] != "passed":
            words = "    not run: " if case["outcome"] == "skipped" else ""
            print(f"{words}{case['message']}", file=sys.stderr, flush=True)

    def _seconds_left(self) -> float | None:
        """Return the stored seconds of the cases still to run, scaled by the pace of the finished cases."""
        expected = {case: seconds for case in self.planned if (seconds := self._expected(case)) is not None}
        done = sum(expected.get(case, 0.0) for case in self.cases)
        ahead = sum(seconds for case, seconds in expected.items() if case not in self.cases)
        if done < 1.0:
            return None
        return ahead * (time.monotonic() - self.begun) / done

    def _expected(self, case: str) -> float | None:
        path = self.config.rootpath / case.partition("::")[0]
        file = stored.file_for(path, self.config.rootpath)
        if file is None:
            return None
        return stored.seconds_of(f"{path.relative_to(file.parent).as_posix()}::{case.partition('::')[2]}", file)

    def pytest_sessionfinish(self, session: pytest.Session, exitstatus: int) -> None:
        """Store errors and write the report, also of a run that was interrupted."""
        if self.config.option.collectonly:
            return
        if self.config.option.store:
            self._store()
        if self.folder:
            from validation.report.verification_page import write

            write(self.folder, content_of(self._run(int(exitstatus))))

    def _store(self) -> None:
        option = self.config.option
        passed = [case for case in self.cases.values() if case["outcome"] == "passed" and case["stored_in"]]
        for file in sorted({case["stored_in"] for case in passed}):
            of_file = [case for case in passed if case["stored_in"] == file]
            for line in stored.store(Path(file), of_file, option.reason, option.store == "worst"):
                print(line, file=sys.stderr)

    def _run(self, exit_status: int) -> dict[str, Any]:
        """Return the facts of the run from which the report is made."""
        from validation.paper.statements import Measured, judge

        cases = self.resumed | self.cases
        numbers = {name: Measured(**of) for case in cases.values() for name, of in case["statements"].items()}
        return {
            "level": self.config.option.level,
            "command": self.config.option.command or f"pytest {' '.join(self.config.invocation_params.args)}",
            "exit": exit_status,
            "seconds": round(time.monotonic() - self.begun, 1),
            "statements": judge(numbers, "", "linecontact replicate solves the ensemble")
            if self.whole or numbers
            else [],
            "not_run": [case for case in self.planned if case not in cases],
            "resumed": len(self.resumed),
            "cases": list(cases.values()),
            "provenance": provenance() | {"fingerprint": self.fingerprint},
        }

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        """Print where the report is."""
        if self.folder:
            terminalreporter.write_line(f"report: {self.folder / 'report.html'}")
