"""The answer of a run in units that a person reads: a row for each target, and what the pull-off took.

A number has as many digits, two to four, as its uncertainty allows: the root of the sum of squares of the numerical
one, which the solver estimates, and that of the input, where a study of the scene knows it.  What is not known of a
state is "–".  `Views.to_table("targets")` has the same columns in SI units, all digits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from bem.scene.result import Result
from bem.scene.result_views import UNITS

PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
FEWEST, MOST = 2, 4  # format: digits
UNKNOWN = "–"
HEADS = (
    "mean pressure",
    "contact fraction",
    "± numerical",
    "± input",
    "separation",
    "contact pressure: mean",
    "contact pressure: peak",
    "contacts",
    "widths: least, median, largest",
    "open share of the period",
    "open gap: mean",
    "open gap: largest",
)

Cell = tuple[str, float | str]  # text, and what it is sorted by
Inputs = Mapping[int, Mapping[str, float]]  # relative uncertainty of the input, by target and quantity


def axis_unit(largest: float, unit: str) -> tuple[float, str]:
    """Factor and unit with a prefix with which the largest of some numbers lies between 1 and 1000.

    Examples
    --------
    >>> axis_unit(2.5e-5, "m")
    (1000000.0, 'µm')
    """
    power = 3 * math.floor(math.log10(largest) / 3 + 1e-12) if largest else 0
    return (10.0**-power, PREFIXES[power] + unit) if power in PREFIXES else (1.0, unit)


def digits(relative: float) -> int:
    """Digits that a relative uncertainty leaves, two to four.

    Examples
    --------
    >>> digits(0.3), digits(0.02), digits(0.004), digits(1e-9)
    (2, 2, 3, 4)
    """
    return min(max(1 + math.floor(-math.log10(relative)), FEWEST), MOST) if relative > 0 else MOST


def readable(value: float, unit: str, figures: int) -> str:
    """A number with so many digits and a prefix before its unit.

    Examples
    --------
    >>> readable(1.44496e-7, "m", 4), readable(50000.0, "Pa", 3), readable(0.30041, "", 2), readable(0.0, "m", 4)
    ('144.5 nm', '50.0 kPa', '0.30', '0 m')
    >>> readable(9.9996e-7, "m", 4), readable(3e-30, "m", 2)
    ('1.000 µm', '3.0e-30 m')
    """
    if value == 0 or not unit:
        return f"{_fixed(value, figures)} {unit}".strip()
    rounded = float(f"{value:.{figures - 1}e}")
    factor, prefixed = axis_unit(abs(rounded), unit)
    return f"{_fixed(rounded * factor, figures)} {prefixed}"


def quantity(value: float, unit: str) -> str:
    """A number that is given, with the digits that it has and a prefix before its unit.

    Examples
    --------
    >>> quantity(5e-05, "m"), quantity(1.25e6, "Pa"), quantity(0.0, "m"), quantity(3e-30, "m")
    ('50 µm', '1.25 MPa', '0 m', '3e-30 m')
    """
    factor, prefixed = axis_unit(abs(value), unit)
    return f"{value * factor:.6g} {prefixed}"


def _fixed(value: float, figures: int) -> str:
    """A number with so many digits, without an exponent where it is of common size."""
    if value == 0:
        return "0"
    scientific = f"{value:.{figures - 1}e}"
    power = int(scientific.partition("e")[2])
    return f"{float(scientific):.{max(figures - 1 - power, 0)}f}" if -4 <= power < 6 else scientific


def share(relative: float) -> str:
    """A relative uncertainty in per cent.

    Examples
    --------
    >>> share(6e-11), share(0.0832), share(2.5), share(0.0)
    ('< 0.01 %', '8.3 %', '250 %', '0 %')
    """
    if not math.isfinite(relative):
        return UNKNOWN
    if relative == 0:
        return "0 %"
    return "< 0.01 %" if relative < 1e-4 else f"{_fixed(100 * relative, 2)} %"


def heads(result: Result) -> list[str]:
    """The headings: what is held, then the quantities but that one."""
    held = result.scene["loading"]["control"].replace("_", " ")
    return [f"{held} (held)", *(head for head in HEADS if head != held)]


def rows(result: Result, inputs: Inputs | None = None) -> Iterator[list[Cell]]:
    """The cells of each target."""
    control = result.scene["loading"]["control"]
    columns = {name: values.tolist() for name, values in result.to_table("targets").items()}
    unit = "Pa" if control == "mean_pressure" else "m"
    for k in range(len(result.targets)):
        row = {name: values[k] for name, values in columns.items()}
        known = (inputs or {}).get(k, {})
        held = (UNKNOWN, "") if math.isnan(row["target"]) else (quantity(row["target"], unit), row["target"])
        cells = {
            "mean pressure": _cell(row, "mean_pressure", "Pa", known),
            "separation": _cell(row, "separation", "m", known),
        }
        cells.pop(control.replace("_", " "), None)
        yield [held, *_ordered(cells, row, known)]


def _ordered(cells: dict[str, Cell], row: Mapping[str, float], known: Mapping[str, float]) -> Iterator[Cell]:
    """The cells in the order of the headings."""
    fraction, error = row["contact_fraction"], row["error_estimate_contact_fraction"]
    own = error / fraction if fraction else 0.0
    outer = known.get("contact_fraction", math.nan)
    if "mean pressure" in cells:
        yield cells["mean pressure"]
    yield _cell(row, "contact_fraction", "", known)
    yield (UNKNOWN, "") if math.isnan(fraction) else (share(own), own)
    yield (UNKNOWN, "") if math.isnan(outer) else (share(outer), outer)
    if "separation" in cells:
        yield cells["separation"]
    yield _cell(row, "contact_pressure", "Pa", known)
    yield _cell(row, "peak_pressure", "Pa", known)
    yield (UNKNOWN, "") if math.isnan(fraction) else (f"{row['n_patches']:.0f}", row["n_patches"])
    widths = [row[f"width_{name}"] for name in ("least", "median", "largest")]
    if math.isnan(widths[0]):
        yield UNKNOWN, ""
    else:
        factor, prefixed = axis_unit(widths[-1], "m")
        yield f"{', '.join(_fixed(width * factor, 3) for width in widths)} {prefixed}", widths[1]
    opened = row["open_share"]  # its error is that of the contact fraction
    yield _cell(row, "open_share", "", {"open_share": outer * fraction / opened} if outer > 0 < opened else {})
    yield _cell(row, "open_gap_mean", "m", known)
    yield _cell(row, "open_gap_largest", "m", known)


def _cell(row: Mapping[str, float], name: str, unit: str, known: Mapping[str, float]) -> Cell:
    """A number as its uncertainty allows; one that no uncertainty is known of, as that of the contact fraction does."""
    value = row[name]
    if math.isnan(value):
        return UNKNOWN, ""
    error = row.get(f"error_estimate_{name}", math.nan)
    own = abs(error / value) if value and math.isfinite(error) else 0.0
    outer = known.get(name, known.get("contact_fraction", 0.0))
    return readable(value, unit, digits(math.hypot(own, outer))), value


def pull_off_words(result: Result) -> str:
    """The largest tension of the way out and where the contact came apart; nothing where there is no adhesion."""
    found = result.pull_off()
    if found is None:
        return ""
    error = "" if found.error is None else f" (± {share(found.error / found.tension)} numerical)"
    where = f"Pull-off: the largest tension found on the way out is {readable(found.tension, 'Pa', MOST)}{error}"
    where += f", at a separation of {readable(found.separation, 'm', MOST)}"
    if found.apart is None:
        return f"{where}; the surfaces have not come apart on this path."
    return f"{where}; the surfaces come apart at {readable(found.apart, 'm', MOST)}."


def csv_text(result: Result) -> str:
    """The answer as comma-separated values in SI units, which the headings name; empty where nothing is known."""
    columns = result.to_table("targets")
    units = {name: UNITS.get(name.removeprefix("error_estimate_"), "") for name in columns}
    lines = [",".join(f"{name} / {unit}" if unit else name for name, unit in units.items())]
    for row in zip(*(values.tolist() for values in columns.values()), strict=True):
        lines.append(",".join(value if isinstance(value, str) else _plain(value) for value in row))
    return "\n".join(lines) + "\n"


def _plain(value: float) -> str:
    """A number with all its digits; nothing where there is none."""
    return "" if math.isnan(value) else f"{value:.17g}"


def table_text(result: Result, inputs: Inputs | None = None) -> str:
    """The answer for a terminal: a line for each quantity, a column for each target."""
    listed = [heads(result), *([text for text, _ in row] for row in rows(result, inputs))]
    columns = [_padded(column, k) for k, column in enumerate(listed)]
    lines = ["  ".join(line).rstrip() for line in zip(*columns, strict=True)]
    return "\n".join([*lines, *filter(None, [pull_off_words(result)])])


def _padded(column: Sequence[str], place: int) -> list[str]:
    """Texts of equal width, headings to the left."""
    width = max(map(len, column))
    return [f"{text:<{width}}" if place == 0 else f"{text:>{width}}" for text in column]
