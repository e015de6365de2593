"""Lock of an output folder: a lock file in the folder, held while a command writes to it.

The lock is the operating system's (flock through `filelock`), so that it ends with the process that holds it, also when
that is killed; the file `.lock` names the holder and is removed at the end.  Limits: file systems without flock, where
`filelock` says so.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from filelock import FileLock, Timeout

LOCK_FILE = ".lock"
PATIENCE = 0.2  # format: s; a lock file that its holder just removed is tried again


class FolderError(RuntimeError):
    """Folder that cannot be written to; nothing was changed."""


class FolderInUseError(FolderError):
    """Folder that another process writes to."""


@contextmanager
def locked(folder: Path) -> Iterator[bool]:
    """Keep other processes from writing to a folder within this context; yield whether the folder is new.

    A new folder that stays empty is removed.

    Raises
    ------
    FolderInUseError
        Another process holds the folder; who, where and since when.
    FolderError
        The folder cannot be made; why.
    FileExistsError
        The path is not a folder.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as parent, locked(Path(parent) / "out") as new:
    ...     new
    True
    """
    try:
        folder.mkdir(parents=True)
        new = True
    except FileExistsError:
        if not folder.is_dir():
            raise
        new = False
    except OSError as error:
        raise FolderError(f"{folder}: cannot be made ({error.filename}: {error.strerror})") from error
    path = folder / LOCK_FILE
    lock = FileLock(path)
    try:
        lock.acquire(timeout=PATIENCE)
    except Timeout as error:
        raise FolderInUseError(f"{folder}: in use by {_holder(path)}; wait for it, or choose another folder") from error
    try:
        since = datetime.now(UTC).isoformat(timespec="seconds")
        path.write_text(f"process {os.getpid()} on {socket.gethostname()} since {since}\n", "utf-8")
        yield new
    finally:
        path.unlink(missing_ok=True)  # while it is held: who waits for it finds it gone, and makes another
        lock.release()
        if new and folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()


def _holder(path: Path) -> str:
    """Return the holder of a lock in the words of its file."""
    try:
        return path.read_text("utf-8").strip() or "another process"
    except FileNotFoundError:  # it has just been given back
        return "another process until this moment"
