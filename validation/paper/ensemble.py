"""Solutions of an ensemble, each stored as soon as it is there, and computed only where it is missing.

A member is a name and the content of a scene file; its result lies in `folder/NAME/` as the solver writes it, with its
checksum.  A stored member counts where its checksum holds and its scene is the one asked for; else it is computed
again.  Results depend on the scene alone, not on the number of processes.
"""

import multiprocessing
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

import bem
from bem.scene.result import Result
from bem.scene.result_file import CorruptResultError, digest, read_result, write_result
from validation.report.pages import ReportError


@dataclass(frozen=True)
class Member:
    """Solution of an ensemble, by name and scene."""

    name: str  # of its folder
    scene: Mapping[str, Any]  # content of a scene file, SI units


@contextmanager
def workers(jobs: int, executor: str = "local") -> Iterator[Executor]:
    """Open processes of this machine, or of a dask scheduler: "local" or "dask://host:port".

    Raises
    ------
    ReportError
        Another executor, or dask without the extra `cluster`.
    """
    if executor == "local":
        with ProcessPoolExecutor(
            jobs, multiprocessing.get_context("spawn"), initializer=threadpool_limits, initargs=(1,)
        ) as pool:
            yield pool
        return
    if not executor.startswith("dask://"):
        raise ReportError(f"--executor {executor!r}: must be local or dask://host:port")
    try:
        from distributed import Client
    except ImportError:
        raise ReportError(f"--executor {executor!r}: install linecontact[cluster]") from None
    with Client(executor.replace("dask", "tcp", 1)) as client:  # type: ignore[no-untyped-call]
        yield client.get_executor()


def read_member(member: Member, folder: Path) -> Result | None:
    """Read the stored result of a member; None where it is missing, damaged, or of another scene."""
    try:
        result = read_result(folder / member.name)
    except (FileNotFoundError, CorruptResultError):
        return None
    scene = digest(bem.parse_scene(member.scene).resolved())
    return result if result.provenance.get("scene_sha256") == scene else None


def solve_members(
    members: Iterable[Member], folder: Path, pool: Executor, say: Callable[[str], None]
) -> dict[str, str]:
    """Solve and store members that are missing; return the reasons of members without a result, by name."""
    folder.mkdir(parents=True, exist_ok=True)
    planned = list(members)
    missing = [member for member in planned if read_member(member, folder) is None]
    if len(missing) < len(planned):
        say(f"{len(planned) - len(missing)} of {len(planned)} members are stored already")
    futures = {pool.submit(bem.solve, dict(member.scene)): member for member in missing}
    failed: dict[str, str] = {}
    try:
        for count, future in enumerate(as_completed(futures), 1):
            name = futures[future].name
            try:
                result = future.result()
            except (ValueError, ArithmeticError, MemoryError, RuntimeError) as error:
                failed[name] = f"{type(error).__name__}: {error}"
                say(f"[{count}/{len(missing)}] {name}: {failed[name]}")
                continue
            write_result(result, folder / name)
            say(f"[{count}/{len(missing)}] {name}: {result.status}")
    finally:
        for future in futures:
            future.cancel()
    return failed
