"""Test of the tests: random slips are put into copies of the code, and the tests and the quick level run on each.

    python -m validation.studies.mutants --out DIR [--count 300] [--jobs N] [--only TEXT]

A mutant differs from the code in one place: + and -, * and / are exchanged, a comparison or a condition is turned
around, `and` and `or` are exchanged, a minus or a `not` is lost, a number is changed by one or by half.  Places are
drawn at random from the packages bem, fem_reference, persson and the judging code of validation; the seed is the
version of the package, so that no test is made for a sample.  Messages, annotations and decorators are left alone.
Kernels are compiled and keep their text.

Each mutant is run twice: with the tests of its folder (bem/path/fold.py: tests/bem/path), and with the quick level.
It is killed where a test fails or takes ten times as long as without a mutant.  A survivor is a hole in the tests, or
computes the same numbers by another way; names of the latter go, when looked at, into DIR/equivalent.txt, a line each,
and are counted apart by the next call.  DIR/mutants.jsonl holds every answer: a call continues where another ended.
"""

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from validation.plugin.rows import Code, Quantity, Rows
from validation.plugin.study_report import Part, write_study

ROOT = Path(__file__).parents[2]
JUDGED = ("bem", "fem_reference", "persson", "validation/plugin", "validation/routes", "validation/references")
COPIED = ("bem", "fem_reference", "persson", "validation", "tests")
QUICK = ["-c", "validation/plugin/pytest.ini", "--rootdir", "validation/cases", "-p", "validation.plugin.hooks"]
QUICK += ["--level", "quick", "--report", "quick-report", "validation/cases"]
KILLED_BY_TESTS, KILLED_BY_QUICK = 0.85, 0.6  # least shares of the mutants that are not equivalent
PATIENCE = 10.0  # a mutant takes at most this many times as long as its folder's tests without a mutant
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
    line: int
    start: int
    stop: int
    before: str
    after: str

    @property
    def name(self) -> str:
        """Place and change, the name in mutants.jsonl."""
        return f"{self.file}:{self.line}:{self.start} {self.before} -> {self.after}"

    @property
    def module(self) -> str:
        """Folder, of which the report has a line."""
        return str(Path(self.file).parent)

    def put_into(self, root: Path) -> None:
        """Change the file below a root."""
        path = root / self.file
        text = path.read_bytes()
        path.write_bytes(text[: self.start] + self.after.encode() + text[self.stop :])


def mutants_of(file: str) -> Iterator[Mutant]:
    """Yield all mutants of a source file below the root."""
    text = (ROOT / file).read_bytes()
    begins = [0]
    for line in text.splitlines(keepends=True):
        begins.append(begins[-1] + len(line))

    def first(node: ast.expr) -> int:
        return begins[node.lineno - 1] + node.col_offset

    def last(node: ast.expr) -> int:
        return begins[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)

    def changed(node: ast.expr, start: int, stop: int, after: bytes) -> Mutant:
        return Mutant(file, node.lineno, start, stop, text[start:stop].decode(), after.decode())

    def between(left: ast.expr, right: ast.expr, before: bytes, after: bytes) -> Iterator[Mutant]:
        start = text.find(before, last(left), first(right))
        if start >= 0:
            yield changed(left, start, start + len(before), after)

    def walk(node: ast.AST) -> Iterator[Mutant]:
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


def all_mutants() -> list[Mutant]:
    """Return every mutant of every judged file."""
    files = [path for folder in JUDGED for path in sorted((ROOT / folder).rglob("*.py"))]
    return [mutant for path in files for mutant in mutants_of(path.relative_to(ROOT).as_posix())]


def suite_of(file: str) -> list[str]:
    """Return the tests that a file's folder has, as arguments of pytest: the nearest folder of that name in tests."""
    folder = Path("tests") / Path(file).parent
    while not (ROOT / folder).is_dir():
        folder = folder.parent
    inner = [path for path in (ROOT / folder).iterdir() if path.is_dir() and any(path.glob("test_*.py"))]
    return [folder.as_posix(), *(f"--ignore={path.relative_to(ROOT).as_posix()}" for path in inner)]


def passes(tree: Path, words: list[str], limit: float | None) -> bool:
    """Return whether pytest passes in a tree within a limit in s; it stops at the first failure."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *words]
    environment = os.environ | {"PYTHONPATH": str(tree), "PYTEST_ADDOPTS": "", "OMP_NUM_THREADS": "1"}
    try:
        return subprocess.run(command, cwd=tree, env=environment, capture_output=True, timeout=limit).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def judged(mutant: Mutant | None, words: list[str], scratch: str, limit: float | None) -> tuple[bool, float]:
    """Run pytest on a copy of the code with a mutant, or without; return whether it passes, and the seconds."""
    with TemporaryDirectory(dir=scratch) as name:
        tree, begun = Path(name), time.monotonic()
        for package in COPIED:
            shutil.copytree(ROOT / package, tree / package)
        shutil.copy(ROOT / "pyproject.toml", tree)
        if mutant is not None:
            mutant.put_into(tree)
        return passes(tree, words, limit), time.monotonic() - begun


def main() -> int:
    """Run the mutants that have no answer yet, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--only", default="", help="mutants of the sample whose file contains this text")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    path, seed = options.out / "mutants.jsonl", version("linecontact")
    known = (
        {line["name"]: line for line in map(json.loads, path.read_text("utf-8").splitlines())} if path.exists() else {}
    )
    chosen = [
        mutant for mutant in random.Random(seed).sample(all_mutants(), options.count) if options.only in mutant.file
    ]
    left = [mutant for mutant in chosen if mutant.name not in known]
    with TemporaryDirectory() as scratch, ThreadPoolExecutor(options.jobs) as pool:
        suites = (
            {" ".join(words): words for words in (*(suite_of(mutant.file) for mutant in left), QUICK)} if left else {}
        )
        controls = dict(
            zip(suites, pool.map(lambda words: judged(None, words, scratch, None), suites.values()), strict=True)
        )
        for suite, (passed, seconds) in controls.items():
            print(f"{suite}: {'passes' if passed else 'FAILS'} without a mutant, {seconds:.0f} s", file=sys.stderr)
            if not passed:
                return 1

        def answer(mutant: Mutant) -> dict[str, Any]:
            line: dict[str, Any] = {"name": mutant.name, **asdict(mutant)}
            for key, words in (("tests", suite_of(mutant.file)), ("quick", QUICK)):
                passed, line[f"{key}_seconds"] = judged(mutant, words, scratch, PATIENCE * controls[" ".join(words)][1])
                line[key] = "survived" if passed else "killed"
            return line

        for count, line in enumerate(pool.map(answer, left), 1):
            known[line["name"]] = line
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")
            print(
                f"[{count}/{len(left)}] {line['name']}: {line['tests']}, quick level {line['quick']}", file=sys.stderr
            )
    return report(options.out, [known[mutant.name] | {"module": mutant.module} for mutant in chosen])


def report(folder: Path, lines: list[dict[str, Any]]) -> int:
    """Write the report of all answers; return 1 if fewer mutants were killed than asked, else 0."""
    looked_at = folder / "equivalent.txt"
    equivalent = set(looked_at.read_text("utf-8").splitlines()) if looked_at.exists() else set()
    rows, counted = Rows(), [line for line in lines if line["name"] not in equivalent]
    for key, least, name in (
        ("tests", KILLED_BY_TESTS, "tests of the folder"),
        ("quick", KILLED_BY_QUICK, "quick level"),
    ):
        share = sum(line[key] == "killed" for line in counted) / max(1, len(counted))
        rows.compare(
            f"share killed by the {name}",
            share,
            1.0,
            of=Code.BEM,
            by=Code.IDENTITY,
            quantity=Quantity.COUNT,
            kind="construction",
            required=1 - least,
            because=f"{least:.0%} of the mutants that are not equivalent",
        )
    modules = sorted({line["module"] for line in lines})
    table = []
    for module in modules:
        own = [line for line in lines if line["module"] == module]
        other = [line for line in own if line["name"] not in equivalent]
        killed = [sum(line[key] == "killed" for line in other) for key in ("tests", "quick")]
        table.append([module, len(own), *killed, len(other) - killed[0], len(own) - len(other)])
    columns = ["module", "mutants", "killed by tests", "killed by quick level", "survived the tests", "equivalent"]
    rows.table("Mutants by module", columns, table)
    survivors = [[line["name"]] for line in counted if line["tests"] == "survived"]
    rows.table("Survivors of the tests", ["place and change"], survivors)
    part = Part("mutants", "Would the tests and the quick level notice a slip in the code?", rows)
    content = write_study(folder, "python -m validation.studies.mutants", [part], level="mutants")
    print(f"{len(lines)} mutants; report: {folder / 'report.html'}")
    return 1 if content["failed"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
