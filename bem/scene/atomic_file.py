"""Files that exist in full or not at all: written under a temporary name, flushed to disk and renamed."""

from __future__ import annotations

import os
from pathlib import Path


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write a file under a temporary name, flush it to disk and rename it.

    OSError where the disk is full, or the folder is not there; the old file is left as it was, and nothing beside it.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with temporary.open("wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def remove_remains(path: Path) -> None:
    """Remove temporary files that dead processes left of a file; no other process may write the file meanwhile."""
    for remains in path.parent.glob(f".{path.name}.[0-9]*"):
        remains.unlink(missing_ok=True)
