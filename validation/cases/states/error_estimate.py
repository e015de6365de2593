"""Are the error estimates of a state true, and is the tolerance met?  Against closed forms and dense algebra.

Every number that a state reports comes with an estimated error.  Here the true errors are known: sinusoids with and
without adhesion from Johnson's and Westergaard's formulas at the same control, everything else, layers and rough
profiles included, from the equilibrium that dense algebra finds next to the state (dense_equilibrium.py).  An estimate
is good when it bounds the true error, and is not more than a hundred times larger; errors below the resolution of the
reference, 1e-14 of the largest value, count as that.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

import bem
from bem.scene.result import State
from bem.scene.scene import Scene
from validation.cases.shared.checks import Against, Found, case, column, posed, touching
from validation.harness.figure_data import digits, drawn, loglog, marks, table, trace
from validation.references.closed_forms import Sinusoid
from validation.references.dense_equilibrium import reference

TIGHT = 1e-12
RESOLUTION = 1e-14  # of the reference, over the largest value of that quantity in the scene
ORDERS = 100.0
AMPLITUDE, WAVELENGTH = 1e-4, 0.01
LAYER: dict[str, Any] = {"layer": {"thickness": 0.001}, "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3}}
QUANTITIES = (
    "mean_pressure", "contact_fraction", "penetration", "separation", "total_displacement", "elastic_energy",
    "adhesion_energy", "total_energy", "stress_intensity_max", "contact_stiffness",
)  # fmt: skip
KINDS = {  # as they are drawn
    "pressure, contact fraction": ("mean_pressure", "contact_fraction"),
    "displacements": ("penetration", "separation", "total_displacement"),
    "energies": ("elastic_energy", "adhesion_energy", "total_energy"),
    "stress intensity, stiffness": ("stress_intensity_max", "contact_stiffness"),
}
MEASURED_ERROR = {1e-3: 2.7e-9, 1e-6: 2.7e-9, 1e-10: 1.8e-12}  # at the tolerances


@dataclass(frozen=True)
class Number:
    """One reported number: true and estimated error over the largest value of the scene."""

    quantity: str
    scene: str
    tolerance: float
    true: float
    estimate: float

    @property
    def bounded(self) -> bool:
        """Whether the estimate is not below the true error, as far as the reference resolves it."""
        return self.true <= self.estimate + RESOLUTION

    @property
    def ratio(self) -> float:
        """Estimate over the true error, or over what the reference resolves."""
        return self.estimate / max(self.true, RESOLUTION)


def scenes(tolerance: float) -> Iterator[tuple[str, Scene, Sinusoid | None]]:
    """Name, scene, and its closed form where there is one."""

    def at(scene: str, control: str, targets: list[float], **tables: Any) -> Scene:
        loading = {"control": control, "targets": targets}
        return posed(scene, accuracy={"tolerance": tolerance}, loading=loading, **tables)

    for alpha in (0.0, 0.1, 0.5):
        wave = Sinusoid(AMPLITUDE, WAVELENGTH, 1e6, 0.5, alpha)
        adhesion = {"work_of_adhesion": wave.work_of_adhesion} if alpha else None
        scene = at("sinusoid", "penetration", [2e-5, 5e-5, 9e-5, 4e-5], adhesion=adhesion)
        yield f"sinusoid, alpha = {alpha:g}", scene, wave
    scene = at("sinusoid", "mean_pressure", [2e3, 8e3, 1.5e4], adhesion=None)
    yield "sinusoid under load", scene, Sinusoid(AMPLITUDE, WAVELENGTH, 1e6, 0.5, 0.0)
    yield "layer", at("sinusoid", "total_displacement", [1e-5, 5e-5, 9e-5], **LAYER), None
    yield "layer under load", at("sinusoid", "mean_pressure", [1e3, 2e3, 4e3], **LAYER), None
    path, fewer = [70e-6, 45e-6, 30e-6, 50e-6], {"harmonics": 40}
    yield "rough", at("rough_100", "separation", path, profile=fewer), None
    yield "rough, no adhesion", at("rough_100", "separation", path, profile=fewer, adhesion=None), None
    scene = at("rough_100", "mean_pressure", [1e3, 4e3, 9e3], profile=fewer, adhesion=None)
    yield "rough under load", scene, None


def exact(posed: Scene, state: State, wave: Sinusoid | None) -> dict[str, float]:
    """What a state should report: by dense algebra, and by the closed form where there is one."""
    known = reference(posed, state)
    if wave is None:
        return known
    near = state.contact_fraction * np.pi / 2
    loaded = posed.loading.control == "mean_pressure"
    of = wave.mean_pressure if loaded else wave.penetration
    target = state.penetration
    if loaded:
        target = min(posed.loading.targets, key=lambda value: abs(value - state.mean_pressure))
    psi = float(brentq(lambda p: float(of(p)) - target, near * (1 - 1e-5), near * (1 + 1e-5), xtol=1e-16, rtol=1e-15))
    known.update(contact_fraction=psi * 2 / np.pi, mean_pressure=float(wave.mean_pressure(psi)))
    if loaded:
        penetration = float(wave.penetration(psi))
        known.update(penetration=penetration, separation=wave.amplitude - penetration)
    return known


def numbers(name: str, posed: Scene, wave: Sinusoid | None, states: tuple[State, ...]) -> list[Number]:
    """Every number that the states with edges report."""
    there = touching(states)
    known = [exact(posed, state, wave) for state in there]
    scale = {quantity: max(abs(values[quantity]) for values in known) for quantity in QUANTITIES}
    dry = ("adhesion_energy", "stress_intensity_max") if posed.adhesion is None else ()  # zero, but for rounding
    return [
        Number(quantity, name, posed.accuracy.tolerance,
               abs(getattr(state, quantity) - values[quantity]) / scale[quantity], estimate / scale[quantity])
        for state, values in zip(there, known, strict=True)
        for quantity, estimate in asdict(state.error_estimate).items()
        if estimate is not None and scale[quantity] != 0 and quantity not in dry
    ]  # fmt: skip


def distance(posed: Scene, states: tuple[State, ...], tight: tuple[State, ...]) -> float:
    """Largest error that the tolerance bounds: of contact fraction and mean pressure, as the contract scales them."""
    surface = posed.surface()
    least = 1e-3 * surface.rms_slope * posed.solid.youngs_modulus / (1 - posed.solid.poisson_ratio**2)
    errors = [
        max(
            abs(state.contact_fraction - other.contact_fraction),
            abs(state.mean_pressure - other.mean_pressure) / max(abs(other.mean_pressure), least),
        )
        for state, other in zip(states, tight, strict=True)
    ]
    return max(errors)


def _error_estimate() -> Found:
    found: list[Number] = []
    errors: dict[float, float] = {}
    effort = {tolerance: [0, 0] for tolerance in MEASURED_ERROR}
    tight = {name: bem.solve(scene).targets for name, scene, _ in scenes(TIGHT)}
    for tolerance in MEASURED_ERROR:
        for name, scene, wave in scenes(tolerance):
            result = bem.solve(scene)
            effort[tolerance][0] += sum(state.unknowns for state in result.targets)
            effort[tolerance][1] += sum(state.evaluations for state in result.states)
            found += numbers(name, scene, wave, result.targets)
            miss = distance(scene, result.targets, tight[name])
            errors[tolerance] = max(errors.get(tolerance, 0.0), miss)
    known = Against("exact", "closed forms; dense algebra for layers and rough profiles")
    of = {quantity: [number for number in found if number.quantity == quantity] for quantity in QUANTITIES}
    least = min(float(np.mean(column(numbers, "bounded"))) for numbers in of.values())
    close = float(np.mean([number.ratio <= ORDERS for number in found]))
    yield known.row(f"share of {len(found)} reported numbers whose true error is below the estimate, least of "
                    f"{len(of)} quantities", "", 1.0, least, 0.0105, "absolute", required=0.05,
                    pinned="unconverged")  # fmt: skip
    yield known.row("share of estimates at most a hundred times the true error", "", 1.0, close, 0.038, "absolute",
                    required=0.05, pinned="unconverged")  # fmt: skip
    for tolerance, error in errors.items():
        yield Against("self", f"the same path at tolerance {TIGHT:g}").row(
            f"true error of contact fraction and mean pressure at tolerance {tolerance:g}", "", 0.0, error,
            MEASURED_ERROR[tolerance], "absolute", required=tolerance, pinned="unconverged")  # fmt: skip
    span = [RESOLUTION, 1e-7]
    kinds = {label: [number for number in found if number.quantity in names] for label, names in KINDS.items()}
    yield drawn("error-estimates",
                "Estimated against true errors, over the largest value of the scene: good ones lie between the lines.",
                loglog("true error (1e-14: that or less)", "estimated error",
                       *(marks(label, [max(number.true, RESOLUTION) for number in numbers], column(numbers, "estimate"))
                         for label, numbers in kinds.items()),
                       trace("true error", span, span),
                       trace("a hundred times that", span, [ORDERS * value for value in span], "dashed")))  # fmt: skip
    tolerances = sorted(errors)
    yield drawn("tolerance-met",
                "Largest true error of contact fraction and mean pressure at the targets of all scenes.",
                loglog("tolerance asked for", "error",
                       marks("largest true error", tolerances, [errors[t] for t in tolerances]),
                       trace("tolerance", tolerances, tolerances, "dashed")))  # fmt: skip
    words = [name.replace("_", " ") if name != "stress_intensity_max" else "largest stress intensity" for name in of]
    ratios = [column(numbers, "ratio") for numbers in of.values()]
    yield table(
        "Estimated over true errors of every number reported; 1e-14 of the largest value counts as no error.",
        {"quantity": words, "numbers": map(len, of.values()),
         "bounded": [sum(column(numbers, "bounded")) for numbers in of.values()],
         "median of estimate/true": digits(map(np.median, ratios), 2), "largest": digits(map(max, ratios), 2),
         "largest true error, relative": digits((max(column(numbers, "true")) for numbers in of.values()), 2)}
    )  # fmt: skip
    yield table("What a tolerance costs: unknowns of all states at targets, evaluations of all paths.",
                {"tolerance": errors, "true error": digits(errors.values(), 2),
                 "unknowns": [effort[tolerance][0] for tolerance in errors],
                 "evaluations": [effort[tolerance][1] for tolerance in errors]})  # fmt: skip
    yield {"numbers": len(found), "evaluations": sum(evaluations for _, evaluations in effort.values())}


CASES = (
    case("error-estimate", "accuracy", _error_estimate,
         "Do the error estimates of a state bound its true errors closely, and is the tolerance met?",
         r"true error $\le$ estimate $\le$ 100 true error in 95 % of all, the first of each quantity; "
         r"error $\le$ tolerance",
         "johnson1995 carbone2009", "half_space layer adhesion slope_term unloading load_control", scene="rough_100"),
)  # fmt: skip
