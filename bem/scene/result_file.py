"""Files of a finished result: result.json and fields.npz.

`result.json` holds everything but arrays, as the dataclasses of result.py have it (pydantic); null stands for NaN and
infinity, and all other numbers come back bit for bit.  `fields.npz` holds the arrays asked for (stored_arrays.py); its
digest stands in the provenance.  Both are written under a temporary name, flushed to disk and renamed, so that a reader
finds the old or the new file, never a part.  A run in the making is in journal.py.

Results of linecontact 0.2.0 (schema 1), whose states do not name their targets, are refused.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from numpy.typing import NDArray
from pydantic import TypeAdapter

from bem.geometry.ranges import shown
from bem.scene.atomic_file import write_atomically
from bem.scene.digest import digest
from bem.scene.journal import JOURNAL_FILE, Journal
from bem.scene.result import Result
from bem.scene.result_invariants import contradiction
from bem.scene.stored_arrays import CorruptArraysError, packed, unpacked
from bem.scene.stored_json import SCHEMA, CorruptResultError, read_bytes, typed, verified

RESULT_FILE, FIELDS_FILE = "result.json", "fields.npz"
_RESULT = TypeAdapter(Result)


def write_result(result: Result, folder: Path) -> None:
    """Write result.json and, when there are fields, fields.npz, and remove the journal; make the folder if need be.

    Raises
    ------
    OSError
        Disk full or folder not writable; what was there before stays as it was.
    """
    folder.mkdir(parents=True, exist_ok=True)
    arrays = packed(result.fields)
    text = _text_of(result, hashlib.sha256(arrays).hexdigest() if arrays else None)
    if arrays:
        write_atomically(folder / FIELDS_FILE, arrays)
    write_atomically(folder / RESULT_FILE, text)
    if not arrays:
        (folder / FIELDS_FILE).unlink(missing_ok=True)
    (folder / JOURNAL_FILE).unlink(missing_ok=True)


def write_states(result: Result, folder: Path) -> None:
    """Write result.json alone, of a run that goes on: fields are written at its end.  OSError as `write_result`."""
    write_atomically(folder / RESULT_FILE, _text_of(result, None))
    (folder / FIELDS_FILE).unlink(missing_ok=True)


def read_result(folder: Path | str) -> Result:
    """Read the result of a folder, or of its result.json; of a run that has not ended, the states that it has stored.

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
        raw = read_bytes(path)
    except FileNotFoundError as error:
        rows = "; of a map that was solved row by row, read_rows reads the folder" if any(folder.glob("row-*")) else ""
        raise FileNotFoundError(f"{path}: no result of a run there{rows}") from error
    result, sha256 = _without_arrays(raw, str(path))
    if sha256 is None and result.status != "interrupted" and any(state.stored is not None for state in result.states):
        raise CorruptResultError(
            f"{path}: provenance.fields_sha256 is null; allowed: the digest of the arrays of states"
        )
    result = replace(result, fields=_arrays(folder / FIELDS_FILE, sha256))
    mistake = contradiction(result)
    if mistake is not None:
        path = folder / FIELDS_FILE if mistake.path.startswith("fields.") else path
        raise CorruptResultError(f"{path}: {mistake}")
    return result


def _without_arrays(raw: bytes, place: str) -> tuple[Result, str | None]:
    """Return the result of result.json, and the digest of its arrays, None without arrays."""
    content = verified(raw, place, SCHEMA)
    facts = content.get("provenance")
    sha256 = facts.pop("fields_sha256", False) if isinstance(facts, dict) else None
    if sha256 is not None and not isinstance(sha256, str):
        raise CorruptResultError(f"{place}: provenance.fields_sha256 is {shown(sha256)}; allowed: a digest or null")
    return typed(_RESULT, content, place, without="fields"), sha256


def _arrays(path: Path, sha256: str | None) -> dict[str, NDArray[Any]]:
    """Return the arrays of fields.npz, which a run in the making does not have yet."""
    if sha256 is None:
        return {}
    if not path.exists():
        raise CorruptResultError(f"{path}: missing, but result.json was written with it")
    raw = read_bytes(path)
    if hashlib.sha256(raw).hexdigest() != sha256:
        raise CorruptResultError(f"{path}: corrupt, or not the file written with result.json")
    try:
        arrays = unpacked(raw)
    except CorruptArraysError as error:
        raise CorruptResultError(f"{path}: {error}") from error
    if not arrays:
        raise CorruptResultError(f"{path}: holds no arrays")
    return arrays


def _text_of(result: Result, fields_sha256: str | None) -> str:
    """Return result.json of a result with its checksum: a line for each value, and for each entry of a list."""
    content: dict[str, Any] = {"schema": SCHEMA} | json.loads(_RESULT.dump_json(result, exclude={"fields"}))
    content["provenance"]["fields_sha256"] = fields_sha256
    parts = []
    for name, value in (content | {"checksum": digest(content)}).items():
        entries = [json.dumps(entry, allow_nan=False) for entry in value] if isinstance(value, list) else None
        text = json.dumps(value, allow_nan=False) if not entries else "[\n  " + ",\n  ".join(entries) + "\n ]"
        parts.append(f" {json.dumps(name)}: {text}")
    return "{\n" + ",\n".join(parts) + "\n}\n"
