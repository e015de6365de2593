"""Error of scans that cannot be used: mistakes with the key of [profile] concerned and the allowed values."""

from __future__ import annotations

from collections.abc import Iterable

from bem.geometry.ranges import Mistake


class ScanFileError(ValueError):
    """Error of a scan that cannot be used; `mistakes` lists all its mistakes."""

    def __init__(self, mistakes: Iterable[Mistake]) -> None:
        self.mistakes = tuple(mistakes)
        super().__init__("; ".join(map(str, self.mistakes)))


def refused(key: str, found: str, allowed: str) -> ScanFileError:
    """Return the error of a scan with a single mistake, in a key of [profile]."""
    return ScanFileError([Mistake(f"profile.{key}", found, allowed)])
