"""All commands of `linecontact`: scenes and their results, the verification, and the studies.

`python -m bem` and `python -m validation` have a part of them, by the same parsers; `verify` is `run` there.
"""

import argparse
import json
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import bem
import validation.__main__ as harness
from bem import scene_commands as scenes
from bem.command_line.perform import BAD_INPUT, DONE, FAILED
from validation.command_line import comparison, examples, fem_answer
from validation.harness.schema import Report
from validation.report.history import history_of, named, write_history

SHELLS = ("bash", "zsh", "tcsh")


def main(arguments: Sequence[str]) -> int:
    """Run one command of `linecontact` and return its exit code."""
    options = _parser().parse_args(arguments)
    perform: Callable[[argparse.Namespace], int] = options.perform
    return perform(options)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="linecontact", description="Adhesive contact of rough profiles, verified.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {bem.__version__}")
    parser.add_argument("--print-completion", action=_PrintCompletion, choices=SHELLS, help="print shell completion")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    example = commands.add_parser("example", help="list examples, or write one into the current folder")
    example.add_argument("name", nargs="?", choices=examples.NAMES, metavar="NAME", help=", ".join(examples.NAMES))
    example.set_defaults(command=_example, perform=harness.perform)

    scenes.add_commands(commands)
    fem_answer.add_command(commands, harness.perform)
    harness.add_commands(commands, run_name="verify")

    what = "two results, or two verification reports, by their uncertainties; more reports: their history"
    several = commands.add_parser("compare", help=what)
    given = "two or more, of runs or of reports; or one that holds folders of reports"
    several.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help=given)
    several.add_argument("--out", type=Path, metavar="DIR", help="write the history of the reports, DIR/history.html")
    several.add_argument("--json", action="store_true", help="print as JSON")
    several.set_defaults(command=_compare, perform=harness.perform)
    return parser


def _example(options: argparse.Namespace) -> int:
    if options.name is None:
        print("\n".join(examples.listed()))
        return DONE
    for path in examples.write_example(options.name, Path()):
        print(path)
    return DONE


def _compare(options: argparse.Namespace) -> int:
    """Compare two; more, or two with a page to write, by their history."""
    folders = comparison.folders_of(options.folders)
    if len(folders) == 2 and options.out is None:
        return _compare_two(folders[0], folders[1], options.json)
    return _history(comparison.read_reports(folders), options)


def _history(reports: list[Report], options: argparse.Namespace) -> int:
    """Print what rose in the newest report above the bands of the earlier ones, and write the page where asked."""
    found = history_of(reports)
    rises, newest = found.rises(-1), named(found.reports[-1], len(reports))
    page = None if options.out is None else str(write_history(found, options.out))
    if options.json:
        facts = {"reports": len(reports), "numbers": len(found.lines), "newest": newest, "rises": rises}
        print(json.dumps(facts | {"unjudged": found.unjudged, "gone": found.gone, "page": page}))
    else:
        ending = f"{len(rises)} rose in the newest, {newest}" if rises else f"none rose in the newest, {newest}"
        told = f"{len(reports)} reports, {len(found.lines)} errors and counts: {ending}; {found.unjudged} not judged"
        notes = [f"not in the newest report: case {name}" for name in found.gone]
        print(*notes, *(f"RISES {line}" for line in rises), told + (f"; page: {page}" if page else ""), sep="\n")
    return FAILED if rises else DONE


def _compare_two(a: Path, b: Path, as_json: bool) -> int:
    """Print what differs, the largest difference of each quantity, and how many numbers were compared."""
    found = comparison.compare(a, b)
    differing, apart = found.differing, sum(number.differs for number in found.numbers)
    most = max(found.numbers, key=lambda number: number.ratio / number.limit)
    if as_json:
        facts = {"compared": len(found.numbers), "apart": apart, "differing": differing, "notes": found.notes}
        print(json.dumps(facts | {"largest": str(most)}))
    else:
        ending = f"they agree; at most, {most}"
        if differing:
            ending = f"{apart} differ, and {len(found.others)} other differences"
        said = [*found.notes, *(f"DIFFERS {line}" for line in differing)]
        print(*said, f"{len(found.numbers)} numbers compared: {ending}", sep="\n")
    return FAILED if differing else DONE


class _PrintCompletion(argparse.Action):
    """Print what makes a shell complete our commands, by shtab (extra `completion`)."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: Any, values: Any, option: str | None = None) -> None:
        try:
            shtab = import_module("shtab")
        except ImportError:
            parser.exit(BAD_INPUT, f"error: {option}: not installed: pip install 'linecontact[completion]'\n")
        _complete_paths(parser, shtab)
        print(shtab.complete(parser, values))
        parser.exit(DONE)


def _complete_paths(parser: argparse.ArgumentParser, shtab: Any) -> None:
    """Tell which arguments are files, and which are folders."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                _complete_paths(command, shtab)
        elif action.type is Path:
            action.complete = shtab.FILE if action.dest == "scene" else shtab.DIRECTORY  # type: ignore[attr-defined]
