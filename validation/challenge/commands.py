"""The commands of the challenge: list and show problems, judge a solver or a submission, make answers and standings."""

import argparse
import importlib.util
import json
import sys
import threading
import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from bem.command_line.console import positive
from bem.command_line.folder_lock import locked
from validation.challenge import standings
from validation.challenge.judging import MOST_DIGITS
from validation.challenge.problem import FOLDER, NAMES, Shipped, problem
from validation.harness.entry_points import solvers
from validation.harness.execution import Note
from validation.harness.executors import LOCAL, opener_of

DONE, FAILED = 0, 1
SOLVER = "from the dictionary of a problem to one of answers"
DIGITS, TIME_LIMIT = 3.0, 600.0
MOST_MEMORY = 1e6  # GB
SHORT = 6  # numbers of a list that are shown


def _list(options: argparse.Namespace) -> int:
    width = max(map(len, NAMES))
    for name in NAMES:
        data = problem(name).data
        print(f"{name:{width}}  {data['difficulty']:6}  {data['title']}")
    return DONE


def _show(options: argparse.Namespace) -> int:
    """A problem with its answers, or its files as they are shipped."""
    one = problem(options.name)
    if options.out is not None:
        options.out.mkdir(parents=True, exist_ok=True)
        for source in sorted((FOLDER / one.name).iterdir()):
            (options.out / source.name).write_bytes(source.read_bytes())
            print(options.out / source.name)
        return DONE
    print("\n".join(map(_short, one.text.splitlines())))
    print("\n".join(_answers(one)))
    return DONE


def _short(line: str) -> str:
    """A line of problem.toml with long lists cut off."""
    name, _, rest = line.partition(" = ")
    values = tomllib.loads(line).get(name) if rest.startswith("[") else None
    if values is None or len(values) <= SHORT:
        return line
    return f"{name} = [{', '.join(map(str, values[:SHORT]))}, ...]  # {len(values)} numbers"


def _answers(one: Shipped) -> list[str]:
    lines = ["", "# the answers"]
    for name, key in one.answers.items():
        lines.append(f"{name}: {key.made}; errors are divided by {key.scale:.6g} {key.unit}".rstrip())
        pairs = zip(key.value, key.uncertainty, strict=True)
        lines += [f"    {value!r} +- {spread:.1g} {key.unit}".rstrip() for value, spread in pairs]
        lines += [f"    {check.route}: differs by at most {max(check.difference):.1g}" for check in key.second_routes]
    return lines


def _judge(options: argparse.Namespace) -> int:
    """Judge, and write what came out; 1 where an answer is missing or wrong, or digits were lost to a baseline."""
    from validation.challenge import run_judge
    from validation.challenge.judging import Judgement, judged, lost
    from validation.challenge.submission import submitted

    opener = opener_of(options.executor)
    problems = run_judge.chosen(options.only)
    before = None if options.baseline is None else run_judge.earlier(options.baseline, problems)
    with locked(options.out):
        if options.solver is not None:
            name, spec = options.solver, solvers().get(options.solver, options.solver)
            asked = problems, options.time_limit, options.out, say, options.jobs, opener, options.memory_limit
            found = run_judge.solved(spec, *asked)
        else:
            name = options.submission.name
            found = submitted(options.submission, problems)
        rows = tuple(judged(one, answer, options.digits) for one, answer in zip(problems, found, strict=True))
        judgement = Judgement(name, options.digits, rows)
        if before is not None:
            judgement = replace(judgement, baseline=options.baseline.name, lost=tuple(lost(rows, before)))
        run_judge.write(judgement, problems, options.out)
    for line in (*(line for one in rows for line in one.told), *(f"LOST {line}" for line in judgement.lost or ())):
        print(line, file=sys.stderr)
    page = str(options.out / run_judge.PAGE)
    if options.json:
        print(json.dumps({"passed": judgement.passed, "outcome": judgement.outcome, "page": page}))
    else:
        print(f"{judgement.outcome}; page: {page}")
    return DONE if judgement.passed else FAILED


def _make(options: argparse.Namespace) -> int:
    from validation.challenge.certify import certified, write

    for name in options.names or NAMES:
        write(certified(name), options.out)
        print(options.out / name, flush=True)
    return DONE


def _standings(options: argparse.Namespace) -> int:
    from validation.challenge.record_standings import record

    with locked(options.out):
        path = record(options.out, options.solvers, options.time_limit, say)
    print(path)
    return DONE


def add_commands(commands: Any, perform: Callable[[argparse.Namespace], int]) -> None:
    """Add ours to the commands of a program (`add_subparsers`); `perform` runs what was parsed."""
    actions = commands.add_parser("challenge", help="problems with certified answers: judge a solver by them")
    actions = actions.add_subparsers(required=True, metavar="ACTION")

    def action(name: str, what: str, command: Callable[[argparse.Namespace], int]) -> argparse.ArgumentParser:
        parser: argparse.ArgumentParser = actions.add_parser(name, help=what)
        parser.set_defaults(command=command, perform=perform)
        return parser

    action("list", "one problem a line", _list)

    show = action("show", "a problem with its answers", _show)
    show.add_argument("name", help="name of a problem, from `list`")
    show.add_argument("--out", type=Path, metavar="DIR", help="write problem.toml, answers.json, answers.csv there")

    one = action("judge", "judge a solver, or submitted answers", _judge)
    given = one.add_mutually_exclusive_group(required=True)
    given.add_argument("--solver", metavar="MODULE:FUNCTION", help=f"{SOLVER}, or a name of an installed package")
    given.add_argument("--submission", type=Path, metavar="FILE", help="answers as .json or .csv")
    one.add_argument("--only", metavar="PATTERN", help="problems whose name matches, several between commas")
    one.add_argument("--digits", type=_digits, default=DIGITS, help=f"digits of a right answer (default: {DIGITS:g})")
    memory = "memory of each process of the solver (default: no limit)"
    one.add_argument("--memory-limit", type=_gigabytes, metavar="GB", help=memory)
    earlier = "an earlier challenge.json: fail when digits are lost"
    one.add_argument("--baseline", type=Path, metavar="FILE", help=earlier)
    one.add_argument("--jobs", type=positive, default=1, metavar="N", help="problems at a time (default: 1)")
    one.add_argument("--executor", default=LOCAL, metavar="SPEC", help="local (default) or dask://host:port")
    one.add_argument("--json", action="store_true", help="print the summary as JSON")

    make = action("answers", "make the answers anew", _make)
    make.add_argument("names", nargs="*", metavar="NAME", help="problems (default: all)")
    make.add_argument("--out", type=Path, default=FOLDER, metavar="DIR", help="default: where they are shipped")

    again = action("standings", "run the recorded solvers again", _standings)
    again.add_argument("solvers", nargs="*", metavar="SOLVER", help=f"of {', '.join(standings.SOLVERS)} (default: all)")

    for command, kept in ((one, "folder of challenge.html and challenge.json"), (again, "folder of what was finished")):
        limit = "of each problem (default: 600)"
        command.add_argument("--time-limit", type=_seconds, default=TIME_LIMIT, metavar="S", help=limit)
        command.add_argument("--out", type=Path, required=True, metavar="DIR", help=kept)


def _positive(most: float, needed: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not 0 < number <= most:
        raise argparse.ArgumentTypeError(f"{text!r}: {needed} is needed")
    return number


_digits = partial(_positive, MOST_DIGITS, f"a number of digits > 0 and <= {MOST_DIGITS:g}")
_seconds = partial(_positive, threading.TIMEOUT_MAX, f"a number of seconds > 0, at most {threading.TIMEOUT_MAX:.3g}")


def _gigabytes(text: str) -> float:
    if importlib.util.find_spec("resource") is None:
        raise argparse.ArgumentTypeError("this system cannot limit memory (resource.setrlimit)")
    return _positive(MOST_MEMORY, f"a number of GB > 0, at most {MOST_MEMORY:g}", text)


def say(note: Note) -> None:
    """Progress goes to stderr."""
    print(note.text, file=sys.stderr, flush=True)
