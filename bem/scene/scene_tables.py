"""The tables of a scene file: keys, types, ranges and defaults, as pydantic models.

Types are strict.  What depends on more than one key is in scene_rules.py.  Every key says by `_about` what it does,
what it may be, its unit, what is taken where it is absent, and an example: bem/command_line/keys.py
prints that, and hands it to editors.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from bem.geometry.ranges import LEAST, MOST, MOST_HARMONICS, POSITIVE, RANGES
from bem.scans.scan_keys import DEFAULTS, UNITS

Number = Annotated[float, Field(ge=-MOST, le=MOST)]
Numbers = Annotated[tuple[Number, ...], Field(strict=False)]
Order = Annotated[int, Field(ge=1, le=MOST_HARMONICS)]
Length = Annotated[float, Field(ge=LEAST, le=MOST)]
FileName = Annotated[str, Field(pattern=r"^[^\x00]+$")]
Unit = Literal["m", "cm", "mm", "um", "nm", "angstrom", "pm", "in", "mil", "uin"]
Columns = Annotated[tuple[Annotated[int, Field(ge=1)], ...], Field(strict=False, min_length=1, max_length=2)]
HARMONICS = RANGES["profile.harmonics"].words + ', or "all" of a scan'
TARGETS_OF = "true, false or a list of targets"
TITLE = "What the scene is about, a text; it stands above its results."


def _about(does: str, allowed: str, example: Any, unit: str = "", absent: str = "", **limits: Any) -> Any:
    """What is said of a key, and its limits; `absent`: what is taken without it, where that is no plain default.

    `allowed` also ends the sentence on a mistake.
    """
    said = {"allowed": allowed, "unit": unit, "absent": absent}
    return Field(description=does, examples=[example], json_schema_extra=said, **limits)  # type: ignore[arg-type]


def _number(path: str, does: str, example: Any, unit: str = "", absent: str = "") -> Any:
    """The same of a number, of the range and in the words of `RANGES`."""
    return _about(does, RANGES[path].words, example, unit, absent, **RANGES[path].limits)


def _prepared(key: str, does: str, allowed: str, example: str) -> Any:
    """The same of a step of the preparation of a scan."""
    return _about(does, allowed, example, absent=f'"{DEFAULTS[key]}"')


class Table(BaseModel):
    """Keys of one table; unknown ones are mistakes, and no text or truth value passes for a number."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class SolidTable(Table):
    """[solid]: the elastic body that is pressed on the rigid profile."""

    youngs_modulus: Annotated[float, _number("solid.youngs_modulus", "Young's modulus E of the body.", 2.1e11, "Pa")]
    poisson_ratio: Annotated[float, _number("solid.poisson_ratio", "Its Poisson's ratio; 0.5: incompressible.", 0.3)]


class ProfileTable(Table):
    """[profile]: one period of the rigid profile.

    Keys that the kind does not use are None.
    """

    kind: Annotated[
        Literal["self_affine", "harmonics", "samples"],
        _about(
            "Where the heights come from: a random self-affine profile, given cosines, or the file of a scan.",
            '"self_affine", "harmonics" or "samples"',
            "samples",
        ),
    ]
    period: Annotated[
        float | None,
        _number("profile.period", "Length after which the profile repeats.", 0.01, "m", "of samples, that of the file"),
    ] = None
    hurst: Annotated[float | None, _number("profile.hurst", "Hurst exponent of the power spectrum.", 0.8)] = None
    rms_height: Annotated[
        float | None, _number("profile.rms_height", "Root mean square of the heights about their mean.", 1e-6, "m")
    ] = None
    harmonics: Annotated[
        Order | Literal["all"] | None,
        _about(
            "The cut: how many waves per period the shortest wave has.",
            HARMONICS,
            200,
            absent="of samples, 1000, or all if there are fewer",
        ),
    ] = None
    seed: Annotated[int | None, _number("profile.seed", "Which realisation of the random phases.", 3, absent="0")] = (
        None
    )
    orders: Annotated[
        Annotated[tuple[Order, ...], Field(strict=False, min_length=1)] | None,
        _about("Waves per period of each cosine.", RANGES["profile.orders"].words, [1, 4]),
    ] = None
    amplitudes: Annotated[
        Numbers | None, _about("Amplitude of each cosine.", RANGES["profile.amplitudes"].words, [1e-6, 2e-7], "m")
    ] = None
    phases: Annotated[
        Numbers | None, _about("Phase of each cosine.", RANGES["profile.phases"].words, [0.0, 1.5], "rad")
    ] = None
    file: Annotated[
        str | None,
        _about(
            "Heights, with positions or without; relative names start from the folder of the scene.",
            "the name of a text file or of an instrument's file",
            "own-scan.csv",
        ),
    ] = None
    unit_x: Annotated[
        Unit | None, _about("Unit of the positions.", f"one of {UNITS}", "mm", absent="what the file states")
    ] = None
    unit_h: Annotated[
        Unit | None, _about("Unit of the heights.", f"one of {UNITS}", "um", absent="what the file states")
    ] = None
    decimal: Annotated[
        Literal[".", ","] | None,
        _about("Decimal mark of the file.", '"." or ","', ",", absent="what the file allows, if one does"),
    ] = None
    columns: Annotated[
        Columns | None,
        _about(
            "Which columns of a text file are read.",
            "[x, h], or [h] with spacing: columns of the file from 1",
            [1, 3],
            absent="[1, 2], or [1] of a file with one column; needed where there are more than two",
        ),
    ] = None
    skip_lines: Annotated[
        int | None,
        _about("Lines at the beginning of a text file that are not read.", "an integer >= 0", 6, absent="none", ge=0),
    ] = None
    missing_value: Annotated[
        Number | None,
        _about(
            "Height in the file that stands for a missing one.",
            f"a number from {-MOST:g} to {MOST:g}, in unit_h",
            -9999.0,
            "unit_h",
            "none",
        ),
    ] = None
    valid_column: Annotated[
        int | None,
        _about(
            "Column of a text file whose 0 flags a missing height.",
            "a column of the file from 1, or 0 if no column is a flag",
            3,
            absent="none; needed where a column that is not read holds few whole numbers",
            ge=0,
        ),
    ] = None
    spacing: Annotated[
        Length | None,
        _about(
            "Distance of neighbouring heights that have no positions.",
            f"{POSITIVE}, in unit_x",
            0.5,
            "unit_x",
            "what an instrument's file states",
        ),
    ] = None
    row: Annotated[
        Annotated[int, Field(ge=0)] | Literal["mean"] | None,
        _about("Which line of a map of heights, or their mean.", 'an integer >= 0 or "mean"', 12),
    ] = None
    channel: Annotated[
        int | None, _about("Which of several maps of an instrument's file.", "an integer >= 0", 0, ge=0)
    ] = None
    dropouts: Annotated[
        Literal["missing", "keep"] | None,
        _prepared("dropouts", "Runs of one value far from their neighbours (-9999, 0).", '"missing" or "keep"', "keep"),
    ] = None
    missing: Annotated[
        Literal["refuse", "interpolate"] | None,
        _prepared(
            "missing", "Gaps in the heights: refused, or straight lines.", '"refuse" or "interpolate"', "interpolate"
        ),
    ] = None
    outliers: Annotated[
        Literal["keep", "replace"] | None,
        _prepared("outliers", "Spikes: kept, or set to the running median.", '"keep" or "replace"', "replace"),
    ] = None
    unequal_spacing: Annotated[
        Literal["refuse", "resample"] | None,
        _prepared(
            "unequal_spacing",
            "Unequal steps: refused, or monotone cubics onto equal ones.",
            '"refuse" or "resample"',
            "resample",
        ),
    ] = None
    detrend: Annotated[
        Literal["none", "mean", "line", "quadratic", "cubic"] | None,
        _prepared(
            "detrend",
            'Least-squares polynomial that is subtracted; "line" takes the tilt of the instrument away.',
            '"none", "mean", "line", "quadratic" or "cubic"',
            "line",
        ),
    ] = None
    periodic: Annotated[
        Literal["as_is", "mirror", "window"] | None,
        _prepared(
            "periodic",
            "What makes samples periodic: nothing, their mirror image behind them, or tapers at both ends.",
            '"as_is", "mirror" or "window"',
            "mirror",
        ),
    ] = None
    cutoff_short: Annotated[
        Length | None,
        _about("Gaussian filter (ISO 16610-21) that takes shorter waves away.", f"{POSITIVE} (m)", 8e-6, "m"),
    ] = None
    cutoff_long: Annotated[
        Length | None,
        _about("Gaussian filter (ISO 16610-21) that takes longer waves away.", f"{POSITIVE} (m)", 8e-4, "m"),
    ] = None


class LayerTable(Table):
    """[layer]: the body is a layer bonded to a rigid plate; without this table it is a half-space."""

    thickness: Annotated[float, _number("layer.thickness", "Thickness of the layer.", 1e-3, "m")]


class AdhesionTable(Table):
    """[adhesion]: strict JKR adhesion; without this table there is none."""

    work_of_adhesion: Annotated[
        float, _number("adhesion.work_of_adhesion", "Work of adhesion w per area of contact.", 0.05, "J/m^2")
    ]
    slope_term: Annotated[
        bool, _about("Count the true length of the profile in contact, not its projection.", "true or false", True)
    ] = False


class StoredStart(Table):
    """State `state` (counted from 0) of the result in the folder `result`."""

    result: FileName
    state: int = Field(ge=0)


class LoadingTable(Table):
    """[loading]: what is prescribed, and its values one after the other.

    Once resolved, `targets` holds all of them.
    """

    control: Annotated[
        Literal["separation", "penetration", "mean_pressure", "total_displacement"],
        _about(
            "What is prescribed: mean gap, approach from first touch, load over nominal area, or motion of the plate.",
            '"separation", "penetration", "mean_pressure" or, with [layer], "total_displacement"',
            "mean_pressure",
        ),
    ]
    targets: Annotated[
        Annotated[tuple[Number, ...], Field(strict=False, min_length=1)],
        _about(
            "Values at which states are stored, in the order of the path; tension is negative.",
            "a list of at least one finite number (m, or Pa with mean_pressure control)",
            [1e5, 2e5, 1e5],
            "m or Pa",
            "start, stop and count",
        ),
    ] = ()
    start: Annotated[
        Number | None, _about("First of count equal steps.", "a finite number (m or Pa)", 1e5, "m or Pa")
    ] = None
    stop: Annotated[
        Number | None,
        _about("Last of count equal steps.", "a finite number (m or Pa) other than start", 5e5, "m or Pa"),
    ] = None
    count: Annotated[
        int | None,
        _about("Number of targets from start to stop, both included.", "an integer >= 2", 9, ge=2, le=1_000_000),
    ] = None
    then_back_to: Annotated[
        Number | None,
        _about(
            "The path goes back to this value in as many steps.",
            "a finite number (m or Pa) on the same side of stop as start",
            0.0,
            "m or Pa",
            "no way back",
        ),
    ] = None
    stop_at_mean_pressure: Annotated[
        Number | None,
        _about(
            "The path ends where this mean pressure is passed.", "a finite number (Pa)", 1e6, "Pa", "at the last target"
        ),
    ] = None
    at_mean_pressures: Annotated[
        Numbers,
        _about(
            "Mean pressures at which states on the way are stored too.", "a list of finite numbers (Pa)", [1e5], "Pa"
        ),
    ] = ()
    initial: Annotated[
        Literal["separated", "complete_contact"] | StoredStart,
        _about(
            "Where the path begins; a stored state is one of an earlier run of the same bodies.",
            '"separated", "complete_contact" or {result = "folder", state = integer >= 0}',
            "complete_contact",
        ),
    ] = "separated"
    flaw: Annotated[
        Length | None,
        _about(
            "Length without adhesion at which complete contact opens under tension.",
            "a finite number > 0 (m), below profile.period",
            1e-5,
            "m",
            "none; needed under mean_pressure control from complete contact with adhesion",
        ),
    ] = None


class AccuracyTable(Table):
    """[accuracy]: how exactly, and in which steps."""

    tolerance: Annotated[
        float,
        _about(
            "Largest |G/w - 1| at the edges of a certified state; what lies between targets is found to 1/100 of it.",
            "a number from 1e-12 to 1e-2",
            1e-8,
            ge=1e-12,
            le=1e-2,
        ),
    ] = 1e-6
    max_increment: Annotated[
        float,
        _about(
            "Longest increment of the path between targets; results do not depend on it, the time does.",
            "a number from 1e-5 (a million increments from touch to closure) to 100",
            0.2,
            "rms heights, or hundredths of E* times the rms slope",
            ge=1e-5,
            le=100,
        ),
    ] = 0.05


class OutputTable(Table):
    """[output]: what is stored beside the numbers of each state."""

    shapes: Annotated[bool | Numbers, _about("Displacement, gap and pressure along the period.", TARGETS_OF, [1e5])] = (
        False
    )
    spectra: Annotated[
        bool | Numbers, _about("Power spectra of heights, displacement and pressure.", TARGETS_OF, True)
    ] = False
    pressure_distribution: Annotated[
        bool | Numbers, _about("Distribution of the contact pressure.", TARGETS_OF, [1e5])
    ] = False
    width_distributions: Annotated[
        bool | Numbers, _about("Distributions of the widths of contacts and gaps.", TARGETS_OF, True)
    ] = False
    contact_slopes: Annotated[
        bool | Numbers, _about("Mean square slope of the profile where it is touched.", TARGETS_OF, True)
    ] = False


OUTPUTS = tuple(OutputTable.model_fields)


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


def said_of(model: type[BaseModel], key: str) -> dict[str, Any]:
    """What is said of a key: does, allowed, unit, absent, example.

    Examples
    --------
    >>> said_of(SolidTable, "youngs_modulus")["unit"], said_of(LayerTable, "thickness")["example"]
    ('Pa', 0.001)
    """
    field = model.model_fields[key]
    extra: Any = field.json_schema_extra or {}
    return {**extra, "does": field.description, "example": (field.examples or [None])[0]}
