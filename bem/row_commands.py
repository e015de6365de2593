"""Runs of all rows of a map: a folder for each row, and the median and scatter of every answer in answer.csv."""

from __future__ import annotations

import argparse
import csv
import io
import json
import math
import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bem.command_line.answer_table import (
    FLAW,
    NO_NUMBER,
    NOTHING,
    PULL_OFF,
    QUANTITIES,
    UNBOUNDED,
    aligned,
    pull_off,
    quantity,
    readable,
    stays_complete,
)
from bem.command_line.checkpoint import ANSWERS, OutputFolderError, remove_answers, usable
from bem.command_line.folder_lock import locked
from bem.command_line.perform import DONE, FAILED
from bem.geometry.ranges import Mistake
from bem.map_rows import ANSWERED, OUTCOMES, ROW_FOLDERS, RowResults, median_and_scatter, rows_of, solve_rows
from bem.scene.atomic_file import write_atomically
from bem.scene.journal import JOURNAL_FILE
from bem.scene.memory_estimate import refuse_beyond_memory
from bem.scene.result_file import FIELDS_FILE, RESULT_FILE
from bem.scene.result_views import UNITS
from bem.scene.scene_error import SceneError

TABLE = ANSWERS[0]
MEDIANS = {"width_median": "width: median", "open_gap_p50": "open gap: median"}  # of one column in three
SCATTER = "Median and scatter of {} rows: half of the distance of their 16 and 84 % quantiles."
TABLE_DIGITS, SCATTER_DIGITS = 3, 2  # format: of a median and its scatter


def run_rows(tables: Mapping[str, Any], options: argparse.Namespace) -> int:
    """Solve the rows of a map into a folder; a row without an answer is named, and the exit code is 1."""
    _, first = rows_of(tables, options.scene.parent)
    refuse_beyond_memory(first)
    if options.plot:
        raise SceneError([Mistake("--plot", "with all rows of a map", "a scene of one row, as in profile.row = 0")])
    usable(options.out)
    with locked(options.out) as new:
        return run_alone(tables, options, new)


def run_alone(tables: Mapping[str, Any], options: argparse.Namespace, new: bool) -> int:
    """Solve the rows of a map into a locked folder; `new` says whether the folder was made for this run."""
    _prepare(options, new)
    rows, first = rows_of(tables, options.scene.parent)
    count = 0

    def told(row: int, status: str) -> None:
        nonlocal count
        count += 1
        if not options.quiet:
            print(f"row {row}: {status} ({count} of {len(rows)})", file=sys.stderr, flush=True)

    outcome = solve_rows(options.scene, options.jobs, options.out, told)
    write_atomically(options.out / TABLE, csv_text(outcome))
    write_atomically(options.out / OUTCOMES, outcomes_text(outcome))
    failures = {str(row): reason for row, reason in outcome.failures.items()}
    for line in warning_lines(outcome):
        print(f"warning: {line}", file=sys.stderr)
    if options.json:
        facts = {"rows": len(rows), "answered": len(outcome.results), "failures": failures, "out": str(options.out)}
        print(json.dumps(facts))
    else:
        print("\n".join(filter(None, [*aligned(cells(outcome, first.loading.control)), pull_off_words(outcome)])))
        print(SCATTER.format(len(outcome.results)))
        print(f"{len(outcome.results)} of {len(rows)} rows answered, each a ridge -> {options.out}")
    for row, reason in failures.items():
        print(f"FAILED: row {row}: {reason}", file=sys.stderr)
    return FAILED if failures else DONE


def warning_lines(outcome: RowResults) -> list[str]:
    """Return a line for each subject of warnings: the first warning, and of how many rows."""
    messages: dict[str, list[str]] = {}
    for result in outcome.results.values():
        for about, message in {warning.about: warning.message for warning in result.warnings}.items():
            messages.setdefault(about, []).append(message)
    count = len(outcome.results)
    return [f"{about}: {told[0]} ({len(told)} of {count} rows)" for about, told in messages.items()]


def _prepare(options: argparse.Namespace, new: bool) -> None:
    """Raise OutputFolderError unless the folder may be used; remove what --overwrite replaces."""
    folder: Path = options.out
    if not (new or options.resume or options.overwrite):
        raise OutputFolderError(f"{folder}: exists; --resume continues from what it holds, --overwrite replaces it")
    if options.resume and (folder / RESULT_FILE).exists():
        raise OutputFolderError(f"{folder}: holds the result of one profile; choose another folder, or --overwrite")
    if options.overwrite:
        for name in (RESULT_FILE, FIELDS_FILE, JOURNAL_FILE):
            (folder / name).unlink(missing_ok=True)
        for path in folder.glob(ROW_FOLDERS):
            shutil.rmtree(path)
    remove_answers(folder)


def entries_of(outcome: RowResults) -> list[tuple[float, str, str, str, int, float, float]]:
    """Return target, branch, quantity, unit, rows, median and scatter of each answer, the pull-off at last.

    The pull-off belongs to the path and has no target (NaN); rows whose path does not know it are left out.
    """
    entries = list(zip(*(values.tolist() for values in outcome.to_table().values()), strict=True))
    tensions = [-tension.mean_pressure for tension in map(pull_off, outcome.results.values()) if tension is not None]
    if tensions:
        entries.append((math.nan, "unloading", PULL_OFF, "Pa", len(tensions), *median_and_scatter(tensions)))
    return entries


def csv_text(outcome: RowResults) -> str:
    """Return median and scatter of each quantity at each target as comma-separated values in SI units."""
    lines = [",".join(outcome.to_table())]
    for entry in entries_of(outcome):
        lines.append(",".join(value if isinstance(value, str) else f"{value:.17g}" for value in entry))
    return "\n".join(lines) + "\n"


def outcomes_text(outcome: RowResults) -> str:
    """Return row, outcome and pull-off (Pa, where its path knows it) of each row as comma-separated values."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("row", "outcome", PULL_OFF))
    for row in sorted({*outcome.results, *outcome.failures}):
        tension = pull_off(outcome.results[row]) if row in outcome.results else None
        known = "" if tension is None else f"{-tension.mean_pressure:.17g}"
        writer.writerow((row, outcome.failures.get(row, ANSWERED), known))
    return text.getvalue()


def cells(outcome: RowResults, control: str) -> list[list[str]]:
    """Return the answer as texts: a line for each quantity, a column for each target, headings first."""
    found: dict[str, dict[str, str]] = {}
    entries = entries_of(outcome)
    largest: dict[str, float] = {}
    for _, _, name, _, _, median, _ in entries:
        largest[name] = max(largest.get(name, 0.0), abs(median))
    for target, branch, name, unit, rows, median, scatter in entries:
        if name in QUANTITIES and name != control:
            shown = [value if abs(value) > NOTHING * largest[name] else 0.0 for value in (median, scatter)]
            place = f"{quantity(target, UNITS[control])}, {branch}"
            found.setdefault(name, {})[place] = _median_words(shown, unit, rows, len(outcome.results))
    heads = list(dict.fromkeys(head for row in found.values() for head in row))
    texts = [
        [MEDIANS.get(name, words), *(found[name].get(head, NO_NUMBER) for head in heads)]
        for name, words in QUANTITIES.items()
        if name in found
    ]
    return [[f"{control.replace('_', ' ')} (held)", *heads], *texts] if heads else []


def pull_off_words(outcome: RowResults) -> str:
    """Return median and scatter of the pull-off in words, and why rows have none; nothing without tension."""
    count, words = len(outcome.results), []
    for _, _, name, unit, rows, median, scatter in entries_of(outcome):
        if name == PULL_OFF:
            words.append(f"Pull-off: {_median_words((median, scatter), unit, rows, count)}.")
    complete = sum(map(stays_complete, outcome.results.values()))
    if complete:
        words.append(f"No pull-off in {complete} of {count} rows: {UNBOUNDED} Set {FLAW}")
    return " ".join(words)


def _median_words(values: Sequence[float], unit: str, rows: int, count: int) -> str:
    """Return median and scatter in words, of one row or of zeros the median alone; of how many rows, if not of all."""
    shown = zip(values[: 2 if rows > 1 and any(values) else 1], (TABLE_DIGITS, SCATTER_DIGITS), strict=False)
    words = " ± ".join(readable(value, unit, figures) for value, figures in shown)
    return words + (f" ({rows} of {count} rows)" if rows < count else "")
