"""Command of the verification: pytest with this plugin, and nothing else that happens to be installed.

Exit codes: 0 nothing failed, 1 a case failed, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import argparse
import json
import os
import shlex
import sys
from pathlib import Path
from typing import Any

from validation.plugin.stored import FILE

PLUGIN = Path(__file__).parent
CASES = PLUGIN.parent / "cases"
EXIT = {0: 0, 1: 1, 2: 130}  # of pytest: passed, failed, interrupted; all else is bad input
NOTHING_MATCHED = 5
LEVELS = ("quick", "standard", "full")


OPTIONS: dict[str, dict[str, Any]] = {  # of the command and of the plugin
    "--level": {"choices": LEVELS, "default": "quick", "help": "the cases of this level and below (default: quick)"},
    "--only": {"metavar": "TEXT", "help": "cases, of any level, whose file or name contains this text"},
    "--resume": {"action": "store_true", "help": "keep the cases of the report that passed with these sources"},
    "--store": {
        "choices": ("anew", "worst"),
        "nargs": "?",
        "const": "anew",
        "help": "rewrite stored errors of the cases that run; 'worst' keeps the larger of old and new",
    },
    "--reason": {"default": "", "metavar": "TEXT", "help": "of --store: why the numbers change"},
    "--grace": {"type": float, "default": 15.0, "help": argparse.SUPPRESS},  # s, after which a hanging worker ends
}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a run."""
    cores = os.cpu_count() or 1
    for name, keywords in OPTIONS.items():
        parser.add_argument(name, **keywords)
    parser.add_argument("--jobs", type=int, default=cores, help=f"worker processes (default: {cores})")
    parser.add_argument("--cases", type=Path, metavar="FOLDER", help="own cases: test_*.py, case_*.toml")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the report")


def run(options: argparse.Namespace) -> int:
    """Run the cases, write the report, and print one line; return the exit code."""
    if options.only is not None and not any(map(str.isalnum, options.only)):
        return _refused(f"--only {options.only!r}: no letter; write a part of a case's name, such as --only johnson")
    if options.jobs < 1:
        return _refused(f"--jobs {options.jobs}: at least 1")
    if options.cases is not None and not options.cases.is_dir():
        return _refused(f"--cases {options.cases}: no such folder")
    if options.store and options.cases is not None and not any(options.cases.rglob(FILE)):
        return _refused(f"--store: {options.cases / FILE} does not exist; make it, empty, and errors are stored there")
    if options.reason and not options.store:
        return _refused("--reason: says why stored numbers change; add --store")
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    os.environ.pop("PYTEST_ADDOPTS", None)
    import pytest

    folder = (options.cases or CASES).resolve()
    words = ["-c", str(PLUGIN / "pytest.ini"), "--rootdir", str(folder), "-p", "no:terminal", "-p", "no:cacheprovider"]
    words += ["-p", "validation.plugin.hooks", "-p", "xdist.plugin"]
    words += ["-n", str(options.jobs), "--max-worker-restart", "1000", "--continue-on-collection-errors"]
    words += ["--level", options.level, "--grace", str(options.grace), "--report", str(options.out)]
    words += ["--command", _command(options)]
    words += ["--only", options.only] if options.only else []
    words += ["-o", f"pythonpath={folder}"] if options.cases else []  # own cases import modules beside them
    words += ["--resume"] * options.resume
    words += ["--store", options.store, "--reason", options.reason] if options.store else []
    status = int(pytest.main([*words, str(folder)]))
    if status == pytest.ExitCode.USAGE_ERROR:  # pytest has said which
        return 2
    if status == NOTHING_MATCHED and options.only:
        return _refused(f"--only {options.only}: no case matches")
    report = options.out / "report.json"
    content = json.loads(report.read_text("utf-8")) if report.exists() else {"cases": []}
    if status not in (*EXIT, NOTHING_MATCHED) or not content["cases"]:
        return _refused(f"{folder}: no case ran")
    print(f"{content['headline']}; report: {options.out / 'report.html'}")
    return EXIT.get(status, 0)  # nothing was left to run after --resume


def _command(options: argparse.Namespace) -> str:
    words = ["linecontact", "verify", *(["--only", options.only] if options.only else ["--level", options.level])]
    words += ["--cases", options.cases.name] if options.cases else []
    return shlex.join([*words, "--out", options.out.name or "."])


def _refused(sentence: str) -> int:
    print(f"error: {sentence}", file=sys.stderr)
    return 2
