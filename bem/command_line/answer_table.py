"""Answer of a run: a line for each quantity, a column for each target, and the largest tension of the way out.

A quantity has one unit in all columns.  A number has as many digits, two to four, as the larger of its own two
uncertainties allows: the numerical one, which the solver estimates, and the one of the input, where a study of the
scene knows it.  A line of uncertainties belongs to the quantity it names.  There is no such line where nothing is
known.  An unknown number is "–".
`Views.to_table("targets")` has the same quantities in SI units, all digits.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from bem.scene.result import LargestTension, Result
from bem.scene.result_views import UNITS
from bem.scene.state import State

PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
FEWEST_DIGITS, MOST_DIGITS = 2, 4  # format
NOTHING = 1e-12  # format: of the largest number of a line, below which a number is rounding and shown as 0
NO_NUMBER = "–"
INPUT = "input_uncertainty_"  # before the name of a quantity
QUANTITIES = {  # name of a column of `to_table("targets")`: heading
    "mean_pressure": "mean pressure",
    "contact_fraction": "contact fraction",
    "separation": "separation",
    "contact_pressure": "contact pressure: mean",
    "peak_pressure": "contact pressure: peak",
    "n_patches": "contacts",
    "width_median": "widths: least, median, largest",
    "open_share": "open share of the period",
    "open_gap_mean": "open gap: mean",
    "open_gap_largest": "open gap: largest",
    "open_gap_p50": "open gap: 10, 50, 90 % of the open length below",
    "mean_cubic_root": "gap for flow along the ridges, <g³>^(1/3)",
    "widest_channel": "widest open channel",
}
PULL_OFF = "pull_off"  # of `Inputs`: the largest tension of the path
GAPS = ("open_gap_mean", "open_gap_largest", "open_gap_p50", "mean_cubic_root")  # in one unit
PRESSURES = ("contact_pressure", "peak_pressure")  # in one unit
TRIPLES = {  # columns shown in one cell
    "width_median": ("width_least", "width_median", "width_largest"),
    "open_gap_p50": ("open_gap_p10", "open_gap_p50", "open_gap_p90"),
}
UNBOUNDED = "complete contact cannot open without a flaw, as a gap of no width needs an unbounded tension."
FLAW = "loading.flaw, a length without adhesion: its size decides at what tension the contact opens (shorter: larger)."
NO_FLAW = f"No pull-off: {UNBOUNDED} Set {FLAW}"
FORCED = f"No largest tension: {UNBOUNDED} The control forced it open. Under a given mean pressure, set {FLAW}"

Unit = tuple[float, str]  # factor from SI, and the unit with its prefix
Inputs = Mapping[int | None, Mapping[str, float]]  # uncertainty of the input in SI units, by target (None: the path)


def axis_unit(largest: float, unit: str) -> Unit:
    """Return the factor and the unit with a prefix that bring the largest of some numbers between 1 and 1000.

    Examples
    --------
    >>> axis_unit(2.5e-5, "m")
    (1000000.0, 'µm')
    """
    power = 3 * math.floor(math.log10(largest) / 3 + 1e-12) if largest else 0
    return (10.0**-power, PREFIXES[power] + unit) if power in PREFIXES else (1.0, unit)


def common_unit(values: Iterable[float], unit: str) -> Unit:
    """Return the factor and the unit with a prefix in which to write all of some numbers.

    The prefix suits the least number that is no smaller than a thousandth of the largest, which stays below 10,000.

    Examples
    --------
    >>> common_unit([5e4, 1e6], "Pa"), common_unit([0.0, 1.5e-9, 2.5e-5], "m"), common_unit([0.0, math.nan], "m")
    ((0.001, 'kPa'), (1000000.0, 'µm'), (1.0, 'm'))
    """
    sizes = [abs(value) for value in values if value and math.isfinite(value)]
    if not sizes:
        return 1.0, unit
    largest = max(sizes)
    least = min(size for size in sizes if size >= largest / 1000)
    power = max(3 * math.floor(math.log10(least) / 3 + 1e-12), 3 * math.floor((math.log10(largest) - 4) / 3) + 3)
    return (10.0**-power, PREFIXES[power] + unit) if power in PREFIXES else (1.0, unit)


def units_of(result: Result) -> dict[str, Unit]:
    """Return the unit of each quantity, for all states of a path.

    Pressures on the contacts share a unit, and so do the heights of open gaps.
    """
    states = [state for state in result.states if state.found]
    means = [state.mean_pressure / state.contact_fraction for state in states if state.contact_fraction]
    peaks = [state.peak_pressure for state in states if state.peak_pressure is not None]
    gaps = [state.separation / (1 - state.contact_fraction) for state in states if state.contact_fraction < 1]
    table = {name: values.tolist() for name, values in result.to_table("targets").items()}
    values = {
        "separation": [state.separation for state in states],
        "mean_pressure": [state.mean_pressure for state in states],
        **dict.fromkeys(PRESSURES, means + peaks),
        **dict.fromkeys(GAPS, gaps),
        **{name: table.get(name, []) for name in ("width_median", "widest_channel")},
    }
    control = result.scene["loading"]["control"]
    met = [target for target, state in zip(table["target"], result.targets, strict=True) if state.found]
    values[control] = values.get(control, []) + met
    return {name: common_unit(of, UNITS[name]) for name, of in values.items()}


def digits(relative: float) -> int:
    """Return the number of digits that a relative uncertainty leaves, two to four.

    Examples
    --------
    >>> digits(0.3), digits(0.02), digits(0.004), digits(1e-9)
    (2, 2, 3, 4)
    """
    return min(max(1 + math.floor(-math.log10(relative)), FEWEST_DIGITS), MOST_DIGITS) if relative > 0 else MOST_DIGITS


def readable(value: float, unit: str, figures: int) -> str:
    """Return a number with `figures` digits and a prefix before its unit.

    Examples
    --------
    >>> readable(1.44496e-7, "m", 4), readable(50000.0, "Pa", 3), readable(0.30041, "", 2), readable(0.0, "m", 4)
    ('144.5 nm', '50.0 kPa', '0.30', '0 m')
    >>> readable(9.9996e-7, "m", 4), readable(3e-30, "m", 2)
    ('1.000 µm', '3.0e-30 m')
    """
    if value == 0 or not unit:
        return f"{fixed(value, figures)} {unit}".strip()
    rounded = float(f"{value:.{figures - 1}e}")
    factor, prefixed = axis_unit(abs(rounded), unit)
    return f"{fixed(rounded * factor, figures)} {prefixed}"


def quantity(value: float, unit: str) -> str:
    """Return a given number with all its digits, up to six, and a prefix before its unit.

    Examples
    --------
    >>> quantity(5e-05, "m"), quantity(1.25e6, "Pa"), quantity(0.0, "m"), quantity(3e-30, "m")
    ('50 µm', '1.25 MPa', '0 m', '3e-30 m')
    """
    factor, prefixed = axis_unit(abs(value), unit)
    return f"{value * factor:.6g} {prefixed}"


def fixed(value: float, figures: int) -> str:
    """Return a number with `figures` digits, without an exponent from 1e-4 to 1e6."""
    if value == 0:
        return "0"
    scientific = f"{value:.{figures - 1}e}"
    power = int(scientific.partition("e")[2])
    return f"{float(scientific):.{max(figures - 1 - power, 0)}f}" if -4 <= power < 6 else scientific


def share(relative: float) -> str:
    """Return a relative uncertainty in per cent.

    Examples
    --------
    >>> share(6e-11), share(0.0832), share(2.5), share(0.0)
    ('< 0.01 %', '8.3 %', '250 %', '0 %')
    """
    if not math.isfinite(relative):
        return NO_NUMBER
    if relative == 0:
        return "0 %"
    return "< 0.01 %" if relative < 1e-4 else f"{fixed(100 * relative, 2)} %"


def answer(result: Result, inputs: Inputs | None = None) -> list[tuple[str, list[str]]]:
    """Return the lines of the answer: a heading, and a text for each target.

    A heading "± ..." belongs to the uncertainties of the quantity before it: in per cent, of a zero in its unit.
    """
    control = result.scene["loading"]["control"]
    columns = {name: values.tolist() for name, values in result.to_table("targets").items()}
    targets = [{name: values[k] for name, values in columns.items()} for k in range(len(result.targets))]
    known = [(inputs or {}).get(k, {}) for k in range(len(targets))]
    units = units_of(result)
    held = [
        _held(target["target"], units[control]) if state.found else quantity(target["target"], UNITS[control])
        for target, state in zip(targets, result.targets, strict=True)
    ]
    lines = [(f"{control.replace('_', ' ')} (held)", held)]
    for name, head in QUANTITIES.items():
        if name == control:
            continue
        unit = units.get(name, (1.0, ""))
        pairs = list(zip(targets, known, strict=True))
        largest = max((abs(target[name]) for target in targets if math.isfinite(target[name])), default=0.0)
        lines.append((head, [_cell(target, name, outer, unit, largest) for target, outer in pairs]))
        uncertain = [_uncertainty(target, name, outer) for target, outer in pairs]
        if any(text != NO_NUMBER for text in uncertain):
            lines.append((f"± {head}", uncertain))
    return lines


def _held(target: float, unit: Unit) -> str:
    """Return the target with all its digits, up to six: the value of the quantity under control."""
    return NO_NUMBER if math.isnan(target) else f"{target * unit[0]:.6g} {unit[1]}"


def _cell(row: Mapping[str, Any], name: str, inputs: Mapping[str, float], unit: Unit, largest: float) -> str:
    """Return a number with the digits that the larger of its own uncertainties allows; 0 if the largest rounds it."""
    value, (factor, prefixed) = row[name], unit
    if math.isnan(value):
        return "apart" if name == "n_patches" and row["status"] == "unreachable" and row["target"] < 0 else NO_NUMBER
    if name == "n_patches":
        return "complete" if row["contact_fraction"] == 1 else f"{value:.0f}"
    if name in TRIPLES:
        return f"{', '.join(fixed(row[column] * factor, 3) for column in TRIPLES[name])} {prefixed}"
    if abs(value) < NOTHING * largest:
        return f"0 {prefixed}".strip()
    relative = max(filter(math.isfinite, _relative(row, name, inputs)), default=0.0)
    if name == "open_share" and value:  # its error is that of the contact fraction
        name = "contact_fraction"
        relative = max(filter(math.isfinite, _relative(row, name, inputs)), default=0.0) * row[name] / value
    return f"{fixed(value * factor, digits(relative))} {prefixed}".strip()


def _relative(row: Mapping[str, float], name: str, inputs: Mapping[str, float]) -> tuple[float, float]:
    """Return the relative uncertainties of a number, numerical and of the input; nan where one is not known.

    The mean contact pressure is the mean pressure over the contact fraction.
    """
    if name == "contact_pressure":
        parts = zip(*(_relative(row, part, inputs) for part in ("mean_pressure", "contact_fraction")), strict=True)
        numerical, outer = (area if math.isnan(load) else math.hypot(load, area) for load, area in parts)
        return numerical, outer
    value, error = row[name], row.get(f"error_estimate_{name}", math.nan)
    return (abs(error / value), inputs.get(name, math.nan) / abs(value)) if value else (math.nan, math.nan)


def _uncertainty(row: Mapping[str, float], name: str, inputs: Mapping[str, float]) -> str:
    """Return the uncertainties of a number in per cent, of a zero in its unit, by their origin."""
    if row[name] == 0 and inputs.get(name):
        return f"{readable(inputs[name], UNITS.get(name, ''), FEWEST_DIGITS)} input"
    pairs = zip(_relative(row, name, inputs), ("numerical", "input"), strict=True)
    return ", ".join(f"{share(value)} {origin}" for value, origin in pairs if math.isfinite(value)) or NO_NUMBER


def pull_off_words(result: Result, inputs: Inputs | None = None) -> str:
    """Return words on the largest tension of the way out, or on its absence; nothing without tension."""
    if stays_complete(result):
        return NO_FLAW
    tension, end, where = result.largest_tension, end_in_tension(result), ""
    units = units_of(result)
    load, height = units["mean_pressure"], units["separation"]
    if tension is not None:
        error = tension.error_estimate.mean_pressure / -tension.mean_pressure
        outer = (inputs or {}).get(None, {}).get(PULL_OFF, math.nan) / -tension.mean_pressure
        known, figures = f"± {share(error)} numerical", MOST_DIGITS
        if math.isfinite(outer):
            known, figures = f"{known}, {share(outer)} input", digits(max(error, outer))
        where = f"{_in(load, -tension.mean_pressure, figures)} ({known}), at a separation of "
        nothing = abs(tension.separation) < NOTHING * abs(tension.penetration)
        where += _in(height, 0.0 if nothing else tension.separation)
    forced = was_forced_open(result)
    if end is not None:
        words = "The way out ends in tension"
        if end.target:
            words += f", {_in(load, -end.mean_pressure)}"
            words += f" at a separation of {_in(height, end.separation)}"
        if forced:
            return f"{FORCED} {words}" + (f"; the load turns at {where}." if where else ".")
        words = f"Pull-off: not reached. {words}, and larger tensions may lie beyond"
        return words + (f"; before that it turns at {where}." if where else ".")
    if tension is None:
        return FORCED if forced else ""
    apart = result.came_apart()
    parting = (
        "the surfaces have not come apart on this path"
        if apart is None
        else f"the surfaces come apart at {_in(height, apart)}"
    )
    if forced:
        claim = f"{FORCED} After that the load turns at"
    elif was_exceeded(result):
        claim = "Pull-off: the way out begins in larger tension, and the load turns at"
    else:
        claim = "Pull-off: the largest tension on the way out is"
    return f"{claim} {where}; {parting}."


def _in(unit: Unit, value: float, figures: int = MOST_DIGITS) -> str:
    """Return a number in a given unit."""
    return f"{fixed(value * unit[0], figures)} {unit[1]}"


def pull_off(result: Result) -> LargestTension | None:
    """Return the located tension that is the largest of the way out; None where the path does not know the largest."""
    return None if was_forced_open(result) or was_exceeded(result) else result.largest_tension


def end_in_tension(result: Result) -> State | None:
    """Return the end of a way out of largest tension, if no turn, fold or jump of the load has a larger one.

    A way out ends, or turns back, at a target, where nothing depends on the increment; else the path broke off.
    """
    states = [*(state for state in result.states if state.found), None]
    ends = [
        state
        for state, after in pairwise(states)
        if state is not None
        and state.branch == "unloading"
        and (after is None or after.branch == "loading")
        and state.mean_pressure < 0
    ]
    end = min(ends, key=lambda state: state.mean_pressure, default=None)
    tension = result.largest_tension
    if end is None or tension is None:
        return end
    return end if _exceeds(end, tension) else None


def _exceeds(state: State, tension: LargestTension) -> bool:
    """Return whether a state is in larger tension than the largest that was located, beyond its error."""
    return state.mean_pressure < tension.mean_pressure - tension.error_estimate.mean_pressure


def was_exceeded(result: Result) -> bool:
    """Return whether the way out begins or ends in larger tension than it has at any turn, fold or jump."""
    tension = result.largest_tension
    out = [state for state in result.states if state.found and state.branch == "unloading"]
    return tension is not None and any(_exceeds(state, tension) for state in out)


def slope_words(result: Result) -> str:
    """Return words on the rms slope that filter and cut leave of a prepared scan; nothing without one."""
    steps = {step["step"]: step for step in result.profile_preparation}
    if "cut" not in steps:
        return ""
    before, after = steps.get("filter", steps["cut"])["rms_slope"][0], steps["cut"]["rms_slope"][1]
    if before == 0:
        return ""
    return (
        f"Roughness: filter and cut leave {fixed(100 * after / before, 3)} % of the rms slope, {fixed(after, 3)} of "
        f"{fixed(before, 3)}; a small contact area without adhesion goes as its inverse."
    )


def stays_complete(result: Result) -> bool:
    """Return whether the way out ends in complete contact that nothing can open: with adhesion, without a flaw."""
    last = next((state for state in reversed(result.states) if state.found), None)
    unflawed = result.scene["adhesion"] is not None and result.scene["loading"].get("flaw") is None
    return unflawed and last is not None and (last.status, last.branch) == ("complete_contact", "unloading")


def was_forced_open(result: Result) -> bool:
    """Return whether a given separation or penetration opened complete contact, at a tension without bound."""
    return any(event.kind == "opening" and math.isnan(event.mean_pressure) for event in result.events)


def csv_text(result: Result, inputs: Inputs | None = None) -> str:
    """Return the answer as comma-separated values in SI units, named in the headings; unknown values are empty.

    A column `input_uncertainty_NAME` holds the uncertainty of the input of the quantity NAME, where `inputs` know it.
    """
    columns = result.to_table("targets")
    known = [(inputs or {}).get(k, {}) for k in range(len(result.targets))]
    for name in [name for name in QUANTITIES if any(name in uncertain for uncertain in known)]:
        columns[INPUT + name] = np.array([uncertain.get(name, math.nan) for uncertain in known])
    units = {name: UNITS.get(name.removeprefix("error_estimate_").removeprefix(INPUT), "") for name in columns}
    lines = [",".join(f"{name} / {unit}" if unit else name for name, unit in units.items())]
    for row in zip(*(values.tolist() for values in columns.values()), strict=True):
        lines.append(",".join(value if isinstance(value, str) else _plain(value) for value in row))
    return "\n".join(lines) + "\n"


def _plain(value: float) -> str:
    """Return a number with all its digits, an unknown one as an empty text."""
    return "" if math.isnan(value) else f"{value:.17g}"


def table_text(result: Result, inputs: Inputs | None = None) -> str:
    """Return the answer for a terminal: a line for each quantity, a column for each target."""
    lines = answer(result, inputs)
    listed = aligned([(head, *texts) for head, texts in lines])
    return "\n".join([*listed, *filter(None, [pull_off_words(result, inputs), slope_words(result)])])


def aligned(table: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table, its columns of equal width: the first to the left, others to the right."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return [
        "  ".join([f"{line[0]:<{widths[0]}}", *(f"{text:>{k}}" for text, k in zip(line[1:], widths[1:], strict=True))])
        for line in table
    ]
