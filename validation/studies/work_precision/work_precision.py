"""What accuracy costs: seconds against achieved error for every method, on contacts with a reference of another code.

Protocol: one process for every scene and method, one thread, the coarsest setting first as a warm-up, then every
setting up to 20 times or 2 s (quick: twice or 0.3 s), the least wall time and the spread of the others, the least CPU
time, largest memory of the process so far, and set-up, solution and evaluation apart.  Curves and conclusion go by CPU
time: on one thread it is the wall time of an idle machine, and others do not add to it.  Errors of all quantities are
kept; the curve shows the larger of those of contact fraction and mean pressure.  Points below the uncertainty of their
reference are grey, failed ones stay with their message.  Counts, not seconds, are what could be gated.
"""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import partial
from typing import Any

from validation.corpus.accuracy_costs import FILE as STORED
from validation.corpus.accuracy_costs import AccuracyCosts, CostPoint
from validation.corpus.effects import loaded_for_nothing
from validation.harness.case import Case, CaseError, Found
from validation.harness.figure_data import drawn, loglog, shaded, trace
from validation.harness.schema import Cells, Figure, Row, Series, Table
from validation.harness.store import Store, plain, write_json
from validation.references.posed_contacts import Posed, numbers_of, scenes
from validation.routes import cohesive_grid
from validation.studies.bench import Bench, failed, none_of, study_case
from validation.studies.shown import peak_megabytes
from validation.studies.work_precision.conclusion import MethodCurve, Spot, sentences
from validation.studies.work_precision.methods import METHODS, SHOWN, Method, MethodPoint, Timed, by_method
from validation.studies.work_precision.peers import FFT_METHODS, PEER_COLUMNS, peer_sentences, peer_table
from validation.studies.work_precision.price_list import Price, digits_of, priced
from validation.studies.work_precision.price_list import sentences as price_sentences
from validation.studies.work_precision.references import SOURCES, Source, Yardstick, source_for

SCHEMA = "linecontact-work-precision/3"
FILE = "work-precision.json"
QUICK_SCENES = ("sinusoid", "theory")
QUICK_PRICES, PRICES = (60, 3), (250, 3)  # harmonics of the rough scene, runs of each effect
PRICE_COLUMNS = ["effect", "on top of", "CPU seconds", "times the scene without it", "evaluations", "digits",
                 "reference"]  # fmt: skip
SMALLEST_SHOWN = 1e-17  # error
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
    points: list[MethodPoint] = field(default_factory=list)
    failures: list[Row] = field(default_factory=list)
    prices: list[Price] = field(default_factory=list)
    loaded: list[str] | None = None  # modules that the bare scene has for nothing; None: nobody looked

    @property
    def conclusion(self) -> list[str]:
        """What points and prices say, in words, scene by scene."""
        said = [line for scene in self.posed for line in sentences(scene, curves_of(self.points, scene))]
        said += peer_sentences(self.points)
        return said + price_sentences(self.prices, self.loaded or []) if self.prices else said

    def found(self) -> Found:
        """What the report has of it."""
        answered = {(point.scene, point.method): False for point in self.points}
        answered |= {(point.scene, point.method): True for point in self.points if not math.isnan(point.error)}
        without = [f"{scene}, {method}" for (scene, method), known in answered.items() if not known]
        yield none_of("methods without an answer at any setting of a scene", without)
        if self.loaded is not None:
            yield none_of("modules of absent effects that the bare scene loads", self.loaded)
        yield from self.failures
        yield from figures_of(self.points, self.posed)
        yield from self._tables()

    def _tables(self) -> Iterator[Table]:
        yield Table(caption="What to choose.", columns=["conclusion"], rows=[[line] for line in self.conclusion])
        yield Table(caption="All settings; errors of contact fraction or mean pressure, the larger.",
                    columns=COLUMNS, rows=list(map(_row, self.points)))  # fmt: skip
        if compared := peer_table(self.points):
            yield Table(caption="FFT solvers.", columns=list(PEER_COLUMNS), rows=compared)
        if self.prices:
            yield Table(
                caption="The price of each effect.", columns=PRICE_COLUMNS,
                rows=[[p.effect, p.on_top_of, plain(p.seconds), str(p.times or ""), p.evaluations, digits_of(p),
                       p.reference] for p in self.prices]
            )  # fmt: skip
        left_out = [[m.name, f"not run on {scene}: {why}"] for m in self.methods for scene, why in m.cannot.items()
                    if scene in self.posed]  # fmt: skip
        if absent := cohesive_grid.missing():
            left_out.append(["fft", f"not run: {absent}"])
        rows: list[Cells] = [[m.name, f"{m.knob} is the knob; fixed: {m.fixed}"] for m in self.methods]
        yield Table(caption="The methods, and what they cannot do.", columns=["method", "in words"],
                    rows=[*rows, *left_out])  # fmt: skip

    def write(self, bench: Bench) -> None:
        """work-precision.json, and what validation/corpus keeps of it."""
        methods = [
            {"name": m.name, "knob": m.knob, "fixed": m.fixed, "settings": [str(s) for s in m.settings],
             "scenes": list(m.scenes), "not run on": dict(m.cannot)}
            for m in self.methods
        ]  # fmt: skip
        points = [asdict(point) | {"error": point.error, "within_uncertainty": point.grey} for point in self.points]
        bench.write(FILE, SCHEMA, threads=1, scenes={name: asdict(posed) for name, posed in self.posed.items()},
                    methods=methods, points=points, conclusion=self.conclusion,
                    prices=[asdict(price) | {"digits": price.digits} for price in self.prices])  # fmt: skip
        if not bench.quick:
            write_json(bench.folder / STORED, asdict(kept_costs(self.points, bench.facts)))


def cases(
    bench: Bench,
    methods: Sequence[Method] = METHODS,
    sources: dict[str, tuple[Source, ...]] = SOURCES,
    with_prices: bool = True,
    peers: bool = False,
) -> list[Case]:
    """The case of the study. Quick: fewer scenes, settings and repeats.

    Other methods and references (by scene) than those of the study may be given, and the price list left out. `peers`:
    the scenes of the FFT peers only, side by side; else they take part where their extra is installed. CaseError where
    they are asked for and not installed.
    """
    absent = cohesive_grid.missing()
    if peers and absent:
        raise CaseError(f"--peers: {absent}")
    if methods is METHODS and not absent:
        methods = (*METHODS, *FFT_METHODS)
    chosen = {
        name: posed
        for name, posed in scenes().items()
        if (not bench.quick or name in QUICK_SCENES) and (not peers or name in FFT_METHODS[0].scenes)
    }
    results = Results(bench.quick, methods, chosen)
    return [
        study_case("work-precision", partial(_measured, bench, results, sources, with_prices and not peers),
                   "Which error does each method reach in which time, and what does each effect of a scene cost?",
                   "error of contact fraction and mean pressure, the larger, over their scales; CPU seconds of one "
                   "thread", "johnson1995 carbone2009", "half_space layer adhesion")
    ]  # fmt: skip


def _measured(bench: Bench, results: Results, sources: dict[str, tuple[Source, ...]], with_prices: bool) -> Found:
    for posed in results.posed.values():
        taking_part = [method for method in results.methods if posed.id in method.scenes]
        references = _references(posed, taking_part, sources, bench.store, results.failures)
        for method in taking_part:
            reference = references.get(source_for(posed.id, method, sources).name)
            timed = _swept(posed, method, bench.quick, bench.store)
            results.points += [point_of(posed, method, one, reference) for one in timed]
    if with_prices:
        _price(results, bench.store)
    results.write(bench)
    yield from results.found()


def _swept(posed: Posed, method: Method, quick: bool, store: Store) -> list[Timed]:
    """All settings of a method on a scene, kept or measured in a process of their own."""
    sweep = Sweep(posed, method, method.settings_for(posed.id, quick), *(SECONDS if quick else REPEATS))
    decides = (posed, method.fixed, sweep.settings, sweep.repeats, sweep.seconds)
    answer = store.alone(list[Timed], measured, sweep, f"{posed.id}, {method.name}", *decides)
    return answer if isinstance(answer, list) else [Timed("all", f"{type(answer).__name__}: {answer}")]


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
            Spot(point.timed.setting, max(point.error, point.floor), point.timed.cpu_seconds) for point in known
        )
        independent = not known[0].reference.endswith("(self)")
        curves.append(MethodCurve(name, known[0].reference, spots, known[0].floor, independent))
    return curves


def figures_of(points: Sequence[MethodPoint], chosen: Mapping[str, Posed]) -> Iterator[Figure]:
    """A figure for every scene: what each reference cannot resolve is shaded, points within it are grey."""
    for scene, posed in chosen.items():
        found = by_method(points, scene)
        lost = [f"{p.method} at {p.timed.setting}: {p.timed.status}" for p in points
                if p.scene == scene and p.timed.found is None]  # fmt: skip
        if not found:
            continue
        curves = [one for hue, (name, known) in enumerate(found.items()) for one in _curve(name, known, hue)]
        references = {
            known[0].reference: (hue, known[0].floor) for hue, known in reversed([*enumerate(found.values())])
        }
        times = [point.timed.cpu_seconds for known in found.values() for point in known]
        least = min(_shown(point) for known in found.values() for point in known)
        shades = [
            shaded("", [min(least, floor) / 4, floor], [min(times)] * 2, [max(times)] * 2, hue)
            for hue, floor in references.values() if floor > 0
        ]  # fmt: skip
        yield drawn(
            f"cost-{scene}",
            f"{posed.title}, against {'; '.join(references)}. Beside the points: unknowns. Shaded: the uncertainty of "
            f"the reference; grey: points within it.{''.join(f' Failed: {one}.' for one in lost)}",
            loglog("error of contact fraction and mean pressure, the larger", "CPU time / s, one thread", *curves,
                   *shades)
        )  # fmt: skip


def _curve(name: str, known: Sequence[MethodPoint], hue: int) -> Iterator[Series]:
    """The points of a method, joined, with their unknowns; those that its reference does not resolve in grey."""
    at, seconds = list(map(_shown, known)), [point.timed.cpu_seconds for point in known]
    unknowns = [point.timed.found.unknowns if point.timed.found else "" for point in known]
    yield trace(name, at, seconds, hue=hue)
    yield trace("", at, seconds, "points", hue).noted(unknowns)
    grey = [(x, y) for x, y, point in zip(at, seconds, known, strict=True) if point.grey]
    if grey:
        yield trace("", [x for x, _ in grey], [y for _, y in grey], "grey", hue)


def _shown(point: MethodPoint) -> float:
    """Its error, where it can be drawn."""
    return max(point.error, SMALLEST_SHOWN)


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


def _price(results: Results, store: Store) -> None:
    """The price list, and what the bare scene loads."""
    harmonics, runs = QUICK_PRICES if results.quick else PRICES
    answer = store.alone(list[Price], priced, (harmonics, runs), f"price list, {harmonics} harmonics", runs)
    loaded = store.alone(list[str], loaded_for_nothing, harmonics, "the bare scene, alone", harmonics)
    if isinstance(answer, list):
        results.prices = answer
    else:
        results.failures.append(failed("price list", answer))
    if isinstance(loaded, list):
        results.loaded = loaded
    else:
        results.failures.append(failed("modules of the bare scene", loaded))


def _references(
    posed: Posed, methods: Sequence[Method], known: dict[str, tuple[Source, ...]], answers: Store, failures: list[Row]
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
            failures.append(failed(task, answer))
    return found


COLUMNS = ["scene", "method", "setting", "unknowns", "error", "of it the reference's", "wall / s", "spread", "CPU / s",
           "MB", "repeats", "status"]  # fmt: skip


def _row(point: MethodPoint) -> Cells:
    timed = point.timed
    unknowns = timed.found.unknowns if timed.found else None
    reported = timed.status if timed.found is None or not point.grey else "within the uncertainty of its reference"
    return [point.scene, point.method, timed.setting, unknowns,
            *map(plain, (point.error, point.floor, timed.wall_seconds, timed.spread, timed.cpu_seconds,
                         timed.peak_megabytes)),
            timed.repeats, reported]  # fmt: skip


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
