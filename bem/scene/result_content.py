"""A result as plain values of JSON and as the bytes of an npz file, and back, with every type checked.

JSON knows neither NaN nor infinity: they become null, and null reads as None where a value may be missing, as NaN where
a number is asked for.  All other numbers come back bit for bit.  Types are those of the dataclasses of result.py: what
has another one, is missing or is unknown is named with its place.  Arrays are stored as they are: an archive that is
compressed, or whose headers promise more than it holds, is refused before anything is unpacked.
"""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from bem.scene.result import NotFiniteError

Kind = TypeVar("Kind")
LONGEST_NAME = 64  # format: characters of the name of an array
NUMBERS = "biuf"  # kinds of arrays that a result holds


class CorruptResultError(ValueError):
    """A stored result that cannot be trusted: damaged, incomplete or of another schema."""


def plain(value: Any) -> Any:
    """The same value in types of JSON, NaN and infinity as null.

    Examples
    --------
    >>> plain({"a": (1, math.nan), "b": np.float64(0.5)})
    {'a': [1, None], 'b': 0.5}
    """
    if is_dataclass(value):
        return {part.name: plain(getattr(value, part.name)) for part in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def typed(kind: type[Kind], stored: Any, place: str) -> Kind:
    """A value of JSON as what it stands for: a dataclass, a tuple, a mapping, a number, a name.

    Parameters
    ----------
    kind : type
        As annotated.
    stored : value of JSON
    place : str
        Where it stands, for the error.

    Raises
    ------
    CorruptResultError
        It is none; which part, and what it is instead.

    Examples
    --------
    >>> typed(tuple[float, ...], [1, None, 0.5], "here")
    (1.0, nan, 0.5)
    >>> typed(tuple[float, ...], [1, "0.5"], "here")
    Traceback (most recent call last):
    ...
    bem.scene.result_content.CorruptResultError: here[1] is '0.5', not a number
    """
    return cast(Kind, _typed(kind, stored, place))


def packed(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Arrays as the bytes of an npz file, not compressed; no bytes without arrays."""
    if not arrays:
        return b""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()


def unpacked(raw: bytes, place: str) -> dict[str, NDArray[Any]]:
    """What `packed` made, after a look at what the archive and the headers of its arrays promise.

    Raises
    ------
    CorruptResultError
        Not such an archive: which array, and why.
    """
    if not raw:
        return {}
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            return {_name(member): _array(archive, member) for member in archive.infolist()}
    except (ValueError, EOFError, zipfile.BadZipFile, NotImplementedError, RuntimeError) as error:
        raise CorruptResultError(f"{place}: corrupt ({error})") from error


def _name(member: zipfile.ZipInfo) -> str:
    """The name of an array in an archive."""
    name = member.filename.removesuffix(".npy")
    if not (name != member.filename and name.isascii() and name.isidentifier() and len(name) <= LONGEST_NAME):
        raise ValueError(f"{member.filename[:LONGEST_NAME]!r} is no name of an array")
    return name


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    """An array of an archive; ValueError where it is compressed, of another size than it says, or not of numbers."""
    if member.compress_type != zipfile.ZIP_STORED or member.file_size != member.compress_size:
        raise ValueError(f"{member.filename} is compressed")
    raw = archive.read(member)
    stream = io.BytesIO(raw)
    versions = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    version = np.lib.format.read_magic(stream)
    if version not in versions:
        raise ValueError(f"{member.filename} has a format of version {version}")
    shape, _, kind = versions[version](stream)
    if kind.kind not in NUMBERS or math.prod(shape) * kind.itemsize != len(raw) - stream.tell():
        raise ValueError(f"{member.filename}: its bytes are not numbers of shape {shape} and type {kind}")
    stream.seek(0)
    return np.asarray(np.lib.format.read_array(stream, allow_pickle=False))


@cache
def _parts(kind: type) -> dict[str, tuple[Any, bool]]:
    """Annotated type of each field of a dataclass, and whether a file may lack it."""
    hints = get_type_hints(kind)
    return {
        part.name: (hints[part.name], part.default is not MISSING or part.default_factory is not MISSING)
        for part in fields(kind)
    }


def _typed(kind: Any, stored: Any, place: str) -> Any:
    """As `typed`, of any annotation."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is UnionType:
        (kind,) = (one for one in inner if one is not NoneType)
        return None if stored is None else _typed(kind, stored, place)
    if is_dataclass(kind):
        return _record(cast(type, kind), stored, place)
    if origin is tuple and isinstance(stored, list) and (inner[-1] is Ellipsis or len(inner) == len(stored)):
        return tuple(_typed(inner[0], item, f"{place}[{i}]") for i, item in enumerate(stored))
    if origin is dict and isinstance(stored, dict):
        return stored if inner[1] is Any else {k: _typed(inner[1], v, f"{place}.{k}") for k, v in stored.items()}
    if kind is float and (stored is None or type(stored) in (int, float)):
        return math.nan if stored is None else _number(stored, place)
    if kind in (int, str, bool) and type(stored) is kind:
        return stored
    asked = {float: "a number", int: "an integer", str: "a text", bool: "true or false", tuple: "a list"}
    raise CorruptResultError(f"{place} is {_shown(stored)}, not {asked.get(origin or kind, 'a table')}")


def _number(stored: float, place: str) -> float:
    try:
        return float(stored)
    except OverflowError as error:
        raise CorruptResultError(f"{place} is an integer too large for a number") from error


def _record(kind: type, stored: Any, place: str) -> Any:
    """A dataclass, every field checked."""
    if not isinstance(stored, dict):
        raise CorruptResultError(f"{place} is {_shown(stored)}, not a table")
    parts = _parts(kind)
    for name in stored:
        if name not in parts:
            raise CorruptResultError(f"{place} has an unknown key, {_shown(name)}")
    for name, (_, optional) in parts.items():
        if name not in stored and not optional:
            raise CorruptResultError(f"{place}.{name} is missing")
    found = {name: _typed(parts[name][0], value, f"{place}.{name}") for name, value in stored.items()}
    try:
        return kind(**found)
    except NotFiniteError as error:
        raise CorruptResultError(f"{place}: {error}") from error


def _shown(value: Any) -> str:
    """A value, or its beginning."""
    text = repr(value)
    return text if len(text) <= LONGEST_NAME else f"{text[:LONGEST_NAME]}..."
