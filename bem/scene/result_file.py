"""The two files that hold a result, written whole and verified when read.

`result.json` holds everything but arrays; `fields.npz` the fields asked for.  Both are written under a
temporary name, flushed to disk and renamed, so that a reader finds the old or the new file, never a part.
`checksum` is the SHA-256 of `json.dumps(content, sort_keys=True)` of the content without that field; the digest of
fields.npz stands in the provenance.  JSON knows neither NaN nor infinity: they become null, and null reads as
None where a value may be missing, as NaN elsewhere.  All other numbers come back bit for bit.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import platform
import zipfile
from collections.abc import Mapping
from dataclasses import asdict
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.scene.atomic_file import write_atomically
from bem.scene.result import (
    Caution,
    Certificate,
    Effect,
    ErrorEstimate,
    Event,
    EventError,
    NotFiniteError,
    Result,
    State,
)

SCHEMA = "linecontact-result/1"
RESULT_FILE, FIELDS_FILE = "result.json", "fields.npz"


class CorruptResultError(ValueError):
    """A stored result that cannot be trusted: damaged, incomplete or of another schema."""


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
    """Write result.json and, when there are fields, fields.npz; make the folder if need be.

    Raises
    ------
    OSError
        Disk full or folder not writable; what was there before stays as it was.
    """
    folder.mkdir(parents=True, exist_ok=True)
    arrays = b""
    if result.fields:
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **result.fields)
        arrays = buffer.getvalue()
    content = _plain(
        {
            "schema": SCHEMA,
            "scene": result.scene,
            "effects": [asdict(effect) for effect in result.effects],
            "warnings": [asdict(caution) for caution in result.warnings],
            "groups": result.groups,
            "profile_preparation": result.profile_preparation,
            "provenance": result.provenance | {"fields_sha256": hashlib.sha256(arrays).hexdigest() if arrays else None},
            "states": [asdict(state) for state in result.states],
            "events": [asdict(event) for event in result.events],
            "status": result.status,
            "failure": result.failure,
        }
    )
    content["checksum"] = digest(content)
    if arrays:
        write_atomically(folder / FIELDS_FILE, arrays)
    write_atomically(folder / RESULT_FILE, _lines(content))
    if not arrays:
        (folder / FIELDS_FILE).unlink(missing_ok=True)


def read_result(folder: Path | str) -> Result:
    """Read what `write_result` wrote, and verify it.

    Parameters
    ----------
    folder : Path or str
        The folder, or its result.json.

    Raises
    ------
    FileNotFoundError
        No result.json there.
    CorruptResultError
        Not JSON, another schema, wrong checksum, fields.npz missing or not the one written with it.

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
    path = folder / RESULT_FILE
    try:
        content = json.loads(path.read_bytes())
    except FileNotFoundError as error:
        raise FileNotFoundError(f"{path}: no result of a run there") from error
    except ValueError as error:
        raise CorruptResultError(f"{path}: corrupt, not JSON ({error})") from error
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        found = content.get("schema") if isinstance(content, dict) else type(content).__name__
        raise CorruptResultError(f"{path}: schema {found!r} is not {SCHEMA!r}")
    stored = content.pop("checksum", None)
    if stored != _digest_or_none(content):
        raise CorruptResultError(f"{path}: corrupt, its checksum does not match its content")
    try:
        fields_sha256 = content["provenance"].pop("fields_sha256")
        return Result(
            scene=content["scene"],
            effects=tuple(Effect(**effect) for effect in content["effects"]),
            provenance=content["provenance"],
            states=tuple(_state(state) for state in content["states"]),
            events=tuple(_event(event) for event in content["events"]),
            status=content["status"],
            fields=_read_fields(folder / FIELDS_FILE, fields_sha256),
            failure=content.get("failure"),
            groups=content.get("groups", {}),
            warnings=tuple(Caution(**caution) for caution in content.get("warnings", ())),
            profile_preparation=tuple(content.get("profile_preparation", ())),
        )
    except (KeyError, TypeError, AttributeError, NotFiniteError) as error:
        raise CorruptResultError(f"{path}: incomplete ({error!r})") from error


def _read_fields(path: Path, sha256: str | None) -> dict[str, NDArray[Any]]:
    if sha256 is None:
        return {}
    try:
        raw = path.read_bytes()
    except FileNotFoundError as error:
        raise CorruptResultError(f"{path}: missing, but result.json was written with it") from error
    if hashlib.sha256(raw).hexdigest() != sha256:
        raise CorruptResultError(f"{path}: corrupt, or not the file written with result.json")
    try:
        with np.load(io.BytesIO(raw), allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (ValueError, zipfile.BadZipFile) as error:
        raise CorruptResultError(f"{path}: corrupt ({error})") from error


def _lines(content: dict[str, Any]) -> str:
    """JSON of a mapping with a line for each of its values, and for each entry of those that are lists."""
    parts = []
    for name, value in content.items():
        entries = [json.dumps(entry, allow_nan=False) for entry in value] if isinstance(value, list) else None
        text = json.dumps(value, allow_nan=False) if not entries else "[\n  " + ",\n  ".join(entries) + "\n ]"
        parts.append(f" {json.dumps(name)}: {text}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _digest_or_none(content: dict[str, Any]) -> str | None:
    """The digest; None for content with NaN, which this module never writes."""
    try:
        return digest(content)
    except ValueError:
        return None


def _plain(value: Any) -> Any:
    """The same value in types of JSON, NaN and infinity as null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _float(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _optional(value: float | None) -> float | None:
    return None if value is None else float(value)


def _state(stored: dict[str, Any]) -> State:
    content = dict(stored)
    for name in ("total_displacement", "stress_intensity_max", "contact_stiffness"):
        content[name] = _optional(stored[name])
    for name in ("penetration", "separation", "mean_pressure", "contact_fraction", "cpu_seconds"):
        content[name] = _float(stored[name])
    for name in ("elastic_energy", "adhesion_energy", "total_energy"):
        content[name] = _float(stored[name])
    content["edges"] = tuple((float(a), float(b)) for a, b in stored["edges"])
    content["error_estimate"] = ErrorEstimate(**stored["error_estimate"])
    certificate = stored["certificate"]
    content["certificate"] = Certificate(**certificate | {"reasons": tuple(certificate.get("reasons", ()))})
    return State(**content)


def _event(stored: dict[str, Any]) -> Event:
    return Event(
        kind=stored["kind"],
        penetration=_float(stored["penetration"]),
        mean_pressure=_float(stored["mean_pressure"]),
        position=_optional(stored["position"]),
        energy_released=_optional(stored["energy_released"]),
        error_estimate=EventError(**stored["error_estimate"]),
    )
