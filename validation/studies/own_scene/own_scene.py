"""What accuracy costs for one's own scene, and what its question leaves open: `study scene SCENE --out DIR`.

The scene is solved as it is, then with the finest numerical settings, then with all others (settings.py), each in a
process of its own and kept as soon as it is there (harness/store.py): the same command continues.  Every setting is
expected to take the seconds of the scene as it is.  What would go beyond the budget is left out, a run that takes far
longer than expected is stopped, a setting that the scene refuses is a row with the reason.

DIR gets study.json (findings.py) and study.html (validation/report/study_page.py), rendered from the former alone.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bem.scene.result_file import digest
from bem.scene.scene import SceneError, load_scene, parse_scene, read_tables
from validation.harness.execution import Listener, Note
from validation.harness.executors import local_processes
from validation.harness.provenance import provenance
from validation.harness.store import Store, store_in, write_json
from validation.report.pages import ReportError
from validation.report.study_page import FILE, PAGE, write_study_page
from validation.studies.own_scene import BUDGET, SEEDS
from validation.studies.own_scene.findings import findings_of
from validation.studies.own_scene.settings import Setting, settings_of
from validation.studies.own_scene.solved_setting import Solved, ToSolve, solved
from validation.studies.own_scene.words import content_of, sentence, table_text

SCHEMA = "linecontact-scene-study/1"
PARTS = "parts"  # of a scan
SLACK, LEAST_LIMIT = 30.0, 60.0  # times the seconds expected, and s: when a run is stopped


@dataclass(frozen=True)
class Options:
    """How a study is run."""

    seeds: int = SEEDS  # realisations besides the scene's own
    budget: float = BUDGET  # CPU seconds
    jobs: int = 1  # processes at a time
    quick: bool = False  # fewer settings
    overwrite: bool = False  # whether the study of another scene may be replaced


def run(path: Path, folder: Path, options: Options, report: Listener) -> int:
    """Run the study of a scene file into a folder; 1 where the scene does not converge as it is.

    SceneError where the scene is refused, ReportError where the folder holds the study of another scene.
    """
    scene = load_scene(path)
    resolved = scene.resolved()
    if not _is_there(folder, digest(resolved), options.overwrite):
        (folder / PAGE).unlink(missing_ok=True)
        _write(folder, {"scene": resolved, "status": "interrupted"})
    facts = provenance()
    tables = read_tables(path)
    settings = settings_of(scene, tables, (path.parent, folder / PARTS), options.seeds, options.quick)
    answered = _answered(settings, Desk(path.parent, options, store_in(folder, report), report))
    head = {"scene": resolved, "command": f"linecontact study scene {path.name} --out {folder.name}{_words(options)}"}
    base = answered[0][1]
    if not base.good:
        why = f"the scene does not converge as it is: {base.status.replace('_', ' ')} {base.failure}".strip()
        _write(folder, head | {"status": "failed", "sentence": why})
        report(Note(f"FAILED: {why}"))
        return 1
    found = findings_of(answered)
    _write(folder, head | {"status": "done", "provenance": facts} | content_of(found, answered))
    write_study_page(folder)
    print(table_text(found))
    print(sentence(found))
    print(folder / PAGE)
    return 0


def _words(options: Options) -> str:
    """Options that are not the default, as on the command line; the answers do not depend on --overwrite."""
    numbers = {"seeds": options.seeds, "budget": options.budget, "jobs": options.jobs}
    given = [f" --{name} {value:.15g}" for name, value in numbers.items() if value != getattr(Options, name)]
    return (" --quick" if options.quick else "") + "".join(given)


def _is_there(folder: Path, sha256: str, overwrite: bool) -> bool:
    """Whether the folder holds the study of this scene; that of another one is refused, or to be overwritten."""
    path = folder / FILE
    if not path.exists():
        return False
    try:
        content = json.loads(path.read_text("utf-8"))
        known, same = content["schema"] == SCHEMA, content["scene_sha256"] == sha256
        title = content["scene"]["title"] or "untitled"
    except (ValueError, KeyError, TypeError, RecursionError):
        known, same, title = False, False, ""
    if known and same:
        return True
    if not overwrite:
        what = f"the study of another scene ({title!r})" if known else "not the study of a scene"
        raise ReportError(f"{path}: {what}; another folder, or --overwrite")
    return False


def _write(folder: Path, content: Mapping[str, Any]) -> None:
    head = {"schema": SCHEMA, "scene_sha256": digest(content["scene"])}
    write_json(folder / FILE, head | dict(content))


@dataclass(frozen=True)
class Desk:
    """What all settings of a study share: the folder of its scene, its options, its answers, and who is told."""

    base: Path
    options: Options
    answers: Store
    report: Listener


def _answered(settings: Sequence[Setting], desk: Desk) -> list[tuple[Setting, Solved]]:
    """Return all settings with their answers."""
    refused = {setting: why for setting in settings if (why := _refusal(setting, desk.base)) is not None}
    known = [setting for setting in settings if setting not in refused]
    found = dict(refused)
    first, budget = settings[0], desk.options.budget
    desk.report(Note(f"{len(known)} settings; at most {budget:g} s of one core"))
    found |= _solve_all({first: 0.0}, math.inf, desk)
    if not found[first].good:
        return [(setting, found.get(setting, Solved("not run", ""))) for setting in settings]
    took = found[first].seconds
    expected = {setting: took for setting in known if setting != first}
    desk.report(Note(f"as it is: {took:.3g} s; by that {sum(expected.values()):.3g} s for the others"))
    chosen, spent = dict[Setting, float](), took
    for setting, cost in expected.items():
        if spent + cost > budget:
            found[setting] = Solved("left out", f"{cost:.3g} s expected, beyond the budget of {budget:g} s")
            desk.report(Note(f"{setting.title}: left out, {found[setting].failure}"))
        else:
            spent += cost
            chosen[setting] = cost
    found |= _solve_all(chosen, LEAST_LIMIT, desk)
    return [(setting, found[setting]) for setting in settings]


def _refusal(setting: Setting, base: Path) -> Solved | None:
    """Return why a setting cannot be solved, if it cannot."""
    if setting.why_not:
        return Solved("does not apply", setting.why_not)
    try:
        parse_scene(setting.tables, base)
    except SceneError as error:
        return Solved("refused", str(error))
    return None


def _solve_all(expected: Mapping[Setting, float], least_limit: float, desk: Desk) -> dict[Setting, Solved]:
    """Solve settings that have no answer yet; each may take SLACK times its seconds, or `least_limit`."""
    settings = {setting.title: setting for setting in expected}
    tasks = [
        ToSolve(name, one.tables, str(desk.base), max(SLACK * expected[one], least_limit), one.kind == "base")
        for name, one in settings.items()
    ]
    found: dict[Setting, Solved] = {}
    took = seen = 0.0
    for task, answer, _ in desk.answers.answers(
        Solved, solved, tasks, lambda task: (task.name, task.tables), desk.options.jobs, local_processes,
        keeps=lambda answer: answer.status != "stopped",
    ):  # fmt: skip
        if isinstance(answer, Exception):
            answer = Solved("error", f"{type(answer).__name__}: {answer}")
        setting = settings[task.name]
        found[setting] = answer
        took, seen = took + answer.seconds, seen + expected[setting]
        left = sum(expected[one] for one in settings.values() if one not in found)
        ahead = f"; {left * took / seen:.3g} s to go by the pace so far" if left and seen else ""
        said = f"[{len(found)}/{len(tasks)}] {task.name}: {answer.status}"
        desk.report(Note(f"{said}, {answer.seconds:.3g} s{ahead}"))
    return found
