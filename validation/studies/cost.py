"""What the paper's profile costs: seconds, memory and counts of each realisation, and whether its path is converged.

The benchmark (quick) runs seeds 0, 1, 2 with 1000 harmonics to 0.02 E*, each alone in a process on one thread, and
again at a quarter of the increment to show that nothing changes.  The full study adds the cost against the number of
harmonics with fitted exponents.  Counts can be compared between machines; seconds are for the machine at hand.
"""

from __future__ import annotations

import json
import multiprocessing
import resource
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

import bem
from bem.result import Progress
from validation import adapters
from validation.compare import fitted_order
from validation.runner import write_atomically

SEEDS = (0, 1, 2)
HARMONICS = (125, 250, 500, 1000, 2000, 4000)
INCREMENT = 0.05  # rms heights


@dataclass(frozen=True)
class Run:
    """One realisation: cost, and what path convergence is judged by."""

    seed: int
    harmonics: int
    increment: float
    status: str
    wall_seconds: float
    cpu_seconds: float
    peak_megabytes: float
    unknowns: int
    evaluations: int
    accepted: int
    rejected: int
    events: int
    states: int
    certificates_not_ok: int
    worst_closure: float
    contact_fractions: tuple[float, ...]
    separations: tuple[float, ...]


def run(folder: Path, quick: bool, jobs: int) -> int:
    """Run the study, print its table, write cost.json; 1 when a state failed or a path is not converged.

    Parameters
    ----------
    folder : Path
    quick : bool
        Only the benchmark.
    jobs : int
        Processes at a time; 1 gives clean times.
    """
    tasks = [(seed, 1000, increment) for seed in SEEDS for increment in (INCREMENT, INCREMENT / 4)]
    if not quick:
        tasks += [(0, harmonics, INCREMENT) for harmonics in HARMONICS if harmonics != 1000]
    runs: list[Run] = []
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(max_workers=jobs, mp_context=context, max_tasks_per_child=1) as pool:
        for done, found in enumerate(pool.map(_one, tasks), 1):
            runs.append(found)
            print(f"[{done}/{len(tasks)}] {_line(found)}", file=sys.stderr, flush=True)
    drift = max(_drift(runs, seed) for seed in SEEDS)
    content = {"runs": [asdict(found) for found in runs], "path_drift": drift}
    print(HEADING)
    for found in runs:
        print(_line(found))
    print(f"largest change at a quarter of the increment: {drift:.1e} (contact fraction; separation in rms heights)")
    if not quick:
        curve = [found for found in runs if found.seed == 0 and found.increment == INCREMENT and found.harmonics >= 250]
        order = fitted_order([found.harmonics for found in curve], [found.cpu_seconds for found in curve])
        content["exponent"] = order
        print(f"cost grows as harmonics^{order:.2f} from {curve[0].harmonics} to {curve[-1].harmonics}")
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / "cost.json", json.dumps(content, indent=1))
    good = all(found.status == "converged" and found.certificates_not_ok == 0 for found in runs)
    return 0 if good and drift <= 1e-6 else 1


def _one(task: tuple[int, int, float]) -> Run:
    """One realisation, in a process of its own."""
    seed, harmonics, increment = task
    changes: dict[str, Any] = {
        "profile": {"seed": seed, "harmonics": harmonics},
        "accuracy": {"max_increment": increment},
    }
    posed = adapters.scene("paper_profile", changes)
    last: list[Progress] = []
    with threadpool_limits(limits=1):
        wall, cpu = time.perf_counter(), time.process_time()
        result = bem.solve(posed, progress=last.append)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    return Run(
        seed=seed,
        harmonics=harmonics,
        increment=increment,
        status=result.status,
        wall_seconds=wall,
        cpu_seconds=cpu,
        peak_megabytes=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        unknowns=max(state.unknowns for state in result.states),
        evaluations=last[-1].evaluations,
        accepted=last[-1].increments_accepted,
        rejected=last[-1].increments_rejected,
        events=len(result.events),
        states=len(result.states),
        certificates_not_ok=sum(not state.certificate.ok for state in result.states),
        worst_closure=max(state.certificate.closure or 0.0 for state in result.states),
        contact_fractions=tuple(state.contact_fraction for state in result.targets),
        separations=tuple(state.separation for state in result.targets),
    )


def _drift(runs: list[Run], seed: int) -> float:
    """Largest change of contact fraction and separation (in rms heights) at a quarter of the increment."""
    coarse, fine = (
        next(r for r in runs if (r.seed, r.harmonics, r.increment) == (seed, 1000, increment))
        for increment in (INCREMENT, INCREMENT / 4)
    )
    if len(coarse.separations) != len(fine.separations):
        return float("inf")
    area = max(abs(a - b) for a, b in zip(coarse.contact_fractions, fine.contact_fractions, strict=True))
    gap = max(abs(a - b) for a, b in zip(coarse.separations, fine.separations, strict=True)) / 50e-6
    return max(area, gap)


HEADING = (
    "seed harmonics increment status     wall/s  cpu/s   MB unknowns evaluations accepted rejected events states "
    "not-ok closure"
)


def _line(found: Run) -> str:
    return (
        f"{found.seed:4d} {found.harmonics:9d} {found.increment:9.4f} {found.status:10s} {found.wall_seconds:6.1f} "
        f"{found.cpu_seconds:6.1f} {found.peak_megabytes:4.0f} {found.unknowns:8d} {found.evaluations:11d} "
        f"{found.accepted:8d} {found.rejected:8d} {found.events:6d} {found.states:6d} {found.certificates_not_ok:6d} "
        f"{found.worst_closure:.1e}"
    )
