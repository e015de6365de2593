"""What accuracy costs: seconds against achieved error for every method, on contacts with a reference of another code.

Protocol: one process for every scene and method, one thread, the coarsest setting first as a warm-up, then every
setting up to 20 times or 2 s (quick: twice or 0.3 s), the least wall time and the spread of the others, the least CPU
time, largest memory of the process so far, and set-up, solution and evaluation apart.  Curves and conclusion go by CPU
time: on one thread it is the wall time of an idle machine, and others do not add to it.  Errors of all quantities are
kept; the curve shows the larger of those of contact fraction and mean pressure.  Points below the uncertainty of their
reference are grey, failed ones stay with their message.  Counts, not seconds, are what could be gated.  Each finished
curve, reference and price list is kept (harness/store.py).
"""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from validation.corpus.accuracy_costs import FILE as STORED
from validation.corpus.accuracy_costs import AccuracyCosts, CostPoint
from validation.corpus.effects import loaded_for_nothing
from validation.harness.case import CaseError
from validation.harness.execution import Listener
from validation.harness.provenance import provenance
from validation.harness.store import Store, store_in, write_json
from validation.references.posed_contacts import Posed, numbers_of, scenes
from validation.report.study_figures import Line, Plot, write_svg
from validation.routes import cohesive_grid
from validation.studies.shown import peak_megabytes, text_table
from validation.studies.work_precision.conclusion import MethodCurve, Spot, sentences
from validation.studies.work_precision.methods import METHODS, SHOWN, Method, MethodPoint, Timed, by_method
from validation.studies.work_precision.peers import FFT_METHODS, PEER_COLUMNS, peer_sentences, peer_table
from validation.studies.work_precision.price_list import Price, digits_of, priced
from validation.studies.work_precision.price_list import sentences as price_sentences
from validation.studies.work_precision.references import SOURCES, Source, Yardstick, source_for

SCHEMA = "linecontact-work-precision/2"
FILE = "work-precision.json"
QUICK_SCENES = ("sinusoid", "theory")
QUICK_PRICES, PRICES = (60, 3), (250, 3)  # harmonics of the rough scene, runs of each effect
PRICE_COLUMNS = ("effect", "on top of", "cpu/s", "times", "evaluations", "digits", "reference")
REPEATS, SECONDS = (20, 2.0), (2, 0.3)  # most repeats and seconds for them: in full, quick


@dataclass(frozen=True)
class Sweep:
    """A method on a scene, in a process of its own."""

    posed: Posed
    method: Method
    settings: tuple[Any, ...]
    repeats: int
    seconds: float


def measured(task: Sweep) -> list[Timed]:
    """All settings of a task, after a warm-up with the first."""
    answers: list[Timed] = []
    with suppress(Exception):  # which the first setting is going to have too
        task.method.solve(task.posed, task.settings[0])
    for setting in task.settings:
        try:
            answers.append(_timed(task, setting))
        except Exception as error:  # stays as a marker with its message
            answers.append(Timed(str(setting), f"{type(error).__name__}: {error}"))
    return answers


@dataclass
class Results:
    """What a run of the study has so far, and what was asked of it."""

    quick: bool
    methods: Sequence[Method]
    posed: dict[str, Posed]
    facts: dict[str, Any] = field(default_factory=provenance)
    points: list[MethodPoint] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    prices: list[Price] = field(default_factory=list)

    @property
    def conclusion(self) -> list[str]:
        """What the points say, in words, scene by scene."""
        said = [line for scene in self.posed for line in sentences(scene, curves_of(self.points, scene))]
        return [*said, *peer_sentences(self.points)]

    def write(self, folder: Path) -> None:
        """work-precision.json, and what validation/corpus keeps of it."""
        content = {
            "schema": SCHEMA,
            "provenance": self.facts,
            "quick": self.quick,
            "threads": 1,
            "scenes": {name: asdict(posed) for name, posed in self.posed.items()},
            "methods": [
                {"name": m.name, "knob": m.knob, "fixed": m.fixed, "settings": [str(s) for s in m.settings],
                 "scenes": list(m.scenes), "not run on": dict(m.cannot)}
                for m in self.methods
            ],
            "points": [
                asdict(point) | {"error": point.error, "within_uncertainty": point.grey} for point in self.points
            ],
            "peers": cohesive_grid.missing() or "installed",
            "conclusion": self.conclusion,
            "prices": [asdict(price) | {"digits": price.digits} for price in self.prices],
            "failures": self.failures,
        }  # fmt: skip
        write_json(folder / FILE, content)
        write_json(folder / STORED, asdict(kept_costs(self.points, self.facts)))


def run(
    folder: Path,
    quick: bool,
    report: Listener,
    methods: Sequence[Method] = METHODS,
    sources: dict[str, tuple[Source, ...]] = SOURCES,
    with_prices: bool = True,
    peers: bool = False,
) -> int:
    """Run the study, print points, price list and conclusion, write work-precision.json and a figure for each scene.

    1 when a reference fails, or a method on every setting of a scene, or the price list, or when the bare scene loads
    a module of an effect that it does not have. Quick: fewer scenes, settings and repeats. Other methods and
    references (by scene) than those of the study may be given, and the price list left out. `peers`: the scenes of the
    FFT peers only, side by side; else they take part where their extra is installed. CaseError where they are asked
    for and not installed.
    """
    absent = cohesive_grid.missing()
    if peers and absent:
        raise CaseError(f"--peers: {absent}")
    if methods is METHODS and not absent:
        methods = (*METHODS, *FFT_METHODS)
    chosen = {
        name: posed
        for name, posed in scenes().items()
        if (not quick or name in QUICK_SCENES) and (not peers or name in FFT_METHODS[0].scenes)
    }
    results, store = Results(quick, methods, chosen), store_in(folder, report)
    for posed in chosen.values():
        taking_part = [method for method in methods if posed.id in method.scenes]
        references = _references(posed, taking_part, sources, store, results.failures)
        for method in taking_part:
            reference = references.get(source_for(posed.id, method, sources).name)
            found = [point_of(posed, method, timed, reference) for timed in _swept(posed, method, quick, store)]
            results.points += found
            if all(math.isnan(point.error) for point in found):
                results.failures.append(f"{posed.id}, {method.name}: no setting has an answer")
            results.write(folder)
    told = _prices(results, store) if with_prices and not peers else []
    results.write(folder)
    _print(results, told)
    for name, plot in figures_of(results.points, chosen):
        write_svg(plot, folder / f"{name}.svg")
    return 1 if results.failures else 0


def _swept(posed: Posed, method: Method, quick: bool, store: Store) -> list[Timed]:
    """All settings of a method on a scene, kept or measured in a process of their own."""
    sweep = Sweep(posed, method, method.settings_for(posed.id, quick), *(SECONDS if quick else REPEATS))
    decides = (posed, method.fixed, sweep.settings, sweep.repeats, sweep.seconds)
    answer = store.alone(list[Timed], measured, sweep, f"{posed.id}, {method.name}", *decides)
    return answer if isinstance(answer, list) else [Timed("all", f"{type(answer).__name__}: {answer}")]


def _print(results: Results, told: Sequence[str]) -> None:
    columns = ["scene", "method", "setting", "unknowns", "error", "of it the reference's", "wall/s", "spread", "cpu/s",
               "MB", "repeats", "status"]  # fmt: skip
    print(text_table(columns, [_row(point) for point in results.points]))
    for method in results.methods:
        print(f"{method.name}: {method.knob} is the knob; fixed: {method.fixed}")
        for scene, reason in method.cannot.items():
            if scene in results.posed:
                print(f"  not run on {scene}: {reason}")
    if absent := cohesive_grid.missing():
        print(f"fft: not run: {absent}")
    elif compared := peer_table(results.points):
        print(text_table(PEER_COLUMNS, compared))
    if results.prices:
        prices = [[p.effect, p.on_top_of, p.seconds, str(p.times or ""), p.evaluations, digits_of(p), p.reference]
                  for p in results.prices]  # fmt: skip
        print(text_table(PRICE_COLUMNS, prices))
    for line in [*results.conclusion, *told, *(f"FAILED: {message}" for message in results.failures)]:
        print(line)


def point_of(posed: Posed, method: Method, timed: Timed, reference: Yardstick | None) -> MethodPoint:
    """A setting with its errors against a reference; without errors where either failed."""
    if timed.found is None or reference is None:
        return MethodPoint(posed.id, method.name, timed)
    floor = reference.floor(posed, SHOWN)
    errors = posed.errors(numbers_of(timed.found.values), reference.answer)
    return MethodPoint(posed.id, method.name, timed, errors, floor, f"{reference.source} ({reference.kind})")


def curves_of(points: Sequence[MethodPoint], scene: str) -> list[MethodCurve]:
    """Curves of a scene as the conclusion takes them."""
    curves = []
    for name, known in by_method(points, scene).items():
        spots = tuple(
            Spot(point.timed.setting, max(point.error, point.floor, point.doubt), point.timed.cpu_seconds)
            for point in known
        )
        independent = not known[0].reference.endswith("(self)")
        curves.append(MethodCurve(name, known[0].reference, spots, known[0].floor, independent))
    return curves


def figures_of(points: Sequence[MethodPoint], chosen: dict[str, Posed]) -> Iterator[tuple[str, Plot]]:
    """A figure for every scene."""
    for scene, posed in chosen.items():
        found = by_method(points, scene)
        lines = [
            Line(
                label=f"{name}, against {known[0].reference}",
                x=[max(point.error, 1e-17) for point in known],
                y=[point.timed.cpu_seconds for point in known],
                notes=[str(point.timed.found.unknowns) if point.timed.found else "" for point in known],
                grey=[point.grey for point in known],
            )
            for name, known in found.items()
        ]
        bands = {f"uncertainty of {known[0].reference}": known[0].floor for known in found.values()}
        failed = [f"{p.method} at {p.timed.setting}: {p.timed.status}" for p in points
                  if p.scene == scene and p.timed.found is None]  # fmt: skip
        across, up = "error of contact fraction and mean pressure, the larger", "CPU time / s, one thread"
        yield f"work-precision-{scene}", Plot(f"{posed.title} (points: unknowns)", across, up, lines,
                                              bands=list(bands.items()), failures=failed, size=(8.4, 6.0))  # fmt: skip


def _timed(task: Sweep, setting: Any) -> Timed:
    """A setting, repeated; the answer is that of the last."""
    walls: list[float] = []
    cpus: list[float] = []
    found = None
    while not walls or (len(walls) < task.repeats and sum(walls) < task.seconds):
        wall, cpu = time.perf_counter(), time.process_time()
        found = task.method.solve(task.posed, setting)
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    return Timed(
        setting=str(setting),
        found=found,
        wall_seconds=min(walls),
        spread=max(walls) / min(walls) - 1,
        cpu_seconds=min(cpus),
        repeats=len(walls),
        peak_megabytes=peak_megabytes(),
    )


def _prices(results: Results, store: Store) -> list[str]:
    """The price list added, and what it says in words."""
    harmonics, runs = QUICK_PRICES if results.quick else PRICES
    answer = store.alone(list[Price], priced, (harmonics, runs), f"price list, {harmonics} harmonics", runs)
    loaded = store.alone(list[str], loaded_for_nothing, harmonics, "the bare scene, alone", harmonics)
    if not isinstance(answer, list) or not isinstance(loaded, list):
        results.failures.append(f"price list: {answer if isinstance(answer, Exception) else loaded}")
        return []
    if loaded:
        results.failures.append(f"the bare scene loads {', '.join(loaded)}")
    results.prices = answer
    return price_sentences(answer, loaded)


def _references(
    posed: Posed, methods: Sequence[Method], known: dict[str, tuple[Source, ...]], answers: Store, failures: list[str]
) -> dict[str, Yardstick]:
    """The references that these methods need, by name; those that fail are reported."""
    wanted = {source.name: source for source in (source_for(posed.id, method, known) for method in methods)}
    found: dict[str, Yardstick] = {}
    for name, source in wanted.items():
        task = f"{posed.id}, reference: {name}"
        answer = answers.alone(Yardstick, source.compute, posed, task, posed)
        if isinstance(answer, Yardstick):
            found[name] = answer
        else:
            failures.append(f"{posed.id}, reference {name}: {type(answer).__name__}: {answer}")
    return found


def _row(point: MethodPoint) -> list[Any]:
    timed = point.timed
    unknowns = timed.found.unknowns if timed.found else None
    reported = timed.status if timed.found is None or not point.grey else "within the uncertainty of its reference"
    return [point.scene, point.method, timed.setting, unknowns, point.error, point.floor, timed.wall_seconds,
            timed.spread, timed.cpu_seconds, timed.peak_megabytes, timed.repeats, reported]  # fmt: skip


def kept_costs(points: Sequence[MethodPoint], facts: Mapping[str, Any]) -> AccuracyCosts:
    """What validation/corpus keeps of the points: those that have an answer and an error."""
    known = [(point, point.timed.found) for point in points]
    return AccuracyCosts(
        machine=str(facts["processor"]),
        date=str(facts["date"])[:10],
        points=[
            CostPoint(p.scene, p.method, p.timed.setting, found.unknowns, p.timed.cpu_seconds, p.error, p.floor,
                      p.reference)
            for p, found in known if found is not None and not math.isnan(p.error)
        ],
    )  # fmt: skip
