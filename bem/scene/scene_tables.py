"""The tables of a scene file: keys, types, ranges and defaults, as pydantic models.

Types are strict.  What depends on more than one key is in scene_rules.py; what the keys mean in `bem/README.md`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from bem.geometry.ranges import LEAST, MOST, MOST_HARMONICS, POSITIVE, RANGES
from bem.scans.scan_keys import UNITS

Number = Annotated[float, Field(ge=-MOST, le=MOST)]
Numbers = Annotated[tuple[Number, ...], Field(strict=False)]
Order = Annotated[int, Field(ge=1, le=MOST_HARMONICS)]
Length = Annotated[float, Field(ge=LEAST, le=MOST)]
FileName = Annotated[str, Field(pattern=r"^[^\x00]+$")]
Unit = Literal["m", "cm", "mm", "um", "nm", "angstrom", "pm", "in", "mil", "uin"]
Columns = Annotated[tuple[Annotated[int, Field(ge=1)], ...], Field(strict=False, min_length=1, max_length=2)]


def _range(path: str) -> Any:
    """The field of a number, of the range and in the words of `RANGES`."""
    return Field(**RANGES[path].limits, description=RANGES[path].words)


def _words(path: str) -> str:
    """What is said of a list; its items have ranges of their own."""
    return RANGES[path].words


class Table(BaseModel):
    """Keys of one table; unknown ones are mistakes, and no text or truth value passes for a number."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class SolidTable(Table):
    """[solid]."""

    youngs_modulus: Annotated[float, _range("solid.youngs_modulus")]
    poisson_ratio: Annotated[float, _range("solid.poisson_ratio")]


class ProfileTable(Table):
    """[profile]; keys the kind does not use are None."""

    kind: Literal["self_affine", "harmonics", "samples"] = Field(description='"self_affine", "harmonics" or "samples"')
    period: Annotated[float | None, _range("profile.period")] = None
    hurst: Annotated[float | None, _range("profile.hurst")] = None
    rms_height: Annotated[float | None, _range("profile.rms_height")] = None
    harmonics: Order | Literal["all"] | None = Field(
        None, description=f'{_words("profile.harmonics")}, or "all" of a scan'
    )
    seed: Annotated[int | None, _range("profile.seed")] = None
    orders: Annotated[tuple[Order, ...], Field(strict=False, min_length=1)] | None = Field(
        None, description=_words("profile.orders")
    )
    amplitudes: Numbers | None = Field(None, description=_words("profile.amplitudes"))
    phases: Numbers | None = Field(None, description=_words("profile.phases"))
    file: FileName | None = Field(None, description="the name of a text file or of an instrument's file")
    unit_x: Unit | None = Field(None, description=f"one of {UNITS}")
    unit_h: Unit | None = Field(None, description=f"one of {UNITS}")
    decimal: Literal[".", ","] | None = Field(None, description='"." or ","')
    columns: Columns | None = Field(None, description="[x, h], or [h] with spacing: columns of the file from 1")
    spacing: Length | None = Field(None, description=f"{POSITIVE}, in unit_x")
    row: Annotated[int, Field(ge=0)] | Literal["mean"] | None = Field(None, description='an integer >= 0 or "mean"')
    channel: int | None = Field(None, ge=0, description="an integer >= 0")
    dropouts: Literal["missing", "keep"] | None = Field(None, description='"missing" or "keep"')
    missing: Literal["refuse", "interpolate"] | None = Field(None, description='"refuse" or "interpolate"')
    outliers: Literal["keep", "replace"] | None = Field(None, description='"keep" or "replace"')
    unequal_spacing: Literal["refuse", "resample"] | None = Field(None, description='"refuse" or "resample"')
    detrend: Literal["none", "mean", "line", "quadratic", "cubic"] | None = Field(
        None, description='"none", "mean", "line", "quadratic" or "cubic"'
    )
    periodic: Literal["as_is", "mirror", "window"] | None = Field(None, description='"as_is", "mirror" or "window"')
    cutoff_short: Length | None = Field(None, description=f"{POSITIVE} (m)")
    cutoff_long: Length | None = Field(None, description=f"{POSITIVE} (m)")


class LayerTable(Table):
    """[layer]."""

    thickness: Annotated[float, _range("layer.thickness")]


class AdhesionTable(Table):
    """[adhesion]."""

    work_of_adhesion: Annotated[float, _range("adhesion.work_of_adhesion")]
    slope_term: bool = Field(False, description="true or false")


class StoredStart(Table):
    """State `state` (counted from 0) of the result in the folder `result`."""

    result: FileName
    state: int = Field(ge=0)


class LoadingTable(Table):
    """[loading]; `targets` holds all of them once resolved."""

    control: Literal["separation", "penetration", "mean_pressure", "total_displacement"] = Field(
        description='"separation", "penetration", "mean_pressure" or, with [layer], "total_displacement"'
    )
    targets: Annotated[tuple[Number, ...], Field(strict=False, min_length=1)] = Field(
        (), description="a list of at least one finite number (m, or Pa with mean_pressure control)"
    )
    start: Number | None = Field(None, description="a finite number (m or Pa)")
    stop: Number | None = Field(None, description="a finite number (m or Pa) other than start")
    count: int | None = Field(None, ge=2, le=1_000_000, description="an integer >= 2")
    then_back_to: Number | None = Field(None, description="a finite number (m or Pa) on the side of stop start lies on")
    stop_at_mean_pressure: Number | None = Field(None, description="a finite number (Pa)")
    at_mean_pressures: Numbers = Field((), description="a list of finite numbers (Pa)")
    initial: Literal["separated", "complete_contact"] | StoredStart = Field(
        "separated", description='"separated", "complete_contact" or {result = "folder", state = integer >= 0}'
    )
    flaw: Length | None = Field(None, description="a finite number > 0 (m), below profile.period")


class AccuracyTable(Table):
    """[accuracy]."""

    tolerance: float = Field(1e-6, ge=1e-12, le=1e-2, description="a number from 1e-12 to 1e-2")
    max_increment: float = Field(
        0.05, ge=1e-5, le=100, description="a number from 1e-5 (a million increments from touch to closure) to 100"
    )


class OutputTable(Table):
    """[output]."""

    shapes: Numbers = Field((), description="a list of finite numbers (separations in m, or Pa)")
    spectra: bool | Numbers = Field(False, description="true, false or a list of targets")
    pressure_distribution: bool | Numbers = Field(False, description="true, false or a list of targets")
    width_distributions: bool | Numbers = Field(False, description="true, false or a list of targets")
    contact_slopes: bool | Numbers = Field(False, description="true, false or a list of targets")
    cut_sensitivity: bool | None = Field(None, description="true or false, of a scan")


OUTPUTS = tuple(name for name in OutputTable.model_fields if name != "cut_sensitivity")  # at targets


TABLES: dict[str, type[Table]] = {
    "solid": SolidTable,
    "profile": ProfileTable,
    "layer": LayerTable,
    "adhesion": AdhesionTable,
    "loading": LoadingTable,
    "accuracy": AccuracyTable,
    "output": OutputTable,
}
REQUIRED_TABLES = ("solid", "profile", "loading")
