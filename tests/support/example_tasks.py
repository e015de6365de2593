"""A task that tells which processes ran it; importable by worker processes."""

import os
import time
from pathlib import Path

SECONDS = 0.5


def squared(folder: str, k: int) -> int:
    with (Path(folder) / str(k)).open("a") as runs:
        print(os.getpid(), file=runs, flush=True)
    time.sleep(SECONDS)
    return k * k
