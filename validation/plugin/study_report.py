"""Report of a study: rows that were made without pytest, in the form of the verification report."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from validation.harness.provenance import provenance
from validation.plugin.content import content_of
from validation.plugin.rows import PASSING, Rows
from validation.report.verification_page import write

BEGUN = time.monotonic()


@dataclass(frozen=True)
class Part:
    """Question of a study with its rows; a part that raised has a `message` and fails."""

    name: str
    question: str
    rows: Rows = field(default_factory=Rows)
    method: str = ""
    seconds: float = 0.0
    message: str = ""

    def case(self) -> dict[str, Any]:
        """Return the part as the report holds a case."""
        failing = any(row.verdict not in PASSING for row in self.rows.rows)
        outcome = "error" if self.message else "deviates" if failing else "passed"
        return self.rows.content() | {
            "case": self.name,
            "question": self.question,
            "method": self.method,
            "source": "",
            "level": "",
            "seconds": self.seconds,
            "outcome": outcome,
            "message": self.message
            or "; ".join(row.described() for row in self.rows.rows if row.verdict not in PASSING),
        }


def write_study(
    folder: Path,
    command: str,
    parts: Sequence[Part],
    *,
    level: str = "study",
    statements: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Write report.json and report.html; return the content, whose "failed" counts parts that failed.

    `statements` of the paper are tables with the keys statement, printed, ours, uncertainty, verdict.
    """
    content = content_of(
        {
            "level": level,
            "command": command,
            "seconds": round(time.monotonic() - BEGUN, 1),
            "not_run": [],
            "statements": statements,
            "cases": [part.case() for part in parts],
            "provenance": provenance(),
        }
    )
    write(folder, content)
    return content
