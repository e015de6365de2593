"""A solver or a submission judged on problems: challenge.json and challenge.html, and what a baseline says of them.

What a solver returned is kept in DIR/answers, so that an interrupted judgement continues; the key of an answer holds
the problem, the file of the solver's module, the sources of the solvers of this project, and versions.  Another module
that the solver imports is not seen: judge a changed one in a new folder.  What crashed or took too long or too much
memory is tried again.
"""

import hashlib
import importlib.util
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from fnmatch import fnmatch
from functools import partial
from pathlib import Path

from pydantic import TypeAdapter

from bem.scene.atomic_file import write_atomically
from validation.challenge import standings
from validation.challenge.judging import Judged, Judgement
from validation.challenge.problem import NAMES, ChallengeError, Shipped, problem
from validation.challenge.solver_process import look_up, returned
from validation.harness.execution import Listener, Note
from validation.harness.executors import Opener, local_processes
from validation.harness.provenance import provenance, versions
from validation.harness.route import Answer
from validation.harness.store import FOLDER, Store, plain, write_json
from validation.report.challenge_page import render_challenge

SCHEMA = "linecontact-challenge/1"
JSON_FILE, PAGE = "challenge.json", "challenge.html"
SOLVERS = ("bem", "fem_reference", "persson", "validation/references", "validation/routes")


def chosen(only: str | None) -> tuple[Shipped, ...]:
    """Problems whose name matches a pattern, or one of several between commas; all without one.

    ChallengeError where a pattern matches none.
    """
    patterns = ["*"] if only is None else only.split(",")
    for pattern in patterns:
        if not any(fnmatch(name, pattern) for name in NAMES):
            raise ChallengeError(f"--only {pattern!r}: one of {', '.join(NAMES)} is needed")
    return tuple(problem(name) for name in NAMES if any(fnmatch(name, pattern) for pattern in patterns))


def solved(
    spec: str,
    problems: Sequence[Shipped],
    limit: float,
    folder: Path,
    report: Listener,
    jobs: int = 1,
    opener: Opener = local_processes,
    memory: float | None = None,
) -> list[Answer]:
    """What a solver, "package.module:function", returns for each problem; from `folder` where it is kept there.

    `limit` is in seconds for each problem, `memory` in GB for each process of the solver; `jobs` and `opener` say how
    many at a time, and where. ChallengeError where the solver cannot be imported.
    """
    look_up(spec)
    store, source = Store(folder / FOLDER, _key(), report), _digest(spec)
    names_of = {one.text: one.name for one in problems}

    def task_of(text: str) -> tuple[str, ...]:
        return names_of[text], spec, source, hashlib.sha256(text.encode()).hexdigest()

    ask, found = partial(returned, spec, limit=limit, memory=memory), dict[str, Answer]()
    for text, answer, _ in store.answers(Answer, ask, names_of, task_of, jobs, opener, keeps=_stands):
        if isinstance(answer, Exception):  # of the process that asked
            answer = Answer("crashed", f"{type(answer).__name__}: {answer}")
        found[text] = answer
        spent = "" if answer.seconds is None else f" in {answer.seconds:.3g} s"
        report(Note(f"{names_of[text]}: {answer.status}{spent}{': ' + answer.message if answer.message else ''}"))
    return [found[one.text] for one in problems]


def _stands(answer: Answer) -> bool:
    """Whether it is kept: what crashed or took too long or too much memory is tried again."""
    return answer.status in ("answered", "not offered")


def earlier(baseline: Path, problems: Sequence[Shipped]) -> tuple[Judged, ...]:
    """The problems of a baseline, challenge.json of an earlier judgement.

    ChallengeError where it is none, or holds none of the problems.
    """
    try:
        content = json.loads(baseline.read_text("utf-8"))
        schema = content["schema"]
        before = TypeAdapter(tuple[Judged, ...]).validate_python(content["problems"]) if schema == SCHEMA else ()
    except FileNotFoundError as error:
        raise ChallengeError(f"baseline {baseline}: no such file") from error
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise ChallengeError(f"baseline {baseline}: challenge.json of a judgement is needed") from error
    if schema != SCHEMA:
        raise ChallengeError(f"baseline {baseline}: schema {schema!r} is not {SCHEMA!r}")
    held = ", ".join(one.problem for one in before)
    if not {one.name for one in problems} & {one.problem for one in before}:
        raise ChallengeError(f"baseline {baseline}: has none of the problems judged; it holds {held or 'none'}")
    return before


def write(judgement: Judgement, problems: Sequence[Shipped], folder: Path) -> None:
    """Write challenge.json and challenge.html."""
    shown, told = ("title", "difficulty", "what_is_hard"), ("solver", "digits", "outcome", "passed", "baseline")
    rows = [
        asdict(row) | {name: one.data[name] for name in shown}
        for row, one in zip(judgement.problems, problems, strict=True)
    ]
    facts = {name: getattr(judgement, name) for name in told} | {"lost": list(judgement.lost or ())}
    content = plain({"schema": SCHEMA, **facts, "problems": rows, "provenance": provenance()})
    write_json(folder / JSON_FILE, content)
    write_atomically(folder / PAGE, render_challenge(content, standings.recorded()))


def _key() -> str:
    """SHA-256 of versions and of the sources of the solvers of this project, not of what their record changes."""
    root, digest = Path(__file__).parents[2], hashlib.sha256(json.dumps(versions(), sort_keys=True).encode())
    for folder in SOLVERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".py", ".c", ".h"):
                digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _digest(spec: str) -> str:
    """SHA-256 of the file of the solver's module; empty where it has none."""
    sys.path.insert(0, str(Path.cwd()))
    try:
        found = importlib.util.find_spec(spec.partition(":")[0])
    finally:
        sys.path.pop(0)
    if found is None or found.origin is None or not Path(found.origin).is_file():
        return ""
    return hashlib.sha256(Path(found.origin).read_bytes()).hexdigest()
