"""Provenance of a report: commit, versions, machine, BLAS; nothing that names a person, a host or a folder."""

import hashlib
import os
import platform
import subprocess
from collections.abc import Iterable
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from importlib.util import find_spec
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
PROJECT = ("bem", "fem_reference", "persson", "validation")
SOURCES = (*PROJECT, "linecontact_compiled")
SUFFIXES = (".py", ".pyx", ".h", ".so", ".pyd", ".toml", ".json", ".csv", ".npz", ".jinja")
LIBRARIES = ("numpy", "scipy", "scikit-fem", "meshio", "pydantic")  # that numbers depend on


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
        "fingerprint": fingerprint(),
    } | versions()


def versions() -> dict[str, str]:
    """Return the versions of Python, of this package and of the packages it runs on."""
    return {"python": platform.python_version()} | {name: _version(name) for name in PACKAGES}


def fingerprint(places: Iterable[Path] = (), without: Path | None = None) -> str:
    """Return the hash of all sources, data, kernels and libraries that a number depends on.

    `places` are files or folders of further cases; the folder of the report may lie among them and is left out.
    """
    report = without.resolve() if without else None
    digest = hashlib.sha256(f"{platform.python_version()} {platform.machine()}".encode())
    for library in LIBRARIES:
        digest.update(f"{library} {metadata.version(library)}".encode())
    roots = [Path(place) for name in SOURCES if (spec := find_spec(name)) for place in _places(spec)]
    for root in (*roots, *(place.resolve() for place in places)):
        for file in [root] if root.is_file() else sorted(root.rglob("*")):
            if file.suffix in SUFFIXES and file.is_file() and report not in file.parents:
                digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def _places(spec: Any) -> list[str]:
    """Return the folders of a package, or the file of a module."""
    return list(spec.submodule_search_locations or []) or ([spec.origin] if spec.origin else [])


def checkout(folder: Path, *places: str) -> tuple[str, list[str]] | None:
    """Return the commit of the checkout that holds a folder, and its changed files in places, stored errors aside.

    None outside of a checkout.
    """
    words = ["status", "--porcelain", "--", *places, ":!stored.csv", ":!*/stored.csv"]
    try:
        commit, status = _git(folder, "rev-parse", "HEAD"), _git(folder, *words)
    except OSError:  # no git on this machine
        return None
    if commit.returncode != 0 or status.returncode != 0:
        return None
    return commit.stdout.strip(), [line[3:] for line in status.stdout.splitlines()]


def _git(root: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)


def _commit() -> str:
    root = Path(__file__).parents[2]
    tree = checkout(root, *PROJECT) if (root / ".git").exists() else None
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
    """Return the name and version of a BLAS, and the processor for which its kernels are made."""
    return " ".join(str(pool[key]) for key in ("internal_api", "version", "architecture") if pool.get(key))


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown"
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"
