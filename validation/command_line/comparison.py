"""Two results, or two verification reports, number by number: differences in units of their combined uncertainty.

Results meet at targets (same control, branch and value) and at events (same sequence of kinds).  Their combined
uncertainty is the sum u_a + u_b of the estimated errors, never below rounding, and numbers differ beyond twice that.
Reports meet at rows of one case, name and pair of codes.  Measured values differ beyond the uncertainties of both, or
what the rows allow where they state none; verdicts differ where they are not equal.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from bem.certified_states import ERROR_FLOOR
from bem.scene.result import Event, EventError, LargestTension, Result, TensionError
from bem.scene.result_file import RESULT_FILE, read_result
from bem.scene.state import ErrorEstimate, State
from validation.__main__ import read_report
from validation.report.pages import ReportError
from validation.report.verification_page import REPORT

SAME = 1e-6  # of the largest target: two states this near one another are at one target
LIMIT = 2.0  # of the combined uncertainty of two estimates
KINDS = {REPORT: "a verification report", RESULT_FILE: "a result"}  # by the file that a folder holds
WORDS = ("n_patches", "status")  # attributes of a state that are equal or differ, without an uncertainty


@dataclass(frozen=True)
class Apart:
    """Pair of numbers of A and B with their combined uncertainty; `limit` is the allowed difference over it."""

    quantity: str
    where: str
    a: float
    b: float
    combined: float
    limit: float = LIMIT

    @property
    def ratio(self) -> float:
        """Difference over combined uncertainty: 0 for equal numbers, infinite if one is NaN or the uncertainty is 0."""
        if self.a == self.b or (math.isnan(self.a) and math.isnan(self.b)):
            return 0.0
        apart = abs(self.a - self.b)
        return math.inf if math.isnan(apart) or self.combined == 0 else apart / self.combined

    @property
    def in_percent(self) -> str:
        """Difference over the larger number, in words; a difference within rounding counts as none."""
        apart, larger = abs(self.a - self.b), max(abs(self.a), abs(self.b))
        if self.a == self.b or apart <= ERROR_FLOOR * larger:
            return "equal to rounding"
        return "one is not a number" if math.isnan(apart / larger) else f"{100 * apart / larger:.2g} % apart"

    @property
    def differs(self) -> bool:
        """True if the ratio exceeds the limit."""
        return not self.ratio <= self.limit

    def __str__(self) -> str:
        values = f"{self.a:.12g} and {self.b:.12g}, {self.in_percent}"
        judged = f"{self.ratio:.3g} times the combined uncertainty {self.combined:.2g}"
        return f"{self.where}: {self.quantity} {values}, {judged}"


@dataclass(frozen=True)
class ComparedFolders:
    """Compared numbers, sentences on other differences, and notes on differences of the inputs."""

    numbers: tuple[Apart, ...]
    others: tuple[str, ...]
    notes: tuple[str, ...] = ()

    @property
    def differing(self) -> list[str]:
        """Other differences, and the largest difference of each differing quantity, one sentence each."""
        return [*self.others, *(str(number) for number in self.worst() if number.differs)]

    def worst(self) -> list[Apart]:
        """Return the number with the largest ratio of each quantity, over all places."""
        largest: dict[str, Apart] = {}
        for number in self.numbers:
            known = largest.setdefault(number.quantity, number)
            if number.ratio > known.ratio:
                largest[number.quantity] = number
        return list(largest.values())


def compare(a: Path, b: Path) -> ComparedFolders:
    """Compare the results or the reports of two folders.

    ReportError where they are not of one kind or have nothing in common, CorruptResultError where a result cannot be
    trusted.
    """
    kind, other = _kind(a), _kind(b)
    if kind != other:
        raise ReportError(f"not comparable: {a} holds {kind}, {b} holds {other}")
    if kind == KINDS[RESULT_FILE]:
        compared = compare_results(read_result(a), read_result(b))
    else:
        compared = compare_reports(read_report(a), read_report(b))
    if not compared.numbers:
        raise ReportError(f"not comparable: no number in common ({'; '.join(compared.others) or 'none at all'})")
    return compared


def _kind(folder: Path) -> str:
    for file, kind in KINDS.items():
        if (folder / file).exists():
            return kind
    if not folder.is_dir():
        raise ReportError(f"{folder}: is no folder; a folder of a run or of a verification is needed")
    raise ReportError(f"{folder}: neither {RESULT_FILE} nor {REPORT} there")


def compare_results(a: Result, b: Result) -> ComparedFolders:
    """Compare states at common targets, and events; ReportError for another control, or no target in common."""
    control, other = (result.scene["loading"]["control"] for result in (a, b))
    if control != other:
        raise ReportError(f"not comparable: loading.control is {control!r} and {other!r}")
    pairs, alone = _paired(a, b, control)
    if not pairs:
        raise ReportError(f"not comparable: no target of {control} in common, by value and branch")
    numbers: list[Apart] = []
    others = [f"only in {name}: {place}" for name, places in alone.items() for place in places]
    for left, right in pairs:
        place = _place(left, control)
        numbers += _numbers(left, right, ErrorEstimate, place)
        for word in WORDS:
            if getattr(left, word) != getattr(right, word):
                values = f"{getattr(left, word)} and {getattr(right, word)}"
                others.append(f"{place}: {word.replace('_', ' ')} {values}")
    tensions = a.largest_tension, b.largest_tension
    if tensions[0] is not None and tensions[1] is not None:
        numbers += _numbers(tensions[0], tensions[1], TensionError, "largest tension")
    elif tensions[0] is not tensions[1]:
        others.append(f"only in {'B' if tensions[0] is None else 'A'}: largest tension")
    kinds = [[event.kind for event in result.events] for result in (a, b)]
    if kinds[0] == kinds[1]:
        for k, (before, after) in enumerate(zip(a.events, b.events, strict=True), 1):
            numbers += _numbers(before, after, EventError, f"event {k}, {before.kind.replace('_', ' ')}")
    else:
        others.append(f"events: {_counts(kinds[0])} and {_counts(kinds[1])}")
    return ComparedFolders(tuple(numbers), tuple(others), tuple(_scene_notes(a.scene, b.scene)))


def compare_reports(a: Mapping[str, Any], b: Mapping[str, Any]) -> ComparedFolders:
    """Compare the rows of two reports; ReportError where they have none in common."""
    left, right = ({_key(row): row for row in report["rows"]} for report in (a, b))
    both = [key for key in left if key in right]
    if not both:
        raise ReportError("not comparable: no row in common")
    numbers: list[Apart] = []
    others = [f"only in A: {key}" for key in left if key not in right]
    others += [f"only in B: {key}" for key in right if key not in left]
    for key in both:
        mine, theirs = left[key], right[key]
        if mine["verdict"] != theirs["verdict"]:
            others.append(f"{key}: {mine['verdict']} and {theirs['verdict']}")
        values = [row["value"] for row in (mine, theirs)]
        if None in values:
            continue
        uncertainty = math.hypot(*(row["value_uncertainty"] or 0.0 for row in (mine, theirs)))
        allowed = uncertainty or max(row["allowed"] or 0.0 for row in (mine, theirs))
        allowed = max(allowed, ERROR_FLOOR * max(map(abs, values)))
        numbers.append(Apart(key, "row", values[0], values[1], allowed, 1.0))
    return ComparedFolders(tuple(numbers), tuple(others))


def _key(row: Mapping[str, Any]) -> str:
    return f"{row['case']}: {row['name']} [{', '.join(row['routes'])}]"


def _paired(a: Result, b: Result, control: str) -> tuple[list[tuple[State, State]], dict[str, list[str]]]:
    """Pair states of A and B at equal targets, in the order of A; also return the places of unpaired states."""
    met, free = (
        [state for state in result.targets if not math.isnan(getattr(state, control))] for result in (a, b)
    )  # not a pressure on the way that was missed
    scale = max((abs(getattr(state, control)) for state in (*met, *free)), default=0.0)
    pairs, alone = [], []
    for state in met:
        value = getattr(state, control)
        fit = (s for s in free if s.branch == state.branch and abs(getattr(s, control) - value) <= SAME * scale)
        match = next(fit, None)
        if match is None:
            alone.append(_place(state, control))
        else:
            free = [other for other in free if other is not match]
            pairs.append((state, match))
    return pairs, {"A": alone, "B": [_place(state, control) for state in free]}


def _place(state: State, control: str) -> str:
    return f"{control.replace('_', ' ')} {getattr(state, control):.6g} ({state.branch})"


def _numbers(
    a: State | Event | LargestTension, b: State | Event | LargestTension, estimates: type, where: str
) -> Iterator[Apart]:
    """Yield the numbers that have an estimated error on both sides."""
    for name in (item.name for item in fields(estimates)):
        errors = [getattr(side.error_estimate, name) for side in (a, b)]
        values = [getattr(side, name) for side in (a, b)]
        if None not in errors and None not in values:
            # results of older versions state errors below rounding
            apart = max(sum(errors), ERROR_FLOOR * max(map(abs, values)))
            yield Apart(name.replace("_", " "), where, values[0], values[1], apart)


def _scene_notes(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys in which two resolved scenes differ, except their titles."""
    for table in (name for name in a if name != "title"):
        left, right = ({} if scene.get(table) is None else scene[table] for scene in (a, b))
        for key in dict.fromkeys((*left, *right)):
            if left.get(key) != right.get(key):
                yield f"the scenes differ in {table}.{key}: {left.get(key)} and {right.get(key)}"


def _counts(words: Iterable[str]) -> str:
    """Return a text of distinct words with their counts, in the order of first occurrence."""
    listed = list(words)
    return ", ".join(f"{listed.count(word)} {word.replace('_', ' ')}" for word in dict.fromkeys(listed)) or "none"
