"""Why a scan cannot be used."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Refusal(NamedTuple):
    """The key of [profile] concerned, what was found, what is allowed."""

    key: str
    found: str
    allowed: str


class ScanFileError(ValueError):
    """A scan that cannot be used; `refusals` says everything that is wrong with it."""

    def __init__(self, refusals: Iterable[Refusal]) -> None:
        self.refusals = tuple(refusals)
        super().__init__("; ".join(f"{key}: {found}; allowed: {allowed}" for key, found, allowed in self.refusals))
