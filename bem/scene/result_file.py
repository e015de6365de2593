"""The files that hold a result: result.json and fields.npz of one that is written, journal.jsonl of one in the making.

`result.json` holds everything but arrays; `fields.npz` the fields asked for.  Both are written under a
temporary name, flushed to disk and renamed, so that a reader finds the old or the new file, never a part.
`checksum` is the SHA-256 of `json.dumps(content, sort_keys=True)` of the content without that field; the digest of
fields.npz stands in the provenance.

A run appends to `journal.jsonl` a line for every state, with the events on the way to it, its fields and a checksum of
its own: what a line holds is there whole or not at all, whatever happens to the process and to the two other files.
The first line holds what all states share.  While there is a journal it is the result of its folder; `write_result`
ends it.  A last line without its end is a write that was cut off, and does not count.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import platform
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import numpy as np
from numpy.typing import NDArray

from bem.scene.atomic_file import write_atomically
from bem.scene.result import Caution, Entry, Event, Result, State
from bem.scene.result_content import CorruptResultError as CorruptResultError
from bem.scene.result_content import packed, plain, typed, unpacked
from bem.scene.scene_tables import TABLES

SCHEMA = "linecontact-result/1"
RESULT_FILE, FIELDS_FILE, JOURNAL_FILE = "result.json", "fields.npz", "journal.jsonl"
SHAPE = ("x", "displacement", "gap", "pressure", "patch")  # arrays of a stored shape, each with its index


def digest(content: Mapping[str, Any]) -> str:
    """SHA-256 of a mapping as JSON with sorted keys.

    Examples
    --------
    >>> digest({"a": 1, "b": 0.1}) == digest({"b": 0.1, "a": 1})
    True
    """
    return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=False).encode()).hexdigest()


@cache
def installed_version() -> str:
    """Version of this package, as it is installed: `bem.__version__`."""
    try:
        return metadata.version("linecontact")
    except metadata.PackageNotFoundError:
        return "not installed"


def provenance(resolved_scene: Mapping[str, Any]) -> dict[str, Any]:
    """Versions, kernels, Python, platform, date (UTC) and digest of the scene; no path, no host name."""
    import scipy  # which reading a result does without

    from bem.compiled.kernels import IN_USE

    return {
        "linecontact": installed_version(),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "kernels": IN_USE,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "scene_sha256": digest(resolved_scene),
    }


def write_result(result: Result, folder: Path) -> None:
    """Write result.json and, when there are fields, fields.npz, and end the journal; make the folder if need be.

    Raises
    ------
    OSError
        Disk full or folder not writable; what was there before stays as it was.
    """
    folder.mkdir(parents=True, exist_ok=True)
    arrays = packed(result.fields)
    content = _content(result, hashlib.sha256(arrays).hexdigest() if arrays else None)
    if arrays:
        write_atomically(folder / FIELDS_FILE, arrays)
    write_atomically(folder / RESULT_FILE, _lines(content))
    if not arrays:
        (folder / FIELDS_FILE).unlink(missing_ok=True)
    (folder / JOURNAL_FILE).unlink(missing_ok=True)


def write_states(result: Result, folder: Path) -> None:
    """Write result.json alone, of a run that goes on: fields are written with its end.

    Raises
    ------
    OSError
        As `write_result`.
    """
    write_atomically(folder / RESULT_FILE, _lines(_content(result, None)))
    (folder / FIELDS_FILE).unlink(missing_ok=True)


def read_result(folder: Path | str) -> Result:
    """Read what `write_result` wrote, or what a run has kept in its journal so far, and verify it.

    Parameters
    ----------
    folder : Path or str
        The folder, or its result.json.

    Raises
    ------
    FileNotFoundError
        No result there.
    CorruptResultError
        Not JSON, another schema, wrong checksum, a value of another type, a scene of an unknown kind, fields.npz
        missing, not the one written with it, or with a part of a shape.

    Examples
    --------
    >>> import tempfile
    >>> kept = Result({}, (), {}, (), (), "interrupted", failure="stopped by the user")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_result(kept, Path(folder))
    ...     read_result(folder).failure
    'stopped by the user'
    """
    folder = Path(folder)
    if folder.name == RESULT_FILE and not folder.is_dir():
        folder = folder.parent
    try:
        return Journal(folder).read()
    except FileNotFoundError:
        pass
    path = folder / RESULT_FILE
    try:
        content = _loaded(path.read_bytes(), str(path))
    except FileNotFoundError as error:
        raise FileNotFoundError(f"{path}: no result of a run there") from error
    if content.get("schema") != SCHEMA:
        raise CorruptResultError(f"{path}: schema {content.get('schema')!r} is not {SCHEMA!r}")
    result, fields_sha256 = _result(_verified(content, str(path)), str(path))
    fields = _fields(folder / FIELDS_FILE, fields_sha256)
    _whole(fields, str(folder / FIELDS_FILE))
    return replace(result, fields=fields)


@dataclass(frozen=True)
class Journal:
    """The journal of a folder.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     journal = Journal(Path(folder))
    ...     journal.begin(Result({}, (), {}, (), (), "interrupted"), [])
    ...     journal.read().status
    'interrupted'
    """

    folder: Path

    def begin(self, begun: Result, entries: Iterable[Entry]) -> None:
        """Write a journal with these entries in place of any that was there, whole or not at all.

        Parameters
        ----------
        begun : Result
            What all states share: scene, effects, provenance, groups, warnings, and fields of no state.
        entries : iterable of Entry

        Raises
        ------
        OSError
            Disk full, folder not writable or gone.
        """
        begun = replace(begun, states=(), events=(), status="interrupted", failure=None)
        first = {"begun": _content(begun, None), "fields": _text(packed(begun.fields))}
        write_atomically(self.path, _line(first) + b"".join(map(_entry_line, entries)))

    def add(self, entry: Entry) -> None:
        """Append an entry.

        Raises
        ------
        OSError
            Disk full; no journal there, as where the folder was removed.
        """
        line = _entry_line(entry)
        with os.fdopen(os.open(self.path, os.O_WRONLY | os.O_APPEND), "ab") as file:
            file.write(line)

    def read(self) -> Result:
        """What it holds, as an interrupted result.

        Raises
        ------
        FileNotFoundError
            There is none.
        CorruptResultError
            A line other than a last one without end is damaged.
        """
        *lines, _ = self.path.read_bytes().split(b"\n")
        place = [f"line {number}" for number in range(1, len(lines) + 1)]
        try:
            first = _verified(_loaded(lines[0], place[0]), place[0])
            begun, _ = _result(first["begun"], place[0])
            begun = replace(begun, fields=unpacked(_bytes(first["fields"]), place[0]))
            held = begun.with_entries(map(_entry, lines[1:], place[1:]))
            _whole(held.fields, "fields")
            return held
        except (IndexError, KeyError, TypeError, ValueError) as error:
            kept = "remove this line and all after it, and the run continues from the lines before"
            raise CorruptResultError(f"{self.path}: corrupt ({error}); {kept}") from error

    @property
    def path(self) -> Path:
        """The file of the journal."""
        return self.folder / JOURNAL_FILE


def _content(result: Result, fields_sha256: str | None) -> dict[str, Any]:
    """A result without its arrays in types of JSON."""
    return {
        "schema": SCHEMA,
        "scene": plain(result.scene),
        "effects": plain(result.effects),
        "warnings": plain(result.warnings),
        "groups": plain(result.groups),
        "profile_preparation": plain(result.profile_preparation),
        "provenance": plain(result.provenance) | {"fields_sha256": fields_sha256},
        "states": plain(result.states),
        "events": plain(result.events),
        "status": result.status,
        "failure": result.failure,
    }


def _loaded(raw: bytes, place: str) -> dict[str, Any]:
    """A mapping stored with its checksum, as it is."""
    try:
        content = json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise CorruptResultError(f"{place}: corrupt, not JSON of a result ({error})") from error
    if not isinstance(content, dict):
        raise CorruptResultError(f"{place}: corrupt, it holds a {type(content).__name__} where a result is a table")
    return content


def _verified(content: dict[str, Any], place: str) -> dict[str, Any]:
    """The same without its checksum, which matches."""
    stored = content.pop("checksum", None)
    try:
        sound = stored == digest(content)
    except (ValueError, RecursionError):  # NaN or a depth that this module never writes
        sound = False
    if not sound:
        raise CorruptResultError(f"{place}: corrupt, its checksum does not match its content")
    return content


def _result(content: Any, place: str) -> tuple[Result, str | None]:
    """The result of a content, without fields, and the digest of these."""
    try:
        stored = {name: value for name, value in content.items() if name not in ("schema", "checksum")}
        result = typed(Result, stored, "result")
        facts = dict(result.provenance)
        sha256 = facts.pop("fields_sha256")
    except (KeyError, AttributeError, CorruptResultError) as error:
        raise CorruptResultError(f"{place}: incomplete ({error})") from error
    for name, table in result.scene.items():
        _known(name, table, place)
    return replace(result, provenance=facts), sha256


def _known(name: str, table: Any, place: str) -> None:
    """Refuse a table of a scene in which a key has a word that it does not allow."""
    if name not in TABLES or not isinstance(table, dict):
        return
    keys = TABLES[name].model_fields
    for key in keys.keys() & table.keys():
        words = get_args(keys[key].annotation) if get_origin(keys[key].annotation) is Literal else None
        if words is not None and table[key] not in words:
            raise CorruptResultError(f"{place}: scene.{name}.{key} is {table[key]!r}, not one of {', '.join(words)}")


def _whole(fields: Mapping[str, NDArray[Any]], place: str) -> None:
    """Refuse a shape of which an array is missing."""
    for name in fields:
        kind, _, index = name.rpartition("_")
        for other in SHAPE if kind in SHAPE and index.isdigit() else ():
            if f"{other}_{index}" not in fields:
                raise CorruptResultError(f"{place}: corrupt, it holds {name} without {other}_{index}")


def _fields(path: Path, sha256: str | None) -> dict[str, NDArray[Any]]:
    """The fields written with a result."""
    if sha256 is None:
        return {}
    try:
        raw = path.read_bytes()
    except FileNotFoundError as error:
        raise CorruptResultError(f"{path}: missing, but result.json was written with it") from error
    if hashlib.sha256(raw).hexdigest() != sha256:
        raise CorruptResultError(f"{path}: corrupt, or not the file written with result.json")
    return unpacked(raw, str(path))


def _line(content: dict[str, Any]) -> bytes:
    """A line of the journal, with its checksum."""
    return (json.dumps(content | {"checksum": digest(content)}, allow_nan=False) + "\n").encode()


def _entry_line(entry: Entry) -> bytes:
    fields = _text(packed(entry.fields))
    return _line(plain({"events": entry.events, "state": entry.state, "warnings": entry.warnings}) | {"fields": fields})


def _entry(line: bytes, place: str) -> Entry:
    """What a line of the journal holds."""
    content = _verified(_loaded(line, place), place)
    events = typed(tuple[Event, ...], content["events"], f"{place}, events")
    state = typed(State, content["state"], f"{place}, state")
    warnings = typed(tuple[Caution, ...], content["warnings"], f"{place}, warnings")
    return Entry(events, state, unpacked(_bytes(content["fields"]), place), warnings)


def _text(raw: bytes) -> str | None:
    return base64.b64encode(raw).decode() if raw else None


def _bytes(text: str | None) -> bytes:
    return b"" if text is None else base64.b64decode(text, validate=True)


def _lines(content: dict[str, Any]) -> str:
    """JSON of a mapping and its checksum: a line for each value, and for each entry of a list."""
    parts = []
    for name, value in (content | {"checksum": digest(content)}).items():
        entries = [json.dumps(entry, allow_nan=False) for entry in value] if isinstance(value, list) else None
        text = json.dumps(value, allow_nan=False) if not entries else "[\n  " + ",\n  ".join(entries) + "\n ]"
        parts.append(f" {json.dumps(name)}: {text}")
    return "{\n" + ",\n".join(parts) + "\n}\n"
