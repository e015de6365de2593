"""Command line: run the cases, render a report again, check and update baselines, run studies, replicate the paper.

Exit codes: 0 done and nothing gating failed, 1 something failed (named), 2 bad input, 130 interrupted.
Progress and what failed go to stderr, one summary line to stdout.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from bem.command_line.console import positive
from bem.command_line.folder_lock import FolderError, locked
from bem.command_line.perform import DONE, FAILED
from bem.command_line.perform import perform as perform_command
from bem.scene.atomic_file import write_atomically
from bem.scene.result_file import RESULT_FILE, CorruptResultError, installed_version
from bem.scene.scene import SceneError
from validation.challenge import commands as challenge
from validation.challenge.commands import say
from validation.harness import baseline
from validation.harness.case import Case, CaseError, registry, select
from validation.harness.entry_points.own_cases import own_cases
from validation.harness.executors import ExecutorError, opener_of
from validation.harness.provenance import provenance
from validation.harness.runner import run_cases
from validation.harness.schema import SCHEMA, Report, is_intact, mistakes_in, with_checksum
from validation.harness.verdict import counted, counts, fails
from validation.report.pages import PAGE, ReportError
from validation.report.pdf import write_pdf
from validation.report.render import bibliography, failures, refuse_unset, write_html
from validation.report.run_page import write_run_page
from validation.report.run_words import outcome, succeeded
from validation.studies import OF_A_SCENE, SCENE, STUDIES, that_take
from validation.studies.bench import Bench, carried_out
from validation.studies.own_scene import BUDGET, SEEDS
from validation.studies.shown import text_table

REFUSED = (
    CaseError, ExecutorError, ReportError, CorruptResultError, SceneError, FolderError, baseline.BaselineError
)  # fmt: skip
REPORT_FILE = "report.json"
OF_STUDIES = ("scene", "seeds", "budget", "overwrite", "peers", "random", "seed", "jobs", "executor")  # of some alone
ABSENT = {"overwrite": False, "peers": False, "seed": 0, "executor": "local"}  # None for the others


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, by default that of `sys.argv`; its exit code.

    0 done, 1 something failed, 2 bad input, 130 interrupted.
    """
    parser = argparse.ArgumentParser(prog="linecontact", description=__doc__)
    parser.add_argument("--version", action="version", version=f"linecontact {installed_version()}")
    add_commands(parser.add_subparsers(required=True, metavar="COMMAND"))
    return perform(parser.parse_args(arguments))


def perform(options: argparse.Namespace) -> int:
    """Run the command that was parsed; its exit code."""
    return perform_command(options, REFUSED)


def read_report(folder: Path) -> Report:
    """The report of a folder; ReportError where it is missing, not JSON, of another schema, or incomplete."""
    path = folder / REPORT_FILE
    try:
        content = json.loads(path.read_text("utf-8"))
    except FileNotFoundError as error:
        raise ReportError(f"{path}: no report there, and no result of a run") from error
    except (ValueError, RecursionError) as error:
        raise ReportError(f"{path}: not JSON ({error})") from error
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        found = content.get("schema") if isinstance(content, dict) else type(content).__name__
        raise ReportError(f"{path}: schema {found!r} is not {SCHEMA!r}")
    try:
        return Report.model_validate(content)
    except ValidationError as error:
        raise ReportError(f"{path}: {mistakes_in(error)}") from error


def _alone(command: Callable[[argparse.Namespace], int]) -> Callable[[argparse.Namespace], int]:
    """The command, holding its output folder while it runs."""

    def run(options: argparse.Namespace) -> int:
        with locked(options.out):
            return command(options)

    return run


def _run(options: argparse.Namespace) -> int:
    opener = opener_of(options.executor)
    every, kept_numbers, own = _cases_and_baselines(options)
    cases = select(every, options.level, options.only)
    bibliography(cases)  # an unknown source is reported now
    refuse_unset(cases)
    expected = baseline.expected_seconds([case.id for case in cases], kept_numbers)  # and a malformed baseline
    facts = provenance() | own  # before the run: sources that change meanwhile are not those of the report
    folder: Path = options.out
    begun = time.monotonic()
    records = run_cases(cases, folder, options.jobs, say, expected, opener, anew=bool(own))
    level = options.level if options.only is None else f"only {options.only}"
    asked = "" if options.only is None else f" --only {options.only}"
    asked += "" if options.cases is None else f" --cases {options.cases.resolve().name}"
    made = Report(
        schema_=SCHEMA,
        level=level,
        command=f"python -m validation run --level {options.level}{asked} --out {options.out.resolve().name}",
        planned=len(cases),
        provenance=facts
        | {"seconds": round(time.monotonic() - begun, 1), "jobs": options.jobs}
        | {"executor": options.executor.split(":")[0]},  # not its address
        cases=records,
        changes=baseline.changes(records, kept_numbers),
    )
    return _stored(made, folder, options)


def _cases_and_baselines(options: argparse.Namespace) -> tuple[tuple[Case, ...], Path, dict[str, str]]:
    """The cases that are meant, the folder of their baselines, and the provenance of cases outside the package."""
    every, folder, own = registry(), options.baselines, {}
    if folder is not None and not folder.is_dir():
        raise CaseError(f"--baselines {folder}: no such folder; for new baselines make it first")
    if options.cases is not None:
        found = own_cases(options.cases, [case.id for case in every])
        every, own = found.cases, {baseline.OWN_DIGEST: found.digest()}
        folder = folder or found.baselines
        if folder is None:
            raise CaseError(f"--cases {options.cases}: cases of an entry point need --baselines DIR beside it")
    return every, folder or baseline.FOLDER, own


def _replicate(options: argparse.Namespace) -> int:
    """Replicate the paper's results section; its realisations and figures lie beside the report."""
    replicate = import_module("validation.paper.replicate").replicate
    return int(replicate(options.out, quick=options.quick, jobs=options.jobs, executor=options.executor,
                         say=lambda text: print(text, file=sys.stderr)))  # fmt: skip


def _stored(made: Report, folder: Path, options: argparse.Namespace) -> int:
    """Write a report with its checksum, and its page."""
    report = with_checksum(made)
    write_atomically(folder / REPORT_FILE, report.model_dump_json(by_alias=True, indent=1) + "\n")
    return _render(report, folder, options.json, options.jobs)


def _report(options: argparse.Namespace) -> int:
    """Render a stored report again, or the page of a run; print it where that is asked for."""
    folder: Path = options.folder if options.folder.name else options.folder.absolute()  # "." says nothing
    if not (folder / REPORT_FILE).exists() and (folder / RESULT_FILE).exists():
        code = _run_page(folder, options.json)
    else:
        code = _render(read_report(folder), folder, options.json, os.cpu_count() or 1)
    if options.pdf:
        print(write_pdf(folder), file=sys.stderr if options.json else sys.stdout)
    return code


def _run_page(folder: Path, as_json: bool) -> int:
    result = write_run_page(folder)
    page, said = str(folder / PAGE), outcome(result)
    facts = {"status": result.status, "outcome": said, "report": page}
    print(json.dumps(facts) if as_json else f"{said} report: {page}")
    if succeeded(result):
        return DONE
    print(f"FAILED: {said}", file=sys.stderr)
    return FAILED


def _render(report: Report, folder: Path, as_json: bool, jobs: int) -> int:
    write_html(report, folder, jobs)
    for case, why in failures(report):
        print(f"FAILED {case}: {why}" if case else f"FAILED: {why}", file=sys.stderr)
    failed = fails(report) or not is_intact(report)
    given = {name: count for name, count in counts(report.cases).items() if count}
    seconds = report.provenance.get("seconds")
    page = str(folder / PAGE)
    if as_json:
        summary = {"cases": len(report.cases), "planned": report.planned, "failed": failed}
        print(json.dumps(summary | {"verdicts": given, "seconds": seconds, "report": page}))
    else:
        verdicts = ", ".join(f"{count} {name}" for name, count in given.items())
        print(f"{counted(len(report.cases), 'case')}: {verdicts}; {seconds} s; report: {page}")
    return FAILED if failed else DONE


def _baseline_check(options: argparse.Namespace) -> int:
    cases, folder, _ = _cases_and_baselines(options)
    report = read_report(options.out)
    found = baseline.changes(report.cases, folder)
    if not is_intact(report):
        found.append(f"{REPORT_FILE} was changed after it was written: its checksum does not fit")
    found += baseline.orphans([case.id for case in cases], folder)
    for line in found:
        print(line, file=sys.stderr)
    compared = counted(len(report.cases), "case")
    print(f"{compared} compared with their baselines: {counted(len(found), 'difference')}")
    return FAILED if found else DONE


def _baseline_update(options: argparse.Namespace) -> int:
    _, folder, own = _cases_and_baselines(options)
    report = read_report(options.out)
    baseline.refuse_other_sources(report.provenance, own.get(baseline.OWN_DIGEST))
    if not is_intact(report):
        raise baseline.BaselineError(f"{options.out / REPORT_FILE}: changed after it was written, run it again")
    known = {record.id: record for record in report.cases}
    if options.case not in known:
        raise baseline.BaselineError(f"case {options.case!r} is not in the report: {', '.join(known)}")
    for line in baseline.update(known[options.case], options.reason, folder, own=folder != baseline.FOLDER):
        print(line)
    return DONE


def _study(options: argparse.Namespace) -> int:
    study = SCENE if options.name == OF_A_SCENE else STUDIES[options.name]
    for key in OF_STUDIES:
        given = getattr(options, key)
        if given == ABSENT.get(key) or key in study.takes:
            continue
        if key in ("jobs", "executor"):
            where = "in one process" if key == "jobs" else "on this machine only"
            raise ExecutorError(f"--{key} {given!r}: study {options.name} runs {where}")
        option = key if key in ("scene", "seeds", "budget") else f"--{key}"
        raise CaseError(f"{option}: study {options.name} does not take it, {that_take(key)} does")
    module = import_module(f"validation.studies.{study.module}")
    if options.name == OF_A_SCENE:
        if options.scene is None:
            raise CaseError(f"study {OF_A_SCENE}: a scene file is needed: study {OF_A_SCENE} SCENE --out DIR")
        if options.json:
            raise CaseError(f"--json: study {OF_A_SCENE} does not take it, its study.json holds everything")
        given = {key: value for key in ("seeds", "budget") if (value := getattr(options, key)) is not None}
        plan = module.Options(jobs=options.jobs or 1, quick=options.quick, overwrite=options.overwrite, **given)
        return int(module.run(options.scene, options.out, plan, say))
    if options.seed and options.random is None:
        raise CaseError(f"--seed {options.seed}: has no meaning without --random")
    if options.quick and options.random is not None:
        raise CaseError("--quick: has no meaning with --random, whose scenes have one form")
    alone = options.name == "stability" or "jobs" not in study.takes  # cases are timed there
    jobs = options.jobs or (1 if alone else os.cpu_count() or 1)
    bench = Bench(options.out, options.quick, say, jobs, opener_of(options.executor))
    asked: dict[str, Any] = {"peers": True} if options.peers else {}
    words = " --quick" * options.quick + " --peers" * options.peers
    if options.random is not None:
        asked |= {"tasks": module.random_tasks(options.random, options.seed), "file": module.RANDOM_FILE}
        words += f" --random {options.random} --seed {options.seed}"
    command = f"python -m validation study {options.name}{words} --out {options.out.resolve().name}"
    made = carried_out(options.name, module.cases(bench, **asked), bench, command)
    if not options.json:
        for table in (table for case in made.cases for table in case.tables):
            print(table.caption, text_table(table.columns, table.rows), sep="\n", end="\n\n")
    return _stored(made, options.out, options)


def add_commands(commands: argparse._SubParsersAction[argparse.ArgumentParser], run_name: str = "run") -> None:
    """Add ours to the commands of a program (`add_subparsers`), which hands what it parsed to `options.perform`.

    `run_name` is what running the cases is called there.
    """
    cores = os.cpu_count() or 1

    run = commands.add_parser(run_name, help="run the cases of a level and write the report")
    run.add_argument("--level", default="quick", help="quick, standard or full (default: quick)")
    run.add_argument("--only", metavar="PATTERN", help="cases whose name or group matches, of any level")
    run.add_argument("--jobs", type=positive, default=cores, help=f"worker processes (default: {cores})")
    run.add_argument("--executor", default="local", help="local (default) or dask://host:port")
    run.add_argument("--out", type=Path, required=True, help="folder of the report; what is there already is kept")
    run.add_argument("--json", action="store_true", help="print the summary as JSON")
    _add_own(run)
    run.set_defaults(command=_alone(_run), perform=perform)

    report = commands.add_parser("report", help="render the page of a run, or report.json of a folder again")
    report.add_argument("folder", type=Path)
    report.add_argument("--json", action="store_true", help="print the summary as JSON")
    report.add_argument("--pdf", action="store_true", help="print it to report.pdf too, with bookmarks (by Chromium)")
    report.set_defaults(command=_report, perform=perform)

    paper = commands.add_parser("replicate", help="the results of the paper from 11 realisations, as a report")
    paper.add_argument("--out", type=Path, required=True, help="folder of the report; realisations there are kept")
    paper.add_argument("--jobs", type=positive, default=cores, help=f"worker processes (default: {cores})")
    paper.add_argument("--executor", default="local", help="local (default) or dask://host:port")
    short = "few realisations with few harmonics: shows only that it runs"
    paper.add_argument("--quick", action="store_true", help=short)
    paper.add_argument("--json", action="store_true", help="print the summary as JSON")
    paper.set_defaults(command=_alone(_replicate), perform=perform)

    base = commands.add_parser("baseline", help="compare a report with the baselines, or update one").add_subparsers(
        required=True, metavar="ACTION"
    )
    check = base.add_parser("check", help="say what a report holds otherwise than the baselines")
    check.add_argument("--out", type=Path, required=True, help="folder of a report")
    _add_own(check)
    check.set_defaults(command=_baseline_check, perform=perform)
    change = base.add_parser("update", help="make the numbers of one case the new baseline")
    change.add_argument("case", metavar="CASE", help="name of a case of the report")
    change.add_argument("--reason", required=True, metavar="TEXT", help="why the numbers moved; it is stored with them")
    change.add_argument("--out", type=Path, required=True, help="folder of a report")
    _add_own(change)
    change.set_defaults(command=_baseline_update, perform=perform)

    challenge.add_commands(commands, perform)

    study = commands.add_parser("study", help="run a study")
    listed = "; ".join(f"{name}: {one.what}" for name, one in ({OF_A_SCENE: SCENE} | STUDIES).items())
    study.add_argument("name", choices=(OF_A_SCENE, *STUDIES), help=listed)
    study.add_argument("scene", type=Path, nargs="?", metavar="SCENE", help=f"scene file (TOML) of study {OF_A_SCENE}")
    seeds, budget = f"realisations besides its own (default: {SEEDS})", f"CPU seconds it may take (default: {BUDGET:g})"
    study.add_argument("--seeds", type=_natural, metavar="N", help=f"{OF_A_SCENE}: {seeds}")
    study.add_argument("--budget", type=positive, metavar="SECONDS", help=f"{OF_A_SCENE}: {budget}")
    study.add_argument("--overwrite", action="store_true", help=f"{OF_A_SCENE}: replace the study of another scene")
    study.add_argument("--quick", action="store_true", help="its short form")
    study.add_argument("--out", type=Path, required=True)
    study.add_argument("--json", action="store_true", help=f"print the summary as JSON (not of {OF_A_SCENE})")
    jobs = f"processes of {that_take('jobs')} (default: {cores}; scene, stability: 1)"
    study.add_argument("--jobs", type=positive, help=jobs)
    study.add_argument("--executor", default="local", help=f"for {that_take('executor')}: local or dask://host:port")
    peers = f"{that_take('peers')} beside FFT solvers only (extra `peers`)"
    study.add_argument("--peers", action="store_true", help=peers)
    study.add_argument("--random", type=positive, metavar="N", help=f"{that_take('random')}: N random scenes instead")
    study.add_argument("--seed", type=_natural, default=0, metavar="K", help="seed of the random scenes (default: 0)")
    study.set_defaults(command=_alone(_study), perform=perform)


def _add_own(command: argparse.ArgumentParser) -> None:
    """Options for cases and baselines outside the package."""
    command.add_argument(
        "--cases", type=Path, metavar="DIR", help="own cases: a folder, or a linecontact.cases entry point"
    )
    command.add_argument(
        "--baselines", type=Path, metavar="DIR", help="folder of the baselines (of own cases by default DIR/baselines)"
    )


def _natural(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r}: an integer >= 0 is needed")
    return int(text)


if __name__ == "__main__":
    sys.exit(main())
