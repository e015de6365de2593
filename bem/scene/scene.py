"""Scene: solid, profile, path and accuracy in SI units, checked in full before anything runs.

A scene is TOML with the tables [solid], [profile], [layer], [adhesion], [loading], [accuracy], [output], or the objects
of these names.  `parse_scene` makes every table (scene_tables.py), which checks types and ranges, then checks what
depends on more than one key (scene_rules.py), and lists every mistake at once.  The `Scene` is frozen and resolved:
defaults filled in, start/stop/count expanded, the scan read and prepared.

Values of the targets and of the lists in [output] are those of the controlled quantity (m, or Pa for mean_pressure).
An output is asked for at targets alone, so that no output changes the path.  A path start/stop/count visits
linspace(start, stop, count); `then_back_to` appends the way back with the same count, the turning point once.
A separation of exactly 0 asks for complete contact.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from bem.geometry.profile import Profile
from bem.geometry.ranges import Mistake, shown, unknown_key
from bem.geometry.scaling import Solid
from bem.geometry.table import TableError, plain
from bem.scene.magnitudes import magnitude_mistakes
from bem.scene.scene_error import SceneError
from bem.scene.scene_file import read_tables
from bem.scene.scene_rules import QUESTIONS, loading_mistakes, profile_mistakes
from bem.scene.scene_scan import scan_of, with_scan, without_arrays
from bem.scene.scene_tables import (
    OUTPUTS,
    REQUIRED_TABLES,
    TABLES,
    WITH_DEFAULTS,
    AccuracyTable,
    Loading,
    Output,
    ProfileTable,
    StoredStart,
    class_of,
    required_keys,
)
from bem.scene.state import State
from bem.scene.stored_start import StartingState, other_problem, stored_start
from bem.scene.surface import surface_of
from bem.scene.targets import equal_target, expanded, origin

if TYPE_CHECKING:
    from bem.adhesive.adhesion import Adhesion
    from bem.elastic.layer import Layer
    from bem.scans.measured_line import Step
    from bem.scans.periodic_samples import PeriodicSamples

NAMED = 12  # format: targets listed in an error

__all__ = ["Loading", "Mistake", "Scene", "SceneError", "StoredStart", "load_scene", "parse_scene", "scene_of"]

Table = Mapping[str, Any]


class Tables(TypedDict, total=False):
    """Tables of a scene: objects, or mappings with the keys of the scene file; arrays of NumPy are lists."""

    title: str
    solid: Solid | Table
    profile: Profile | ProfileTable | Table
    layer: Layer | Table | None
    adhesion: Adhesion | Table | None
    loading: Loading | Table
    accuracy: AccuracyTable | Table
    output: Output | Table


@dataclass(frozen=True, repr=False)
class Scene:
    """Checked and resolved scene; tables absent from the file are None.

    Parameters
    ----------
    title : str
    solid, profile, layer, adhesion, loading, accuracy, output
        Tables, SI units; `loading.targets` holds all targets.
    origin : float
        Value of the controlled quantity where the path begins, possibly infinite.
    scan : PeriodicSamples, optional
        Samples of profile.file.
    cut_by_default : bool
        Whether profile.harmonics was chosen for a scan, not given.
    start_state : State, optional
        Stored state of loading.initial.
    """

    title: str
    solid: Solid
    profile: ProfileTable
    layer: Layer | None
    adhesion: Adhesion | None
    loading: Loading
    accuracy: AccuracyTable
    output: Output
    origin: float
    scan: PeriodicSamples | None = field(default=None, compare=False)
    cut_by_default: bool = False
    start_state: State | None = None

    def __repr__(self) -> str:
        count, control = len(self.loading.targets), self.loading.control
        tables = ", ".join(name for name in ("layer", "adhesion") if getattr(self, name) is not None)
        kind = f"{self.profile.kind} profile{', ' * bool(tables)}{tables}"
        return f"<Scene {self.title!r}: {kind}, {count} target{'s' * (count != 1)} of {control}>"

    def surface(self) -> Profile:
        """Return the profile, SI units; made once, as its table takes seconds and memory where harmonics are many."""
        return self._surface

    @cached_property
    def _surface(self) -> Profile:
        return surface_of(plain(self.profile), self.scan)

    def preparation(self) -> tuple[Step, ...]:
        """Return the steps of the preparation of a scan; empty for other profiles."""
        if self.scan is None or not isinstance(self.profile.harmonics, int):
            return ()
        return self.scan.preparation(self.profile.harmonics)

    def physics(self) -> dict[str, Any]:
        """Return the tables that say what is in contact, without absent ones."""
        tables = {name: getattr(self, name) for name in TABLES if name not in QUESTIONS}
        return {name: table for name, table in tables.items() if table is not None}

    def wants(self, output: str, index: int) -> bool:
        """Return whether `output` ("shapes", "spectra", ...) is asked for at the target with an index."""
        asked = getattr(self.output, output)
        if isinstance(asked, bool):
            return asked
        return index < len(self.loading.targets) and equal_target(self.loading.targets[index], asked) is not None

    def resolved(self) -> dict[str, Any]:
        """Return all tables as plain values, defaults included; a file is given by its name and digest."""
        content = {"title": self.title} | {name: plain(getattr(self, name)) for name in TABLES}
        if self.scan is not None:
            content["profile"] |= {"file": Path(str(self.profile.file)).name, "sha256": self.scan.measured.sha256}
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
    return parse_scene(read_tables(path), Path(path).parent)


def scene_of(scene: Scene | Path | str | Table | None, tables: Mapping[str, Any]) -> Scene:
    """Return the scene given as a `Scene`, as a file, as a mapping of tables, or by `tables`.

    Raises
    ------
    SceneError
        As of `parse_scene`.
    TypeError
        Neither a scene nor tables, or both; a scene of another type.

    Examples
    --------
    >>> wave, loading = Profile.from_harmonics(0.01, [1], [1e-5]), Loading("separation", (8e-6, 4e-6))
    >>> scene = scene_of(None, {"profile": wave, "solid": Solid(1e6, 0.5), "loading": loading})
    >>> scene.surface().max_height, scene.loading.targets
    (1e-05, (8e-06, 4e-06))
    """
    refuse_unclear(scene, tables)
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, str | Path):
        return load_scene(scene)
    return parse_scene(tables if scene is None else scene)


def refuse_unclear(scene: Scene | Path | str | Table | None, tables: Mapping[str, Any]) -> None:
    """Raise TypeError for neither a scene nor tables, for both of them, and for a scene of another type."""
    needed = "a scene, its file or its tables as a mapping is needed, or profile=, solid=, loading=, ..."
    if scene is not None and not isinstance(scene, Scene | Path | str | Mapping):
        raise TypeError(f"scene = {scene!r}, {type(scene).__name__}: {needed}")
    if scene is not None and tables:
        unknown = [f"{name}=" for name in tables if name not in Tables.__annotations__]
        clashing = [f"{name}=" for name in tables if name in Tables.__annotations__]
        wrong = [f"{', '.join(unknown)} unknown"] if unknown else []
        wrong += [f"{', '.join(clashing)} beside a whole scene"] if clashing else []
        raise TypeError(f"{' and '.join(wrong)}: {needed}")
    if scene is None and not tables:
        raise TypeError(f"nothing given: {needed}")


def parse_scene(data: Mapping[str, Any], base_dir: Path | str = ".") -> Scene:
    """Check the tables of a scene and resolve them.

    Parameters
    ----------
    data : mapping
        Tables by name, as `tomllib` returns them, or objects (`Tables`).  A profile of samples may have arrays or lists
        `x` and `h` in m instead of `file`, or `h` and `spacing`; they are prepared like those of a file, where masked
        heights are missing.  An `h` of two indices is a map, the first index along x, of which `row` is solved.
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
    base_dir, mistakes = Path(base_dir), []
    data, arrays, incomplete = without_arrays(data)
    mistakes += incomplete
    for name in data:
        if name not in TABLES and name != "title":
            mistakes.append(Mistake(name, f"= {shown(data[name])} is unknown", unknown_key(name, ["title", *TABLES])))
    if not isinstance(data.get("title", ""), str):
        mistakes.append(Mistake("title", f"= {shown(data['title'])}", "a text"))
    made: dict[str, Any] = {}  # tables without mistakes
    values: dict[str, dict[str, Any]] = {}  # valid keys of every table
    given: dict[str, set[str]] = {}  # all keys of every table
    for name in TABLES:
        raw = _as_mapping(data.get(name))
        given[name] = set(raw) if isinstance(raw, Mapping) else set()
        made[name], values[name], wrong = _made(name, raw)
        mistakes += wrong
    profile, loading = values["profile"], values["loading"]
    if "profile" in data:
        mistakes += profile_mistakes(profile, given["profile"])
    if "loading" in data:
        tables = [name for name in TABLES if data.get(name) is not None]
        mistakes += loading_mistakes(loading, given["loading"], tables, profile.get("period"))
    scan, wrong = (None, []) if incomplete else scan_of(profile, given["profile"], base_dir, arrays)
    mistakes += wrong
    start, wrong = stored_start(loading.get("initial"), loading.get("control"), base_dir)
    mistakes += wrong
    if mistakes:
        raise SceneError(mistakes)
    return _resolved(data.get("title", ""), made, scan, start)


def _as_mapping(table: Any) -> Any:
    """Return a table as plain values; a `Profile` is one of given harmonics."""
    if isinstance(table, Profile):
        return {"kind": "harmonics", **plain(asdict(table))}
    return plain(table)


def _made(name: str, raw: Any) -> tuple[Any, dict[str, Any], list[Mistake]]:
    """Return a table (None if absent or wrong), its valid keys and its mistakes."""
    if raw is None:
        if name in REQUIRED_TABLES:
            return None, {}, [Mistake(f"[{name}]", "is missing", f"a table with {', '.join(required_keys(name))}")]
        return class_of(name)() if name in WITH_DEFAULTS else None, {}, []
    if not isinstance(raw, Mapping):
        return None, {}, [Mistake(name, f"= {shown(raw)}", f"a table [{name}]")]
    try:
        return class_of(name)(**raw), dict(raw), []
    except TableError as error:
        return None, error.valid, error.mistakes


def _resolved(title: str, tables: dict[str, Any], scan: PeriodicSamples | None, start: StartingState | None) -> Scene:
    """Return the scene of tables without mistakes: defaults, targets; SceneError for mistakes of the whole."""
    loading: Loading = tables["loading"]
    cut_by_default = scan is not None and tables["profile"].harmonics is None
    profile: ProfileTable = tables["profile"]
    if scan is not None:
        profile = with_scan(profile, scan)
    elif profile.kind == "self_affine" and profile.seed is None:
        profile = replace(profile, seed=0)
    targets = loading.targets
    if loading.start is not None and loading.stop is not None and loading.count is not None:
        targets = expanded(loading.start, loading.stop, loading.count, loading.then_back_to)
    if isinstance(loading.initial, StoredStart) and start is not None:
        begin = float(getattr(start.state, loading.control))
    else:
        begin = origin(loading.control, str(loading.initial), targets[0])
    tables["profile"] = profile
    tables["loading"] = replace(loading, targets=targets, start=None, stop=None, count=None, then_back_to=None)
    scene = Scene(
        title=title,
        **tables,
        origin=begin,
        scan=scan,
        cut_by_default=cut_by_default,
        start_state=None if start is None else start.state,
    )
    resolved = scene.resolved()
    mistakes = [*_output_mistakes(scene), *other_problem(resolved, start)]
    mistakes += magnitude_mistakes(resolved, scene.surface())
    if mistakes:
        raise SceneError(mistakes)
    return scene


def _output_mistakes(scene: Scene) -> Iterator[Mistake]:
    """Yield outputs asked for at other values than targets."""
    targets = scene.loading.targets
    listed = ", ".join(f"{target:g}" for target in dict.fromkeys(targets[:NAMED])) + ", ..." * (len(targets) > NAMED)
    allowed = f"true, false or a list of targets ({listed}); add it to loading.targets to have a state there"
    for name in OUTPUTS:
        asked = getattr(scene.output, name)
        for k, value in enumerate(() if isinstance(asked, bool) else asked):
            if equal_target(value, targets) is None:
                yield Mistake(f"output.{name}[{k}]", f"= {value:g} is not a target", allowed)
