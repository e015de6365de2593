"""Command line: run the cases, render a report again, study a scene, replicate the paper, judge solvers.

Exit codes: 0 done and nothing failed, 1 something failed (named), 2 bad input, 130 interrupted.
Progress and what failed go to stderr, one summary line to stdout.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from bem.command_line.console import positive
from bem.command_line.folder_lock import FolderError, locked
from bem.command_line.perform import DONE, FAILED
from bem.command_line.perform import perform as perform_command
from bem.geometry.regular_file import read_regular
from bem.map_rows import ROW_FOLDERS
from bem.scene.atomic_file import write_atomically
from bem.scene.provenance import installed_version
from bem.scene.result_file import RESULT_FILE
from bem.scene.scene import SceneError
from bem.scene.stored_json import CorruptResultError
from validation.challenge import judge as challenge
from validation.plugin import verify
from validation.plugin.content import SCHEMA
from validation.report.pages import PAGE, ReportError, counted
from validation.report.rows_page import write_rows_page
from validation.report.run_page import write_run_page
from validation.report.run_words import outcome, succeeded
from validation.report.verification_page import REPORT, page_of_file
from validation.studies.own_scene import BUDGET

REFUSED = (ReportError, CorruptResultError, SceneError, FolderError)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, by default the command in `sys.argv`, and return its exit code.

    0 done, 1 something failed, 2 bad input, 130 interrupted.
    """
    parser = argparse.ArgumentParser(prog="linecontact", description=__doc__)
    parser.add_argument("--version", action="version", version=f"linecontact {installed_version()}")
    add_commands(parser.add_subparsers(required=True, metavar="COMMAND"))
    return perform(parser.parse_args(without_kind(sys.argv[1:] if arguments is None else arguments)))


def without_kind(words: Sequence[str]) -> list[str]:
    """Return the words of a command line without the kind of a study, which may be left out: study scene SCENE."""
    return [words[0], *words[2:]] if list(words[:2]) == ["study", "scene"] and len(words) > 2 else list(words)


def perform(options: argparse.Namespace) -> int:
    """Run the command that was parsed, and return its exit code."""
    return perform_command(options, REFUSED)


def read_report(folder: Path) -> dict[str, Any]:
    """Return the content of a verification report; ReportError where it is missing, not JSON, or of another schema."""
    path = folder / REPORT
    try:
        content = json.loads(read_regular(path).decode())
    except FileNotFoundError as error:
        if not folder.is_dir():
            raise ReportError(f"{folder}: is no folder; a folder of a run or of a verification is needed") from error
        raise ReportError(f"{path}: no report there, and no result of a run") from error
    except OSError as error:
        raise ReportError(f"{path}: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise ReportError(f"{path}: not JSON ({error})") from error
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        schema = content.get("schema") if isinstance(content, dict) else type(content).__name__
        raise ReportError(f"{path}: schema {schema!r} is not {SCHEMA!r}; run the cases again")
    missing = {"headline", "rows", "cases", "counts", "failed", "provenance", "quantities"} - content.keys()
    if missing:
        raise ReportError(f"{path}: without {', '.join(sorted(missing))}")
    return content


def say(text: str) -> None:
    """Print progress on stderr."""
    print(text, file=sys.stderr, flush=True)


def _verify(options: argparse.Namespace) -> int:
    with locked(options.out):
        return verify.run(options)


def _report(options: argparse.Namespace) -> int:
    """Render the page of a run or of a verification again."""
    folder: Path = options.folder if options.folder.name else options.folder.absolute()  # "." has no name
    if not (folder / REPORT).exists() and (folder / RESULT_FILE).exists():
        result = write_run_page(folder)
        words, code = outcome(result), DONE if succeeded(result) else FAILED
        if code == FAILED:
            print(f"FAILED: {words}", file=sys.stderr)
    elif not (folder / REPORT).exists() and any(folder.glob(ROW_FOLDERS)):
        rows = write_rows_page(folder)
        words, code = f"{counted(len(rows.results), 'row')} answered;", FAILED if rows.failures else DONE
    else:
        content = read_report(folder)
        write_atomically(folder / PAGE, page_of_file(content))
        words, code = f"{content['headline']};", FAILED if content["failed"] else DONE
    print(f"{words} report: {folder / PAGE}")
    return code


def _replicate(options: argparse.Namespace) -> int:
    """Replicate the paper's results section; its realisations and figures lie beside the report."""
    replicate = import_module("validation.paper.replicate").replicate
    with locked(options.out):
        return int(replicate(options.out, quick=options.quick, jobs=options.jobs, say=say))


def _study(options: argparse.Namespace) -> int:
    """Study a scene."""
    module = import_module("validation.studies.own_scene")
    given = {name: getattr(options, name) for name in ("quick", "jobs", "overwrite", "budget")}
    with locked(options.out):
        code = int(module.run(options.scene, options.out, say, **given))
        if code == DONE and (options.out / RESULT_FILE).exists():
            write_run_page(options.out)  # with the uncertainty of the input
            print(options.out / PAGE)
    return code


def add_commands(commands: argparse._SubParsersAction[argparse.ArgumentParser], run_name: str = "run") -> None:
    """Add the commands to a program, which passes its parsed options to `options.perform`.

    `run_name` is the name of the command that runs the cases.
    """
    cores = os.cpu_count() or 1

    run = commands.add_parser(run_name, help="run the cases of a level and write the report")
    verify.add_options(run)
    run.set_defaults(command=_verify, perform=perform)

    report = commands.add_parser("report", help="render the page of a run, or of a verification, again")
    report.add_argument("folder", type=Path)
    report.set_defaults(command=_report, perform=perform)

    paper = commands.add_parser("replicate", help="the results of the paper from an ensemble, as a report")
    paper.add_argument("--out", type=Path, required=True, help="folder of the report; realisations there stay")
    paper.add_argument("--jobs", type=positive, default=cores, help=f"worker processes (default: {cores})")
    paper.add_argument("--quick", action="store_true", help="few realisations with few harmonics: shows that it runs")
    paper.set_defaults(command=_replicate, perform=perform)

    challenge.add_commands(commands, perform)

    study = commands.add_parser(
        "study",
        usage="linecontact study [scene] SCENE --out DIR [--quick] [--budget S] [--jobs N] [--overwrite]",
        help="study SCENE: how far each choice of a scene moves each answer",
        description="Solve a scene again with other cuts, detrending, windows, rows, noise, seeds and tolerances, and "
        "write study.html: how far each choice moves each answer, the +- of the input that follows, and the CPU "
        "seconds of fewer and more digits.  In the folder of a run, the page of the run takes the +- over.  It takes "
        "some ten times as long as the scene.",
    )
    study.add_argument("scene", type=Path, metavar="SCENE", help="scene file (TOML)")
    study.add_argument(
        "--budget", type=positive, default=BUDGET, metavar="S", help="CPU seconds (default: %(default)s)"
    )
    study.add_argument("--overwrite", action="store_true", help="replace the study of another scene")
    study.add_argument("--quick", action="store_true", help="fewer settings: a first +- in a third of the time")
    study.add_argument("--jobs", type=positive, default=1, help="worker processes (default: 1)")
    study.add_argument("--out", type=Path, required=True, help="folder of the study, perhaps that of the run")
    study.set_defaults(command=_study, perform=perform)


if __name__ == "__main__":
    sys.exit(main())
