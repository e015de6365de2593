"""Commands for a scene: `check SCENE`, `run SCENE --out DIR`, `keys [SECTION]` and `schema`.

The command `linecontact` mounts them beside its own, `python -m bem` has them alone.  `run` ends with 0 also where all
targets that were not met lie behind a pull-off (status `unreachable`).  Progress goes to stderr, results into files,
one summary line to stdout.  matplotlib is imported only for --plot, and the code that makes schemas only for `keys`
and `schema`.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterable, Sequence
from importlib import import_module
from pathlib import Path

from bem.command_line.answer_table import table_text
from bem.command_line.checkpoint import Checkpoint, holds_result, remove_answers, stored_result, uninterrupted, usable
from bem.command_line.console import (
    effects_text,
    groups_text,
    positive,
    reporter,
    scene_text,
    size_text,
    summary,
    summary_line,
)
from bem.command_line.folder_lock import locked
from bem.command_line.perform import BAD_INPUT, DONE, FAILED, INTERRUPTED, perform
from bem.command_line.preparation_words import preparation_sentences
from bem.geometry.ranges import Mistake
from bem.map_rows import asks_for_rows, rows_of
from bem.path_for import check_path
from bem.scene.effects import effects_of
from bem.scene.memory_estimate import memory_estimate, refuse_beyond_memory
from bem.scene.plausibility import cautions_of, groups_of
from bem.scene.provenance import installed_version
from bem.scene.result import Caution, Result
from bem.scene.scene import Scene, SceneError, StoredStart, parse_scene
from bem.scene.scene_file import read_tables
from bem.scene.scene_tables import TABLES
from bem.scene.state import FINAL_STATUSES
from bem.solver import solve


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command, by default the one of `sys.argv`, and return its exit code."""
    parser = argparse.ArgumentParser(prog="linecontact", description="Adhesive line contact of a rough profile.")
    parser.add_argument("--version", action="version", version=f"linecontact {installed_version()}")
    add_commands(parser.add_subparsers(required=True, metavar="check|run|keys|schema"))
    return perform(parser.parse_args(arguments))


def add_commands(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the commands for a scene to the parsers of a program, which calls `options.perform(options)`."""
    check = commands.add_parser("check", help="print the resolved scene, its effects and the memory that it needs")
    check.add_argument("scene", type=_scene_file, help="scene file (TOML)")
    check.add_argument("--json", action="store_true", help="print as JSON")
    check.set_defaults(command=_check, perform=perform)

    run = commands.add_parser("run", help="solve a scene; writes result.json and fields.npz")
    run.add_argument("scene", type=_scene_file, help="scene file (TOML)")
    run.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the result")
    present = run.add_mutually_exclusive_group()
    present.add_argument("--resume", action="store_true", help="continue from the states DIR holds")
    present.add_argument("--overwrite", action="store_true", help="replace the result DIR holds")
    run.add_argument("--plot", action="store_true", help="also draw curves and stored shapes as PNG")
    run.add_argument("--quiet", action="store_true", help="no progress")
    cores = os.cpu_count() or 1
    many = f"processes for large contacts with adhesion, at a tolerance of 1e-4 or more (default: {cores})"
    run.add_argument("--jobs", type=positive, default=cores, metavar="N", help=many)
    output = run.add_mutually_exclusive_group()
    output.add_argument("--json", action="store_true", help="print the summary as JSON")
    output.add_argument(
        "--table", action="store_true", help="print the answer too: a column of numbers for each target"
    )
    run.set_defaults(command=_run, perform=perform)

    keys = commands.add_parser("keys", help="print what every key of a scene is, or those of one section")
    keys.add_argument("section", nargs="?", metavar="SECTION", help=", ".join(TABLES))
    keys.set_defaults(command=_keys, perform=perform)
    schema = commands.add_parser("schema", help="print the JSON Schema of a scene, by which editors complete its keys")
    schema.set_defaults(command=_schema, perform=perform)


def _scene_file(word: str) -> Path:
    """Return the path of a scene; a file that is no TOML by its name and content is refused before missing options."""
    path = Path(word)
    if path.suffix.lower() != ".toml" and path.is_file():
        try:
            read_tables(path)
        except SceneError as error:
            raise argparse.ArgumentTypeError(str(error.mistakes[0])) from error
    return path


def _check(options: argparse.Namespace) -> int:
    """Print the resolved scene, its groups, effects and memory."""
    tables = read_tables(options.scene)
    rows = None
    if asks_for_rows(tables):
        rows, scene = rows_of(tables, options.scene.parent)
    else:
        scene = parse_scene(tables, options.scene.parent)
    refuse_beyond_memory(scene)
    check_path(scene)
    effects, groups = effects_of(scene), groups_of(scene)
    cautions = cautions_of(scene, groups)
    if options.json:
        listed = [vars(effect) for effect in effects]
        size = memory_estimate(scene)
        facts = {"scene": scene.resolved(), "effects": listed, "unknowns": size.unknowns, "memory": size.bytes}
        facts |= {"groups": groups}
        facts |= {"warnings": [vars(caution) for caution in cautions], "profile_preparation": scene.preparation()}
        facts |= {} if rows is None else {"rows": list(rows)}
        print(json.dumps(facts))
    else:
        parts = (scene_text(scene.resolved()), _prepared(scene), groups_text(groups, cautions))
        needs = effects_text(effects) + "\n" + size_text(memory_estimate(scene))
        print("\n\n".join(part for part in (*parts, needs) if part))
        if rows is not None:
            each = f"{len(rows)} rows of the map, {rows[0]} to {rows[-1]}, each solved as a ridge"
            print(f"{each}; above: row {scene.profile.row}")
    return DONE


def _prepared(scene: Scene) -> str:
    """Return the preparation of the scan of a scene, a line for each step."""
    return "\n".join(f"# profile: {sentence}" for sentence in preparation_sentences(scene.preparation()))


def _keys(options: argparse.Namespace) -> int:
    """Print the reference of keys."""
    keys = import_module("bem.command_line.keys")
    try:
        print(keys.keys_text(options.section))
    except keys.UnknownSectionError as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD_INPUT
    return DONE


def _schema(options: argparse.Namespace) -> int:
    """Print the JSON Schema of a scene."""
    schema = import_module("bem.command_line.keys").json_schema()
    print(json.dumps(schema, indent=1, ensure_ascii=False))
    return DONE


def _run(options: argparse.Namespace) -> int:
    """Solve a scene into a folder."""
    tables = read_tables(options.scene)
    if asks_for_rows(tables):
        return int(import_module("bem.row_commands").run_rows(tables, options))
    scene = parse_scene(tables, options.scene.parent)
    _keep_start(scene, options)
    refuse_beyond_memory(scene)
    usable(options.out)
    with locked(options.out) as new:
        return run_alone(scene, options, new)


def run_alone(scene: Scene, options: argparse.Namespace, new: bool) -> int:
    """Solve a scene into a locked folder; `new` says whether the folder was made for this run."""
    cautions = cautions_of(scene, groups_of(scene))
    _warn(cautions)
    stored = None if new else stored_result(scene, options.out, options.resume, options.overwrite)
    if options.overwrite and holds_result(options.out):
        remove_answers(options.out)
    result = stored if stored is not None and stored.status in FINAL_STATUSES else _solved(scene, stored, options)
    _warn(caution for caution in result.warnings if caution not in cautions)
    if options.plot:
        _draw(result, options.out)
    facts = summary(result, str(options.out), len(scene.loading.targets))
    if options.table:
        print(table_text(result))
    print(json.dumps(facts) if options.json else summary_line(facts))
    if result.answered:
        return DONE
    return INTERRUPTED if result.status == "interrupted" else FAILED


def _warn(cautions: Iterable[Caution]) -> None:
    """Print warnings on stderr."""
    for caution in cautions:
        print(f"warning: {caution.about}: {caution.message}", file=sys.stderr)


def _keep_start(scene: Scene, options: argparse.Namespace) -> None:
    """Raise SceneError if --overwrite would replace the result that the path starts from."""
    initial = scene.loading.initial
    if not isinstance(initial, StoredStart) or not options.overwrite:
        return
    if (options.scene.parent / initial.result).resolve() == options.out.resolve():
        raise SceneError([Mistake("loading.initial.result", "is the folder --out would overwrite", "another folder")])


def _solved(scene: Scene, stored: Result | None, options: argparse.Namespace) -> Result:
    """Solve a scene, write every state as it converges, and write the result."""
    checkpoint = Checkpoint(options.out)
    report = reporter(sys.stderr, options.quiet, scene.loading.targets)
    try:
        result = solve(scene, progress=report, on_state=checkpoint.keep, resume=stored, jobs=options.jobs)
        with uninterrupted():
            checkpoint.finish(result)
    finally:
        report.close()
    return result


def _draw(result: Result, folder: Path) -> None:
    """Draw the mean pressure against contact fraction and separation, and the stored shapes, as PNG."""
    plots = import_module("bem.scene.plots")
    for quantity in plots.CURVES:
        plots.curves(result.states, [quantity]).savefig(folder / f"{quantity}.png", dpi=150)
    for name in (key.removeprefix("x_") for key in result.fields if key.startswith("x_")):
        plots.shape(result.fields, name).savefig(folder / f"shape_{name}.png", dpi=150)
