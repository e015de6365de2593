"""What the paper's profile costs: seconds, memory and counts of each realisation, and whether its path is converged.

The benchmark (quick) runs seeds 0, 1, 2 with 1000 harmonics to 0.025 E*, each alone in a process on one thread, and
again at a quarter of the increment: contact fraction and separation at the loads asked for must not change beyond
1e-6 of themselves.  The full study does so for seeds 0 to 30; it adds seed 0 with 125 to 8000 harmonics and fits
exponents, of the whole curve and of its part up to a contact fraction of a fifth.  Seed 0 is also taken
apart, stage by stage and against patches (cost_breakdown.py), in a run of its own.  Without adhesion, where no path is
needed, single loads are solved up to 100,000 harmonics.  A run that fails is a line with its message; finished runs are
kept (harness/store.py).  Counts, memory and digits gate; seconds are those of the machine at hand.
"""

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

import bem
from bem.scene.result import FINAL_STATUSES, Progress, State
from bem.scene.scene import Scene, parse_scene
from validation.harness.compare import fitted_order
from validation.harness.execution import Listener, Note
from validation.harness.provenance import provenance
from validation.harness.schema import Table
from validation.harness.store import plain, store_in, write_json
from validation.references import adapters
from validation.report.study_figures import Line, Plot, write_svg
from validation.studies.cost_breakdown import Breakdown, dissected, figures_of, patch_exponents, stage_exponents
from validation.studies.cost_breakdown import sentences as breakdown_sentences
from validation.studies.shown import peak_megabytes

SCHEMA = "linecontact-cost/1"
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
class Cost:
    """What a realisation cost, and what path convergence is judged by."""

    seed: int
    harmonics: int
    increment: float
    load: float | None
    status: str
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


def run(
    folder: Path,
    quick: bool,
    report: Listener,
    realisations: Sequence[PaperRun] | None = None,
    measure: Callable[[PaperRun], Cost] | None = None,
    dissect: Callable[[int], Breakdown] | None = dissected,
) -> int:
    """Run the study, print its table, write cost.json; 1 when anything that gates is not reached.

    Quick: only the benchmark. Other realisations than those of the study may be given, and other measurements of a
    realisation and of a path taken apart, importable by name; None leaves the latter out.
    """
    chosen = realisations_of(quick) if realisations is None else list(realisations)
    facts, store, measure = provenance(), store_in(folder, report), measure or measured
    found: list[Cost] = []
    for done, one in enumerate(chosen, 1):
        answer = store.alone(Cost, measure, one, one.name, one, measure.__qualname__)
        found.append(answer if isinstance(answer, Cost) else Cost(**vars(one), status=_told(answer)))
        report(Note(f"[{done}/{len(chosen)}] {_line(found[-1])}"))
        _write(folder, facts, found, len(chosen), [])
    runs, _ = _on_paths(found)
    apart: list[Breakdown] = []
    for harmonics in sorted({one.harmonics for one in runs if one.seed == 0 and one.increment == INCREMENT}):
        if dissect is not None:
            name = f"{harmonics} harmonics, stage by stage"
            taken = store.alone(Breakdown, dissect, harmonics, name, dissect.__qualname__)
            apart.append(taken if isinstance(taken, Breakdown) else Breakdown(harmonics, _told(taken), {}, {}, ()))
            _write(folder, facts, found, len(chosen), apart)
    print(HEADING, *map(_line, found), sep="\n")
    for name, order in exponents_of(runs).items():
        print(f"{name} grows as harmonics^{order:.2f}")
    for line in breakdown_sentences(apart):
        print(line)
    for name, plot in [*_figures(runs), *figures_of(apart)]:
        write_svg(plot, folder / f"{name}.svg")
    met = judged(found, drifts_of(runs))
    for name, text, good, _ in met:
        print(f"{'met' if good else 'NOT MET'}: {name}: {text}")
    return 0 if all(good for _, _, good, gates in met if gates) else 1


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
        worst_closure=max((state.certificate.closure or 0.0 for state in result.states), default=math.nan),
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


def judged(found: Sequence[Cost], drifts: Sequence[Drift]) -> list[tuple[str, str, bool, bool]]:
    """What is asked for: name, what was found, whether it is met, whether it gates."""
    runs, dry = _on_paths(found)
    paper = [run for run in runs if run.harmonics == PAPER_HARMONICS and run.increment == INCREMENT] or runs
    slowest, largest = _worst(run.cpu_seconds for run in paper), _worst(run.peak_megabytes for run in paper)
    closure = _worst(run.worst_closure for run in runs)
    unfinished = [f"seed {run.seed}, {run.harmonics}: {run.status}" for run in runs if not _complete(run)]
    failed = sum(run.failed_states for run in runs)
    not_ok = sum(run.certificates_not_ok for run in runs)
    area = _worst(drift.contact_fraction for drift in drifts)
    gap = _worst(drift.separation for drift in drifts)
    bare = [f"{one.harmonics}, {one.load:g} E*: {one.status}" for one in dry if one.status != "converged"]
    met = [
        ("every load reached", "; ".join(unfinished) or f"{len(runs)} runs", not unfinished, True),
        ("no failed state", f"{failed}", failed == 0, True),
        ("every certificate ok", f"{not_ok} are not", not_ok == 0, True),
        (f"closure <= {CLOSURE:g}", f"{closure:.1e}", closure <= CLOSURE, True),
        (f"contact fraction at a quarter of the increment within {DRIFT:g}", f"{area:.1e}", area <= DRIFT, True),
        (f"separation at a quarter of the increment within {DRIFT:g}", f"{gap:.1e}", gap <= DRIFT, True),
        (f"below {MEGABYTES:g} MB", f"{largest:.0f} MB", largest < MEGABYTES, True),
        (f"at most {SECONDS:g} s of one core (not gating)", f"{slowest:.1f} s", slowest <= SECONDS, False),
    ]
    exponent = exponents_of([run for run in runs if run.harmonics >= FEWEST_FITTED]).get("cpu_seconds_to_a_fifth")
    if exponent is not None:
        name = f"CPU seconds to a contact fraction of {FRACTION:g} grow no faster than harmonics^{EXPONENT:g}"
        met.append((f"{name} (not gating)", f"exponent {exponent:.2f}", exponent <= EXPONENT, False))
    if dry:
        met.append(("every load without adhesion certified", "; ".join(bare) or f"{len(dry)} loads", not bare, True))
    return met


def _write(
    folder: Path, facts: dict[str, Any], found: Sequence[Cost], planned: int, apart: Sequence[Breakdown]
) -> None:
    runs, dry = _on_paths(found)
    drifts = drifts_of(runs)
    bare = [vars(one) | {"contact_fraction": _only(one.contact_fractions), "closure": one.worst_closure} for one in dry]
    content = {
        "schema": SCHEMA,
        "provenance": facts,
        "planned": planned,
        "runs": [{name: value for name, value in asdict(one).items() if name != "load"} for one in runs],
        "table": _table("Cost of loading the paper's profile to 0.025 E*, one thread.", ON_PATHS, map(vars, runs)),
        "without_adhesion": _table(
            "Cost of single loads on the paper's profile without adhesion, one thread.", BARE, bare
        ),
        "drifts": [asdict(drift) for drift in drifts],
        "exponents": exponents_of(runs),
        "breakdown": [asdict(one) | {"patch_exponents": patch_exponents(one)} for one in apart],
        "stage_exponents": stage_exponents(apart),
        "met": {name: bool(good) for name, _, good, _ in judged(found, drifts)},
    }
    write_json(folder / FILE, content)


def _table(caption: str, columns: list[str], found: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    rows = [[plain(one[name]) for name in columns] for one in found]
    return Table(caption=caption, columns=columns, rows=rows).model_dump(mode="json")


def _figures(runs: Sequence[Cost]) -> list[tuple[str, Plot]]:
    """Seconds, memory and unknowns against harmonics, when more than one number of them ran."""
    curve = _curve(runs)
    if len({run.harmonics for run in curve}) < 2:
        return []
    sizes = [float(run.harmonics) for run in curve]
    shown = {"CPU seconds": "cpu_seconds", "peak MB": "peak_megabytes", "unknowns": "unknowns", "patches": "patches"}
    lines = [Line(label, sizes, [float(getattr(run, name)) for run in curve]) for label, name in shown.items()]
    return [("cost-harmonics", Plot("The paper's profile to 0.025 E*, seed 0", "harmonics", "", lines))]


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


HEADING = (
    "seed harmonics increment  wall/s   cpu/s     MB unknowns patches evaluations accepted rejected events states "
    "failed not-ok closure status"
)


def _line(found: Cost) -> str:
    if found.load is not None:
        return (
            f"without adhesion, {found.harmonics} harmonics, {found.load:g} E*: {found.cpu_seconds:.1f} s, "
            f"{found.peak_megabytes:.0f} MB, {found.patches} patches, {found.evaluations} evaluations, "
            f"contact fraction {_only(found.contact_fractions):.6f}, closure {found.worst_closure:.1e}, {found.status}"
        )
    return (
        f"{found.seed:4d} {found.harmonics:9d} {found.increment:9.4f} {found.wall_seconds:7.1f} "
        f"{found.cpu_seconds:7.1f} {found.peak_megabytes:6.0f} {found.unknowns:8d} {found.patches:7d} "
        f"{found.evaluations:11d} {found.accepted:8d} {found.rejected:8d} {found.events:6d} {found.states:6d} "
        f"{found.failed_states:6d} {found.certificates_not_ok:6d} {found.worst_closure:.1e} {found.status}"
    )
