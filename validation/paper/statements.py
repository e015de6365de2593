"""Statements of the paper (statements.toml), each with its printed number, ours with U, and a verdict.

U is twice the standard error of our number (k = 2).  With d = |ours - printed| and `allowed`, the difference within
which the statement holds (declared before the ensemble was solved, and at most half the distance to the alternative
that the statement excludes):

    reproduced        d + U <= allowed: all of ours +- U lies within what is allowed
    not reproduced    d - U > allowed: all of ours +- U lies outside
    not established   otherwise: the ensemble cannot decide
    not run           the ensemble is not the paper's, or the number does not exist

A statement that two numbers differ (claim = "differs") is judged the other way round: reproduced where d - U >
allowed, not reproduced where d + U <= allowed.  A curvature whose interval ours +- U excludes zero establishes no
straight line (claim = "vanishes"): its statement is at best not established.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan
from pathlib import Path
from typing import Any, Literal

Verdict = Literal["reproduced", "not reproduced", "not established", "not run"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "not reproduced", "not established", "not run")
TABLE = Path(__file__).with_name("statements.toml")


@dataclass(frozen=True)
class Measured:
    """Number of ours with its standard error; `printed` and `excluded` where they are computed from the ensemble too.

    `note` stands beside the verdict, before the note of the statement.
    """

    value: float
    error: float = 0.0
    printed: float | None = None
    excluded: float | None = None
    note: str = ""


@dataclass(frozen=True)
class Statement:
    """Statement of the paper.

    Attributes
    ----------
    measure : name of our number; of the load too, if the statement is made at a load.
    where : place in the paper, and its words.
    quantity : number that stands for the statement.
    allowed : largest difference with which the statement holds.
    printed : the paper's number, or the number that the statement amounts to; NaN if the theory gives the number.
    excluded : number that contradicts the statement.
    claim : relation of the two numbers.
    note : text beside the verdict.
    """

    measure: str
    where: str
    quantity: str
    allowed: float
    printed: float = nan
    excluded: float | None = None
    claim: Literal["equals", "differs", "vanishes"] = "equals"
    note: str = ""

    def judged(self, measured: Measured | None, shortfall: str = "") -> dict[str, Any]:
        """Return the statement with our number and the verdict, as report.json holds it."""
        ours = measured or Measured(nan, nan)
        printed = self.printed if ours.printed is None else ours.printed
        excluded = self.excluded if ours.excluded is None else ours.excluded
        allowed = self.allowed if excluded is None else min(self.allowed, abs(excluded - printed) / 2)
        run = not shortfall and isfinite(ours.value)
        return {
            "statement": f"{self.where}: {self.quantity}",
            "printed": _finite(printed),
            "ours": _finite(ours.value),
            "uncertainty": _finite(2 * ours.error),
            "verdict": self.verdict(ours.value - printed, 2 * ours.error, allowed) if run else "not run",
            "allowed": _finite(allowed),
            "note": shortfall or "; ".join(filter(None, (ours.note, self.note))),
        }

    def verdict(self, difference: float, uncertainty: float, allowed: float) -> Verdict:
        """Return the verdict on a difference of ours and the printed number."""
        inside, outside = abs(difference) + uncertainty <= allowed, abs(difference) - uncertainty > allowed
        if self.claim == "differs":
            inside, outside = outside, inside
        if inside and not (self.claim == "vanishes" and abs(difference) > uncertainty):
            return "reproduced"
        return "not reproduced" if outside else "not established"


def statements() -> list[Statement]:
    """Return the statements of statements.toml; a statement with a list `at` is made at each of these loads."""
    table = []
    for content in tomllib.loads(TABLE.read_text("utf-8"))["statement"]:
        loads = content.pop("at", None)
        statement = Statement(**content)
        table += [statement] if loads is None else [_at(statement, load) for load in loads]
    return table


def _at(statement: Statement, load: float) -> Statement:
    quantity = statement.quantity.format(load=f"{load:g}")
    return replace(statement, measure=f"{statement.measure} {load:g}", quantity=quantity)


def judge(measured: Mapping[str, Measured], shortfall: str, without: str = "") -> list[dict[str, Any]]:
    """Return all statements with their verdicts; `without` is the note of a statement that has no number."""
    return [
        statement.judged(measured.get(statement.measure), shortfall or without * (statement.measure not in measured))
        for statement in statements()
    ]


def headline(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the outcome in one sentence: how many statements were run, with which verdicts."""
    counts = {verdict: sum(row["verdict"] == verdict for row in rows) for verdict in VERDICTS[:-1]}
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    return f"{sum(counts.values())} of {len(rows)} statements run{': ' if verdicts else ''}{verdicts}"


def _finite(value: float) -> float | None:
    return float(value) if isfinite(value) else None
