"""Bytes of a regular file: a pipe or a device in its place is an error at once, where reading would wait for ever."""

from __future__ import annotations

import errno
import stat
from pathlib import Path


def read_regular(path: Path) -> bytes:
    """Return the bytes of a file; OSError where it cannot be read, or is a folder, a pipe or a device."""
    if not stat.S_ISREG(path.stat().st_mode):
        raise OSError(errno.EINVAL, "is a folder, a pipe or a device", str(path))
    return path.read_bytes()
