"""What the paper's profile costs: seconds, memory and counts of each realisation, and whether its path is converged.

The benchmark (quick) runs seeds 0, 1, 2 with 1000 harmonics to 0.025 E*, each alone in a process on one thread, and
again at a quarter of the increment: contact fraction and separation at the loads asked for must not change beyond
1e-6 of themselves.  The full study does so for seeds 0 to 30; it adds seed 0 with 125 to 8000 harmonics and fits
exponents, of the whole curve and of its part up to a contact fraction of a fifth.  Seed 0 is also taken
apart, stage by stage and against patches (cost_breakdown.py), in a run of its own.  Without adhesion, where no path is
needed, single loads are solved up to 100,000 harmonics.  Counts, memory and digits gate; seconds are those
of the machine at hand, and stand in tables.
"""

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import partial
from typing import Any

import numpy as np

import bem
from bem.scene.result import FINAL_STATUSES, Progress, State
from bem.scene.scene import Scene, parse_scene
from validation.harness.case import Case, Found
from validation.harness.compare import fitted_order
from validation.harness.execution import Note
from validation.harness.figure_data import drawn, loglog, trace
from validation.harness.schema import Figure, Row, Table
from validation.harness.store import plain
from validation.references import adapters
from validation.studies.bench import Bench, no_more, none_of, study_case
from validation.studies.cost_breakdown import (
    Breakdown,
    breakdown_tables,
    dissected,
    figures_of,
    patch_exponents,
    stage_exponents,
)
from validation.studies.shown import peak_megabytes

SCHEMA = "linecontact-cost/2"
FILE = "cost.json"
SEEDS, ALL_SEEDS, PAPER_HARMONICS = range(3), range(31), 1000  # 0 to 10 are the paper's
HARMONICS = (125, 250, 500, 1000, 2000, 4000, 8000)
BARE_HARMONICS, BARE_LOADS = (1000, 10_000, 100_000), (0.005, 0.01, 0.02)  # without adhesion; mean pressures over E*
HIGHEST_LOAD, FRACTION = 0.025, 0.2  # of E*; contact fraction up to which sizes are compared
FEWEST_FITTED, EXPONENT = 250, 1.2  # what the time may grow like, from this number of harmonics
INCREMENT = 0.05  # rms heights, the default of a scene
SECONDS, MEGABYTES, CLOSURE, DRIFT = 60.0, 2048.0, 1e-8, 1e-6  # asked of one realisation
FITTED = ("wall_seconds", "cpu_seconds", "cpu_seconds_to_a_fifth", "peak_megabytes", "unknowns", "evaluations",
          "patches")  # fmt: skip


@dataclass(frozen=True)
class PaperRun:
    """The paper's profile on a path with a largest increment (rms heights), or without adhesion at a load over E*."""

    seed: int
    harmonics: int
    increment: float = INCREMENT
    load: float | None = None

    @property
    def name(self) -> str:
        """In words."""
        if self.load is not None:
            return f"{self.harmonics} harmonics without adhesion, {self.load:g} E*"
        return f"seed {self.seed}, {self.harmonics} harmonics, increment {self.increment:g}"


@dataclass(frozen=True)
class Cost(PaperRun):
    """What a realisation cost, and what path convergence is judged by."""

    status: str = ""
    wall_seconds: float = math.nan
    cpu_seconds: float = math.nan
    cpu_seconds_to_a_fifth: float = math.nan
    peak_megabytes: float = math.nan
    unknowns: int = 0
    patches: int = 0
    evaluations: int = 0
    accepted: int = 0
    rejected: int = 0
    events: int = 0
    states: int = 0
    failed_states: int = 0
    certificates_not_ok: int = 0
    worst_closure: float = math.nan
    contact_fractions: tuple[float, ...] = ()
    separations: tuple[float, ...] = ()
    loads_asked_for: int = 0


ON_PATHS = [name.name for name in fields(Cost) if name.name not in ("load", "contact_fractions", "separations")]
BARE = ["harmonics", "load", "status", "contact_fraction", "cpu_seconds", "peak_megabytes", "unknowns", "patches",
        "evaluations", "closure"]  # fmt: skip


@dataclass(frozen=True)
class Drift:
    """Largest change at a quarter of the increment, relative; infinite when loads are missing on one side."""

    seed: int
    contact_fraction: float
    separation: float


def realisations_of(quick: bool) -> list[PaperRun]:
    """The realisations of the study, in order; those without adhesion last, in its short form the smaller ones."""
    seeds = SEEDS if quick else ALL_SEEDS
    paths = [PaperRun(seed, PAPER_HARMONICS, step) for step in (INCREMENT, INCREMENT / 4) for seed in seeds]
    if not quick:
        paths += [PaperRun(0, harmonics) for harmonics in HARMONICS if harmonics != PAPER_HARMONICS]
    sizes = BARE_HARMONICS[: 2 if quick else None]
    return paths + [PaperRun(0, harmonics, load=load) for harmonics in sizes for load in BARE_LOADS]


def cases(
    bench: Bench,
    realisations: Sequence[PaperRun] | None = None,
    measure: Callable[[PaperRun], Cost] | None = None,
    dissect: Callable[[int], Breakdown] | None = dissected,
) -> list[Case]:
    """The case of the study; quick: only the benchmark.

    Other realisations than those of the study may be given, and other measurements of a realisation and of a path taken
    apart, importable by name; None leaves the latter out.
    """
    chosen = realisations_of(bench.quick) if realisations is None else list(realisations)
    find = partial(_costs, bench, chosen, measure or measured, dissect)
    return [
        study_case("cost-of-the-paper", find,
                   "What does the paper's profile cost against harmonics, and is its path converged?",
                   r"cost $\propto$ harmonics$^p$; states at loads with increments $\Delta$ and $\Delta / 4$",
                   "carbone2009", "half_space adhesion slope_term", "bem")
    ]  # fmt: skip


def _costs(
    bench: Bench,
    chosen: Sequence[PaperRun],
    measure: Callable[[PaperRun], Cost],
    dissect: Callable[[int], Breakdown] | None,
) -> Found:
    found: list[Cost] = []
    for done, one in enumerate(chosen, 1):
        answer = bench.store.alone(Cost, measure, one, one.name, one, measure.__qualname__)
        found.append(answer if isinstance(answer, Cost) else Cost(**vars(one), status=_told(answer)))
        bench.say(Note(f"[{done}/{len(chosen)}] {one.name}: {found[-1].status}, {found[-1].cpu_seconds:.1f} s"))
    runs, dry = _on_paths(found)
    apart: list[Breakdown] = []
    for harmonics in sorted({one.harmonics for one in runs if one.seed == 0 and one.increment == INCREMENT}):
        if dissect is not None:
            name = f"{harmonics} harmonics, stage by stage"
            taken = bench.store.alone(Breakdown, dissect, harmonics, name, dissect.__qualname__)
            apart.append(taken if isinstance(taken, Breakdown) else Breakdown(harmonics, _told(taken), {}, {}, ()))
    drifts, exponents = drifts_of(runs), exponents_of(runs)
    bench.write(
        FILE,
        SCHEMA,
        runs=[asdict(one) for one in found],
        drifts=[asdict(drift) for drift in drifts],
        exponents=exponents,
        breakdown=[asdict(one) | {"patch_exponents": patch_exponents(one)} for one in apart],
        stage_exponents=stage_exponents(apart),
    )
    yield from judged(found, drifts)
    lost = [f"{one.harmonics} harmonics: {one.status}" for one in apart if one.status != "converged"]
    yield none_of("paths that could not be taken apart", lost)
    yield from (*_figures(runs), *figures_of(apart))
    yield _table("Cost of loading the paper's profile to 0.025 E*, one thread.", ON_PATHS, map(vars, runs))
    bare = [vars(one) | {"contact_fraction": _only(one.contact_fractions), "closure": one.worst_closure} for one in dry]
    yield _table("Cost of single loads on the paper's profile without adhesion, one thread.", BARE, bare)
    yield _asked(found, exponents)
    yield from breakdown_tables(apart)


def measured(one: PaperRun) -> Cost:
    """A realisation, in a process of its own: its peak memory is that of the process."""
    posed = _posed(one)
    last: list[Progress] = []

    def note(progress: Progress) -> None:
        last[:] = [progress]

    wall, cpu = time.perf_counter(), time.process_time()
    result = bem.solve(posed, progress=note)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    loading, on_path = posed.loading, one.load is None
    asked = len(loading.at_mean_pressures) + (loading.stop_at_mean_pressure is not None) if on_path else 1
    targets = result.targets[:asked]
    return Cost(
        **vars(one),
        status=result.status,
        wall_seconds=wall,
        cpu_seconds=cpu,
        cpu_seconds_to_a_fifth=_seconds_to(FRACTION, result.states),
        peak_megabytes=peak_megabytes(),
        unknowns=max((state.unknowns for state in result.states), default=0),
        patches=max((state.n_patches for state in result.states), default=0),
        evaluations=last[-1].evaluations if on_path and last else sum(state.evaluations for state in result.states),
        accepted=last[-1].increments_accepted if last else 0,
        rejected=last[-1].increments_rejected if last else 0,
        events=len(result.events),
        states=len(result.states),
        failed_states=sum(state.status not in FINAL_STATUSES for state in result.states),
        certificates_not_ok=sum(not state.certificate.ok for state in result.states),
        worst_closure=_worst(c for state in result.states if (c := state.certificate.closure) is not None),
        contact_fractions=tuple(state.contact_fraction for state in targets),
        separations=tuple(state.separation for state in targets),
        loads_asked_for=asked,
    )


def _posed(one: PaperRun) -> Scene:
    profile = {"seed": one.seed, "harmonics": one.harmonics}
    paper = adapters.scene("paper_profile")
    modulus = paper.solid.youngs_modulus / (1 - paper.solid.poisson_ratio**2)
    if one.load is None:
        loading: dict[str, Any] = {"stop_at_mean_pressure": HIGHEST_LOAD * modulus}
        changes: Any = {"profile": profile, "accuracy": {"max_increment": one.increment}, "loading": loading}
        return adapters.scene("paper_profile", changes)
    of_profile = {name: getattr(paper.profile, name) for name in ("kind", "period", "hurst", "rms_height")}
    loading = {"control": "mean_pressure", "targets": [one.load * modulus]}
    return parse_scene({"solid": paper.solid.model_dump(), "profile": of_profile | profile, "loading": loading})


def _seconds_to(fraction: float, states: Sequence[State]) -> float:
    """CPU seconds until the contact fraction is reached, linear between the states; nan where it never is."""
    seconds = np.cumsum([state.cpu_seconds for state in states])
    reached = np.array([state.contact_fraction for state in states])
    beyond = np.flatnonzero(reached >= fraction)
    if beyond.size == 0 or beyond[0] == 0:
        return math.nan
    last = slice(int(beyond[0]) - 1, int(beyond[0]) + 1)
    return float(np.interp(fraction, reached[last], seconds[last]))


def drifts_of(runs: Sequence[Cost]) -> list[Drift]:
    """Change between each run and the one of the same realisation at the smallest increment."""
    found = []
    for run in runs:
        same = [one for one in runs if (one.seed, one.harmonics) == (run.seed, run.harmonics)]
        finest = min(same, key=lambda one: one.increment)
        if finest.increment < run.increment:
            pairs = ((getattr(run, name), getattr(finest, name)) for name in ("contact_fractions", "separations"))
            found.append(Drift(run.seed, *(_change(*pair, run.loads_asked_for) for pair in pairs)))
    return found


def exponents_of(runs: Sequence[Cost]) -> dict[str, float]:
    """Exponents p of cost ~ harmonics^p, over the runs that ended well at the default increment with seed 0."""
    found = {}
    for name in FITTED:
        known = [(run.harmonics, getattr(run, name)) for run in _curve(runs) if getattr(run, name) > 0]
        if len({size for size, _ in known}) >= 2:
            found[name] = fitted_order(*zip(*known, strict=True))
    return found


def _on_paths(found: Sequence[Cost]) -> tuple[list[Cost], list[Cost]]:
    """Runs along paths, and those at single loads without adhesion."""
    return [one for one in found if one.load is None], [one for one in found if one.load is not None]


def _curve(runs: Sequence[Cost]) -> list[Cost]:
    """Those that ended well at the default increment with seed 0, by harmonics."""
    known = [run for run in runs if run.seed == 0 and run.increment == INCREMENT and run.status == "converged"]
    return sorted(known, key=lambda run: run.harmonics)


def judged(found: Sequence[Cost], drifts: Sequence[Drift]) -> list[Row]:
    """What is asked for and gates."""
    runs, dry = _on_paths(found)
    area, gap = (_worst(getattr(drift, name) for drift in drifts) for name in ("contact_fraction", "separation"))
    quarter = "at a quarter of the increment, relative change"
    rows = [
        none_of("runs that do not reach every load",
                [f"{one.name}: {one.status}" for one in runs if not _complete(one)]),
        none_of("runs with failed states", [one.name for one in runs if one.failed_states]),
        none_of("runs with states whose certificate is not ok", [one.name for one in runs if one.certificates_not_ok]),
        no_more("worst closure", "", _worst(run.worst_closure for run in runs), CLOSURE),
        no_more(f"contact fraction {quarter}", "", area, DRIFT),
        no_more(f"separation {quarter}", "", gap, DRIFT),
        no_more("largest memory", "MB", _worst(run.peak_megabytes for run in _of_paper(runs)), MEGABYTES),
    ]  # fmt: skip
    if dry:
        rows.append(none_of("loads without adhesion that are not certified",
                            [f"{one.name}: {one.status}" for one in dry
                             if one.status != "converged" or one.certificates_not_ok]))  # fmt: skip
    return rows


def _asked(found: Sequence[Cost], exponents: Mapping[str, float]) -> Table:
    """Seconds and exponents beside what is asked of them, which does not gate."""
    runs, _ = _on_paths(found)
    large = exponents_of([run for run in runs if run.harmonics >= FEWEST_FITTED]).get("cpu_seconds_to_a_fifth")
    return Table(
        caption=f"Beside what is asked of one core (seconds do not gate); exponents p of cost ~ harmonics^p, the last "
        f"from {FEWEST_FITTED} harmonics on, to a contact fraction of {FRACTION:g}.",
        columns=["quantity", "found", "at most"],
        rows=[["CPU seconds of the slowest run", plain(_worst(run.cpu_seconds for run in _of_paper(runs))), SECONDS],
              *([f"exponent of {name.replace('_', ' ')}", order, None] for name, order in exponents.items()),
              ["exponent of CPU seconds", large, EXPONENT]]
    )  # fmt: skip


def _of_paper(runs: Sequence[Cost]) -> Sequence[Cost]:
    """Those with the harmonics of the paper at the default increment; all where there are none."""
    return [run for run in runs if run.harmonics == PAPER_HARMONICS and run.increment == INCREMENT] or runs


def _table(caption: str, columns: list[str], found: Iterable[Mapping[str, Any]]) -> Table:
    rows = [[plain(one[name]) for name in columns] for one in found]
    return Table(caption=caption, columns=[name.replace("_", " ") for name in columns], rows=rows)


def _figures(runs: Sequence[Cost]) -> tuple[Figure, ...]:
    """Seconds, memory and unknowns against harmonics, when more than one number of them ran."""
    curve = _curve(runs)
    if len({run.harmonics for run in curve}) < 2:
        return ()
    sizes = [run.harmonics for run in curve]
    shown = {"CPU seconds": "cpu_seconds", "peak MB": "peak_megabytes", "unknowns": "unknowns", "patches": "patches"}
    lines = [trace(label, sizes, [getattr(run, name) for run in curve]) for label, name in shown.items()]
    return (drawn("harmonics", "The paper's profile to 0.025 E*, seed 0.", loglog("harmonics", "cost", *lines)),)


def _complete(run: Cost) -> bool:
    return run.status == "converged" and len(run.separations) == run.loads_asked_for > 0


def _told(error: object) -> str:
    """Kind and text of what came in place of an answer."""
    return f"{type(error).__name__}: {error}"


def _only(values: Sequence[float]) -> float:
    return values[0] if values else math.nan


def _change(coarse: Sequence[float], fine: Sequence[float], asked: int) -> float:
    """Largest relative change; infinite unless every load asked for is on both sides."""
    if not len(coarse) == len(fine) == asked or not asked:
        return math.inf
    return _worst(abs(a - b) / abs(b) if b else math.inf for a, b in zip(coarse, fine, strict=True))


def _worst(values: Iterable[float]) -> float:
    """The largest; nan when the values are empty or one is not a number."""
    known = list(values)
    return math.nan if not known or any(math.isnan(value) for value in known) else max(known)
