"""Statements of the paper, each with its printed number, ours with U, and a verdict.

U is twice the standard error of our number (k = 2).  With d = |ours - printed| and `allowed`, the difference within
which the statement holds (declared before the ensemble was solved, at most half the distance to the alternative that
the statement excludes):

    reproduced        d + U <= allowed: all of ours +- U lies within what is allowed
    not reproduced    d - U > allowed: all of ours +- U lies outside
    not established   otherwise: the ensemble cannot decide
    not run           the ensemble is not the paper's, or the number does not exist

A statement that two numbers differ (`differs`) is judged the other way round: reproduced where d - U > allowed, not
reproduced where d + U <= allowed.  A curvature whose interval ours +- U excludes zero establishes no straight line
(`zero`): its statement is at best not established.

A check compares a number of ours with an exact one; a check that fails makes the command fail.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal

from validation.harness.schema import Figure, Table

Verdict = Literal["reproduced", "not reproduced", "not established", "not run"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "not reproduced", "not established", "not run")


@dataclass(frozen=True)
class Statement:
    """Statement of the paper beside our number.

    Attributes
    ----------
    where : place in the paper, and its words.
    quantity : number that stands for the statement.
    printed : the paper's number, or the number that the statement amounts to.
    ours, uncertainty : our number and U (k = 2).
    allowed : largest difference with which the statement holds.
    alternative : number that contradicts the statement.
    note : text beside the verdict.
    shortfall : reason why the statement is not run; empty where it is.
    differs : whether the statement says that the numbers differ.
    zero : whether the statement says that a quantity vanishes.
    """

    where: str
    quantity: str
    printed: float
    ours: float
    uncertainty: float
    allowed: float
    alternative: float | None = None
    note: str = ""
    shortfall: str = ""
    differs: bool = False
    zero: bool = False

    def __post_init__(self) -> None:
        if self.alternative is not None and self.allowed > abs(self.alternative - self.printed) / 2 * (1 + 1e-12):
            raise ValueError(f"{self.quantity}: allowed {self.allowed:g} does not exclude {self.alternative:g}")

    @property
    def verdict(self) -> Verdict:
        """Verdict by the rule of the module."""
        if self.shortfall or not isfinite(self.ours):
            return "not run"
        difference = abs(self.ours - self.printed)
        inside, outside = difference + self.uncertainty <= self.allowed, difference - self.uncertainty > self.allowed
        if self.differs:
            inside, outside = outside, inside
        if inside and not (self.zero and difference > self.uncertainty):
            return "reproduced"
        return "not reproduced" if outside else "not established"

    def row(self) -> dict[str, Any]:
        """Return the statement as report.json holds it."""
        number = self.ours if isfinite(self.ours) else None
        return {
            "statement": f"{self.where}: {self.quantity}",
            "printed": self.printed,
            "ours": number,
            "uncertainty": self.uncertainty if number is not None and isfinite(self.uncertainty) else None,
            "verdict": self.verdict,
            "allowed": self.allowed,
            "note": self.shortfall or self.note,
        }


@dataclass(frozen=True)
class Check:
    """Number of ours beside an exact number."""

    name: str
    value: float
    exact: float
    allowed: float

    @property
    def holds(self) -> bool:
        """True if the difference is allowed."""
        return abs(self.value - self.exact) <= self.allowed


@dataclass(frozen=True)
class Topic:
    """Statements, checks, figures and tables of one question."""

    question: str
    statements: Sequence[Statement] = ()
    checks: Sequence[Check] = ()
    figures: Sequence[Figure] = ()
    tables: Sequence[Table] = ()
    message: str = ""  # why there is nothing


def headline(rows: Sequence[dict[str, Any]], checks: Sequence[Check]) -> str:
    """Return the outcome in one sentence: how many statements were run, with which verdicts, and the checks.

    Examples
    --------
    >>> headline([{"verdict": "not run"}, {"verdict": "reproduced"}], [Check("gap", 1.0, 1.0, 0.0)])
    '1 of 2 statements run: 1 reproduced; 1 of 1 checks hold'
    """
    counts = {verdict: sum(row["verdict"] == verdict for row in rows) for verdict in VERDICTS[:-1]}
    told = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    run = f"{sum(counts.values())} of {len(rows)} statements run{': ' if told else ''}{told}"
    return f"{run}; {sum(check.holds for check in checks)} of {len(checks)} checks hold"
