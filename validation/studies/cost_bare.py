"""What the paper's profile costs without adhesion, where no path is needed: seconds and memory of single loads.

Each load is solved alone, in a process of its own, from 1000 to 100,000 harmonics.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import bem
from validation.harness.schema import Table
from validation.harness.store import Store, plain
from validation.references import adapters
from validation.studies.shown import peak_megabytes

HARMONICS, LOADS = (1000, 10_000, 100_000), (0.005, 0.01, 0.02)  # mean pressures over E*


@dataclass(frozen=True)
class BareTask:
    """A mean pressure, over E*, on the paper's profile with so many harmonics."""

    harmonics: int
    load: float


@dataclass(frozen=True)
class BareRun:
    """What a load cost."""

    harmonics: int
    load: float
    status: str
    contact_fraction: float = math.nan
    cpu_seconds: float = math.nan
    peak_megabytes: float = math.nan
    unknowns: int = 0
    patches: int = 0
    evaluations: int = 0
    closure: float = math.nan


COLUMNS = [column.name for column in fields(BareRun)]


def tasks_of(quick: bool) -> list[BareTask]:
    """The loads of the study; in its short form those up to 10,000 harmonics."""
    return [BareTask(harmonics, load) for harmonics in HARMONICS[: 2 if quick else None] for load in LOADS]


def measured(task: BareTask) -> BareRun:
    """One load; the peak memory is that of the process."""
    solid = adapters.scene("paper_profile").solid
    pressure = task.load * solid.youngs_modulus / (1 - solid.poisson_ratio**2)
    profile = {"period": 0.01, "hurst": 0.7, "rms_height": 50e-6, "harmonics": task.harmonics, "seed": 0}
    begun = time.process_time()
    result = bem.solve(
        profile={"kind": "self_affine", **profile},
        solid={"youngs_modulus": solid.youngs_modulus, "poisson_ratio": solid.poisson_ratio},
        loading={"control": "mean_pressure", "targets": [pressure]},
    )
    (state,) = result.targets
    return BareRun(
        harmonics=task.harmonics,
        load=task.load,
        status=state.status,
        contact_fraction=state.contact_fraction,
        cpu_seconds=time.process_time() - begun,
        peak_megabytes=peak_megabytes(),
        unknowns=state.unknowns,
        patches=state.n_patches,
        evaluations=state.evaluations,
        closure=math.nan if state.certificate.closure is None else state.certificate.closure,
    )


def measured_alone(measure: Callable[[BareTask], BareRun], task: BareTask, answers: Store) -> BareRun:
    """A load in a process of its own, or a row with its message."""
    about = f"{task.harmonics} harmonics without adhesion, {task.load:g} E*"
    answer = answers.alone(BareRun, measure, task, about, task, measure.__qualname__)
    if isinstance(answer, BareRun):
        return answer
    return BareRun(task.harmonics, task.load, f"{type(answer).__name__}: {answer}")


def table_of(runs: Sequence[BareRun]) -> Table:
    """The runs as a table."""
    return Table(
        caption="Cost of single loads on the paper's profile without adhesion, one thread.",
        columns=COLUMNS,
        rows=[[plain(getattr(found, name)) for name in COLUMNS] for found in runs],
    )


def line(found: BareRun) -> str:
    """A run in words."""
    return (
        f"without adhesion, {found.harmonics} harmonics, {found.load:g} E*: {found.cpu_seconds:.1f} s, "
        f"{found.peak_megabytes:.0f} MB, {found.patches} patches, {found.evaluations} evaluations, "
        f"contact fraction {found.contact_fraction:.6f}, closure {found.closure:.1e}, {found.status}"
    )
