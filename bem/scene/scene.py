"""The scene file: what is solved, in SI units, checked in full before anything runs.

A scene is TOML with the tables [solid], [profile], [layer], [adhesion], [loading], [accuracy], [output].
`parse_scene` checks types and ranges (pydantic, strict: no text or truth value passes for a number), then what
depends on more than one key, and reports every mistake at once.  The `Scene` it returns is frozen and resolved:
defaults filled in, start/stop/count expanded, the scan read.

Values of the targets and of the lists in [output] are those of the controlled quantity (m, or Pa for mean_pressure).
An output is asked for at targets alone, so that no output changes the path.  A path start/stop/count visits
linspace(start, stop, count); `then_back_to` appends the way back with the same count, the turning point once.
A separation of exactly 0 asks for complete contact.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from bem.geometry.profile import Profile
from bem.geometry.ranges import MOST_HARMONICS, Mistake, shown
from bem.scans.scan_keys import BACKSLASHES, CUTOFFS, DEFAULTS, SCAN_KEYS
from bem.scene.result import State
from bem.scene.scene_rules import (
    QUESTIONS,
    RANGE,
    REMOVED,
    SAMPLED_HARMONICS,
    SceneError,
    loading_mistakes,
    magnitude_mistakes,
    profile_mistakes,
    scan_mistakes,
    surface_of,
    unknown_key,
)
from bem.scene.scene_tables import (
    OUTPUTS,
    REQUIRED_TABLES,
    TABLES,
    AccuracyTable,
    AdhesionTable,
    LayerTable,
    LoadingTable,
    OutputTable,
    ProfileTable,
    SolidTable,
    StoredStart,
    Table,
    said_of,
)
from bem.scene.stored_start import StoredState, other_problem, stored_start
from bem.scene.targets import expanded, found, origin

if TYPE_CHECKING:
    from bem.scans.prepared_scan import Scan, Step

LISTED = 12  # format: targets listed in an error

__all__ = ["LoadingTable", "Mistake", "Scene", "SceneError", "StoredStart", "load_scene", "parse_scene"]


@dataclass(frozen=True, repr=False)
class Scene:
    """A checked and resolved scene; tables absent from the file are None.

    Parameters
    ----------
    title : str
    solid, profile, layer, adhesion, loading, accuracy, output
        The tables, SI units; `loading.targets` holds all targets.
    origin : float
        Value of the controlled quantity where the path begins, possibly infinite.
    scan : Scan, optional
        Samples of profile.file.
    cut_by_default : bool
        Whether profile.harmonics was chosen for a scan, not given.
    start_state : State, optional
        The stored state of loading.initial.
    """

    title: str
    solid: SolidTable
    profile: ProfileTable
    layer: LayerTable | None
    adhesion: AdhesionTable | None
    loading: LoadingTable
    accuracy: AccuracyTable
    output: OutputTable
    origin: float
    scan: Scan | None = field(default=None, compare=False)
    cut_by_default: bool = False
    start_state: State | None = None

    def __repr__(self) -> str:
        count, control = len(self.loading.targets), self.loading.control
        tables = ", ".join(name for name in ("layer", "adhesion") if getattr(self, name) is not None)
        kind = f"{self.profile.kind} profile{', ' * bool(tables)}{tables}"
        return f"<Scene {self.title!r}: {kind}, {count} target{'s' * (count != 1)} of {control}>"

    def surface(self) -> Profile:
        """The profile, SI units; made once, as its table takes seconds and memory where harmonics are many."""
        return self._surface

    @cached_property
    def _surface(self) -> Profile:
        return surface_of(self.profile.model_dump(), self.scan)

    def preparation(self) -> tuple[Step, ...]:
        """What was done to the samples of a scan, step by step; nothing for other profiles."""
        if self.scan is None or not isinstance(self.profile.harmonics, int):
            return ()
        return self.scan.preparation(self.profile.harmonics)

    def physics(self) -> dict[str, Any]:
        """The tables that say what is in contact, those absent left out; other codes check that they provide all."""
        tables = {name: getattr(self, name) for name in TABLES if name not in QUESTIONS}
        return {name: table for name, table in tables.items() if table is not None}

    def wants(self, output: str, index: int) -> bool:
        """Return whether `output` ("shapes", "spectra", ...) is asked for at the target with an index."""
        asked = getattr(self.output, output)
        if isinstance(asked, bool):
            return asked
        return index < len(self.loading.targets) and found(self.loading.targets[index], asked) is not None

    def resolved(self) -> dict[str, Any]:
        """Everything as plain values, defaults included; a file is given by its name and digest."""
        content: dict[str, Any] = {"title": self.title}
        for name in TABLES:
            table = getattr(self, name)
            content[name] = None if table is None else table.model_dump(mode="json", exclude_none=True)
        if self.scan is not None:
            content["profile"] |= {"file": Path(str(self.profile.file)).name, "sha256": self.scan.sha256}
        if self.start_state is not None and isinstance(self.loading.initial, StoredStart):
            content["loading"]["initial"]["result"] = Path(self.loading.initial.result).name
            content["loading"]["initial"]["penetration"] = self.start_state.penetration
        return content


def load_scene(path: Path | str) -> Scene:
    """Read a scene file; file names in it are relative to its folder.

    Raises
    ------
    SceneError
        With every mistake, or because the file cannot be read or is not TOML.
    """
    path = Path(path)
    try:
        data = tomllib.loads(path.read_text("utf-8-sig"))
    except OSError as error:
        raise SceneError([Mistake(str(path), f"cannot be read ({error.strerror})", "a TOML file")]) from error
    except (ValueError, RecursionError) as error:
        escaped = str(error).startswith(("Invalid hex value", "Unescaped '\\'"))  # a name of a file under Windows
        allowed = f"names with {BACKSLASHES}" if escaped else "a TOML file in UTF-8"
        raise SceneError([Mistake(str(path), f"is not TOML ({error})", allowed)]) from error
    return parse_scene(data, path.parent)


def parse_scene(data: Mapping[str, Any], base_dir: Path | str = ".") -> Scene:
    """Check the contents of a scene file and resolve them.

    Parameters
    ----------
    data : mapping
        The tables, as `tomllib` returns them.
    base_dir : Path or str
        Folder relative file names start from.

    Raises
    ------
    SceneError
        With every mistake.

    Examples
    --------
    >>> scene = parse_scene({
    ...     "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    ...     "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
    ...     "loading": {"control": "separation", "start": 2e-6, "stop": 1e-6, "count": 2},
    ... })
    >>> scene.loading.targets, scene.adhesion
    ((2e-06, 1e-06), None)
    """
    base_dir = Path(base_dir)
    mistakes: list[Mistake] = []
    values: dict[str, dict[str, Any]] = {}
    for name in data:
        if name not in TABLES and name != "title":
            mistakes.append(Mistake(name, f"= {shown(data[name])} is unknown", unknown_key(name, ["title", *TABLES])))
    if not isinstance(data.get("title", ""), str):
        mistakes.append(Mistake("title", f"= {shown(data['title'])}", "a text"))
    for name, model in TABLES.items():
        values[name], wrong = _checked(name, model, data.get(name))
        mistakes += wrong

    profile, loading = values["profile"], values["loading"]
    given = {name: set(table) if isinstance(table := data.get(name), Mapping) else set() for name in TABLES}
    if "profile" in data:
        mistakes += profile_mistakes(profile, given["profile"])
    if "loading" in data:
        tables = [name for name in TABLES if data.get(name) is not None]
        mistakes += loading_mistakes(loading, given["loading"], tables, profile.get("period"))
    scan, wrong = _scan(profile, given["profile"], base_dir)
    mistakes += wrong
    start, wrong = stored_start(loading.get("initial"), loading.get("control"), base_dir)
    mistakes += wrong
    if mistakes:
        raise SceneError(mistakes)
    return _resolved(data, values, scan, start)


def _checked(name: str, model: type[Table], raw: Any) -> tuple[dict[str, Any], list[Mistake]]:
    """The valid keys of one table, and the mistakes of the others."""
    if raw is None:
        needs = ", ".join(key for key, item in model.model_fields.items() if item.is_required())
        missing = Mistake(f"[{name}]", "is missing", f"a table with {needs}")
        return {}, [missing] if name in REQUIRED_TABLES else []
    if not isinstance(raw, Mapping):
        return {}, [Mistake(name, f"= {shown(raw)}", f"a table [{name}]")]
    try:
        model.model_validate(raw)
        return dict(raw), []
    except ValidationError as error:
        return _split(name, model, raw, [(item["type"], item["loc"]) for item in error.errors()])


def _split(
    name: str, model: type[Table], raw: Mapping[str, Any], errors: list[tuple[str, tuple[int | str, ...]]]
) -> tuple[dict[str, Any], list[Mistake]]:
    """Valid keys and mistakes, one for each wrong key or item of a list."""
    items: dict[str, list[int]] = {}
    for _, location in errors:
        items.setdefault(str(location[0]), []).extend(part for part in location[1:] if isinstance(part, int))
    mistakes = []
    for key, wrong in items.items():
        path = f"{name}.{key}"
        if key not in model.model_fields:
            gone = REMOVED.get(path)
            said = "unknown" if gone is None else "no longer a key"
            known = gone or unknown_key(key, model.model_fields)
            mistakes.append(Mistake(path, f"= {shown(raw[key])} is {said}", known))
            continue
        allowed = str(said_of(model, key)["allowed"])
        if key not in raw:
            mistakes.append(Mistake(path, "is missing", allowed))
        elif wrong:
            mistakes += [Mistake(f"{path}[{k}]", f"= {shown(raw[key][k])}", allowed) for k in sorted(set(wrong))]
        else:
            mistakes.append(Mistake(path, f"= {shown(raw[key])}", allowed))
    return {key: value for key, value in raw.items() if key not in items}, mistakes


def _scan(profile: Mapping[str, Any], given: set[str], base_dir: Path) -> tuple[Scan | None, list[Mistake]]:
    """The samples of profile.file, prepared, if the profile has any and says properly how they are to be read."""
    wrong = [key for key in given.intersection((*SCAN_KEYS, *DEFAULTS, *CUTOFFS)) if key not in profile]
    if profile.get("kind") != "samples" or "file" not in profile or wrong:
        return None, []
    from bem.scans.prepare_scan import prepare
    from bem.scans.read_scan import read_scan
    from bem.scans.scan_refusal import ScanFileError

    name = profile["file"]
    try:
        scan = prepare(read_scan(base_dir / name, profile), profile)
    except ScanFileError as error:
        told = [
            (key, f"= {shown(name)}: {found}" if key == "file" else found, allowed)
            for key, found, allowed in error.refusals
        ]
        return None, [Mistake(f"profile.{key}", found, allowed) for key, found, allowed in told]
    return scan, list(scan_mistakes(profile, scan))


def _resolved(
    data: Mapping[str, Any], values: Mapping[str, dict[str, Any]], scan: Scan | None, start: StoredState | None
) -> Scene:
    """The scene of data without mistakes of their own: defaults, targets; SceneError for what these show."""
    profile = _profile(values["profile"], scan)
    loading = LoadingTable.model_validate(values["loading"])
    targets = loading.targets
    if loading.start is not None and loading.stop is not None and loading.count is not None:
        targets = expanded(loading.start, loading.stop, loading.count, loading.then_back_to)
    if isinstance(loading.initial, StoredStart) and start is not None:
        begin = float(getattr(start.state, loading.control))
    else:
        begin = origin(loading.control, str(loading.initial), targets[0])
    ranged = dict.fromkeys((*RANGE, "then_back_to"))
    tables: dict[str, Any] = {
        name: model.model_validate(values[name]) if name in QUESTIONS or data.get(name) is not None else None
        for name, model in TABLES.items()
    }
    tables |= {"profile": profile, "loading": loading.model_copy(update={**ranged, "targets": targets})}
    scene = Scene(
        title=data.get("title", ""),
        **tables,
        origin=begin,
        scan=scan,
        cut_by_default=scan is not None and "harmonics" not in values["profile"],
        start_state=None if start is None else start.state,
    )
    resolved = scene.resolved()
    mistakes = [*_output_mistakes(scene), *other_problem(resolved, start)]
    mistakes += magnitude_mistakes(resolved, scene.surface())
    if mistakes:
        raise SceneError(mistakes)
    return scene


def _profile(values: Mapping[str, Any], scan: Scan | None) -> ProfileTable:
    """[profile] with the defaults of its kind."""
    profile = ProfileTable.model_validate(values)
    if profile.kind == "self_affine" and profile.seed is None:
        return profile.model_copy(update={"seed": 0})
    if scan is None:
        return profile
    read = scan.steps[0]
    units = {key: read[key] for key in ("unit_x", "unit_h")}
    carried = SAMPLED_HARMONICS if profile.cutoff_short is None else min(scan.carrying, MOST_HARMONICS)
    defaults = DEFAULTS | units | {"period": scan.period, "harmonics": min(scan.max_harmonics, carried)}
    update = {key: value for key, value in defaults.items() if key not in values}
    if profile.harmonics == "all":
        update["harmonics"] = min(scan.max_harmonics, MOST_HARMONICS)
    return profile.model_copy(update=update)


def _output_mistakes(scene: Scene) -> Iterator[Mistake]:
    """Yield outputs asked for at other values than targets."""
    targets = scene.loading.targets
    listed = ", ".join(f"{target:g}" for target in dict.fromkeys(targets[:LISTED])) + ", ..." * (len(targets) > LISTED)
    allowed = f"true, false or a list of targets ({listed}); add it to loading.targets to have a state there"
    for name in OUTPUTS:
        asked = getattr(scene.output, name)
        for k, value in enumerate(() if isinstance(asked, bool) else asked):
            if found(value, targets) is None:
                yield Mistake(f"output.{name}[{k}]", f"= {value:g} is not a target", allowed)
