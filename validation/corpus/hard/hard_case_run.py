"""One hard case of any code, asked and judged: converged and correct are two answers, a refusal is neither.

Every corpus speaks one language: a case (`Asked`) has a question in two forms, an expectation stated beforehand, and
checks by their names; what a check has against an answer is a `Finding`; `run` asks, judges and makes an outcome of it.
A corpus says how its code is asked (`answer`) and what speaks against an answer (`findings`).
"""

import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from validation.references.paper_problem import Table

Check = Callable[[Any], Iterable[str]]  # of what was answered: a text for each that fails


@dataclass(frozen=True)
class Finding:
    """Something that speaks against an answer; studies count the kinds, which are the names of checks."""

    kind: str
    text: str

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"


@dataclass(frozen=True)
class TrialOutcome:
    """What became of a hard case."""

    id: str
    expected: tuple[str, ...]  # status of the result, then of its targets
    observed: tuple[str, ...]  # the same as found, or `refused: ARGUMENT`
    converged: bool  # the solver ended as expected at every target
    correct: bool  # nothing was found against the result: certificates, events, independent checks
    refused_reason: str | None  # why the question was refused or the run broke off
    findings: tuple[str, ...]  # what speaks against it
    seconds: float  # CPU time of the solution alone
    kinds: tuple[str, ...] = ()  # of every finding


@dataclass(frozen=True)
class Answered:
    """A question in one of its forms, and the result that a code gave: what checks take."""

    tables: Table
    result: Any


@dataclass(frozen=True, eq=False)
class Asked:
    """A hard case: what a code is asked, and what must come out."""

    id: str
    reason: str  # what is hard about it
    question: Table  # of the reduced form: a scene, or what else the code is given
    checks: tuple[str, ...] = ()  # independent ones, by their names
    expected: tuple[str, ...] = ("converged",)  # statuses, or `refused: ARGUMENT`
    full: Table = field(default_factory=dict)  # what the full form changes of the question

    refusals: ClassVar[tuple[type[Exception], ...]]  # that the code answers with
    known: ClassVar[Mapping[str, Check]]  # checks by their names
    forms: ClassVar[tuple[Table, Table]] = ({}, {})  # what every question has in its reduced form, and in the full one

    def posed(self, full: bool) -> Table:
        """The question in one of its forms."""
        return self.question | self.forms[full] | (self.full if full else {})

    @staticmethod
    def ask(question: Table) -> Any:
        """What the code says to a question."""
        raise NotImplementedError

    def expectation(self, full: bool) -> tuple[str, ...]:
        """What must come out in a form."""
        return self.expected

    def answer(self, full: bool, folder: Path) -> Any:
        """Ask the code, with a folder for files; what it raises of `refusals` is an answer too."""
        question = self.posed(full)
        return Answered(question, self.ask(question))

    def findings(self, found: Any, full: bool) -> Iterator[Finding]:
        """What speaks against an answer, while its folder is there."""
        for name in self.checks:
            yield from (Finding(name.replace("_", " "), text) for text in self.known[name](found))

    def ended(self, found: Any, full: bool) -> tuple[tuple[str, ...], bool, str | None]:
        """Statuses of an answer, whether it converged as expected, and the reason where it is a refusal after all.

        They are that of the result, then those of its targets, if it has any.
        """
        states = getattr(found.result, "targets", ())
        observed = (found.result.status, *(state.status for state in states))
        return observed, observed == self.expectation(full), None

    def refused(self, error: Exception) -> tuple[tuple[str, ...], str, list[Finding]]:
        """What is observed of a refusal, which names its argument or begins with it; the reason; and findings."""
        observed = (f"refused: {getattr(error, 'argument', str(error).split(':')[0])}",)
        return observed, str(error) if observed == self.expected else f"{type(error).__name__}: {error}", []


def run(case: Asked, full: bool = False) -> TrialOutcome:
    """Ask a case in its reduced form or the full one, and judge the answer.

    What else than a refusal leaves the code is raised: that is the crash which studies count.
    """
    expected = case.expectation(full)
    reason: str | None
    with tempfile.TemporaryDirectory() as folder:
        begun = time.process_time()
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                found = case.answer(full, Path(folder))
        except case.refusals as error:
            seconds = time.process_time() - begun
            observed, reason, findings = case.refused(error)
            converged = False
        else:
            seconds = time.process_time() - begun
            observed, converged, reason = case.ended(found, full)
            findings = [Finding("warning", text) for text in sorted({str(warning.message) for warning in caught})]
            findings += case.findings(found, full)
    return TrialOutcome(
        id=case.id,
        expected=expected,
        observed=observed,
        converged=converged,
        correct=not findings and (reason is None or observed == expected),
        refused_reason=reason,
        findings=tuple(map(str, findings)),
        seconds=seconds,
        kinds=tuple(finding.kind for finding in findings),
    )
