"""Many solutions on any executor, each stored as soon as it is there, and computed only where it is missing.

A member is a name and the content of a scene file; its result lies in `folder/NAME/` as the solver writes it:
result.json with its checksum and fields.npz with its digest, both under temporary names first.  Only
the process that hands out the work writes, one member in one piece: whatever is killed, at most the members in flight
are lost, and a member that two workers computed, because one was given up, is stored once.  A stored member counts
when its checksums hold and its scene is the one asked for; any other is reported, and computed again.

A member depends on its scene alone, not on the number of workers: phases come from the seed in the scene, and
`member_seed` gives the seeds of an ensemble independently of one another and of how many there are
(numpy.random.SeedSequence).  Results carry the commit and the digest of the sources that made them.
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

import bem
from bem.scene.result import Result
from bem.scene.result_file import CorruptResultError, digest, read_result, write_result
from bem.scene.scene import parse_scene
from validation.harness.execution import Ended, Listener, Note, Running, run_in_processes
from validation.harness.executors import Opener, local_processes
from validation.harness.provenance import provenance

Group = TypeVar("Group", bound=Hashable)


class OtherSceneError(ValueError):
    """The stored result is that of another scene."""


class MissingResultError(RuntimeError):
    """Members of an ensemble have no result: which, and why."""


@dataclass(frozen=True)
class Member:
    """One solution of an ensemble."""

    name: str  # of its folder
    scene: Mapping[str, Any]  # content of a scene file, table by table, SI units


@dataclass(frozen=True)
class Gathered:
    """What a run of an ensemble left behind: names of members."""

    found: tuple[str, ...]  # stored before
    computed: tuple[str, ...]  # stored now
    damaged: tuple[str, ...] = ()  # stored before but not to be trusted, with the reason; computed again
    # kind and text of the exception that came in place of a result
    failed: dict[str, str] = field(default_factory=dict)


def member_seed(root: int, k: int) -> int:
    """Seed of realisation k of the ensemble with this root: the same whatever else is computed.

    Examples
    --------
    >>> member_seed(7, 2) == member_seed(7, 2), member_seed(7, 2) == member_seed(7, 3)
    (True, False)
    """
    return int(np.random.SeedSequence(root, spawn_key=(k,)).generate_state(1)[0])


def run_ensemble(
    members: Iterable[Member], folder: Path, jobs: int, report: Listener, opener: Opener = local_processes
) -> Gathered:
    """Compute and store what is missing, of members with distinct names, which are started in this order.

    Raises
    ------
    ValueError
        Two members of one name.
    SceneError
        A scene with mistakes: reported before anything runs.
    OSError
        Disk full, folder not writable: workers are ended, what is stored stays whole.
    KeyboardInterrupt
        Workers are ended first.
    """
    planned = tuple(members)
    names = [member.name for member in planned]
    if len(set(names)) != len(names):
        raise ValueError(f"members: {sorted({n for n in names if names.count(n) > 1})} are named twice")
    found, damaged, computed, waiting = list[str](), list[str](), list[str](), list[Member]()
    failed: dict[str, str] = {}
    for member in planned:
        try:
            read_member(member, folder)
            found.append(member.name)
        except FileNotFoundError:
            waiting.append(member)
        except (CorruptResultError, OtherSceneError) as error:
            damaged.append(member.name)
            waiting.append(member)
            report(Note(f"{error}; computed again"))
    if found:
        report(Note(f"{len(found)} of {len(planned)} members are there already"))
    folder.mkdir(parents=True, exist_ok=True)
    with closing(run_in_processes(solve_member, waiting, jobs, opener=opener)) as events:
        for event in events:
            if isinstance(event, Running):
                active = zip(event.items, event.seconds, strict=True)
                running = [f"{member.name} ({seconds:.0f} s)" for member, seconds in active]
                left = len(waiting) - len(computed) - len(failed)
                report(Note(f"{left} of {len(planned)} members left; running: {', '.join(running)}"))
            elif isinstance(event, Ended):
                name, answer = event.item.name, event.answer
                if isinstance(answer, Exception):
                    failed[name] = f"{type(answer).__name__}: {answer}"
                    report(Note(f"{name}: {failed[name]}"))
                    continue
                write_result(answer, folder / name)
                computed.append(name)
                done = len(found) + len(computed) + len(failed)
                report(Note(f"[{done}/{len(planned)}] {name}: {answer.status}"))
    if len(found) + len(computed) + len(failed) != len(planned):
        raise RuntimeError(f"planned {len(planned)} members, {len(found)} + {len(computed)} + {len(failed)} ended")
    return Gathered(tuple(found), tuple(computed), tuple(damaged), failed)


def results_of(
    groups: Mapping[Group, Sequence[Member]], folder: Path, jobs: int, report: Listener, opener: Opener
) -> dict[Group, list[Result]]:
    """The results of groups of members (`run_ensemble`); MissingResultError where one failed."""
    done = run_ensemble([one for members in groups.values() for one in members], folder, jobs, report, opener)
    if done.failed:
        raise MissingResultError("; ".join(f"{name}: {why}" for name, why in done.failed.items()))
    return {group: [read_member(one, folder) for one in members] for group, members in groups.items()}


def read_member(member: Member, folder: Path) -> Result:
    """The stored result of a member.

    FileNotFoundError where it is not there, CorruptResultError where it is damaged, OtherSceneError where it is that of
    another scene.
    """
    scene_sha256 = digest(parse_scene(member.scene).resolved())
    result = read_result(folder / member.name)
    if result.provenance.get("scene_sha256") != scene_sha256:
        raise OtherSceneError(f"{folder / member.name}: the result of another scene")
    return result


def solve_member(member: Member) -> Result:
    """In a worker: the solution, with the commit and the digest of the sources that made it."""
    result = bem.solve(parse_scene(member.scene))
    return replace(result, provenance=result.provenance | _sources())


@cache
def _sources() -> dict[str, str]:
    facts = provenance()
    return {"commit": facts["commit"], "sources_sha256": facts["sources_sha256"]}
