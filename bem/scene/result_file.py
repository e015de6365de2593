"""Files of a result: result.json and fields.npz of a finished run, journal.jsonl of a run in the making.

`result.json` holds everything but arrays, as the dataclasses of result.py have it (pydantic); null stands for NaN and
infinity, and all other numbers come back bit for bit.  `fields.npz` holds the arrays asked for (stored_arrays.py).
Both are written under a temporary name, flushed to disk and renamed, so that a reader finds the old or the new file,
never a part.  `checksum` is the SHA-256 of `json.dumps(content, sort_keys=True)` of the content without that field; the
digest of fields.npz stands in the provenance.

A run appends to `journal.jsonl` a line for every state, with the events on the way to it, its fields and a checksum.
The first line holds what all states share.  While there is a journal it is the result of its folder; `write_result`
removes it.  A last line without its end is a write that was cut off, and does not count.

Results of linecontact 0.2.0 (schema 1), whose states do not name their targets, are refused.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import platform
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from bem.geometry.table import TableError, plain
from bem.scene.atomic_file import write_atomically
from bem.scene.result import Caution, Entry, Event, LargestTension, Result, State
from bem.scene.scene_rules import REQUIRED
from bem.scene.scene_tables import REQUIRED_TABLES, TABLES, WITH_DEFAULTS, class_of
from bem.scene.stored_arrays import CorruptArraysError, check_arrays, packed, unpacked

SCHEMA, FORMER = "linecontact-result/2", "linecontact-result/1"
RESULT_FILE, FIELDS_FILE, JOURNAL_FILE = "result.json", "fields.npz", "journal.jsonl"
SHOWN = 64  # format: characters of a value in an error
SAME_SHARE = 1e-9  # derived: of the period; rounding of edges, with a margin

Kind = TypeVar("Kind")


class CorruptResultError(ValueError):
    """Stored result that cannot be trusted: damaged, incomplete or of another schema."""


@dataclass(frozen=True)
class Line:
    """Line of the journal: an entry, with its arrays as the base64 text of an npz file."""

    events: tuple[Event, ...]
    state: State
    warnings: tuple[Caution, ...]
    tension: LargestTension | None
    fields: str


_RESULT, _LINE = TypeAdapter(Result), TypeAdapter(Line)


def digest(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a mapping as JSON with sorted keys.

    Examples
    --------
    >>> digest({"a": 1, "b": 0.1}) == digest({"b": 0.1, "a": 1})
    True
    """
    return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=False).encode()).hexdigest()


@cache
def installed_version() -> str:
    """Return the version of this package, as it is installed: `bem.__version__`."""
    try:
        return metadata.version("linecontact")
    except metadata.PackageNotFoundError:
        return "not installed"


def provenance(resolved_scene: Mapping[str, Any]) -> dict[str, Any]:
    """Return versions, Python, platform, date (UTC) and digest of the scene; no path, no host name."""
    import scipy  # which reading a result does without

    return {
        "linecontact": installed_version(),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "scene_sha256": digest(resolved_scene),
    }


def write_result(result: Result, folder: Path) -> None:
    """Write result.json and, when there are fields, fields.npz, and remove the journal; make the folder if need be.

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
    write_atomically(folder / RESULT_FILE, _text_of(content))
    if not arrays:
        (folder / FIELDS_FILE).unlink(missing_ok=True)
    (folder / JOURNAL_FILE).unlink(missing_ok=True)


def write_states(result: Result, folder: Path) -> None:
    """Write result.json alone, of a run that goes on: fields are written at its end.  OSError as `write_result`."""
    write_atomically(folder / RESULT_FILE, _text_of(_content(result, None)))
    (folder / FIELDS_FILE).unlink(missing_ok=True)


def read_result(folder: Path | str) -> Result:
    """Read the result of a folder, which may be given by its result.json, or the journal of an unfinished run.

    Raises
    ------
    FileNotFoundError
        No result there.
    CorruptResultError
        The file, and the key or array that is damaged, missing, of another type, or does not match the others.
    """
    folder = Path(folder)
    if folder.name == RESULT_FILE and not folder.is_dir():
        folder = folder.parent
    if (folder / JOURNAL_FILE).exists():
        return Journal(folder).read()
    path = folder / RESULT_FILE
    try:
        content = _verified(_bytes_of(path), str(path))
    except FileNotFoundError as error:
        raise FileNotFoundError(f"{path}: no result of a run there") from error
    result, sha256 = _result(content, str(path))
    if sha256 is None:
        return result
    path = folder / FIELDS_FILE
    if not path.exists():
        raise CorruptResultError(f"{path}: missing, but result.json was written with it")
    raw = _bytes_of(path)
    if hashlib.sha256(raw).hexdigest() != sha256:
        raise CorruptResultError(f"{path}: corrupt, or not the file written with result.json")
    return _with_arrays(result, _arrays(raw, str(path)), str(path))


def _bytes_of(path: Path) -> bytes:
    """Read a file; CorruptResultError if the path is a pipe or a device, at which reading would wait for ever."""
    if not stat.S_ISREG(path.stat().st_mode):
        raise CorruptResultError(f"{path}: is no file")
    return path.read_bytes()


@dataclass(frozen=True)
class Journal:
    """Journal of a folder."""

    folder: Path

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
        first = {"begun": _content(begun, None), "fields": _encoded(begun.fields)}
        write_atomically(self.path, _line(first) + b"".join(map(_entry_line, entries)))

    def add(self, entry: Entry) -> None:
        """Append an entry; OSError if the disk is full or the journal is missing, as in a removed folder."""
        line = _entry_line(entry)
        with os.fdopen(os.open(self.path, os.O_WRONLY | os.O_APPEND), "ab") as file:
            file.write(line)

    def read(self) -> Result:
        """Return the entries of the journal as an interrupted result; CorruptResultError names a damaged line."""
        *lines, _ = _bytes_of(self.path).split(b"\n")
        try:
            if not lines:
                raise CorruptResultError("line 1: missing")
            first = _verified(lines[0], "line 1")
            begun, _ = _result(first.get("begun"), "line 1: begun")
            shared = _decoded(first.get("fields"), "line 1")
            result = replace(begun, fields=shared).with_entries(_entries(lines[1:]))
            _check_states(result, "states of all lines")
            return _with_arrays(result, result.fields, "fields of all lines")
        except CorruptResultError as error:
            remedy = "remove this line and all after it, and the run continues from the lines before"
            raise CorruptResultError(f"{self.path}: {error}; {remedy}") from error

    @property
    def path(self) -> Path:
        """File of the journal."""
        return self.folder / JOURNAL_FILE


def _content(result: Result, fields_sha256: str | None) -> dict[str, Any]:
    """Return a result without its arrays in types of JSON."""
    content: dict[str, Any] = {"schema": SCHEMA} | json.loads(_RESULT.dump_json(result))
    content["provenance"]["fields_sha256"] = fields_sha256
    return content


def _verified(raw: bytes, place: str) -> dict[str, Any]:
    """Return a stored mapping without its checksum, after verifying schema and checksum."""
    try:
        content = json.loads(raw)
        if not isinstance(content, dict):
            raise ValueError(f"it holds a {type(content).__name__}; allowed: a table")
        if "schema" in content:
            _verify_schema(content, place)
        checksum = content.pop("checksum", None)
        if checksum != digest(content):  # ValueError for NaN, which is never written
            raise CorruptResultError(f"{place}: corrupt, its checksum does not match its content")
    except CorruptResultError:
        raise
    except (ValueError, RecursionError) as error:
        raise CorruptResultError(f"{place}: corrupt, not JSON of a result ({error})") from error
    return content


def _verify_schema(content: Mapping[str, Any], place: str) -> None:
    """Raise CorruptResultError for content of another schema."""
    schema = content.get("schema")
    if schema == FORMER:
        raise CorruptResultError(
            f"{place}: a result of linecontact 0.2.0, which this version does not read; run its scene again"
        )
    if schema != SCHEMA:
        raise CorruptResultError(f"{place}: schema is {schema!r}; allowed: {SCHEMA!r}")


def _typed(adapter: TypeAdapter[Kind], content: Any, place: str) -> Kind:
    """Return content of JSON as a dataclass; CorruptResultError names the first key that is wrong."""
    try:
        return adapter.validate_json(json.dumps(content), strict=True, extra="forbid")
    except ValidationError as error:
        raise CorruptResultError(f"{place}: {_first_mistake(error)}") from error


def _first_mistake(error: ValidationError) -> str:
    """Return the first wrong key, its value and the allowed values."""
    first = error.errors(include_url=False)[0]
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in first["loc"]).lstrip(".")
    if first["type"].startswith("missing"):
        return f"{key} is missing"
    shown = repr(first["input"])
    return f"{key} is {shown if len(shown) <= SHOWN else f'{shown[:SHOWN]}...'}: {first['msg']}"


def _result(content: Any, place: str) -> tuple[Result, str | None]:
    """Return the result of a content without fields, and the digest of the fields."""
    if not isinstance(content, dict):
        raise CorruptResultError(f"{place} is {type(content).__name__}; allowed: a table")
    _verify_schema(content, place)
    result = _typed(_RESULT, {name: value for name, value in content.items() if name != "schema"}, place)
    facts = dict(result.provenance)
    sha256 = facts.pop("fields_sha256", None)
    for key, value in result.provenance.items():
        if not isinstance(value, str) and (value is not None or key != "fields_sha256"):
            raise CorruptResultError(f"{place}: provenance.{key} is {str(value)[:SHOWN]}; allowed: a text")
    _check_scene(result.scene, place)
    _check_states(result, place)
    return replace(result, provenance=facts), sha256


def _check_scene(scene: Mapping[str, Any], place: str) -> None:
    """Raise CorruptResultError where a resolved scene lacks a table or a key, or a value is not allowed."""
    for name in ("title", *TABLES):
        table = scene.get(name, "missing" if name in TABLES else None)
        needed = name in ("title", *REQUIRED_TABLES, *WITH_DEFAULTS)
        if not isinstance(table, str if name == "title" else dict) and (table is not None or needed):
            raise CorruptResultError(f"{place}: scene.{name} is {str(table)[:SHOWN]}; allowed: a text or a table")
        if isinstance(table, dict):
            _check_table(name, table, place)


def _check_table(name: str, table: Mapping[str, Any], place: str) -> None:
    """Raise CorruptResultError where a resolved table lacks a key, has an unknown one, or a value is not allowed."""
    given = {key: value for key, value in table.items() if (name, key) != ("profile", "sha256")}
    if isinstance(given.get("initial"), dict):
        given["initial"] = {key: value for key, value in given["initial"].items() if key != "penetration"}
    try:
        needed = [*plain(class_of(name)(**given))]
    except TableError as error:
        raise CorruptResultError(f"{place}: scene.{error.mistakes[0]}") from error
    needed += ["period", *REQUIRED[table["kind"]]] if name == "profile" else []
    for key in needed:
        if key not in table:
            raise CorruptResultError(f"{place}: scene.{name}.{key} is missing")


def _check_states(result: Result, place: str) -> None:
    """Raise CorruptResultError where a state does not match the targets, the events or its edges."""
    loading, period = result.scene["loading"], result.scene["profile"]["period"]
    asked = len(loading["targets"]) + len(loading["at_mean_pressures"])
    asked += "stop_at_mean_pressure" in loading
    events, stored = 0, 0
    for k, state in enumerate(result.states):
        named = state.index is not None and 0 <= state.index < asked
        share = (
            sum(b - a for a, b in state.edges) / period if state.edges else float(state.status == "complete_contact")
        )
        close = abs(state.contact_fraction - share) < SAME_SHARE or not state.found
        for key, right, allowed in (
            ("index", named if state.target else state.index is None, f"0 to {asked - 1} at a target, else null"),
            ("events", events <= state.events <= len(result.events), f"{events} to {len(result.events)}"),
            ("edges", _placed(state.edges, period), f"ascending positions within one period of {period:g} m"),
            ("n_patches", state.n_patches == len(state.edges), f"{len(state.edges)}, the number of edges"),
            ("contact_fraction", close, f"{share:.9g}, the share of the period between edges"),
            ("stored", state.stored in (None, stored), f"{stored} or null"),
        ):
            if not right:
                raise CorruptResultError(f"{place}: states[{k}].{key} is {getattr(state, key)}; allowed: {allowed}")
        events, stored = state.events, stored + (state.stored is not None)
    for k, event in enumerate(result.events):
        for name, end in (("before", event.before), ("after", event.after)):
            if end is not None and not _placed(end.edges, period):
                allowed = f"ascending positions within one period of {period:g} m"
                raise CorruptResultError(f"{place}: events[{k}].{name}.edges is {end.edges}; allowed: {allowed}")


def _placed(edges: Sequence[tuple[float, float]], period: float) -> bool:
    """Return whether edges ascend within one period."""
    ends = [end for edge in edges for end in edge]
    return ends == sorted(ends) and (not ends or (0 <= ends[0] <= period and ends[-1] <= ends[0] + period))


def _with_arrays(result: Result, arrays: dict[str, NDArray[Any]], place: str) -> Result:
    """Return a result with its arrays; raise CorruptResultError unless they match its states."""
    try:
        check_arrays(arrays, [state.stored for state in result.states if state.stored is not None])
    except CorruptArraysError as error:
        raise CorruptResultError(f"{place}: corrupt, {error}") from error
    return replace(result, fields=arrays)


def _arrays(raw: bytes, place: str) -> dict[str, NDArray[Any]]:
    """Return the arrays of an npz file."""
    try:
        return unpacked(raw)
    except CorruptArraysError as error:
        raise CorruptResultError(f"{place}: corrupt, {error}") from error


def _entries(lines: Iterable[bytes]) -> Iterator[Entry]:
    """Yield the entries of the lines of a journal behind its first one."""
    for number, raw in enumerate(lines, 2):
        place = f"line {number}"
        line = _typed(_LINE, _verified(raw, place), place)
        yield Entry(line.events, line.state, _decoded(line.fields, place), line.warnings, line.tension)


def _entry_line(entry: Entry) -> bytes:
    """Return an entry as a line of the journal."""
    line = Line(entry.events, entry.state, entry.warnings, entry.tension, _encoded(entry.fields))
    return _line(json.loads(_LINE.dump_json(line)))


def _line(content: dict[str, Any]) -> bytes:
    """Return a line of the journal, with its checksum."""
    return (json.dumps(content | {"checksum": digest(content)}, allow_nan=False) + "\n").encode()


def _encoded(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return arrays as the base64 text of an npz file."""
    return base64.b64encode(packed(arrays)).decode()


def _decoded(text: Any, place: str) -> dict[str, NDArray[Any]]:
    """Return the arrays of the base64 text of an npz file."""
    try:
        raw = base64.b64decode(text, validate=True)
    except (ValueError, TypeError) as error:
        raise CorruptResultError(f"{place}: fields are no text of base64 ({error})") from error
    return _arrays(raw, place)


def _text_of(content: dict[str, Any]) -> str:
    """Return JSON of a mapping and its checksum: a line for each value, and for each entry of a list."""
    parts = []
    for name, value in (content | {"checksum": digest(content)}).items():
        entries = [json.dumps(entry, allow_nan=False) for entry in value] if isinstance(value, list) else None
        text = json.dumps(value, allow_nan=False) if not entries else "[\n  " + ",\n  ".join(entries) + "\n ]"
        parts.append(f" {json.dumps(name)}: {text}")
    return "{\n" + ",\n".join(parts) + "\n}\n"
