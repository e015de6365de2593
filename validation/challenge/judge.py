"""Judge of a solver, or of answers in a file, on the problems of problems/NAME.

problem.toml holds plain SI numbers; a solver gets it as a dictionary, lists of numbers as arrays.  answers.json holds
the certified answers: values, uncertainties, the scale that errors are divided by, and how they were made.  An answer
is right with d digits if every error is at most 10^-d of the scale beside the uncertainty of the certified value.  What
a solver raises fails its problem; rows stand in the ordinary report.
"""

import argparse
import json
import sys
import time
import tomllib
from collections.abc import Callable
from importlib import import_module
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


def problem(name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the tables of problem.toml and the certified answers by quantity."""
    tables = tomllib.loads((FOLDER / name / "problem.toml").read_text("utf-8"))
    return tables, json.loads((FOLDER / name / "answers.json").read_text("utf-8"))["answers"]


def names() -> list[str]:
    """Return the names of the problems, easy problems first."""
    order = {"easy": 0, "medium": 1, "hard": 2}
    folders = sorted(path.name for path in FOLDER.iterdir() if (path / "problem.toml").exists())
    return sorted(folders, key=lambda name: order.get(problem(name)[0]["difficulty"], len(order)))


def judge(rows: Rows, name: str, given: dict[str, Any], digits: float, of: Code = Code.USER, own: float = 0.0) -> None:
    """Add a row for every quantity that a problem asks for; `own` is U of an answer over the scale.

    A count, or our own solver by itself, is a construction.
    """
    for quantity, key in problem(name)[1].items():
        column = next((of for start, of in COLUMNS.items() if quantity.startswith(start)), Quantity.POINTS)
        title, values = quantity.replace("_", " "), given.get(quantity)
        by = Code.EXACT if key["made"] == "closed form" else Code.BEM
        if values is None:
            rows.not_converged(title, "not answered", of=of, by=by, quantity=column)
            continue
        try:
            numbers = np.ravel(np.asarray(values, float))
        except (TypeError, ValueError):
            rows.not_converged(title, f"not numbers: {str(values)[:60]}", of=of, by=by, quantity=column)
            continue
        spread = np.asarray(key["uncertainty"], float)
        rows.compare(
            title,
            numbers,
            key["value"] if numbers.size == len(spread) else [],
            of=of,
            by=by,
            quantity=column,
            unit=key["unit"],
            uncertainty=(own * key["scale"], spread.max()),
            required=10.0**-digits * key["scale"] + spread.max(),
            because=f"{digits:g} digits of the scale",
            source=key["made"],
            kind="construction" if of == by or column == Quantity.COUNT else "accuracy",
        )


def solver_of(words: str) -> Callable[[Any], dict[str, Any]]:
    """Return the function MODULE:FUNCTION, its module found from the folder in which the command runs."""
    module, _, name = words.partition(":")
    if not (module and name):
        raise ReportError(f"--solver {words}: write MODULE:FUNCTION")
    sys.path.insert(0, "")
    try:
        return getattr(import_module(module), name)  # type: ignore[no-any-return]
    except (ImportError, AttributeError) as error:
        raise ReportError(f"--solver {words}: {error}") from error


def arrays(value: Any) -> Any:
    """Return the tables of a problem with lists of numbers as arrays."""
    if isinstance(value, dict):
        return {key: arrays(item) for key, item in value.items()}
    return np.array(value) if isinstance(value, list) else value


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
    solver = None if options.solver is None else solver_of(options.solver)
    answers = {} if options.submission is None else submitted(options.submission)
    options.out.mkdir(parents=True, exist_ok=True)
    parts = []
    for name in chosen:
        rows, message, begun = Rows(), "", time.monotonic()
        try:
            given = answers.get(name, {}) if solver is None else solver(arrays(problem(name)[0]))
            judge(rows, name, given, options.digits)
        except Exception as error:
            message = f"{type(error).__name__}: {error}"
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
    command.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the report")
    command.set_defaults(command=_judge, perform=perform)
