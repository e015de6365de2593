"""Test of the tests: random slips are put into copies of the code, and the tests and the quick level run on each.

    python -m validation.studies.mutants --out DIR [--count 300] [--budget 20] [--jobs N]

A mutant differs from the code in one place: + and -, * and / are exchanged, a comparison or a condition is turned
around, `and` and `or` are exchanged, a minus or a `not` is lost, a number is changed by one or by half.  Places are
drawn at random from the packages bem, fem_reference, persson and the judging code of validation; the seed is the
version of the package, so that no test is made for a sample.  Messages, annotations and decorators are left alone.
Kernels are compiled and keep their text.

DIR/sources is the code as it is when DIR is new.  Its tests and the quick level run once without a mutant, to see which
test executes which line (executed_lines.py).  A mutant then meets the tests of its package that execute its statement,
and in the same manner the cases of the quick level: the quickest, up to a budget of CPU seconds, until one fails.  It
is `killed` by a failure, `timeout` if the tests take several times their CPU seconds, `unseen` if none executes the
statement, else `survived`.

DIR/mutants.csv receives every answer at once, so that a call continues where another ended.  Its first line names the
state of the code, whose lines and columns are the places.  Its last column is written by hand after a look at a
survivor: "equivalent: REASON", if the mutant computes the same numbers, or what has been done about it.  The answers of
a version are kept in mutants.csv beside this file, their table in validation/README.md.
"""

import argparse
import ast
import csv
import importlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from validation.harness.provenance import checkout

ROOT = Path(__file__).parents[2]
JUDGED = ("bem", "fem_reference", "persson", "validation/plugin", "validation/routes", "validation/references")
COPIED = ("bem", "fem_reference", "persson", "validation", "tests")
QUICK = ["-c", "validation/plugin/pytest.ini", "--rootdir", ".", "-p", "validation.plugin.hooks", "--level", "quick"]
CASES = "validation/cases"
COLUMNS = ("place", "change", "code", "tests", "quick", "looked at")
PATIENCE = 4  # times the CPU seconds that the chosen tests, and the import of everything, take without a mutant
MEMORY = 4 << 30  # bytes that a process may address
EXCHANGED = {ast.Add: (b"+", b"-"), ast.Sub: (b"-", b"+"), ast.Mult: (b"*", b"/"), ast.Div: (b"/", b"*")}
TURNED = {
    ast.Lt: (b"<", b">="),
    ast.LtE: (b"<=", b">"),
    ast.Gt: (b">", b"<="),
    ast.GtE: (b">=", b"<"),
    ast.Eq: (b"==", b"!="),
    ast.NotEq: (b"!=", b"=="),
}


@dataclass(frozen=True)
class Mutant:
    """Change of the bytes from `start` to `stop` of a file into the text `after`."""

    file: str
    lines: range  # of the statement, without its body
    place: str
    start: int
    stop: int
    before: str
    after: str
    code: str  # line of the place, which moves with every change of the file

    @property
    def name(self) -> tuple[str, str]:
        """Place and change, the name in mutants.csv."""
        return self.place, f"{self.before} -> {self.after}"

    def put_into(self, root: Path) -> None:
        """Change the file below a root."""
        path = root / self.file
        text = path.read_bytes()
        path.write_bytes(text[: self.start] + self.after.encode() + text[self.stop :])


def mutants_of(file: str, root: Path = ROOT) -> Iterator[Mutant]:
    """Yield all mutants of a source file below a root."""
    text = (root / file).read_bytes()
    begins, statement = [0], range(0)
    for line in text.splitlines(keepends=True):
        begins.append(begins[-1] + len(line))

    def first(node: ast.expr) -> int:
        return begins[node.lineno - 1] + node.col_offset

    def last(node: ast.expr) -> int:
        return begins[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)

    def changed(node: ast.expr, start: int, stop: int, after: bytes) -> Mutant:
        line, before = text.count(b"\n", 0, start), text[start:stop].decode()
        place, code = f"{file}:{line + 1}:{start - begins[line]}", text.splitlines()[line].decode().strip()
        return Mutant(file, statement, place, start, stop, before, after.decode(), code)

    def between(left: ast.expr, right: ast.expr, before: bytes, after: bytes) -> Iterator[Mutant]:
        start = text.find(before, last(left), first(right))
        if start >= 0:
            yield changed(left, start, start + len(before), after)

    def walk(node: ast.AST) -> Iterator[Mutant]:
        nonlocal statement
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            statement = range(node.lineno, max(node.lineno + 1, body[0].lineno) if body else (node.end_lineno or 0) + 1)
        elif isinstance(node, ast.match_case):
            statement = range(node.pattern.lineno, node.body[0].lineno)
        match node:
            case ast.Raise() | ast.JoinedStr() | ast.Assert():
                return
            case ast.BinOp(left=left, op=op, right=right) if type(op) in EXCHANGED:
                yield from between(left, right, *EXCHANGED[type(op)])
            case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in TURNED:
                yield from between(left, right, *TURNED[type(op)])
            case ast.BoolOp(op=op, values=[left, right, *_]):
                yield from between(left, right, *((b"and", b"or") if isinstance(op, ast.And) else (b"or", b"and")))
            case ast.UnaryOp(op=ast.USub() | ast.Not() as op):
                yield changed(node, first(node), first(node) + len("-" if isinstance(op, ast.USub) else "not "), b"")
            case ast.If(test=test) | ast.IfExp(test=test) | ast.While(test=test) if isinstance(
                test, ast.Name | ast.Attribute | ast.Call
            ):
                yield changed(test, first(test), last(test), b"not " + text[first(test) : last(test)])
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                other = value + 1 if isinstance(value, int) else 1.5 * value or 1.0
                yield changed(node, first(node), last(node), repr(other).encode())
        for name, child in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list", "type_params"):
                continue
            for part in child if isinstance(child, list) else [child]:
                if isinstance(part, ast.AST):
                    yield from walk(part)

    yield from walk(ast.parse(text))


def all_mutants(root: Path = ROOT) -> list[Mutant]:
    """Return every mutant of every judged file."""
    files = [path for folder in JUDGED for path in sorted((root / folder).rglob("*.py"))]
    return [mutant for path in files for mutant in mutants_of(path.relative_to(root).as_posix(), root)]


def pytest_on(tree: Path, words: Sequence[str], seconds: int = -1, **environment: str) -> tuple[int, str]:
    """Run pytest in a tree, for at most some CPU seconds; return its status (negative: of a signal) and its output."""

    def limit() -> None:
        for what, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, seconds)):
            allowed = resource.getrlimit(what)[1]
            resource.setrlimit(what, (most if allowed == resource.RLIM_INFINITY else allowed, allowed))

    command = [sys.executable, "-m", "pytest", "-n", "0", "-p", "no:cacheprovider", *words]
    environment = {"PYTHONPATH": str(tree), "PYTEST_ADDOPTS": "", "CI": "1", "OMP_NUM_THREADS": "1"} | environment
    run = subprocess.run(
        command, cwd=tree, env=os.environ | environment, preexec_fn=limit, capture_output=True, text=True, check=False
    )
    return run.returncode, run.stdout + run.stderr


def copied(source: Path, target: Path, without: str = "") -> None:
    """Copy the packages, the tests and the documents."""
    for package in COPIED:
        shutil.copytree(source / package, target / package, ignore=shutil.ignore_patterns(without))
    for path in (*source.glob("*.md"), source / "pyproject.toml", source / "CITATION.cff"):
        shutil.copy(path, target)


class Executed:
    """Lines that each test and quick case executes, measured once without a mutant."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.seconds = folder, dict[str, float]()
        suites = [path for path in sorted((folder / "sources/tests").rglob("*")) if any(path.glob("test_*.py"))]
        for number, suite in enumerate([folder / "sources" / CASES, *suites]):
            self._measure(suite.relative_to(folder / "sources").as_posix(), f"[suite {number + 1}/{len(suites) + 1}]")
        self.data = importlib.import_module("coverage").CoverageData(str(folder / "lines"))
        self.data.read()

    def _measure(self, suite: str, progress: str) -> None:
        """Run the tests that lie directly in a folder, unless their seconds are stored.

        Tests that name no judged module are left out, and lines of other processes are not seen.
        """
        kept, tree = self.folder / f"seconds-{suite.replace('/', '-')}.json", self.folder / "sources"
        if not kept.exists():
            begun, part = time.monotonic(), self.folder / "part"
            part.unlink(missing_ok=True)
            judged = [name.replace("/", ".") for name in JUDGED if suite.startswith(f"tests/{name.partition('/')[0]}")]
            texts = {path: path.read_text("utf-8") for path in sorted((tree / suite).glob("test_*.py"))}
            files = [path for path, text in texts.items() if any(name in text for name in judged)]
            words = [*QUICK, suite] if suite == CASES else ["--timeout", "60", *map(str, files)]
            if not files and suite != CASES:
                return
            words = ["-p", "validation.studies.executed_lines", *words]
            _, output = pytest_on(tree, words, FOLDER=str(self.folder), JUDGED=" ".join(JUDGED))
            if not (self.folder / "part.json").exists():
                raise SystemExit(f"{suite}: pytest fails without a mutant:\n{output}")
            seconds, last = time.monotonic() - begun, output.strip().splitlines()[-1]
            print(f"{progress} {suite}: {last}, {seconds:.0f} s", flush=True)
            lines = importlib.import_module("coverage").Coverage(str(self.folder / "lines"), config_file=False)
            lines.load()
            lines.combine([str(path) for path in (part,) if path.exists()])
            lines.save()
            (self.folder / "part.json").rename(kept)
        self.seconds |= json.loads(kept.read_text("utf-8"))

    def tests(self, mutant: Mutant, folder: str, budget: float) -> list[str]:
        """Return the quickest tests below a folder that execute the statement of a mutant, up to a budget in s.

        Tests of the mutant's own folder come first, file by file.  A statement that is executed on import alone
        concerns all tests that execute its file.
        """
        lines = self.data.contexts_by_lineno(str(self.folder / "sources" / mutant.file))
        contexts = {name for line in mutant.lines for name in lines.get(line, ())}
        if "" in contexts:
            contexts |= {name for names in lines.values() for name in names}
        files, total, near = dict[str, list[str]](), 0.0, f"tests/{Path(mutant.file).parent}/"
        for test in sorted(self.seconds, key=lambda test: (not test.startswith(near), self.seconds[test])):
            file, concerned = test.partition("::")[0], test.startswith(folder)
            if concerned and {test, file} & contexts and (total + self.seconds[test] <= budget or not files):
                files.setdefault(file, []).append(test)
                total += self.seconds[test]
        order = sorted(files, key=lambda file: (not file.startswith(near), self.duration(files[file])))
        return [test for file in order for test in files[file]]

    def duration(self, tests: Iterable[str]) -> float:
        """Return the CPU seconds of tests."""
        return sum(map(self.seconds.__getitem__, tests))


def answer(mutant: Mutant, executed: Executed, budget: float) -> dict[str, str]:
    """Run the tests and the quick cases that execute a mutant; return its line of mutants.csv."""
    line = dict(zip(COLUMNS, (*mutant.name, mutant.code), strict=False))
    with TemporaryDirectory() as name:
        tree = Path(name)
        copied(executed.folder / "sources", tree)
        mutant.put_into(tree)
        for key, suite in {"tests": f"tests/{mutant.file.partition('/')[0]}/", "quick": CASES}.items():
            tests = executed.tests(mutant, suite, budget)
            (tree / "chosen.txt").write_text("\n".join(tests), "utf-8")
            words = [*(QUICK if key == "quick" else ()), "-x", "@chosen.txt"]
            limit = int(PATIENCE * (10 + executed.duration(tests)))
            status, output = pytest_on(tree, words, limit, PYTHONDONTWRITEBYTECODE="1") if tests else (0, "")
            if status == 4 and "not found: " in output:  # parameters, which name the tests, have changed
                status = 0
            late = status in (-signal.SIGXCPU, -signal.SIGKILL)
            line[key] = "timeout" if late else "killed" if status else "survived" if tests else "unseen"
    return line | {"looked at": ""}


def read(file: Path) -> dict[tuple[str, str], dict[str, str]]:
    """Return the lines of a mutants.csv, below that of its state of the code, by place and change."""
    with file.open(encoding="utf-8", newline="") as text:
        next(text)
        return {(line["place"], line["change"]): line for line in csv.DictReader(text)}


def table(lines: Iterable[dict[str, str]]) -> str:
    """Return the table of a mutants.csv by folder and in all, with Wilson's intervals (1927) of two standard errors."""
    lines = list(lines)
    text = [
        "| folder | mutants | equivalent | killed by tests | by the quick level |",
        "| --- | --- | --- | --- | --- |",
    ]
    packages = {line["place"].partition("/")[0] for line in lines}
    folders = {line["place"].rpartition("/")[0] for line in lines}
    for folder in (*sorted(folders - packages), *sorted(packages), "all"):
        whole = folder in {*packages, "all"}
        own = [line for line in lines if folder == "all" or line["place"].startswith(f"{folder}/")]
        other = [line for line in own if not line["looked at"].startswith("equivalent")]
        shares = []
        for key in ("tests", "quick"):
            killed, count = sum(line[key] in ("killed", "timeout") for line in other), max(1, len(other))
            middle, half = (killed + 2) / (count + 4), 2 / (count + 4) * (killed * (count - killed) / count + 1) ** 0.5
            interval = f" = {killed / count:.0%} ({middle - half:.0%} to {middle + half:.0%})" if whole else ""
            shares.append(f"{killed} of {len(other)}{interval}")
        text.append(f"| {folder} | {len(own)} | {len(own) - len(other)} | {shares[0]} | {shares[1]} |")
    return "\n".join(text)


def main() -> int:
    """Run the drawn mutants that mutants.csv lacks, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--budget", type=float, default=20.0, help="CPU seconds of tests, and of cases, for a mutant")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    folder = options.out.resolve()
    kept, sources = folder / "mutants.csv", folder / "sources"
    if not sources.exists():
        sources.mkdir(parents=True)
        copied(ROOT, sources, without="__pycache__")
    version = tomllib.loads((sources / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    if not kept.exists():
        commit = (checkout(ROOT, *COPIED) or ("unknown", []))[0]
        kept.write_text(f"# linecontact {version}, commit {commit[:12]}\n{','.join(COLUMNS)}\n", "utf-8")
    executed, everything = Executed(folder), all_mutants(sources)
    chosen = random.Random(version).sample(everything, options.count)
    answers = read(kept)
    left = [mutant for mutant in chosen if mutant.name not in answers]
    begun = time.monotonic()
    with ThreadPoolExecutor(options.jobs) as pool, kept.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        for count, line in enumerate(pool.map(lambda mutant: answer(mutant, executed, options.budget), left), 1):
            writer.writerow(line)
            file.flush()
            minutes = (time.monotonic() - begun) / 60 * (len(left) - count) / count
            print(f"[{count}/{len(left)}, about {minutes:.0f} min left] {line}", flush=True)
    answers = read(kept)
    print(f"version {version}, {len(answers)} of {options.count} drawn from {len(everything)}")
    print(table(answers.values()))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
