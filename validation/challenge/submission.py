"""Submitted answers: a file of JSON or CSV with what a solver said, to any number of problems.

JSON: {problem: {quantity: number or list}}, or answers.json of one problem; a quantity may also be {"value": list}.
CSV: columns problem, quantity, index (from 0), value, in any order; others are ignored, so that answers.csv is one.
"""

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from validation.challenge.problem import NAMES, ChallengeError, Shipped, problem
from validation.harness.route import Answer

NEEDED = ("problem", "quantity", "index", "value")
Submitted = dict[str, dict[str, Any]]


def submitted(path: Path, problems: Sequence[Shipped]) -> list[Answer]:
    """What a file answers to each problem, not yet judged.

    ChallengeError, with the line or the name, where the file is neither, a line is not complete, or a problem does not
    exist.
    """
    try:
        text = path.read_text("utf-8-sig")  # spreadsheets begin a file with a byte order mark
    except FileNotFoundError as error:
        raise ChallengeError(f"submission {path}: no such file") from error
    except OSError as error:
        raise ChallengeError(f"submission {path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ChallengeError(f"submission {path}: UTF-8 is needed") from error
    if path.suffix not in (".json", ".csv"):
        raise ChallengeError(f"submission {path}: a name that ends in .json or .csv is needed")
    try:
        found = _of_json(path, text) if path.suffix == ".json" else _of_csv(path, text)
    except csv.Error as error:
        raise ChallengeError(f"submission {path}: {error}") from error
    for name in found:
        if name not in NAMES:
            raise ChallengeError(f"submission {path}: problem {name!r}: one of {', '.join(NAMES)} is needed")
    return [Answer(values=found.get(one.name, {})) for one in problems]


def _of_json(path: Path, text: str) -> Submitted:
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:  # also an integer of more digits than Python reads
        raise ChallengeError(f"submission {path}: {error}") from error
    if isinstance(content, dict) and isinstance(content.get("problem"), str):
        content = {content["problem"]: content.get("answers")}
    if not isinstance(content, dict) or not all(isinstance(given, dict) for given in content.values()):
        raise ChallengeError(f"submission {path}: {{problem: {{quantity: number or list}}}} is needed")
    return {
        name: {key: given.get("value") if isinstance(given, dict) else given for key, given in answers.items()}
        for name, answers in content.items()
    }


def _of_csv(path: Path, text: str) -> Submitted:
    reader = csv.DictReader(text.splitlines(), skipinitialspace=True)
    absent = [name for name in NEEDED if name not in (reader.fieldnames or ())]
    if absent:
        header = ", ".join(reader.fieldnames or ("nothing",))
        raise ChallengeError(f"submission {path}: line 1: columns {', '.join(absent)} are missing, found: {header}")
    asked = {(name, quantity): len(key.value) for name in NAMES for quantity, key in problem(name).answers.items()}
    found: dict[tuple[str, str], dict[int, float]] = {}
    for row in reader:
        where = f"submission {path}: line {reader.line_num}"
        if any(row[name] is None for name in NEEDED):
            raise ChallengeError(f"{where}: columns are missing")
        try:
            index, value = int(row["index"]), float(row["value"])
        except ValueError as error:
            raise ChallengeError(f"{where}: index and value: {error}") from error
        answered = row["problem"], row["quantity"]
        values, count = found.setdefault(answered, {}), asked.get(answered)
        if index < 0 or index in values or (count is not None and index >= count):
            most = "" if count is None else f" to {count - 1}"
            raise ChallengeError(f"{where}: index {index}: each from 0{most} is needed once")
        values[index] = value
    answers: Submitted = {}
    for (name, quantity), values in found.items():
        places = range(max(values) + 1) if (name, quantity) in asked else values
        answers.setdefault(name, {})[quantity] = [values.get(place) for place in places]
    return answers
