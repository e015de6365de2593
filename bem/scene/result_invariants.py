"""Invariants of a result: what its parts must agree on, besides the type and the range of each number.

`contradiction` judges alike what the solver has computed and what a file holds.  A computed result keeps its states:
`judged` says in its status and failure what does not match (bem/record.py).  A stored result is refused unless its
failure says so (result_file.py, journal.py).  Numbers that follow from others (`_derived`) obey one rule: computed
anew, they are the same.  Types and ranges are in state.py and result.py.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain
from typing import Any

from bem.audit.certificate import Demands
from bem.geometry.ranges import Mistake, shown
from bem.geometry.table import TableError, plain
from bem.scene.array_names import array_mistakes
from bem.scene.digest import digest
from bem.scene.provenance import FACTS
from bem.scene.result import Result, asked_for
from bem.scene.scene_rules import loading_mistakes, profile_mistakes
from bem.scene.scene_tables import REQUIRED_TABLES, TABLES, WITH_DEFAULTS, class_of
from bem.scene.state import FINAL_STATUSES, GapNumbers, State

SUM_ROUNDING = 1e-9  # derived: of a period or a sum of energies; rounding, with a margin
MISSED = ("unreachable", "not_converged")
NEEDED_GROUPS = ("rms_height", "rms_slope", "pressure_scale")  # of every scene
FIGURES = ("closure", "min_gap", "truncation", "contact_residual", "mean_gap_error")  # of a certified state with edges

FAULT = "parts of the result contradict one another, which is a fault of this program: "

Claim = tuple[Any, str, Any, str] | Mistake  # whether it holds, key, value, and what is allowed; or what does not hold
Derived = tuple[str, Any, Any, float]  # key, value stored, value anew, and the difference that rounding makes


def judged(result: Result) -> Result:
    """Return a computed result; one whose parts do not match is `not_converged`, and its failure names the first."""
    mistake = contradiction(result)
    return result if mistake is None else replace(result, status="not_converged", failure=f"{FAULT}{mistake}")


def contradiction(result: Result) -> Mistake | None:
    """Return the first key that does not match the others; None where all match, or where the failure names it."""
    parts = (_scene_claims, _path_claims, _part_claims, _derived_claims, _array_claims, _whole_claims)
    mistakes = filter(None, map(_mistake, chain.from_iterable(part(result) for part in parts)))
    mistake = next(mistakes, None)
    return None if result.failure == f"{FAULT}{mistake}" else mistake


def _mistake(claim: Claim) -> Mistake | None:
    """Return what a claim gets wrong; None if it holds."""
    if isinstance(claim, Mistake):
        return claim
    holds, key, value, allowed = claim
    return None if holds else Mistake(key, f"is {shown(value)}", allowed)


def _scene_claims(result: Result) -> Iterator[Claim]:
    """Yield what holds for a resolved scene: tables made anew of their keys are the same; for groups and facts."""
    scene = result.scene
    yield isinstance(scene.get("title"), str), "scene.title", scene.get("title"), "a text"
    for name in TABLES:
        table, optional = scene.get(name), name not in (*REQUIRED_TABLES, *WITH_DEFAULTS)
        holds = isinstance(table, dict) or (table is None and optional and name in scene)
        yield holds, f"scene.{name}", table, "a table" + " or null" * optional
        if isinstance(table, dict):
            yield from _table_claims(name, table)
    profile, loading = ({**scene[name]} for name in ("profile", "loading"))
    profile.pop("sha256", None)
    yield "period" in profile, "scene.profile.period", None, "a length, which a resolved scene has"
    tables = [name for name in TABLES if scene[name] is not None]
    rules = profile_mistakes(profile, profile), loading_mistakes(loading, loading, tables, profile["period"])
    yield from map(_of_scene, chain(*rules))
    for name in NEEDED_GROUPS:
        yield name in result.groups, f"groups.{name}", None, "a number"
    for name in FACTS:
        yield bool(result.provenance.get(name)), f"provenance.{name}", result.provenance.get(name), "a text"
    date = result.provenance["date"]
    yield re.match(r"\d{4}-\d\d-\d\dT\d\d:\d\d", date), "provenance.date", date, "a date and time of ISO 8601"


def _table_claims(name: str, stored: Mapping[str, Any]) -> Iterator[Claim]:
    """Yield that a resolved table is the same when it is made anew of what is stored."""
    given = {key: value for key, value in stored.items() if (name, key) != ("profile", "sha256")}
    if isinstance(given.get("initial"), dict):
        given["initial"] = {key: value for key, value in given["initial"].items() if key != "penetration"}
    try:
        anew = plain(class_of(name)(**given))
    except TableError as error:
        yield from map(_of_scene, error.mistakes)
        return
    for key in dict.fromkeys((*given, *anew)):
        same = key in given and key in anew and given[key] == anew[key]
        yield same, f"scene.{name}.{key}", given.get(key), f"{shown(anew.get(key))}, or no such key if that is null"


def _of_scene(mistake: Mistake) -> Mistake:
    """Return a mistake of a scene as that of the scene of a result."""
    return Mistake(f"scene.{mistake.path}", mistake.found, mistake.allowed)


def _path_claims(result: Result) -> Iterator[Claim]:
    """Yield what holds for the order of the states: for their targets, events and arrays."""
    loading, last = result.scene["loading"], len(result.events)
    ahead = len(loading["targets"])
    asked = ahead + len(loading["at_mean_pressures"]) + ("stop_at_mean_pressure" in loading)
    events, stored, target, branch, passed = 0, 0, 0, "", set[int]()
    for k, state in enumerate(result.states):
        passed = passed if state.branch == branch else set()  # every leg meets the mean pressures asked for
        indices = [i for i in (*range(ahead)[target : target + 1], *range(ahead, asked)) if i not in passed]
        met = state.index in indices if state.target else state.index is None
        allowed = f"{' or '.join(map(str, indices)) or 'none'} at a target, each once and in order, else null"
        yield met, f"states[{k}].index", state.index, allowed
        yield events <= state.events <= last, f"states[{k}].events", state.events, f"{events} to {last}"
        yield state.stored in (None, stored), f"states[{k}].stored", state.stored, f"{stored} or null"
        events, stored, branch = state.events, stored + (state.stored is not None), state.branch
        if state.index is not None:
            target += state.index == target
            passed.add(state.index)
    whole = target == ahead or result.status in ("not_converged", "interrupted") or "stop_at_mean_pressure" in loading
    yield whole, "status", result.status, f"another one, as target {target} has no state"


def _derived_claims(result: Result) -> Iterator[Claim]:
    """Yield that numbers that follow from others are the same when they are computed anew."""
    for key, stored, anew, rounding in _derived(result):
        same = stored == anew or (isinstance(anew, float) and stored is not None and not abs(stored - anew) > rounding)
        allowed = f"{anew:.9g}" if isinstance(anew, float) else shown(anew)
        yield same, key, stored, f"{allowed}, which follows from other numbers of the result"


def _derived(result: Result) -> Iterator[Derived]:
    """Yield each number that follows from others."""
    yield "provenance.scene_sha256", result.provenance["scene_sha256"], digest(result.scene), 0.0
    period, loading = float(result.scene["profile"]["period"]), result.scene["loading"]
    placed: list[tuple[str, float, float]] = []  # key, penetration and separation, whose sum is the highest crest
    for k, state in enumerate(result.states):
        key, share = f"states[{k}]", float(state.status == "complete_contact")
        yield f"{key}.n_patches", state.n_patches, len(state.edges), 0.0
        yield f"{key}.certificate.ok", state.certificate.ok, state.status in FINAL_STATUSES, 0.0
        if not state.found:
            continue
        placed.append((key, state.penetration, state.separation))
        share = sum(b - a for a, b in state.edges) / period if state.edges else share
        yield f"{key}.contact_fraction", state.contact_fraction, share, SUM_ROUNDING
        size = abs(state.elastic_energy) + abs(state.adhesion_energy)
        total = state.elastic_energy + state.adhesion_energy
        yield f"{key}.total_energy", state.total_energy, total, SUM_ROUNDING * size
        if state.index is not None:
            quantity, asked = asked_for(loading, state.index)
            size = abs(asked)  # of a distance with the crest, penetration + separation: 1e-300 m is 0
            size += 0 if quantity == "mean_pressure" else abs(state.penetration) + abs(state.separation)
            error = getattr(state.error_estimate, quantity) or 0.0
            yield f"{key}.{quantity}", getattr(state, quantity), float(asked), error + SUM_ROUNDING * size
        if state.gaps is not None:
            yield from _derived_gaps(f"{key}.gaps", state.gaps, state, period)
    tension = result.largest_tension
    placed += [] if tension is None else [("largest_tension", tension.penetration, tension.separation)]
    for key, penetration, separation in placed[1:]:
        crest = placed[0][1] + placed[0][2]
        size = abs(crest) + abs(separation) + abs(placed[0][2])
        yield f"{key}.penetration", penetration, crest - separation, SUM_ROUNDING * size


def _derived_gaps(key: str, gaps: GapNumbers, state: State, period: float) -> Iterator[Derived]:
    """Yield the numbers of gaps that follow from contact fraction, edges and separation."""
    share, starts = 1 - state.contact_fraction, [a for a, _ in state.edges]
    following = [*starts[1:], *(start + period for start in starts[:1])]
    widest = max((a - b for (_, b), a in zip(state.edges, following, strict=True)), default=period * share)
    yield f"{key}.open_fraction", gaps.open_fraction, share, SUM_ROUNDING
    yield f"{key}.widest_channel", gaps.widest_channel, widest, SUM_ROUNDING * period
    if share > SUM_ROUNDING:
        mean = state.separation / share
        yield f"{key}.mean_open", gaps.mean_open, mean, SUM_ROUNDING * mean / share


def _part_claims(result: Result) -> Iterator[Claim]:
    """Yield what holds for edges, certificates, gaps, peaks and events."""
    period = float(result.scene["profile"]["period"])
    depth = result.scene["accuracy"]["tolerance"] * result.groups["rms_height"]
    ends = [(f"states[{k}]", state.edges) for k, state in enumerate(result.states)]
    for k, event in enumerate(result.events):
        jump = (("before", event.before), ("after", event.after))
        ends += [(f"events[{k}].{name}", end.edges) for name, end in jump if end is not None]
        known, bound = not math.isnan(event.mean_pressure), event.error_estimate.mean_pressure
        allowed = "null where the tension has no bound and mean_pressure is null, else a number"
        yield known == (bound is not None), f"events[{k}].error_estimate.mean_pressure", bound, allowed
    for key, edges in ends:
        row = [end for edge in edges for end in edge]
        placed = row == sorted(row) and (not row or (0 <= row[0] <= period and row[-1] <= row[0] + period))
        yield placed, f"{key}.edges", edges, f"ascending positions within one period of {period:g} m"
    for k, state in enumerate(result.states):
        key, figures = f"states[{k}]", state.certificate
        allowed = "a text where ok is false, else none"
        yield bool(figures.reasons) != figures.ok, f"{key}.certificate.reasons", figures.reasons, allowed
        least = {"min_gap": -depth} | dict.fromkeys((*FIGURES[:1], *FIGURES[2:], "min_eigenvalue"), 0.0)
        for name, bound in least.items() if figures.ok else ():
            value = getattr(figures, name)
            holds = value >= bound if value is not None else name not in FIGURES or not state.edges
            yield holds, f"{key}.certificate.{name}", value, f"at least {bound:.3g} where ok is true"
        asymmetry, most = figures.hessian_asymmetry or 0.0, Demands().hessian_asymmetry
        holds = 0 <= asymmetry <= most or not figures.ok
        yield holds, f"{key}.certificate.hessian_asymmetry", asymmetry, f"0 to {most:.3g} where ok is true"
        if state.gaps is None or not state.found:
            continue
        heights, top = [*vars(state.gaps.quantiles).values()], max(state.largest_gap or 0.0, state.gaps.mean_open)
        rising = heights == sorted(heights) and heights[0] >= 0 and heights[-1] <= top * (1 + SUM_ROUNDING)
        yield rising, f"{key}.gaps.quantiles", heights, f"rising heights from 0 to {top:.9g}, the largest gap"
        mean = state.mean_pressure / state.contact_fraction if state.contact_fraction > 0 else math.nan
        low = state.peak_pressure is not None and state.peak_pressure < mean - SUM_ROUNDING * abs(mean)
        yield not low, f"{key}.peak_pressure", state.peak_pressure, f"at least {mean:.9g}, the mean in contact"


def _array_claims(result: Result) -> Iterator[Claim]:
    """Yield what holds for arrays: their names and types, and the shapes of states."""
    period = float(result.scene["profile"]["period"])
    depth = result.scene["accuracy"]["tolerance"] * result.groups["rms_height"]
    states = {str(state.stored): state for state in result.states if state.stored is not None}
    for name, fault, allowed in array_mistakes(result.fields, states.keys()):
        yield Mistake(f"fields.{name}", f"is {fault}", allowed)
    for k, state in states.items():
        if f"x_{k}" not in result.fields:
            continue
        x, gap, patch, pressure = (result.fields[f"{name}_{k}"] for name in ("x", "gap", "patch", "pressure"))
        height = max(depth, SUM_ROUNDING * float(gap.max()))
        rising, most = (x[1:] >= x[:-1]).all() and x[-1] - x[0] <= period * (1 + SUM_ROUNDING), max(state.n_patches, 1)
        yield rising, f"fields.x_{k}", x[:3].tolist(), f"rising within {period:g} m"
        yield gap.min() >= -height, f"fields.gap_{k}", gap[:3].tolist(), f"at least {-height:.3g} m"
        yield patch.min() >= -1 and patch.max() < most, f"fields.patch_{k}", patch[:3].tolist(), f"-1 to {most - 1}"
        finite = not (abs(pressure) == math.inf).any()
        yield finite, f"fields.pressure_{k}", pressure[:3].tolist(), "finite, or NaN where it does not exist"


def _whole_claims(result: Result) -> Iterator[Claim]:
    """Yield what holds for the status, the failure and the largest tension."""
    status, failure, tension = result.status, result.failure, result.largest_tension
    met = all(state.found and state.certificate.ok for state in result.targets)
    yield met or status != "converged", "status", status, "another one, as a target is not met"
    yield not met or status != "unreachable", "status", status, "another one, as every target is met"
    told = bool(failure) if status in MISSED else failure is None
    yield told, "failure", failure, f"a text where the status is {' or '.join(MISSED)}, else null"
    if tension is not None:
        yield tension.mean_pressure < 0, "largest_tension.mean_pressure", tension.mean_pressure, "< 0"
