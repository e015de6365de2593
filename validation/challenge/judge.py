"""Judge of a solver, or of answers in a file, on the problems of problems/NAME.

problem.toml holds plain SI numbers; a solver gets it as a dictionary, lists of numbers as arrays.  answers.json holds
the certified answers: values, uncertainties, the scale that errors are divided by, and how they were made.  An answer
is right with d digits if every error is at most 10^-d of the scale beside the uncertainty of the certified value.  Each
problem runs in a process of its own, which ends at the time limit; rows stand in the ordinary report.
"""

import argparse
import json
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from bem.geometry.regular_file import read_regular
from validation.plugin.rows import Code, Quantity, Rows
from validation.plugin.study_report import Part, write_study
from validation.report.pages import ReportError

FOLDER = Path(__file__).parent / "problems"
COLUMNS = {  # of the matrix, by the beginning of a quantity
    "contact_fraction": Quantity.AREA,
    "gap_fraction": Quantity.AREA,
    "mean_pressure": Quantity.PRESSURE,
    "separation": Quantity.LENGTH,
    "penetration": Quantity.LENGTH,
    "edges": Quantity.EDGES,
    "patches": Quantity.COUNT,
    "elastic_energy": Quantity.ENERGY,
    "energy": Quantity.ENERGY,
    "stress_intensity": Quantity.INTENSITY,
    "spectrum": Quantity.SPECTRUM,
}
RUN = """
import importlib, json, sys
import numpy as np
module, _, name = sys.argv[1].partition(":")
def arrays(value):
    if isinstance(value, dict):
        return {key: arrays(item) for key, item in value.items()}
    return np.array(value) if isinstance(value, list) and value and not isinstance(value[0], str) else value
sys.path.insert(0, "")
answers = getattr(importlib.import_module(module), name)(arrays(json.load(sys.stdin)))
json.dump({key: np.asarray(value, float).ravel().tolist() for key, value in answers.items()}, open(sys.argv[2], "w"))
"""


def problem(name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the tables of problem.toml and the certified answers by quantity."""
    tables = tomllib.loads((FOLDER / name / "problem.toml").read_text("utf-8"))
    return tables, json.loads((FOLDER / name / "answers.json").read_text("utf-8"))["answers"]


def names() -> list[str]:
    """Return the names of the problems, easy problems first."""
    order = {"easy": 0, "medium": 1, "hard": 2}
    folders = sorted(path.name for path in FOLDER.iterdir() if (path / "problem.toml").exists())
    return sorted(folders, key=lambda name: order.get(problem(name)[0]["difficulty"], len(order)))


def judge(rows: Rows, name: str, given: dict[str, Any], digits: float, of: Code = Code.USER) -> None:
    """Add a row for every quantity that a problem asks for; our own solver against itself is a construction."""
    for quantity, key in problem(name)[1].items():
        column = next((of for start, of in COLUMNS.items() if quantity.startswith(start)), Quantity.POINTS)
        title, values = quantity.replace("_", " "), given.get(quantity)
        if values is None:
            rows.not_converged(title, "not answered", of=of, by=Code.PUBLISHED, quantity=column)
            continue
        try:
            numbers = np.ravel(np.asarray(values, float))
        except (TypeError, ValueError):
            rows.not_converged(title, f"not numbers: {str(values)[:60]}", of=of, by=Code.PUBLISHED, quantity=column)
            continue
        spread, own = np.asarray(key["uncertainty"], float), of == Code.BEM and key["made"] != "closed form"
        rows.compare(
            title,
            numbers,
            key["value"] if numbers.size == len(spread) else [],
            of=of,
            by=Code.PUBLISHED,
            quantity=column,
            unit=key["unit"],
            uncertainty=(0.0, spread.max()),
            required=10.0**-digits * key["scale"] + spread.max(),
            because=f"{digits:g} digits of the scale",
            source=key["made"],
            kind="construction" if own else "accuracy",
        )


def solved(solver: str, name: str, folder: Path, limit: float) -> dict[str, Any]:
    """Return the answers of a solver MODULE:FUNCTION, run in its own process; ReportError if the solver fails."""
    out = folder / f"{name}.json"
    out.unlink(missing_ok=True)
    words = [sys.executable, "-c", RUN, solver, str(out)]
    try:
        run = subprocess.run(words, input=json.dumps(problem(name)[0]), text=True, capture_output=True, timeout=limit)
    except subprocess.TimeoutExpired as error:
        raise ReportError(f"no answer within {limit:g} s") from error
    if run.returncode != 0 or not out.exists():
        lines = run.stderr.strip().splitlines() or [f"exit code {run.returncode}"]
        raise ReportError(f"the solver ended: {lines[-1]}")
    return dict(json.loads(out.read_text("utf-8")))


def submitted(path: Path) -> dict[str, dict[str, Any]]:
    """Return the answers of a file {problem: {quantity: number or list}}."""
    try:
        content = json.loads(read_regular(path).decode("utf-8-sig"))
    except (OSError, ValueError) as error:
        raise ReportError(f"--submission {path}: {error}") from error
    unknown = [name for name in content if name not in names()] if isinstance(content, dict) else []
    if not isinstance(content, dict) or not all(isinstance(answers, dict) for answers in content.values()) or unknown:
        raise ReportError(
            f"--submission {path}: needs {{problem: {{quantity: number or list}}}} with problems of "
            f"`challenge list`{': not ' + ', '.join(unknown) if unknown else ''}"
        )
    return content


def _judge(options: argparse.Namespace) -> int:
    texts = [""] if options.only is None else [text for text in options.only.split(",") if text]
    chosen = [name for name in names() if any(text in name for text in texts)]
    if not chosen:
        raise ReportError(f"--only {options.only}: no problem matches; problems: {', '.join(names())}")
    if options.solver and not all(options.solver.partition(":")):
        raise ReportError(f"--solver {options.solver}: write MODULE:FUNCTION")
    answers = {} if options.submission is None else submitted(options.submission)
    options.out.mkdir(parents=True, exist_ok=True)
    parts = []
    for name in chosen:
        rows, message, begun = Rows(), "", time.monotonic()
        try:
            given = (
                answers.get(name, {})
                if options.solver is None
                else solved(options.solver, name, options.out, options.time_limit)
            )
            judge(rows, name, given, options.digits)
        except ReportError as error:
            message = str(error)
        parts.append(Part(name, problem(name)[0]["title"], rows, seconds=time.monotonic() - begun, message=message))
        print(f"[{len(parts)}/{len(chosen)}] {name}: {parts[-1].case()['outcome']}", file=sys.stderr, flush=True)
    content = write_study(
        options.out, f"linecontact challenge judge --out {options.out.name}", parts, level="challenge"
    )
    print(f"{content['headline']}; report: {options.out / 'report.html'}")
    return 1 if content["failed"] else 0


def _list(options: argparse.Namespace) -> int:
    for name in names():
        tables = problem(name)[0]
        print(f"{name:20}  {tables['difficulty']:6}  {tables['title']}")
    print(f"files: {FOLDER}")
    return 0


def add_commands(commands: Any, perform: Callable[[argparse.Namespace], int]) -> None:
    """Add `challenge list` and `challenge judge` to the commands of a program; `perform` runs the parsed command."""
    actions = commands.add_parser("challenge", help="problems with certified answers: judge a solver by them")
    actions = actions.add_subparsers(required=True, metavar="ACTION")
    actions.add_parser("list", help="one problem a line").set_defaults(command=_list, perform=perform)
    command = actions.add_parser("judge", help="judge a solver, or submitted answers")
    given = command.add_mutually_exclusive_group(required=True)
    given.add_argument("--solver", metavar="MODULE:FUNCTION", help="from the dictionary of a problem to one of answers")
    given.add_argument("--submission", type=Path, metavar="FILE", help="answers as JSON")
    command.add_argument("--only", metavar="TEXT", help="problems whose name contains this, several between commas")
    command.add_argument("--digits", type=float, default=3.0, help="digits of a right answer (default: 3)")
    command.add_argument("--time-limit", type=float, default=600.0, metavar="S", help="of each problem (default: 600)")
    command.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the report")
    command.set_defaults(command=_judge, perform=perform)
