"""Tables of a scene file: keys, types, limits and defaults.

[solid], [layer] and [adhesion] are the objects `Solid`, `Layer` and `Adhesion` in the modules of their physics;
`TABLES` names the class of every table.  keys.toml has the words of every key.  scene_rules.py checks what depends on
more than one key.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field
from pydantic.dataclasses import dataclass

from bem.geometry.lengths import METRES
from bem.geometry.ranges import LEAST, MOST, MOST_HARMONICS
from bem.geometry.table import CONFIG, limits, table

Number = Annotated[float, Field(ge=-MOST, le=MOST)]
Numbers = Annotated[tuple[Number, ...], Field(strict=False)]
Targets = Annotated[tuple[Number, ...], Field(strict=False, min_length=1)]
Natural = Annotated[int, Field(ge=0)]
Order = Annotated[int, Field(ge=1, le=MOST_HARMONICS)]
Orders = Annotated[tuple[Order, ...], Field(strict=False, min_length=1)]
Length = Annotated[float, Field(ge=LEAST, le=MOST)]
Columns = Annotated[tuple[Annotated[int, Field(ge=1)], ...], Field(strict=False, min_length=1, max_length=2)]
if TYPE_CHECKING:
    Unit = str
else:
    Unit = Literal[tuple(METRES)]


@table("profile")
class ProfileTable:
    """Period of the rigid profile; keys that the kind does not use are None."""

    kind: Literal["self_affine", "harmonics", "samples"]
    period: Annotated[float | None, limits("profile.period")] = None
    hurst: Annotated[float | None, limits("profile.hurst")] = None
    rms_height: Annotated[float | None, limits("profile.rms_height")] = None
    harmonics: Order | Literal["all"] | None = None
    seed: Annotated[int | None, limits("profile.seed")] = None
    orders: Orders | None = None
    amplitudes: Numbers | None = None
    phases: Numbers | None = None
    file: str | None = None
    unit_x: Unit | None = None
    unit_h: Unit | None = None
    decimal: Literal[".", ","] | None = None
    columns: Columns | None = None
    skip_lines: Natural | None = None
    missing_value: Number | Literal["none"] | None = None
    valid_column: Natural | None = None
    valid_value: Number | None = None
    spacing: Length | None = None
    row: Natural | Literal["mean", "all"] | None = None
    every: Annotated[int | None, Field(ge=1)] = None
    channel: Natural | None = None
    dropouts: Literal["missing", "keep"] | None = None
    missing: Literal["refuse", "interpolate"] | None = None
    outliers: Literal["keep", "replace"] | None = None
    unequal_spacing: Literal["refuse", "resample"] | None = None
    detrend: Literal["none", "mean", "line", "quadratic", "cubic"] | None = None
    periodic: Literal["as_is", "mirror", "window"] | None = None
    cutoff_short: Length | None = None
    cutoff_long: Length | None = None


@dataclass(frozen=True, config=CONFIG)
class StoredStart:
    """State `state` (counted from 0) of the result in the folder `result`."""

    result: Annotated[str, Field(pattern=r"^[^\x00]+$")]
    state: Natural


def _stored(value: Any) -> Any:
    """Return the stored start that a mapping describes; return any other value unchanged."""
    return StoredStart(**value) if isinstance(value, Mapping) else value


@table("loading")
class Loading:
    """Prescribed quantity and its values one after the other; a resolved scene has all of them in `targets`."""

    control: Literal["separation", "penetration", "mean_pressure", "total_displacement"]
    targets: Targets = ()
    start: Number | None = None
    stop: Number | None = None
    count: Annotated[int | None, Field(ge=2, le=1_000_000)] = None
    then_back_to: Number | None = None
    stop_at_mean_pressure: Number | None = None
    at_mean_pressures: Numbers = ()
    initial: Annotated[Literal["separated", "complete_contact"] | StoredStart, BeforeValidator(_stored)] = "separated"
    flaw: Length | None = None


@table("accuracy")
class AccuracyTable:
    """Tolerance of certified states, and the longest increment of the path."""

    tolerance: Annotated[float, Field(ge=1e-12, le=1e-2)] = 1e-6
    max_increment: Annotated[float, Field(ge=1e-5, le=100)] = 0.05


@table("output")
class Output:
    """Fields and distributions that are stored beside the numbers of each state."""

    shapes: bool | Numbers = False
    spectra: bool | Numbers = False
    pressure_distribution: bool | Numbers = False


TABLES = {
    "solid": "bem.geometry.scaling.Solid",
    "profile": "bem.scene.scene_tables.ProfileTable",
    "layer": "bem.elastic.layer.Layer",
    "adhesion": "bem.adhesive.adhesion.Adhesion",
    "loading": "bem.scene.scene_tables.Loading",
    "accuracy": "bem.scene.scene_tables.AccuracyTable",
    "output": "bem.scene.scene_tables.Output",
}
REQUIRED_TABLES = ("solid", "profile", "loading")
WITH_DEFAULTS = ("accuracy", "output")  # tables that are made where they are absent
OUTPUTS = ("shapes", "spectra", "pressure_distribution")


def class_of(name: str) -> type[Any]:
    """Return the class of a table, from a module that is imported only where the table is used."""
    module, _, kind = TABLES[name].rpartition(".")
    table_class: type[Any] = getattr(import_module(module), kind)
    return table_class


def required_keys(name: str) -> list[str]:
    """Return the keys of a table that have no default."""
    return [item.name for item in fields(class_of(name)) if item.default is MISSING]
