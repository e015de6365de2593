"""Stored errors of rows: one line per row in stored.csv, beside the cases.

Columns: case, row, value (the number of a count, else the deciding value), error (largest |value - reference|; empty
for a count), unit, reason (why the line was last written).  The line "(seconds)" of a case holds its seconds, for the
time that is left.  The stored error is the worst over the OpenBLAS kernels that CI runs: `--store worst` keeps the
larger of old and new error.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from validation.harness.provenance import checkout
from validation.plugin.rows import PASSING, Row

FILE = "stored.csv"
COLUMNS = ("case", "row", "value", "error", "unit", "reason")
SECONDS = "(seconds)"
SHOWN = 0.2  # changes beyond this share of the old number are printed

Lines = dict[tuple[str, str], dict[str, str]]


class StoreError(ValueError):
    """Refusal to store: a tree with changes, a number that is not finite, no reason."""


def file_for(path: Path, root: Path) -> Path | None:
    """Return the stored.csv nearest above a case, within the root; None where there is none."""
    folders = [folder for folder in path.parents if folder == root or folder.is_relative_to(root)]
    return next((folder / FILE for folder in folders if (folder / FILE).exists()), None)


@cache
def read(file: Path) -> Lines:
    """Return the lines of a stored.csv by case and row."""
    with file.open(encoding="utf-8", newline="") as text:
        return {(line["case"], line["row"]): line for line in csv.DictReader(text)}


def errors_of(case: str, file: Path) -> dict[str, float]:
    """Return stored errors, or values of counts, of a case by row."""
    lines = {row: line for (name, row), line in read(file).items() if name == case and row != SECONDS}
    return {row: float(line["error"] or line["value"]) for row, line in lines.items()}


def seconds_of(case: str, file: Path) -> float | None:
    """Return the seconds that a case took when it was stored."""
    line = read(file).get((case, SECONDS))
    return None if line is None else float(line["value"])


def refuse_changes(folder: Path) -> None:
    """Raise where the checkout that holds a folder has changes besides its stored.csv."""
    tree = checkout(folder, ":/")
    if tree is not None and tree[1]:
        raise StoreError(f"--store: {folder}: files with changes ({', '.join(tree[1][:3])}); commit them first")


def store(file: Path, cases: Iterable[dict[str, Any]], reason: str, keep_worst: bool) -> list[str]:
    """Rewrite the lines of the cases that ran, and return the changes as sentences.

    Rows that deviate for another reason than the stored number are refused, and nothing is written.
    """
    before: Lines = read(file) if file.exists() else {}
    ran, after = {case["key"] for case in cases}, Lines()
    for case in cases:
        after |= _lines(case, before, reason, keep_worst)
    lines = {at: line for at, line in before.items() if at[0] not in ran} | after
    with file.open("w", encoding="utf-8", newline="") as text:
        table = csv.DictWriter(text, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(line for _, line in sorted(lines.items()))
    read.cache_clear()
    return [
        _change(at, before.get(at), lines.get(at))
        for at in sorted(before.keys() | lines.keys())
        if at[1] != SECONDS and _changed(before.get(at), lines.get(at))
    ]


def _lines(case: dict[str, Any], before: Lines, reason: str, keep_worst: bool) -> Lines:
    lines, key = Lines(), case["key"]
    for row in (Row(**fields) for fields in case["rows"]):
        at = key, row.key
        again = Row(**vars(row) | {"stored": None, "must_be_stored": False})
        if again.verdict not in PASSING and row.kind != "regression":
            raise StoreError(f"--store: {key}: {row.key}: {row.verdict}; nothing was stored")
        if row.cause:
            continue
        value, error = row.values[row.worst], row.error
        if not (math.isfinite(value) and math.isfinite(error)):
            raise StoreError(f"--store: {key}: {row.key}: not a number; nothing was stored")
        old = before.get(at)
        if old is not None and keep_worst and row.kind != "regression":
            error = max(error, float(old["error"]))
        shown = "" if row.kind == "regression" else f"{error:.3g}"
        if old is not None and old["error"] == shown and (shown or old["value"] == f"{value:.6g}"):
            lines[at] = old
            continue
        lines[at] = dict(zip(COLUMNS, (*at, f"{value:.6g}", shown, row.unit, reason), strict=True))
    old_seconds, seconds = before.get((key, SECONDS)), float(case["seconds"])
    if old_seconds is not None and abs(seconds - float(old_seconds["value"])) <= 0.5 * seconds + 1:
        lines[key, SECONDS] = old_seconds
    else:
        lines[key, SECONDS] = dict(zip(COLUMNS, (key, SECONDS, f"{seconds:.1f}", "", "s", ""), strict=True))
    return lines


def _number(line: dict[str, str] | None) -> float:
    return math.nan if line is None else float(line["error"] or line["value"])


def _changed(old: dict[str, str] | None, new: dict[str, str] | None) -> bool:
    return not abs(_number(new) - _number(old)) <= SHOWN * abs(_number(old))


def _change(at: tuple[str, str], old: dict[str, str] | None, new: dict[str, str] | None) -> str:
    before, after = ("nothing" if line is None else f"{_number(line):.3g}" for line in (old, new))
    return f"stored: {at[0]}: {at[1]}: {before} -> {after}"
