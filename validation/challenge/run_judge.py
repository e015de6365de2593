"""A solver or a submission judged on problems: challenge.json and challenge.html, and what a baseline says of them.

What a solver returned is kept in DIR/answers, so that an interrupted judgement continues; the key of an answer holds
the problem, the file of the solver's module, the sources of the solvers of this project, and versions.  Another module
that the solver imports is not seen: judge a changed one in a new folder.  What crashed or took
too long or too much memory is tried again.
"""

import hashlib
import importlib.util
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from fnmatch import fnmatch
from functools import partial
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from bem.scene.atomic_file import write_atomically
from validation.challenge import standings
from validation.challenge.judging import Judged, judged, lost
from validation.challenge.problem import NAMES, ChallengeError, Shipped, problem
from validation.challenge.solver_process import look_up, returned
from validation.challenge.submission import read_submission
from validation.harness.execution import Listener, Note
from validation.harness.executors import Opener, local_processes
from validation.harness.provenance import provenance, versions
from validation.harness.route import Answer
from validation.harness.store import FOLDER, Store, plain
from validation.report.challenge_page import render_challenge

SCHEMA = "linecontact-challenge/1"
JSON_FILE, PAGE = "challenge.json", "challenge.html"
SOLVERS = ("bem", "fem_reference", "persson", "validation/references", "validation/routes")


@dataclass(frozen=True)
class Judgement:
    """Everything of a judgement: who, on what terms, and the problems; `lost` is None without a baseline."""

    solver: str
    digits: float
    problems: tuple[Judged, ...]
    baseline: str | None = None
    lost: tuple[str, ...] | None = None

    @property
    def passed(self) -> bool:
        """No digits lost to the baseline; without one, every answer right."""
        return all(one.passed for one in self.problems) if self.lost is None else not self.lost

    @property
    def outcome(self) -> str:
        """In a sentence."""
        statuses = [row.status for one in self.problems for row in one.rows]
        counts = {status: statuses.count(status) for status in dict.fromkeys(statuses) if status != "right"}
        others = "".join(f", {count} {status}" for status, count in counts.items())
        spent = [one.seconds for one in self.problems if one.seconds is not None]
        seconds = f"; {sum(spent):.3g} s" if spent else ""
        held = "" if self.lost is None else f"; {len(self.lost)} quantities lost digits against the baseline"
        right = statuses.count("right")
        return f"{right} of {len(statuses)} answers right to {self.digits:g} digits{others}{seconds}{held}"


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
) -> Iterator[Answer]:
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
    for text, answer, _ in store.answers(Answer, ask, names_of, task_of, jobs, opener, keeps=_kept):
        if isinstance(answer, Exception):  # of the process that asked
            answer = Answer("crashed", f"{type(answer).__name__}: {answer}")
        found[names_of[text]] = answer
        spent = "" if answer.seconds is None else f" in {answer.seconds:.3g} s"
        report(Note(f"{names_of[text]}: {answer.status}{spent}{': ' + answer.message if answer.message else ''}"))
    return iter([found[one.name] for one in problems])


def _kept(answer: Answer) -> bool:
    """Whether an answer stands: what crashed or took too long or too much memory is tried again."""
    return answer.status in ("answered", "not offered")


def submitted(path: Path, problems: Sequence[Shipped]) -> Iterator[Answer]:
    """What a submission answers to each problem."""
    content = read_submission(path)
    for one in problems:
        yield Answer("answered", values=content.get(one.name, {}))


def judge(solver: str, problems: Sequence[Shipped], found: Iterator[Answer], digits: float) -> Judgement:
    """Every problem judged."""
    rows = tuple(judged(one.key, answer, digits) for one, answer in zip(problems, found, strict=True))
    return Judgement(solver, digits, rows)


def earlier(baseline: Path, problems: Sequence[Shipped]) -> tuple[Judged, ...]:
    """The problems of a baseline, challenge.json of an earlier judgement.

    ChallengeError where it is none, or holds none of the problems.
    """
    try:
        content = json.loads(baseline.read_text("utf-8"))
        if content["schema"] != SCHEMA:
            raise ChallengeError(f"baseline {baseline}: schema {content['schema']!r} is not {SCHEMA!r}")
        before = TypeAdapter(tuple[Judged, ...]).validate_python(content["problems"])
    except FileNotFoundError as error:
        raise ChallengeError(f"baseline {baseline}: no such file") from error
    except ChallengeError:
        raise
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise ChallengeError(f"baseline {baseline}: challenge.json of a judgement is needed") from error
    held = ", ".join(one.problem for one in before)
    if not {one.name for one in problems} & {one.problem for one in before}:
        raise ChallengeError(f"baseline {baseline}: has none of the problems judged; it holds {held or 'none'}")
    return before


def against(judgement: Judgement, name: str, before: Sequence[Judged]) -> Judgement:
    """The same beside the problems of a baseline of this name."""
    missed = tuple(lost(judgement.problems, before))
    return replace(judgement, baseline=name, lost=missed)


def write(judgement: Judgement, problems: Sequence[Shipped], folder: Path) -> None:
    """Write challenge.json and challenge.html."""
    shown = ("title", "difficulty", "what_is_hard")
    told = ("solver", "digits", "outcome", "passed", "baseline")
    content: dict[str, Any] = {
        "schema": SCHEMA,
        **{name: getattr(judgement, name) for name in told},
        "lost": list(judgement.lost or ()),
        "problems": [
            asdict(row) | {name: one.data[name] for name in shown}
            for row, one in zip(judgement.problems, problems, strict=True)
        ],
        "provenance": provenance(),
    }
    content = plain(content)
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / JSON_FILE, json.dumps(content, indent=1, allow_nan=False) + "\n")
    write_atomically(folder / PAGE, render_challenge(content, standings.recorded()))


def _key() -> str:
    """SHA-256 of versions and of the sources of the solvers of this project."""
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
