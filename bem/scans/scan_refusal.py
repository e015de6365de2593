"""Errors of scans that cannot be used: the key of [profile] concerned, the mistake, and the allowed values."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Refusal(NamedTuple):
    """Mistake in a scan."""

    key: str  # of [profile]
    problem: str
    allowed: str


class ScanFileError(ValueError):
    """Error of a scan that cannot be used; `refusals` lists all mistakes."""

    def __init__(self, refusals: Iterable[Refusal]) -> None:
        self.refusals = tuple(refusals)
        super().__init__("; ".join(f"{key}: {problem}; allowed: {allowed}" for key, problem, allowed in self.refusals))


def refused(key: str, problem: str, allowed: str) -> ScanFileError:
    """Return the error of a scan with a single mistake."""
    return ScanFileError([Refusal(key, problem, allowed)])
