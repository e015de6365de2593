"""Test of the cases by faults: each fault of the tables is put into a copy of the packages, and its case runs on it.

    python -m validation.studies.faults.faults --out FOLDER [--only TEXT] [--jobs N]

A fault is a slip of the pen, a lost factor or a forgotten case: a change of text that fits exactly one place of one
file (*.toml beside this file; keys `what`, `before`, `after` and `case`, the text of `linecontact verify --only`).  A
fault is noticed where the run of the case fails; the report tells by which verdicts.  Kernels are compiled and keep
their right text: tests/bem/kernels and tests/bem/elastic judge these.  A control run of every case without a fault must
pass.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from validation.plugin.rows import Code, Quantity, Rows
from validation.plugin.study_report import Part, write_study

FOLDER = Path(__file__).parent
PACKAGES = ("bem", "fem_reference", "persson", "validation")
LIMIT = 600.0  # s of a run: a fault may make a path endless


@dataclass(frozen=True)
class Fault:
    """Wrong piece of code to be detected by a case."""

    name: str
    file: str  # below the folder of the packages
    what: str
    before: str
    after: str
    case: str

    def put_into(self, root: Path) -> None:
        """Change the file below a root; ValueError unless the file holds the text `before` exactly once."""
        path = root / self.file
        text = path.read_text("utf-8") if path.exists() else ""
        if text.count(self.before) != 1:
            raise ValueError(
                f"{self.name}: {self.file} holds {self.before!r} {text.count(self.before)} times, not once"
            )
        path.write_text(text.replace(self.before, self.after), "utf-8")


def faults() -> list[Fault]:
    """Return the faults of the tables, in their order."""
    return [
        Fault(name, file, **content)
        for table in sorted(FOLDER.glob("*.toml"))
        for file, entries in tomllib.loads(table.read_text("utf-8")).items()
        for name, content in entries.items()
    ]


def outcome(case: str, fault: Fault | None, root: Path, scratch: Path) -> dict[str, Any]:
    """Run a case in a copy of the packages with or without a fault; return exit code and failing verdicts."""
    with TemporaryDirectory(dir=scratch) as name:
        tree = Path(name)
        for package in PACKAGES:
            shutil.copytree(root / package, tree / package, ignore=shutil.ignore_patterns("__pycache__"))
        if fault is not None:
            fault.put_into(tree)
        words = [sys.executable, "-m", "validation", "run", "--only", case, "--jobs", "1", "--out", str(tree / "out")]
        environment = os.environ | {"PYTHONPATH": str(tree)}
        try:
            run = subprocess.run(words, cwd=tree, env=environment, capture_output=True, text=True, timeout=LIMIT)
        except subprocess.TimeoutExpired:
            return {"code": 1, "verdicts": [f"no end in {LIMIT:g} s"]}
        report = tree / "out" / "report.json"
        rows = json.loads(report.read_text("utf-8"))["rows"] if report.exists() else []
        verdicts = sorted({row["verdict"] for row in rows if row["failed"]})
        last = run.stderr.strip().splitlines()[-1:] if run.returncode and not verdicts else []
        return {"code": run.returncode, "verdicts": verdicts or last}


def main() -> int:
    """Run the faults and write the report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", default="", help="faults whose name or case contains this text")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    chosen = [fault for fault in faults() if options.only in fault.name or options.only in fault.case]
    begun, root, rows, lines = time.monotonic(), FOLDER.parents[2], Rows(), []
    tasks: list[tuple[str, Fault | None]] = [(case, None) for case in sorted({fault.case for fault in chosen})]
    tasks += [(fault.case, fault) for fault in chosen]
    with TemporaryDirectory() as scratch, ThreadPoolExecutor(options.jobs) as pool:
        answers = pool.map(lambda task: outcome(task[0], task[1], root, Path(scratch)), tasks)
        for (case, fault), answer in zip(tasks, answers, strict=True):
            failed = answer["code"] != 0
            name = f"control: {case} fails" if fault is None else f"{fault.name}: noticed"
            rows.compare(
                name,
                float(failed),
                0.0 if fault is None else 1.0,
                of=Code.BEM,
                by=Code.IDENTITY,
                quantity=Quantity.COUNT,
                kind="construction",
                required=0.5,
                because=fault.what if fault else "no fault",
            )
            lines.append(
                [name, case, fault.what if fault else "", "yes" if failed else "no", ", ".join(answer["verdicts"])]
            )
            print(f"[{len(lines)}/{len(tasks)}] {name}: {lines[-1][3:]}", file=sys.stderr, flush=True)
    rows.table("Faults", ["fault", "case", "what is wrong", "fails", "by"], lines)
    part = Part("faults", "Would the cases notice a fault in the code?", rows, seconds=time.monotonic() - begun)
    content = write_study(options.out, "python -m validation.studies.faults.faults", [part], level="faults")
    missed = sum(row.error > 0 for row in rows.rows)
    print(f"{len(chosen)} faults, {missed} rows otherwise than they should be; report: {options.out / 'report.html'}")
    return 1 if content["failed"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
