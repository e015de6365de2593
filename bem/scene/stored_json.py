"""Stored JSON of a result: bytes, checksum and keys are verified, then the dataclasses of result.py are made of it.

A file is right where its checksum is, where every value has the type of its key, and where the dataclasses written
again have the keys of the file.  `checksum` is the SHA-256 of `json.dumps(content, sort_keys=True)` of the content
without that field.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from bem.geometry.ranges import shown
from bem.geometry.regular_file import read_regular
from bem.scene.digest import digest

SIGNS = {"lt": "<", "gt": ">", "ge": ">="}  # of limits, by their names in pydantic
SCHEMA, FORMER = "linecontact-result/2", "linecontact-result/1"

Stored = TypeVar("Stored")


class CorruptResultError(ValueError):
    """Stored result that cannot be trusted: damaged, incomplete or of another schema."""


def read_bytes(path: Path) -> bytes:
    """Read a file; FileNotFoundError if there is none, CorruptResultError if it cannot be read."""
    try:
        return read_regular(path)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise CorruptResultError(f"{path}: {error.strerror}") from error


def verified(raw: bytes, place: str, schema: str | None = None) -> dict[str, Any]:
    """Return a stored mapping without its checksum and its schema, if it needs one, after verifying both."""
    try:
        content = json.loads(raw)
        if not isinstance(content, dict):
            raise ValueError(f"it holds a {type(content).__name__}; allowed: a table")
        if schema is not None and content.get("schema") != schema:
            raise CorruptResultError(f"{place}: {_other_schema(content.get('schema'))}")
        checksum = content.pop("checksum", None)
        if checksum != digest(content):  # ValueError for NaN, which is never written
            raise CorruptResultError(f"{place}: corrupt, its checksum does not match its content")
    except CorruptResultError:
        raise
    except (ValueError, RecursionError) as error:
        raise CorruptResultError(f"{place}: corrupt, not JSON as it was written ({error})") from error
    if schema is not None:
        del content["schema"]
    return content


def _other_schema(schema: Any) -> str:
    """Return what is wrong with another schema."""
    if schema == FORMER:
        return "a result of linecontact 0.2.0, which this version does not read; run its scene again"
    return f"schema is {shown(schema)}; allowed: {SCHEMA}"


def typed(adapter: TypeAdapter[Stored], content: dict[str, Any], place: str, without: str | None = None) -> Stored:
    """Return content of JSON as a dataclass, `without` a key that files do not hold.

    CorruptResultError names the first key that is wrong.
    """
    if without in content:
        raise CorruptResultError(f"{place}: {without} is no key")
    try:
        part = adapter.validate_json(json.dumps(content), strict=True, extra="forbid")
    except ValidationError as error:
        raise CorruptResultError(f"{place}: {_first_mistake(error)}") from error
    exclude = None if without is None else {without}
    missing = _missing(content, json.loads(adapter.dump_json(part, exclude=exclude)))
    if missing:
        raise CorruptResultError(f"{place}: {missing} is missing")
    return part


def _missing(stored: Any, written: Any, key: str = "") -> str:
    """Return the first key of the content written again that the stored content lacks; no key if it lacks none."""
    if isinstance(written, dict):
        pairs = [(f"{key}.{name}".lstrip("."), stored.get(name, KeyError), value) for name, value in written.items()]
    elif isinstance(written, list):
        pairs = [(f"{key}[{k}]", *pair) for k, pair in enumerate(zip(stored, written, strict=True))]
    else:
        return ""
    lacking = (path if value is KeyError else _missing(value, again, path) for path, value, again in pairs)
    return next(filter(None, lacking), "")


def _first_mistake(error: ValidationError) -> str:
    """Return the first wrong key, its value and the allowed values."""
    first = error.errors(include_url=False)[0]
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in first["loc"]).lstrip(".")
    if first["type"].startswith("missing"):
        return f"{key} is missing"
    limit = [f"; allowed: {SIGNS[name]} {value:g}" for name, value in first.get("ctx", {}).items() if name in SIGNS]
    return f"{key} is {shown(first['input'])}{''.join(limit) or ': ' + first['msg']}"
