"""Journal of a run in the making: journal.jsonl in the folder of a result.

The first line holds what all states share, each further line a state with the events, warnings and arrays since the
state before.  A line ends with its checksum.  The last line may lack its end, where a write was cut off; then it does
not count.  While there is a journal it is the result of its folder.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from bem.scene.atomic_file import write_atomically
from bem.scene.digest import digest
from bem.scene.result import Entry, Result
from bem.scene.result_invariants import contradiction
from bem.scene.stored_json import SCHEMA, CorruptResultError, read_bytes, typed, verified

JOURNAL_FILE = "journal.jsonl"
_BEGUN, _ENTRY = TypeAdapter(Result), TypeAdapter(Entry)


@dataclass(frozen=True)
class Journal:
    """Journal of a folder."""

    folder: Path

    @property
    def path(self) -> Path:
        """File of the journal."""
        return self.folder / JOURNAL_FILE

    def begin(self, begun: Result, entries: Iterable[Entry]) -> None:
        """Write a journal with the given entries in place of an earlier journal, whole or not at all.

        Parameters
        ----------
        begun : Result
            Content that all states share: scene, effects, provenance, groups, warnings, and fields of no state.
        entries : iterable of Entry

        Raises
        ------
        OSError
            Disk full, folder not writable or gone.
        """
        begun = replace(begun, states=(), events=(), status="interrupted", failure=None, largest_tension=None)
        first = _line({"schema": SCHEMA} | json.loads(_BEGUN.dump_json(begun)))
        write_atomically(self.path, first + b"".join(map(_entry_line, entries)))

    def add(self, entry: Entry) -> None:
        """Append an entry; OSError if the disk is full or the journal is missing, as in a removed folder."""
        line = _entry_line(entry)
        with os.fdopen(os.open(self.path, os.O_WRONLY | os.O_APPEND), "ab") as file:
            file.write(line)

    def read(self) -> Result:
        """Return the entries of the journal as an interrupted result; CorruptResultError names a damaged line."""
        *lines, _ = read_bytes(self.path).split(b"\n")
        place = "line 1"
        try:
            begun = typed(_BEGUN, verified(lines[0] if lines else b"", place, SCHEMA), place)
            entries = []
            for number, line in enumerate(lines[1:], 2):
                place = f"line {number}"
                entries.append(typed(_ENTRY, verified(line, place), place))
        except CorruptResultError as error:
            remedy = "; remove this line and all after it, and the run continues from the lines before"
            raise CorruptResultError(f"{self.path}: {error}{remedy * (place != 'line 1')}") from error
        result = begun.with_entries(entries)
        mistake = contradiction(result)
        if mistake is not None:
            raise CorruptResultError(f"{self.path}: {mistake}")
        return result


def _entry_line(entry: Entry) -> bytes:
    """Return an entry as a line."""
    return _line(json.loads(_ENTRY.dump_json(entry)))


def _line(content: dict[str, Any]) -> bytes:
    """Return content as a line with its checksum."""
    return (json.dumps(content | {"checksum": digest(content)}, allow_nan=False) + "\n").encode()
