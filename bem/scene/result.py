"""States, events and results of a loading path, and the two files that hold them.

`result.json` holds everything but arrays; `fields.npz` the fields asked for.  Both are written under a
temporary name, flushed to disk and renamed, so that a reader finds the old or the new file, never a part.
`checksum` is the SHA-256 of `json.dumps(content, sort_keys=True)` of the content without that field; the digest of
fields.npz stands in the provenance.  JSON knows neither NaN nor infinity: they become null, and null reads as
None where a value may be missing, as NaN elsewhere.  All other numbers come back bit for bit.

Units: m, Pa, J/m^2 of nominal area, Pa m^1/2, Pa/m, s.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import platform
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.compiled.kernels import IN_USE
from bem.scene.atomic_file import write_atomically
from bem.scene.result_views import Views

SCHEMA = "linecontact-result/1"
RESULT_FILE, FIELDS_FILE = "result.json", "fields.npz"
FINAL_STATUSES = ("converged", "separated", "complete_contact")
STATUSES = (*FINAL_STATUSES, "unreachable", "not_converged", "interrupted")


class NotFiniteError(ArithmeticError):
    """A number of a state came out as NaN or infinite: such a state does not exist."""


class CorruptResultError(ValueError):
    """A stored result that cannot be trusted: damaged, incomplete or of another schema."""


@dataclass(frozen=True)
class Effect:
    """An effect of the vocabulary, whether a scene calls for it, why, and its predicted cost in s."""

    name: str
    active: bool
    reason: str
    seconds: float


@dataclass(frozen=True)
class Caution:
    """What is out of the ordinary in a scene: the key or group concerned, and the probable cause."""

    about: str
    message: str


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated absolute error of every number a state reports, in the unit of that number; None: not estimated."""

    mean_pressure: float | None = None
    contact_fraction: float | None = None
    penetration: float | None = None
    separation: float | None = None
    total_displacement: float | None = None
    elastic_energy: float | None = None
    adhesion_energy: float | None = None
    total_energy: float | None = None
    stress_intensity_max: float | None = None
    contact_stiffness: float | None = None


@dataclass(frozen=True)
class Certificate:
    """A-posteriori checks of a state; `min_gap` in m, the rest dimensionless, None where it has no meaning.

    `reasons` names each demand that is not met, with its limit and place.
    """

    closure: float | None
    min_gap: float | None
    min_eigenvalue: float | None
    truncation: float | None
    hessian_asymmetry: float | None
    ok: bool
    reasons: tuple[str, ...] = ()


@dataclass(frozen=True)
class State:
    """An equilibrium on the path; energies in J/m^2 of nominal area, edges in m, `contact_stiffness` in Pa/m.

    Every number is finite.  Two may say that none exists: an estimated error is infinite where the corrected edges
    overlap; `mean_pressure` is NaN (null in the file) where any would do, in complete contact under a prescribed
    separation, and where the state asked for does not exist.  `total_displacement` is None there on a compressible
    layer.  `events` is the number of events up to this state; None in results that did not store it.  The status is
    `not_converged` where the certificate is not ok.

    Raises
    ------
    NotFiniteError
        Another number is NaN or infinite.
    """

    branch: str
    penetration: float
    separation: float
    total_displacement: float | None
    mean_pressure: float
    contact_fraction: float
    n_patches: int
    edges: tuple[tuple[float, float], ...]
    elastic_energy: float
    adhesion_energy: float
    total_energy: float
    stress_intensity_max: float | None
    contact_stiffness: float | None
    stable_at_fixed_load: bool | None
    error_estimate: ErrorEstimate
    certificate: Certificate
    unknowns: int
    evaluations: int
    cpu_seconds: float
    status: str
    target: bool
    events: int | None = None

    def __post_init__(self) -> None:
        numbers = {name: value for name, value in vars(self).items() if isinstance(value, float)}
        if self.status in ("complete_contact", "unreachable") and math.isnan(self.mean_pressure):
            del numbers["mean_pressure"]
        numbers |= {f"edges[{i}]": a + b for i, (a, b) in enumerate(self.edges)}
        numbers |= {f"certificate.{name}": value for name, value in vars(self.certificate).items()}
        for name, value in numbers.items():
            if isinstance(value, float) and not math.isfinite(value):
                raise NotFiniteError(f"{name} is {value}")
        for name, value in vars(self.error_estimate).items():
            if value is not None and math.isnan(value):
                raise NotFiniteError(f"error_estimate.{name} is {value}")


@dataclass(frozen=True)
class EventError:
    """Estimated absolute error of the numbers of an event, in their units."""

    penetration: float
    mean_pressure: float | None
    energy_released: float | None


@dataclass(frozen=True)
class Event:
    """A change of topology or stability; `position` in m, `energy_released` in J/m^2; kinds: bem/README.md, section 5.

    Penetration and mean pressure are those of the equilibrium from which the contact jumps.  The pressure is NaN (null
    in the file) where the last gap closes, or the first opens, under a given separation: the tension there has no
    bound.  The energy of an avalanche stands with its first event; it is None where a dead tension pulls off.
    """

    kind: str
    penetration: float
    mean_pressure: float
    position: float | None
    energy_released: float | None
    error_estimate: EventError


@dataclass(frozen=True)
class Progress:
    """Where a running solution stands; pressure in Pa, `target_index` counts from 0."""

    mean_pressure: float
    contact_fraction: float
    n_patches: int
    increments_accepted: int
    increments_rejected: int
    evaluations: int
    target_index: int
    n_targets: int


@dataclass(frozen=True, eq=False, repr=False)
class Result(Views):
    """All states and events of a path.

    Parameters
    ----------
    scene : dict
        The resolved scene, `Scene.resolved()`.
    effects : tuple of Effect
    provenance : dict
        See `provenance`.
    states : tuple of State
        In the order visited.
    events : tuple of Event
    status : str
        One of `STATUSES`.
    fields : dict of arrays
        Contents of fields.npz.
    failure : str, optional
        Why the status is `unreachable` or `not_converged`.
    groups : dict of floats
        The dimensionless groups that decide, and the scales they are made with (plausibility.py).
    warnings : tuple of Caution
    profile_preparation : tuple of dict
        What was done to the samples of a scan, step by step (scan_preparation.py).
    """

    scene: dict[str, Any]
    effects: tuple[Effect, ...]
    provenance: dict[str, Any]
    states: tuple[State, ...]
    events: tuple[Event, ...]
    status: str
    fields: dict[str, NDArray[Any]] = field(default_factory=dict)
    failure: str | None = None
    groups: dict[str, float] = field(default_factory=dict)
    warnings: tuple[Caution, ...] = ()
    profile_preparation: tuple[dict[str, Any], ...] = ()

    @property
    def targets(self) -> tuple[State, ...]:
        """The states at targets."""
        return tuple(state for state in self.states if state.target)


def digest(content: Mapping[str, Any]) -> str:
    """SHA-256 of a mapping as JSON with sorted keys.

    Examples
    --------
    >>> digest({"a": 1, "b": 0.1}) == digest({"b": 0.1, "a": 1})
    True
    """
    return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=False).encode()).hexdigest()


def installed_version() -> str:
    """Version of the installed package, `bem.__version__`."""
    try:
        return metadata.version("linecontact")
    except metadata.PackageNotFoundError:
        return "not installed"


def provenance(resolved_scene: Mapping[str, Any]) -> dict[str, Any]:
    """Versions, kernels, Python, platform, date (UTC) and digest of the scene; no path, no host name."""
    return {
        "linecontact": installed_version(),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "numpy": np.__version__,
        "scipy": metadata.version("scipy"),
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
    write_atomically(folder / RESULT_FILE, json.dumps(content, indent=1, allow_nan=False) + "\n")
    if not arrays:
        (folder / FIELDS_FILE).unlink(missing_ok=True)


def read_result(folder: Path | str) -> Result:
    """Read what `write_result` wrote, and verify it.

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
    path = folder / RESULT_FILE
    try:
        content = json.loads(path.read_bytes())
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
