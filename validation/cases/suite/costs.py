"""What accuracy costs by every route, and what each effect of a scene costs.

Error against seconds, on a smooth and two rough contacts, comes from the stored study (corpus/accuracy_costs.py); the
boundary elements solve the contacts again here, so that stored and present stand beside each other, the paper's profile
event by event and in leaps.  Seconds are of one thread and gate nothing.
"""

import time
from collections.abc import Iterable

import numpy as np

import bem
import fem_reference
from bem.scene.result import Result
from bem.scene.scene import parse_scene
from validation.cases.shared.checks import OVER_STATES, Against, Found, case, work
from validation.corpus.accuracy_costs import CostPoint, stored
from validation.corpus.effects import EFFECTS, Times, costs_of, loaded_alone, rough
from validation.harness.figure_data import drawn, loglog, marks, trace
from validation.harness.schema import Cells, Figure, Series, Table
from validation.references.closed_forms import Sinusoid
from validation.references.posed_contacts import Posed, answer_of, exact_sinusoid, scene_tables, scenes

FRACTION, THICK = 0.6, 2.0  # contact fraction of the wave at given edges; thickness of its layer in periods
MESH = (2, 12, 12)  # order, cells, tip levels
TOLERANCE = 1e-8  # of the contacts solved again
LEAPS = 1e-2, 1e-3, 1e-4  # and of the paper's profile in leaps
SMALLEST_SHOWN = 1e-16
ROUTES = {  # of the stored points: their label and colour, in the order of the legend
    "bem": ("boundary elements", 0),
    "bem, dense": ("boundary elements, edges near the answer given", 0),
    "fem (2": ("finite elements, P2", 1),
    "fem (4": ("finite elements, P4", 1),
    "paper's method": ("the paper's method", 2),
    "fft, c = 8": ("FFT grid, cohesion along 8 spacings", 3),
    "fft, c = 16": ("FFT grid, along 16", 3),
    "persson, by separation": ("Persson's theory", 4),
}
DASHED = ("bem, dense", "fem (4", "fft, c = 16")
HARMONICS, RUNS = 30, 3


def curves_of(points: Iterable[CostPoint]) -> tuple[list[Series], str]:
    """A curve for every route with two points or more, and which others are left out, in a sentence."""
    by_route: dict[str, list[CostPoint]] = {}
    for point in points:  # finite elements by their order
        route = f"{point.route} {point.setting[:2]}" if point.route == "fem" else point.route
        by_route.setdefault(route, []).append(point)
    curves: list[Series] = []
    alone = []
    for route, (label, hue) in ROUTES.items():
        chosen = by_route.get(route, [])
        if len(chosen) == 1:
            alone.append(label)
        if len(chosen) > 1:
            seconds = [point.cpu_seconds for point in chosen]
            errors = [max(point.error, point.floor, SMALLEST_SHOWN) for point in chosen]
            style = "dashed" if route in DASHED else "line"
            curves += [trace(label, seconds, errors, style, hue), marks("", seconds, errors, hue)]
    return curves, f" Left out, as one point is no curve: {', '.join(alone)}." if alone else ""


def _again(posed: Posed, tolerance: float = TOLERANCE) -> tuple[Result, float]:
    """The contact solved again by the boundary elements, and the CPU seconds of it."""
    scene = parse_scene(scene_tables(posed) | {"accuracy": {"tolerance": tolerance}})
    begun = time.process_time()
    found = bem.solve(scene)
    return found, time.process_time() - begun


def _figure(
    name: str, title: str, scene: str, crosses: str, again: list[tuple[float, float]], reference: str
) -> Figure:
    """The stored points of a scene, and (seconds, error) of this run as crosses."""
    known = stored()
    curves, left_out = curves_of(point for point in known.points if point.scene == scene)
    caption = (
        f"{title}: error of contact fraction or mean pressure, the larger, against CPU seconds on one thread; every "
        f"route finds its own contact. Against {reference}; no point is drawn below the uncertainty of its reference. "
        f"Curves were measured on {known.date} on {known.machine}; crosses in this run.{left_out}"
    )
    seconds, errors = zip(*again, strict=True)
    crossed = marks(crosses, seconds, [max(error, SMALLEST_SHOWN) for error in errors], hue=5)
    return drawn(name, caption, loglog("CPU seconds", "error", *curves, crossed))


def _costs() -> Found:
    posed = scenes()
    found, of_wave = _again(posed["sinusoid"])
    smooth, exact = found.targets[-1], exact_sinusoid(posed["sinusoid"])
    answer = answer_of(smooth.contact_fraction, smooth.mean_pressure, smooth.elastic_energy, 0.0)
    errors = posed["sinusoid"].errors(answer, exact)
    error = max(errors["contact_fraction"], errors["mean_pressure"])
    _, of_rough = _again(posed["rough"])
    floor = next(point for point in stored().points if (point.scene, point.route) == ("rough", "bem"))
    exact_path, _ = _again(posed["paper"])
    leaps = [_again(posed["paper"], tolerance) for tolerance in LEAPS]
    off = [_apart(found, exact_path) for found, _ in leaps]
    of_leaps = [(took, error) for (_, took), error in zip(leaps, off, strict=True)]
    yield from _given_edges()
    yield _figure("cost-smooth", "Smooth, one adhesive wave", "sinusoid", "boundary elements, this run",
                  [(of_wave, error)], "Johnson's closed form")  # fmt: skip
    yield _figure("cost-rough", "Rough, 60 harmonics and nine contacts, from first touch", "rough",
                  "boundary elements, this run", [(of_rough, max(floor.error, floor.floor))],
                  "the boundary elements, and these against the paper's method extrapolated; finite elements begin at "
                  "edges of the paper's method with four cells, which are in their seconds")  # fmt: skip
    yield _figure(
        "cost-paper", "The paper's profile, 1000 harmonics, six separations on the way in, up to 39 contacts", "paper",
        "boundary elements in leaps, this run", of_leaps,
        "the boundary elements at 1e-12 in a quarter of the increment, as no other code here "
        "reaches it. Their tolerances are 1e-2, 1e-3, 1e-4 (leaps, from the left), 1e-6, 1e-8, 1e-9 (event by "
        "event). In leaps states are as exact, unless one is of another branch: then it is off by up to some "
        "per cent")  # fmt: skip
    yield Against("exact", "Johnson 1995").row("contact fraction, solved again", "", exact["contact_fraction"],
                                               smooth.contact_fraction, (3.5e-14, 1.3e-14), "absolute",
                                               uncertainty=smooth.error_estimate.contact_fraction or 0.0)  # fmt: skip
    yield Against("self", "the path event by event at 1e-8").row(
        "contact fraction of the paper's profile in leaps at 1e-2, 1e-3, 1e-4", "", [0.0] * len(LEAPS), off,
        (5e-12, 1.7e-12), OVER_STATES, 1.0)  # fmt: skip
    yield {f"evaluations in leaps at {tolerance:g}": work("evaluations", found)["evaluations"]
           for tolerance, (found, _) in zip(LEAPS, leaps, strict=True)}  # fmt: skip
    yield {"evaluations event by event": work("evaluations", exact_path)["evaluations"]}


def _apart(found: Result, other: Result) -> float:
    """Largest difference of the contact fractions of two results."""
    pairs = zip(found.targets, other.targets, strict=True)
    return max(abs(one.contact_fraction - two.contact_fraction) for one, two in pairs)


def _given_edges() -> Found:
    """Both codes at given edges of one adhesive wave against Johnson."""
    wave = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3)
    psi, period = FRACTION * np.pi / 2, wave.wavelength
    penetration, pressure = float(wave.penetration(psi)), float(wave.mean_pressure(psi))
    star, critical = wave.full_contact_pressure, float(np.sqrt(2 * wave.modulus * wave.work_of_adhesion))
    edges = [[period * (1 - FRACTION / 2), period * (1 + FRACTION / 2)]]
    solid = bem.Solid(wave.youngs_modulus, wave.poisson_ratio)
    ours = bem.ContactState(bem.Profile.from_harmonics(period, [1], [wave.amplitude]), solid, edges, penetration,
                            tolerance=1e-13)  # fmt: skip
    fem = fem_reference.solve(youngs_modulus=wave.youngs_modulus, poisson_ratio=wave.poisson_ratio,
                              thickness=THICK * period, period=period, harmonics=([1], [wave.amplitude], [0.0]),
                              control="penetration", value=penetration, edges=edges,
                              resolution=fem_reference.Resolution(*MESH))  # fmt: skip
    johnson = Against("exact", "Johnson 1995, contact fraction 0.6, alpha 0.3")
    uncertain = {name: float(np.max(fem.uncertainty[name])) for name in ("mean_pressure", "stress_intensity")}
    yield johnson.row("mean pressure over p*, boundary elements", "Pa", pressure, ours.mean_pressure, (2e-15, 4.4e-16),
                      "absolute", star)  # fmt: skip
    yield johnson.row("mean pressure over p*, finite elements", "Pa", pressure, fem.mean_pressure, 2.5e-5, "absolute",
                      star, code="fem", uncertainty=uncertain["mean_pressure"])  # fmt: skip
    yield johnson.row("stress intensity over critical, finite elements", "Pa m^1/2", critical,
                      float(fem.stress_intensity.max()), 1.9e-4, "absolute", critical, code="fem",
                      uncertainty=uncertain["stress_intensity"])  # fmt: skip
    yield {"unknowns of the finite elements": fem.unknowns}


def _prices() -> Found:
    """Seconds and evaluations of the rough scene with each effect; what an absent one costs."""
    found = costs_of({effect.name: rough(effect.changes, HARMONICS) for effect in EFFECTS}, RUNS)
    lines: list[Cells] = []
    for effect in EFFECTS:
        own, base = found[effect.name], found.get(effect.on_top_of)
        times, without = (str(Times.of(own, base)), base.evaluations) if base else ("–", None)
        lines.append([effect.name, effect.on_top_of or "–", float(f"{own.least:.2g}"), times, own.evaluations, without])
    loaded = loaded_alone(HARMONICS)
    absent = "0: no module of theirs is loaded" if not loaded else f"loads {', '.join(loaded)}"
    lines.append(["any effect, absent", "bare", absent, "–", found["bare"].evaluations, found["bare"].evaluations])
    yield Table(
        id="price-effects",
        caption=f"CPU seconds of a rough scene of {HARMONICS} harmonics with each effect, on one thread of this run, "
        f"the least of {RUNS} runs in alternation, over those of the scene that it is put on top of. After ±: what "
        "repetition changes; no more: the scene with it takes no longer than that. Evaluations depend on no machine.",
        columns=["effect", "on top of", "seconds", "times the scene without it", "evaluations", "without it"],
        rows=lines,
    )
    yield Against("exact", "none is called").count("modules of absent effects that a bare scene loads", 0.0,
                                                   len(loaded))  # fmt: skip
    yield {f"evaluations, {name}": cost.evaluations for name, cost in found.items()}


CASES = (
    case("what-accuracy-costs", "convergence", _costs,
         "How many seconds does a digit cost, by every route, on a smooth and on rough contacts?",
         r"$p = p^\ast [\sin^2 \psi - \alpha \sqrt{\tan \psi}]$, $K = \sqrt{2 E^\ast \gamma}$",
         "johnson1995 carbone2009", "half_space adhesion", problem="adhesive wave, given edges"),
    case("price-of-effects", "cost", _prices,
         "What does each effect of a scene cost, and does one that is absent cost nothing?",
         "CPU seconds and evaluations of the scene with the effect, over those without",
         "carbone2009", "half_space layer adhesion slope_term", code="suite"),
)  # fmt: skip
