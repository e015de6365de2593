"""Where the cost of a path goes: CPU seconds of every stage against harmonics, and of one evaluation against patches.

Stages: stages.py, in a run of its own that is not timed otherwise.  One evaluation: pressure, stress intensities and
their exact sensitivities at the edges of states on the way, by number of patches, the least of a few; its memory is
the peak of all arrays it makes (tracemalloc).  Exponents are fitted from FEWEST_PATCHES patches on: below, overhead
rules.
"""

import time
import tracemalloc
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

import bem
from bem.elastic.collocation import Elastic, evaluate
from bem.elastic.sensitivities import stress_intensity_jacobian
from bem.geometry.patches import ordered
from bem.geometry.scaling import Scales
from bem.scene.result import State
from bem.scene.scene import Scene
from validation.harness.compare import fitted_order
from validation.harness.figure_data import drawn, loglog, trace
from validation.harness.schema import Cells, Figure, Table
from validation.references import adapters
from validation.studies.stages import timed_stages

FEWEST_PATCHES = 8
EVALUATED, REPEATS = 10, 5  # states at which one evaluation is timed, and how often
TOLERANCE = 1e-5
LEAST_SHARE = 0.02  # of the whole: stages below it get no exponent


@dataclass(frozen=True)
class Evaluated:
    """One evaluation at the edges of a state."""

    patches: int
    unknowns: int
    seconds: float
    megabytes: float


@dataclass(frozen=True)
class Breakdown:
    """A path of the paper's profile, taken apart."""

    harmonics: int
    status: str
    stages: dict[str, float]  # CPU seconds of every stage; they add up to the path
    calls: dict[str, int]
    evaluated: tuple[Evaluated, ...]

    @property
    def seconds(self) -> float:
        """Of the whole path."""
        return sum(self.stages.values())


def dissected(harmonics: int) -> Breakdown:
    """Seed 0 of the paper's profile with this many harmonics, in a process of its own."""
    posed = adapters.scene("paper_profile", {"profile": {"harmonics": harmonics}})
    with timed_stages() as times:
        result = bem.solve(posed)
    evaluated = tuple(_evaluated(posed, state) for state in _chosen(result.states))
    return Breakdown(harmonics, result.status, times.shares(), dict(times.calls), evaluated)


def stage_exponents(found: Sequence[Breakdown]) -> dict[str, float]:
    """Exponents p of seconds ~ harmonics^p of every stage that matters at the most harmonics."""
    known = _converged(found)
    if len(known) < 2:
        return {}
    sizes = [run.harmonics for run in known]
    exponents = {}
    for stage, seconds in known[-1].stages.items():
        values = [run.stages.get(stage, 0.0) for run in known]
        if seconds > LEAST_SHARE * known[-1].seconds and min(values) > 0:
            exponents[stage] = fitted_order(sizes, values)
    return exponents


def patch_exponents(run: Breakdown) -> dict[str, float]:
    """Exponents of unknowns, seconds and megabytes of one evaluation against patches."""
    known = [one for one in run.evaluated if one.patches >= FEWEST_PATCHES]
    if len({one.patches for one in known}) < 2:
        return {}
    sizes = [one.patches for one in known]
    return {
        name: fitted_order(sizes, [float(getattr(one, name)) for one in known])
        for name in ("unknowns", "seconds", "megabytes")
    }


def breakdown_tables(found: Sequence[Breakdown]) -> list[Table]:
    """Seconds of every stage with their exponents, and those of one evaluation against patches."""
    if not found:
        return []
    known, orders = _converged(found), stage_exponents(found)
    stages = sorted({name for run in known for name in run.stages}, key=lambda name: -known[-1].stages.get(name, 0.0))
    tables = [
        Table(caption="CPU seconds of the stages of a path, by harmonics; exponents of those that matter.",
              columns=["stage", *(f"{run.harmonics} harmonics" for run in found), "exponent"],
              rows=[*([stage, *(run.stages.get(stage) for run in found), orders.get(stage)] for stage in stages),
                    ["status", *(run.status for run in found), None]])
    ]  # fmt: skip
    for largest in known[-1:]:
        rows: list[Cells] = [[name, order] for name, order in patch_exponents(largest).items()]
        caption = f"Of one evaluation, exponents against patches ({largest.harmonics} harmonics)."
        tables.append(Table(caption=caption, columns=["of one evaluation", "exponent"], rows=rows))
    return tables


def figures_of(found: Sequence[Breakdown]) -> Iterator[Figure]:
    """Stages against harmonics, and one evaluation against patches."""
    known = _converged(found)
    if len(known) > 1:
        largest = sorted(known[-1].stages, key=lambda stage: -known[-1].stages[stage])[:6]
        sizes = [run.harmonics for run in known]
        lines = [trace(stage, sizes, [run.stages.get(stage) for run in known]) for stage in largest]
        yield drawn("stages", "Stages of a path of the paper's profile.", loglog("harmonics", "CPU time / s", *lines))
    if known and known[-1].evaluated:
        lines = [
            trace(f"{run.harmonics} harmonics", [one.patches for one in run.evaluated],
                  [one.seconds for one in run.evaluated]).noted([one.unknowns for one in run.evaluated])
            for run in known
        ]  # fmt: skip
        yield drawn("patches", "One evaluation; beside the points: unknowns.",
                    loglog("patches", "CPU time / s", *lines))  # fmt: skip


def _converged(found: Sequence[Breakdown]) -> list[Breakdown]:
    """Those that are whole, by harmonics."""
    return sorted((run for run in found if run.status == "converged"), key=lambda run: run.harmonics)


def _chosen(states: Sequence[State]) -> list[State]:
    """Some states of different numbers of patches, evenly in their logarithm."""
    by_count: dict[int, State] = {state.n_patches: state for state in states if state.n_patches}
    counts = sorted(by_count)
    if len(counts) <= EVALUATED:
        return [by_count[count] for count in counts]
    wanted = [counts[0] * (counts[-1] / counts[0]) ** (k / (EVALUATED - 1)) for k in range(EVALUATED)]
    nearest = sorted({min(counts, key=lambda count: abs(count - value)) for value in wanted})
    return [by_count[count] for count in nearest]


def _evaluated(posed: Scene, state: State) -> Evaluated:
    profile = posed.surface()
    scales = Scales(profile.period, profile.rms_height, 1.0)
    elastic = Elastic(profile.scaled())
    edges = np.array(state.edges) / scales.length
    patches, depth = ordered(edges[:, 0], edges[:, 1]), state.penetration / scales.height

    def once() -> int:
        found = evaluate(elastic, patches, depth, TOLERANCE)
        stress_intensity_jacobian(found)
        return found.unknowns

    least, unknowns = float("inf"), once()
    for _ in range(REPEATS):
        begun = time.process_time()
        once()
        least = min(least, time.process_time() - begun)
    tracemalloc.start()
    try:
        once()
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    return Evaluated(state.n_patches, unknowns, least, peak / 2**20)
