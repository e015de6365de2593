"""`linecontact study scene SCENE --out DIR`: how far each answer moves when a choice is varied, and what digits cost.

The scene is solved as it is and in the settings of scene_settings.py.  Answers are, at every target, contact fraction,
mean pressure, separation, mean open gap and peak pressure, but not the quantity that is held there, and the pull-off of
the path.  A move is the change over the answer
itself, or over a tenth of the largest answer of its kind where that is more.  Of a source it is the largest move of its
settings, for seeds the standard deviation of the realisations; the numerical one is the larger of the estimated error
and the move at the tightest tolerance.  +- of an answer is the root of the sum of the squares of its moves.

DIR gets study.json and study.html made from it.  Settings that are solved are kept in study.json: the same command
continues.  A setting that would go beyond the budget is left out, a setting that takes far longer than the scene as it
is is stopped; both are listed.
"""

import json
import math
import shlex
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError

import bem
from bem.command_line.answer_table import axis_unit, pull_off, readable
from bem.command_line.answer_table import quantity as given_in_full
from bem.geometry.regular_file import read_regular
from bem.loading.crew import at_work
from bem.scene.atomic_file import write_atomically
from bem.scene.digest import digest
from bem.scene.progress import Progress
from bem.scene.result import Result, asked_for
from bem.scene.scene import Scene, SceneError, load_scene, parse_scene
from bem.scene.scene_file import read_tables
from bem.scene.state import FINAL_STATUSES, LARGEST
from bem.scene.stored_json import CorruptResultError, verified
from validation.harness.provenance import provenance
from validation.plugin.content import finite
from validation.report.pages import ReportError, filled
from validation.studies.scene_settings import BASE, SAME_CUT, SEED, SOURCES, TOLERANCE, Setting, settings_of

SCHEMA = "linecontact-scene-study/3"
FILE, PAGE, PARTS = "study.json", "study.html", "parts"
SEEDS, FEW_SEEDS = 8, 2  # realisations besides the scene's own, and with --quick
BUDGET = 3600  # CPU s
LEAST_SHARE = 0.1  # of the largest answer of its kind on the path
SLACK, LEAST_LIMIT = 30.0, 60.0  # times the seconds of the scene as it is, and s: a setting is stopped beyond both
UNITS = {
    "contact fraction": "",
    "mean pressure": "Pa",
    "separation": "m",
    "mean open gap": "m",
    "largest open gap": "m",
    "gap for flow": "m",
    "widest open channel": "m",
    "peak pressure": "Pa",
    "pull-off": "Pa",
}


STRICT = ConfigDict(strict=True, extra="forbid")
Number = Annotated[float, Field(gt=-LARGEST, lt=LARGEST)]


@dataclass(frozen=True)
class Answer:
    """Number of a solved scene; the pull-off has no target."""

    __pydantic_config__ = STRICT

    target: int | None
    branch: str
    quantity: Annotated[str, Field(pattern=f"^({'|'.join(UNITS)})$")]
    value: Number
    error: Number | None


@dataclass(frozen=True)
class Solved:
    """Outcome of one setting; `sha256` identifies its resolved scene."""

    __pydantic_config__ = STRICT

    sha256: str
    status: str
    reason: str = ""
    cpu_seconds: Number = 0.0
    answers: list[Answer] = field(default_factory=list)

    @property
    def good(self) -> bool:
        """True if the path ended as asked, or behind a pull-off."""
        return self.status in FINAL_STATUSES


@dataclass(frozen=True)
class Stored:
    """Part of study.json that a later run reads."""

    __pydantic_config__ = ConfigDict(strict=True, extra="ignore")

    schema: str
    scene_sha256: str
    title: str
    solved: dict[str, Solved]


def run(
    path: Path,
    folder: Path,
    say: Callable[[str], None],
    *,
    quick: bool = False,
    jobs: int = 1,
    overwrite: bool = False,
    budget: float = BUDGET,
) -> int:
    """Run the study of a scene file into a folder; return 1 if the unchanged scene does not converge.

    SceneError where the scene is refused, ReportError where the folder holds something else.
    """
    scene = load_scene(path)
    resolved = scene.resolved()
    sha256, title = digest(resolved), scene.title or "untitled"
    solved = read_solved(folder, sha256, overwrite)
    settings = settings_of(scene, read_tables(path), path.parent, folder / PARTS, FEW_SEEDS if quick else SEEDS)
    given = [*["--quick"] * quick, *["--budget", f"{budget:g}"] * (budget != BUDGET)]
    words = ["linecontact", "study", "scene", str(path), *given, "--out", str(folder)]
    head = {
        "schema": SCHEMA,
        "scene_sha256": sha256,
        "title": title,
        "scene": resolved,
        "provenance": provenance(),
        "command": shlex.join(words),
    }

    def store(**more: Any) -> None:
        stored = {name: asdict(outcome) for name, outcome in solved.items()}
        content = finite(head | {"solved": stored} | more)
        text = json.dumps(content | {"checksum": digest(content)}, indent=1, allow_nan=False) + "\n"
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(folder / FILE, text)
        if more:
            write_atomically(folder / PAGE, study_page(json.loads(text)))

    for name, answer in solve_settings(settings, solved, path.parent, jobs, budget):
        solved[name] = answer
        say(f"{name}: {answer.status} {answer.reason}".rstrip() + f", {answer.cpu_seconds:.3g} s")
        store()
    base = solved[BASE]
    if base.status not in FINAL_STATUSES:
        print(f"the scene does not converge as it is: {base.status.replace('_', ' ')} {base.reason}".strip())
        if not base.answers:
            return 1
    rows, tolerances = moves_of(settings, solved)
    for row in rows:
        row["at"] = None if row["target"] is None else f"{_place(resolved['loading'], row['target'])}, {row['branch']}"
    untold = [*without_answer(rows, settings, solved), *left_out(scene, path.parent, settings, solved)]
    listed = [_listed(setting, solved.get(setting.title)) for setting in settings]
    store(answers=rows, tolerances=tolerances, settings=listed, left_out=untold, most_open=most_open(rows))
    print("\n".join([*map(words_of, rows), *filter(None, [most_open(rows), *untold])]))
    print(folder / PAGE)
    return 0 if base.status in FINAL_STATUSES else 1


def words_of(row: Mapping[str, Any]) -> str:
    """Return an answer with its place and its +-."""
    place = "" if row["at"] is None else f" at {row['at']}"
    return f"{row['quantity']}{place}: {with_uncertainty(row['value'], row['uncertainty'], row['unit'])}"


def with_uncertainty(value: float, uncertainty: float, unit: str) -> str:
    """Return a number and its +- with the digits that this allows, at most four, and a prefix before the unit.

    Examples
    --------
    >>> with_uncertainty(58379.0, 4.9e3, "Pa"), with_uncertainty(0.0, 3.4e-7, "m"), with_uncertainty(0.87396, 1e-11, "")
    ('58.4 ± 4.9 kPa', '0 ± 340 nm', '0.8740 ± < 0.0001')
    >>> with_uncertainty(0.0, 0.0, "m")
    '0 m'
    """
    if value == uncertainty == 0:
        return f"0 {unit}".strip()
    factor, prefixed = axis_unit(max(abs(value), uncertainty), unit) if unit else (1.0, "")
    larger = max(abs(value), uncertainty) * factor
    most = max(3 - math.floor(math.log10(larger)), 0) if larger else 0
    decimals = most if uncertainty == 0 else min(most, max(1 - math.floor(math.log10(uncertainty * factor)), 0))
    least = 10.0**-decimals
    error = f"{uncertainty * factor:.{decimals}f}" if uncertainty * factor >= 0.5 * least else f"< {least:.{decimals}f}"
    return f"{f'{value * factor:.{decimals}f}' if value else 0} ± {error} {prefixed}".strip()


def most_open(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return words on the answer that the choices leave most open, and on the choice; nothing without choices."""
    moves = [(move, source, row) for row in rows for source, move in row["moved"].items() if source in SOURCES]
    if not moves:
        return ""
    move, source, row = max(moves, key=lambda entry: entry[0])
    return f"Most open: {words_of(row)}; the {source} moves it by {share(move)}."


def without_answer(
    rows: Sequence[Mapping[str, Any]], settings: Sequence[Setting], solved: Mapping[str, Solved]
) -> Iterator[str]:
    """Yield sentences on answers of the scene that a solved setting does not have, such as no pull-off."""
    for row in rows:
        key = row["target"], row["branch"], row["quantity"]
        good = (setting.title for setting in settings if setting.title in solved and solved[setting.title].good)
        absent = [title for title in good if key not in _values(solved[title])]
        if absent:
            place = "" if row["at"] is None else f" at {row['at']}"
            yield f"± of the {row['quantity']}{place} does not hold {', '.join(absent)}: none is there."


def left_out(scene: Scene, base: Path, settings: Sequence[Setting], solved: Mapping[str, Solved]) -> list[str]:
    """Return sentences on choices of which no setting was solved, and on the waves of a scan that none has."""
    answered = {setting.source for setting in settings if setting.title in solved and solved[setting.title].answers}
    kinds = dict.fromkeys(setting.source for setting in settings if setting.tables and setting.source not in answered)
    sentences = [f"± does not hold the choice of {', '.join(kinds)}: no such setting was solved."] if kinds else []
    held = "Young's modulus and Poisson's ratio"
    if scene.adhesion is not None:
        flaw = "" if scene.loading.flaw is None else " and the flaw"
        held = f"{held}, nor the work of adhesion{flaw}, by which the pull-off goes"
    sentences.append(f"± does not hold {held}: solve with others.")
    if scene.scan is None:
        return sentences
    scan, shortest = scene.scan, math.inf
    for setting in settings:
        if setting.source in (BASE, "cut") and setting.title in solved and solved[setting.title].answers:
            profile = parse_scene(setting.tables, base).profile
            wave = float(profile.period or math.inf) / int(profile.harmonics or 1)
            shortest = min(shortest, max(wave, profile.cutoff_short or 0.0))
    least = max(scan.spectrum.crossing or 0.0, scan.period / scan.max_harmonics)
    if shortest > least * (1 + SAME_CUT):
        waves = f"waves shorter than {readable(shortest, 'm', 3)}"
        sentences.append(f"± does not hold roughness of {waves}: no setting with them was solved.")
    return sentences


def _place(loading: Mapping[str, Any], target: int) -> str:
    """Return the value of a target as a person reads it."""
    control, value = asked_for(loading, target)
    return given_in_full(value, "Pa" if control == "mean_pressure" else "m")


def read_solved(folder: Path, sha256: str, overwrite: bool) -> dict[str, Solved]:
    """Read the solved settings of a folder; ReportError, with file and key, where it holds no study of this scene."""
    path = folder / FILE
    if not path.exists():
        return {}
    try:
        stored = TypeAdapter(Stored).validate_json(json.dumps(verified(read_regular(path), str(path))))
    except OSError as error:
        raise ReportError(f"{path}: {error.strerror}") from error
    except CorruptResultError as error:
        problem = str(error).removeprefix(f"{path}: ")
    except ValidationError as error:
        first = error.errors()[0]
        problem = f"{'.'.join(map(str, first['loc'])) or 'the file'}: {first['msg']}"
    else:
        if stored.schema == SCHEMA and stored.scene_sha256 == sha256:
            return stored.solved
        other = f"scene_sha256: the study of another scene ({stored.title!r})"
        problem = other if stored.schema == SCHEMA else f"schema: {stored.schema!r}, not {SCHEMA!r}"
    if overwrite:
        return {}
    raise ReportError(f"{path}: {problem}; choose another folder, or --overwrite")


def solve_settings(
    settings: Sequence[Setting], stored: Mapping[str, Solved], base: Path, jobs: int, budget: float
) -> Iterator[tuple[str, Solved]]:
    """Solve the settings that are not stored, the unchanged scene first, and yield every outcome with its title."""
    first, *others = settings
    known = _known(first, stored, base) or solve_setting((base, math.inf), first.tables)
    yield first.title, _finished(known)
    if not known.answers:
        return
    waiting = [setting for setting in in_turn(others) if setting.tables and _known(setting, stored, base) is None]
    limit = max(SLACK * known.cpu_seconds, LEAST_LIMIT)
    spent, room = known.cpu_seconds, max(min(jobs, len(waiting)), 1)
    with at_work(room, (base, limit)) as each:
        for begin in range(0, len(waiting), room):
            batch = waiting[begin : begin + room]
            if spent + known.cpu_seconds * len(batch) > budget:
                reason = f"beyond the budget of {budget:g} s"
                yield from ((setting.title, Solved("", "left out", reason)) for setting in waiting[begin:])
                return
            outcomes = each(solve_setting, [setting.tables for setting in batch])
            for setting, outcome in zip(batch, outcomes, strict=True):
                spent += outcome.cpu_seconds
                yield setting.title, _finished(outcome)


def _finished(outcome: Solved) -> Solved:
    """Return an outcome; KeyboardInterrupt if its solution was interrupted, as that ends the study."""
    if outcome.status == "interrupted":
        raise KeyboardInterrupt
    return outcome


def in_turn(settings: Sequence[Setting]) -> list[Setting]:
    """Return settings in the order in which they are solved: one of each choice in turn, tolerances at last."""
    counts: dict[str, int] = {}
    turns = []
    for setting in settings:
        counts[setting.source] = counts.get(setting.source, 0) + 1
        turns.append((setting.source == TOLERANCE, counts[setting.source]))
    return [setting for _, setting in sorted(zip(turns, settings, strict=True), key=lambda pair: pair[0])]


def _known(setting: Setting, stored: Mapping[str, Solved], base: Path) -> Solved | None:
    """Return the stored outcome of a setting whose scene is unchanged."""
    outcome = stored.get(setting.title)
    same = outcome is not None and outcome.sha256 == digest(parse_scene(setting.tables, base).resolved())
    return outcome if same else None


class _TooLongError(RuntimeError):
    """A setting took more CPU seconds than allowed."""


def solve_setting(bounds: tuple[Path, float], tables: dict[str, Any]) -> Solved:
    """Solve a scene whose file names are relative to a folder, within so many CPU seconds."""
    base, limit = bounds
    scene, begun = parse_scene(tables, base), time.process_time()
    sha256 = digest(scene.resolved())

    def watch(progress: Progress) -> None:
        if time.process_time() - begun > limit:
            raise _TooLongError

    try:
        result = bem.solve(scene, progress=watch)
    except SceneError as error:
        return Solved(sha256, "refused", str(error))
    except _TooLongError:
        return Solved(sha256, "stopped", f"took more than {limit:.0f} s", time.process_time() - begun)
    status = "converged" if result.answered and result.status not in FINAL_STATUSES else result.status
    reason = "" if result.answered else result.failure or ""
    return Solved(sha256, status, reason, time.process_time() - begun, list(answers_of(result)))


def answers_of(result: Result) -> Iterator[Answer]:
    """Yield the answers of a result: at each target that was met, all but the held quantity, then the pull-off."""
    for state in result.targets:
        if state.index is None or state.status not in FINAL_STATUSES:
            continue
        errors, held = state.error_estimate, asked_for(result.scene["loading"], state.index)[0].replace("_", " ")
        numbers = {
            "contact fraction": (state.contact_fraction, errors.contact_fraction),
            "mean pressure": (state.mean_pressure, errors.mean_pressure),
            "separation": (state.separation, errors.separation),
            "mean open gap": (state.gaps.mean_open if state.gaps else None, errors.separation),
            "largest open gap": (state.largest_gap if state.gaps else None, None),
            "gap for flow": (state.gaps.mean_cubic_root if state.gaps else None, None),
            "widest open channel": (state.gaps.widest_channel if state.gaps else None, None),
            "peak pressure": (state.peak_pressure, None),
        }
        for quantity, (value, error) in numbers.items():
            if quantity != held and value is not None and math.isfinite(value):
                yield Answer(state.index, state.branch, quantity, float(value), _number(error))
    tension = pull_off(result)
    if tension is not None:
        yield Answer(
            None, "unloading", "pull-off", -tension.mean_pressure, _number(tension.error_estimate.mean_pressure)
        )


def moves_of(
    settings: Sequence[Setting], solved: Mapping[str, Solved]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return a row for each answer, with its move by each source and its +-, and a row for each tolerance."""
    base = solved[BASE]
    largest = {
        name: max((abs(answer.value) for answer in base.answers if answer.quantity == name), default=0.0)
        for name in UNITS
    }
    outcomes = [(setting, solved[setting.title]) for setting in settings if setting.title in solved]
    changes = [(s.source, s.name, _values(outcome)) for s, outcome in outcomes if outcome.good and s.source != BASE]
    rows, scales = [], {}
    for answer in base.answers:
        key = answer.target, answer.branch, answer.quantity
        scale = scales[key] = max(abs(answer.value), LEAST_SHARE * largest[answer.quantity]) or 1.0
        moved: dict[str, float] = {}
        tight = [values[key] for source, _, values in changes if source == TOLERANCE and key in values][-1:]
        own = 0.0 if answer.error is None else answer.error
        moved["numerical"] = max([own, *(abs(value - answer.value) for value in tight)]) / scale
        for source in SOURCES:
            apart = [values[key] - answer.value for of, _, values in changes if of == source and key in values]
            if apart:
                spread = float(np.std([0.0, *apart], ddof=1)) if source == SEED else max(map(abs, apart))
                moved[source] = spread / scale
        choices = [move for source, move in moved.items() if source in SOURCES and move is not None]
        uncertain = {
            "input": math.hypot(*choices) * scale if choices else None,
            "uncertainty": math.hypot(moved["numerical"], *choices) * scale,
        }
        rows.append({**asdict(answer), "unit": UNITS[answer.quantity], "moved": moved, **uncertain})
    tightest = next((values for source, _, values in reversed(changes) if source == TOLERANCE), {})
    tolerances = []
    for setting, outcome in outcomes:
        if setting.source == TOLERANCE:
            numbers, most = _values(outcome), dict[str, float]()
            for key in tightest.keys() & numbers.keys() & scales.keys():
                most[key[2]] = max(most.get(key[2], 0.0), abs(numbers[key] - tightest[key]) / scales[key])
            tolerances.append(
                {
                    "tolerance": setting.name,
                    "status": outcome.status,
                    "cpu_seconds": outcome.cpu_seconds,
                    "moved": dict(sorted(most.items())),
                }
            )
    return rows, tolerances


def _values(solved: Solved) -> dict[tuple[int | None, str, str], float]:
    return {(answer.target, answer.branch, answer.quantity): answer.value for answer in solved.answers}


def _listed(setting: Setting, solved: Solved | None) -> dict[str, Any]:
    """Return a setting as study.json lists it."""
    outcome = solved or Solved("", "does not apply", setting.reason)
    return {
        "source": setting.source,
        "name": setting.name,
        "status": outcome.status.replace("_", " "),
        "reason": outcome.reason,
        "cpu_seconds": outcome.cpu_seconds,
        "answers": len(outcome.answers),
    }


def study_page(content: Mapping[str, Any]) -> str:
    """Return the page of the content of a study.json; its table has a column for each source that moves an answer."""
    varied = [name for name in ("numerical", *SOURCES) if any(name in row["moved"] for row in content["answers"])]
    return filled(
        "study_page.jinja", {"share": share, "with_uncertainty": with_uncertainty}, study=content, varied=varied
    )


def share(relative: float | None) -> str:
    """Return a relative number in per cent, or as it is where it is tiny.

    Examples
    --------
    >>> share(0.0832), share(2.5), share(3e-10), share(0.0), share(None)
    ('8.3 %', '250 %', '3e-10', '0', '–')
    """
    if relative is None:
        return "–"
    if relative >= 10:
        return f"{relative:.0f} times"
    if relative >= 1:
        return f"{100 * relative:.0f} %"
    return f"{100 * relative:.2g} %" if relative >= 1e-4 else f"{relative:.1g}"


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
