"""Invariants of a result: what holds between its scene, states, events and arrays, besides the types of each.

`check_result` judges alike what the solver has computed (bem/record.py) and what a file holds (result_file.py,
journal.py).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import is_dataclass
from datetime import datetime
from itertools import chain
from typing import Any

from bem.audit.certificate import Demands
from bem.geometry.ranges import Mistake, shown
from bem.geometry.table import TableError, plain
from bem.scene.provenance import FACTS, digest
from bem.scene.result import Event, LargestTension, Result, asked_for
from bem.scene.scene_rules import REQUIRED, loading_mistakes, profile_mistakes
from bem.scene.scene_tables import REQUIRED_TABLES, TABLES, WITH_DEFAULTS, class_of
from bem.scene.state import FINAL_STATUSES, GapNumbers, State
from bem.scene.stored_arrays import array_mistakes

SUM_ROUNDING = 1e-9  # derived: of a period or a sum of energies; rounding, with a margin
LARGEST = 1e150  # derived: magnitude of any number in SI units, whose square is a double with room for a factor
MISSED = ("unreachable", "not_converged")
GROUPS = ("rms_height", "rms_slope", "pressure_scale")  # of every scene
ENDINGS = ("converged", *MISSED, "interrupted")


class InvariantError(ValueError):
    """Result whose parts do not match; `mistake` is the first wrong key, with its value and the allowed values."""

    def __init__(self, mistake: Mistake) -> None:
        super().__init__(str(mistake))
        self.mistake = mistake


def check_result(result: Result) -> Result:
    """Return a result in which everything holds; raise InvariantError for the first mistake."""
    parts = (
        _scene_mistakes(result.scene),
        _facts_mistakes(result),
        _number_mistakes(result),
        _path_mistakes(result),
        _part_mistakes(result),
        _whole_mistakes(result),
    )
    for mistake in chain(*parts):
        raise InvariantError(mistake)
    return result


def _unless(holds: bool, key: str, value: Any, allowed: str) -> Iterator[Mistake]:
    """Yield a mistake unless a condition holds."""
    if not holds:
        yield Mistake(key, f"is {shown(value)}", allowed)


def _facts_mistakes(result: Result) -> Iterator[Mistake]:
    """Yield groups and facts of the provenance that are missing, and a digest of another scene."""
    for name in GROUPS:
        yield from _unless(name in result.groups, f"groups.{name}", None, "a number")
    for name in FACTS:
        yield from _unless(
            bool(result.provenance.get(name)), f"provenance.{name}", result.provenance.get(name), "a text"
        )
    sha256, own = result.provenance["scene_sha256"], digest(result.scene)
    yield from _unless(sha256 == own, "provenance.scene_sha256", sha256, f"{own}, the digest of the scene")
    try:
        datetime.fromisoformat(result.provenance["date"])
    except ValueError:
        yield Mistake("provenance.date", f"is {shown(result.provenance['date'])}", "a date and time of ISO 8601")


def _number_mistakes(result: Result) -> Iterator[Mistake]:
    """Yield numbers beyond `LARGEST`; NaN is a number that does not exist, an infinite error one not estimated."""
    for name, part in vars(result).items():
        if name in ("scene", "fields"):  # which have limits of their own
            continue
        for key, number in _numbers(name, part):
            holds = abs(number) < LARGEST or number != number or (number == math.inf and ".error_estimate." in key)
            yield from _unless(holds, key, number, f"a number below {LARGEST:g} in magnitude")


def _numbers(key: str, part: Any) -> Iterator[tuple[str, float]]:
    """Yield all numbers of a part of a result with their keys, but for edges, which lie within the period."""
    if isinstance(part, int | float):
        yield key, part
    elif isinstance(part, list | tuple):
        for k, item in enumerate(part):
            yield from _numbers(f"{key}[{k}]", item)
    elif isinstance(part, Mapping) or is_dataclass(part):
        for name, item in (part if isinstance(part, Mapping) else vars(part)).items():
            if name != "edges":
                yield from _numbers(f"{key}.{name}", item)


def _scene_mistakes(scene: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield mistakes of a resolved scene: every table is there, with all its keys and allowed values."""
    yield from _unless(isinstance(scene.get("title"), str), "scene.title", scene.get("title"), "a text")
    for name in TABLES:
        table = scene.get(name)
        if table is None and name in scene and name not in (*REQUIRED_TABLES, *WITH_DEFAULTS):
            continue
        if name not in scene:
            yield Mistake(f"scene.{name}", "is missing", "a table or null")
        yield from _unless(isinstance(table, dict), f"scene.{name}", table, "a table")
        yield from _table_mistakes(name, {**scene[name]})
    tables = [name for name in TABLES if scene[name] is not None]
    profile, loading = ({**scene[name]} for name in ("profile", "loading"))
    profile.pop("sha256", None)
    yield from map(_of_scene, profile_mistakes(profile, profile))
    yield from map(_of_scene, loading_mistakes(loading, loading, tables, profile["period"]))


def _of_scene(mistake: Mistake) -> Mistake:
    """Return a mistake of a scene as that of the scene of a result."""
    return Mistake(f"scene.{mistake.path}", mistake.found, mistake.allowed)


def _table_mistakes(name: str, stored: dict[str, Any]) -> Iterator[Mistake]:
    """Yield mistakes of a resolved table, which is made anew of what is stored."""
    given = {key: value for key, value in stored.items() if (name, key) != ("profile", "sha256")}
    if isinstance(given.get("initial"), dict):
        given["initial"] = {key: value for key, value in given["initial"].items() if key != "penetration"}
    try:
        needed = [*plain(class_of(name)(**given))]
    except TableError as error:
        yield from map(_of_scene, error.mistakes)
        return
    for key in (*needed, *(("period", *REQUIRED[stored["kind"]]) if name == "profile" else ())):
        if key not in stored:
            yield Mistake(f"scene.{name}.{key}", "is missing", "a resolved scene has every key")
    for key, value in given.items():
        yield from _unless(value is not None, f"scene.{name}.{key}", value, "a value, or no such key")


def _whole_mistakes(result: Result) -> Iterator[Mistake]:
    """Yield mistakes of the status, the failure, the provenance and the largest tension."""
    status, failure, tension = result.status, result.failure, result.largest_tension
    yield from _unless(status in ENDINGS, "status", status, ", ".join(ENDINGS))
    met = all(state.found and state.certificate.ok for state in result.targets)
    yield from _unless(met or status != "converged", "status", status, "another one, as a target is not met")
    yield from _unless(not met or status != "unreachable", "status", status, "another one, as every target is met")
    told = bool(failure) if status in MISSED else failure is None
    yield from _unless(told, "failure", failure, f"a text where the status is {' or '.join(MISSED)}, else null")
    if tension is not None:
        yield from _unless(tension.mean_pressure < 0, "largest_tension.mean_pressure", tension.mean_pressure, "< 0")
        yield from _error_mistakes("largest_tension", tension)


def _path_mistakes(result: Result) -> Iterator[Mistake]:
    """Yield mistakes of the order of the states: of their targets, events and arrays."""
    loading, last = result.scene["loading"], len(result.events)
    ahead = len(loading["targets"])
    asked = ahead + len(loading["at_mean_pressures"]) + ("stop_at_mean_pressure" in loading)
    events, stored, target, branch, passed = 0, 0, 0, "", set[int]()
    for k, state in enumerate(result.states):
        passed = passed if state.branch == branch else set()  # every leg meets the mean pressures asked for
        indices = [i for i in (*range(ahead)[target : target + 1], *range(ahead, asked)) if i not in passed]
        met = state.index in indices if state.target else state.index is None
        allowed = f"{' or '.join(map(str, indices)) or 'none'} at a target, each once and in order, else null"
        yield from _unless(met, f"states[{k}].index", state.index, allowed)
        counted = events <= state.events <= last
        yield from _unless(counted, f"states[{k}].events", state.events, f"{events} to {last}")
        yield from _unless(state.stored in (None, stored), f"states[{k}].stored", state.stored, f"{stored} or null")
        events, stored, branch = state.events, stored + (state.stored is not None), state.branch
        if state.index is not None:
            target += state.index == target
            passed.add(state.index)
    whole = target == ahead or result.status in ("not_converged", "interrupted") or "stop_at_mean_pressure" in loading
    yield from _unless(whole, "status", result.status, f"another one, as target {target} has no state")


def _part_mistakes(result: Result) -> Iterator[Mistake]:
    """Yield mistakes of each state, event and array."""
    period, depth = (
        result.scene["profile"]["period"],
        result.scene["accuracy"]["tolerance"] * result.groups["rms_height"],
    )
    for k, state in enumerate(result.states):
        yield from _state_mistakes(f"states[{k}]", state, period)
        yield from _held_mistakes(f"states[{k}]", state, result.scene["loading"])
        if state.certificate.ok:
            yield from _figure_mistakes(f"states[{k}].certificate", state, depth)
        if state.gaps is not None and state.found:
            yield from _gap_mistakes(f"states[{k}].gaps", state.gaps, state, period)
    yield from _crest_mistakes(result)
    for k, event in enumerate(result.events):
        yield from _error_mistakes(f"events[{k}]", event)
        known, bound = not math.isnan(event.mean_pressure), event.error_estimate.mean_pressure
        allowed = "null where the tension has no bound and mean_pressure is null, else a number"
        yield from _unless(known == (bound is not None), f"events[{k}].error_estimate.mean_pressure", bound, allowed)
        for name, end in (("before", event.before), ("after", event.after)):
            yield from _edge_mistakes(f"events[{k}].{name}", () if end is None else end.edges, period)
    stored = {str(state.stored) for state in result.states if state.stored is not None}
    for name, fault, allowed in array_mistakes(result.fields, stored):
        yield Mistake(f"fields.{name}", f"is {fault}", allowed)
    for state in result.states:
        if f"x_{state.stored}" in result.fields:
            yield from _shape_mistakes(result.fields, state, period, depth)


def _shape_mistakes(fields: Mapping[str, Any], state: State, period: float, depth: float) -> Iterator[Mistake]:
    """Yield mistakes of the shape of a state: positions, gaps down to -`depth` or rounding, patches and pressures."""
    x, gap, patch, pressure = (fields[f"{name}_{state.stored}"] for name in ("x", "gap", "patch", "pressure"))
    height = max(depth, SUM_ROUNDING * float(gap.max()))
    for name, holds, allowed in (
        ("x", (x[1:] >= x[:-1]).all() and x[-1] - x[0] <= period * (1 + SUM_ROUNDING), f"rising within {period:g} m"),
        ("gap", gap.min() >= -height, f"at least {-height:.3g} m"),
        ("patch", patch.min() >= -1 and patch.max() < max(state.n_patches, 1), f"-1 to {state.n_patches - 1}"),
        ("pressure", not (abs(pressure) == math.inf).any(), "finite, or NaN where it does not exist"),
    ):
        if not holds:
            yield Mistake(f"fields.{name}_{state.stored}", "has other values", allowed)


def _state_mistakes(key: str, state: State, period: float) -> Iterator[Mistake]:
    """Yield mistakes of a state: edges and contact, energies, certificate and errors."""
    yield from _edge_mistakes(key, state.edges, period)
    count = len(state.edges)
    yield from _unless(state.n_patches == count, f"{key}.n_patches", state.n_patches, f"{count}, the number of edges")
    share = sum(b - a for a, b in state.edges) / period if state.edges else float(state.status == "complete_contact")
    total = state.elastic_energy + state.adhesion_energy
    size = abs(state.elastic_energy) + abs(state.adhesion_energy)
    if state.found:
        close = abs(state.contact_fraction - share) < SUM_ROUNDING
        allowed = f"{share:.9g}, the share of the period between edges"
        yield from _unless(close, f"{key}.contact_fraction", state.contact_fraction, allowed)
        close = abs(state.total_energy - total) <= SUM_ROUNDING * size
        yield from _unless(close, f"{key}.total_energy", state.total_energy, f"{total:.9g}, the sum of both energies")
    ok, reasons, certified = state.certificate.ok, state.certificate.reasons, state.status in FINAL_STATUSES
    yield from _unless(
        ok == certified, f"{key}.certificate.ok", ok, f"{shown(certified)} where the state is {state.status}"
    )
    yield from _unless(
        bool(reasons) != ok, f"{key}.certificate.reasons", reasons, "a text where ok is false, else none"
    )
    for name in ("unknowns", "evaluations", "cpu_seconds"):
        yield from _unless(getattr(state, name) >= 0, f"{key}.{name}", getattr(state, name), ">= 0")
    yield from _error_mistakes(key, state)


def _held_mistakes(key: str, state: State, loading: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield a mistake of a state at a target: the quantity asked for has the value asked for, within its error.

    Distances round with the crest, penetration + separation: a separation of 1e-300 m is 0.
    """
    if state.index is None or not state.found:
        return
    quantity, asked = asked_for(loading, state.index)
    value, error = getattr(state, quantity), getattr(state.error_estimate, quantity) or 0.0
    crest = abs(state.penetration) + abs(state.separation) if quantity in ("separation", "penetration") else 0.0
    allowed = error + SUM_ROUNDING * (abs(asked) + crest)
    held = value is not None and not abs(value - asked) > allowed  # NaN: any pressure would do
    yield from _unless(
        held, f"{key}.{quantity}", value, f"{asked:.9g}, target {state.index}, within the estimated error"
    )


def _crest_mistakes(result: Result) -> Iterator[Mistake]:
    """Yield the first penetration that does not add up with its separation to the highest crest, as others do."""
    places: list[tuple[str, State | LargestTension]] = [
        (f"states[{k}]", state) for k, state in enumerate(result.states) if state.found
    ]
    places += [] if result.largest_tension is None else [("largest_tension", result.largest_tension)]
    for key, part in places[1:]:
        crest = places[0][1].penetration + places[0][1].separation
        rest = crest - part.separation
        size = abs(crest) + abs(part.separation) + abs(places[0][1].separation)
        allowed = f"{rest:.9g}, as penetration + separation is {crest:.9g} m in {places[0][0]}"
        yield from _unless(
            abs(part.penetration - rest) <= SUM_ROUNDING * size, f"{key}.penetration", part.penetration, allowed
        )


def _figure_mistakes(key: str, state: State, depth: float) -> Iterator[Mistake]:
    """Yield figures that no certified state has; surfaces may overlap by `depth` at most."""
    figures, asymmetry = state.certificate, Demands().hessian_asymmetry
    for name in ("closure", "min_gap", "truncation", "contact_residual", "mean_gap_error") if state.edges else ():
        yield from _unless(getattr(figures, name) is not None, f"{key}.{name}", None, "a number where ok is true")
    for name, least, most in (
        ("closure", 0.0, math.inf),
        ("min_gap", -depth, math.inf),
        ("min_eigenvalue", 0.0, math.inf),
        ("hessian_asymmetry", 0.0, asymmetry),
        ("truncation", 0.0, math.inf),
        ("contact_residual", 0.0, math.inf),
        ("mean_gap_error", 0.0, math.inf),
    ):
        value = getattr(figures, name)
        allowed = f"{least:.3g} to {most:.3g} where ok is true"
        yield from _unless(value is None or least <= value <= most, f"{key}.{name}", value, allowed)


def _gap_mistakes(key: str, gaps: GapNumbers, state: State, period: float) -> Iterator[Mistake]:
    """Yield numbers of the gaps that do not follow from contact fraction, edges and separation, and peaks too low."""
    share, starts = 1 - state.contact_fraction, [a for a, _ in state.edges]
    following = [*starts[1:], *(start + period for start in starts[:1])]
    widest = max((a - b for (_, b), a in zip(state.edges, following, strict=True)), default=period * share)
    mean, heights = (
        state.separation / share if share > SUM_ROUNDING else gaps.mean_open,
        [*vars(gaps.quantiles).values()],
    )
    for name, value, right, scale in (
        ("open_fraction", gaps.open_fraction, share, 1.0),
        ("widest_channel", gaps.widest_channel, widest, period),
        ("mean_open", gaps.mean_open, mean, mean / max(share, SUM_ROUNDING)),
    ):
        yield from _unless(abs(value - right) <= SUM_ROUNDING * scale, f"{key}.{name}", value, f"{right:.9g}")
    top = max(state.largest_gap or 0.0, gaps.mean_open)
    rising = heights == sorted(heights) and heights[0] >= 0 and heights[-1] <= top * (1 + SUM_ROUNDING)
    yield from _unless(rising, f"{key}.quantiles", heights, f"rising heights from 0 to {top:.9g}, the largest gap")
    peak, fraction = state.peak_pressure, state.contact_fraction
    if peak is not None and fraction > 0:
        least = state.mean_pressure / fraction
        holds, allowed = peak >= least - SUM_ROUNDING * abs(least), f"at least {least:.9g}, the mean in contact"
        yield from _unless(holds, f"{key.removesuffix('.gaps')}.peak_pressure", peak, allowed)


def _edge_mistakes(key: str, edges: Sequence[tuple[float, float]], period: float) -> Iterator[Mistake]:
    """Yield mistakes of edges."""
    ends = [end for edge in edges for end in edge]
    placed = ends == sorted(ends) and (not ends or (0 <= ends[0] <= period and ends[-1] <= ends[0] + period))
    yield from _unless(placed, f"{key}.edges", edges, f"ascending positions within one period of {period:g} m")


def _error_mistakes(key: str, part: State | Event | LargestTension) -> Iterator[Mistake]:
    """Yield mistakes of estimated errors."""
    for name, error in vars(part.error_estimate).items():
        right = error is None or error >= 0
        yield from _unless(right, f"{key}.error_estimate.{name}", error, "a number >= 0 or null")
