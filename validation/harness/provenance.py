"""Provenance of a report: commit, versions, machine, BLAS; nothing that names a person, a host or a folder."""

import hashlib
import os
import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_info

PACKAGES = (
    "linecontact",
    "numpy",
    "scipy",
    "scikit-fem",
    "meshio",
    "matplotlib",
    "pydantic",
    "jinja2",
    "threadpoolctl",
)
SOURCES = ("bem", "fem_reference", "persson", "validation")


def provenance() -> dict[str, Any]:
    """Return facts about code and machine, as plain values."""
    import numpy  # noqa: F401  (its BLAS is what is asked about)

    blas = [pool for pool in threadpool_info() if pool["user_api"] == "blas"]
    return {
        "commit": _commit(),
        "system": f"{platform.system()} {platform.machine()}",
        "processor": _processor(),
        "cores": os.cpu_count() or 0,
        "blas": ", ".join(sorted({_library(pool) for pool in blas})) or "unknown",
        "blas_threads_per_worker": 1,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "sources_sha256": sources_digest(),
    } | versions()


def versions() -> dict[str, str]:
    """Return the versions of Python, of this package and of the packages it runs on."""
    return {"python": platform.python_version()} | {name: _version(name) for name in PACKAGES}


def sources_digest() -> str:
    """Return the SHA-256 of the source files of the four packages, names and contents."""
    root = Path(__file__).parents[2]
    digest = hashlib.sha256()
    for package in SOURCES:
        for path in sorted((root / package).rglob("*")):
            if path.suffix in (".py", ".pyx", ".h", ".toml", ".json"):
                digest.update(path.relative_to(root).as_posix().encode() + b"\0")
                digest.update(path.read_bytes())
    return digest.hexdigest()


def working_tree() -> tuple[str, bool] | None:
    """Return the commit, and True if sources other than stored errors have changes; None outside a checkout."""
    root = Path(__file__).parents[2]
    if not (root / ".git").exists():
        return None
    changed = ("status", "--porcelain", "--", *SOURCES, ":!validation/cases/stored.csv")
    try:
        commit, status = _git(root, "rev-parse", "HEAD"), _git(root, *changed)
    except OSError:  # no git on this machine
        return None
    if commit.returncode != 0 or status.returncode != 0:
        return None
    return commit.stdout.strip(), bool(status.stdout.strip())


def _git(root: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)


def _commit() -> str:
    tree = working_tree()
    if tree is None:
        return "not a checkout"
    return tree[0] + (" with changes" if tree[1] else "")


@cache
def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def _library(pool: dict[str, Any]) -> str:
    """Name and version of a BLAS, and the processor whose kernels it uses."""
    return " ".join(str(pool[key]) for key in ("internal_api", "version", "architecture") if pool.get(key))


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown"
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"
