"""Are the error estimates of a state true, and is the tolerance met?  Against closed forms and dense algebra.

Every number that a state reports comes with an estimated error.  Here the true errors are known: sinusoids with and
without adhesion from Johnson's and Westergaard's formulas at the same control, everything else, layers and rough
profiles included, from the equilibrium that dense algebra finds next to the state (dense_equilibrium.py).  An estimate
is good when it bounds the true error, and is not more than a hundred times larger; errors below the resolution of the
reference, 1e-14 of the largest value, count as that.  Estimates of a path that goes by leaps hold besides that it may
have come to another branch: they bound, and are not asked to be close.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

import bem
from bem.scene.result import State
from bem.scene.scene import Scene
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, marks, trace
from validation.harness.rows import compared
from validation.harness.schema import Figure, Reference, Row, Table
from validation.references import adapters
from validation.references.closed_forms import Sinusoid
from validation.references.dense_equilibrium import reference

TOLERANCES = (1e-3, 1e-6, 1e-8, 1e-10)
TIGHT = 1e-12
RESOLUTION = 1e-14  # of the reference, over the largest value of that quantity in the scene
ORDERS = 100.0
AMPLITUDE, WAVELENGTH = 1e-4, 0.01
LAYER: dict[str, Any] = {"layer": {"thickness": 0.001}, "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3}}
WORDS = {
    "mean_pressure": "mean pressure",
    "contact_fraction": "contact fraction",
    "penetration": "penetration",
    "separation": "separation",
    "total_displacement": "total displacement",
    "elastic_energy": "elastic energy",
    "adhesion_energy": "adhesion energy",
    "total_energy": "total energy",
    "stress_intensity_max": "largest stress intensity",
    "contact_stiffness": "contact stiffness",
}


@dataclass(frozen=True)
class Number:
    """One reported number: true and estimated error over the largest value of the scene."""

    quantity: str
    scene: str
    tolerance: float
    leaps: bool
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
    accuracy = {"tolerance": tolerance}
    for alpha in (0.0, 0.1, 0.3, 0.5):
        wave = Sinusoid(AMPLITUDE, WAVELENGTH, 1e6, 0.5, alpha)
        adhesion = {"work_of_adhesion": wave.work_of_adhesion} if alpha else None
        loading: dict[str, Any] = {"targets": [2e-5, 5e-5, 9e-5, 4e-5]}
        yield (
            f"sinusoid, alpha = {alpha:g}",
            adapters.scene("sinusoid", {"adhesion": adhesion, "accuracy": accuracy, "loading": loading}),
            wave,
        )
    load = {"control": "mean_pressure", "targets": [2e3, 8e3, 1.5e4]}
    bare: dict[str, Any] = {"adhesion": None, "accuracy": accuracy, "loading": load}
    yield "sinusoid under load", adapters.scene("sinusoid", bare), Sinusoid(AMPLITUDE, WAVELENGTH, 1e6, 0.5, 0.0)
    driven = {"control": "total_displacement", "targets": [1e-5, 5e-5, 9e-5]}
    yield "layer", adapters.scene("sinusoid", {"loading": driven, "accuracy": accuracy, **LAYER}), None
    rough: dict[str, Any] = {"accuracy": accuracy, "profile": {"harmonics": 40}}
    path = {"targets": [70e-6, 45e-6, 30e-6, 50e-6]}
    yield "rough", adapters.scene("rough_100", {**rough, "loading": path}), None
    yield "rough, no adhesion", adapters.scene("rough_100", {**rough, "loading": path, "adhesion": None}), None
    load = {"control": "mean_pressure", "targets": [1e3, 4e3, 9e3]}
    yield "rough under load", adapters.scene("rough_100", {**rough, "loading": load, "adhesion": None}), None


def exact(posed: Scene, state: State, wave: Sinusoid | None) -> dict[str, float]:
    """What a state should report: by dense algebra, and by the closed form where there is one."""
    known = reference(posed, state)
    if wave is None:
        return known
    near = state.contact_fraction * np.pi / 2
    bracket = near * (1 - 1e-5), near * (1 + 1e-5)
    if posed.loading.control == "mean_pressure":
        target = min(posed.loading.targets, key=lambda value: abs(value - state.mean_pressure))
        psi = float(brentq(lambda p: float(wave.mean_pressure(p)) - target, *bracket, xtol=1e-16, rtol=1e-15))
    else:
        psi = float(brentq(lambda p: float(wave.penetration(p)) - state.penetration, *bracket, xtol=1e-16, rtol=1e-15))
    penetration = float(wave.penetration(psi))
    known.update(contact_fraction=psi * 2 / np.pi, mean_pressure=float(wave.mean_pressure(psi)))
    if posed.loading.control == "mean_pressure":
        known.update(penetration=penetration, separation=wave.amplitude - penetration)
    return known


def numbers(name: str, posed: Scene, wave: Sinusoid | None, states: tuple[State, ...]) -> list[Number]:
    """Every number that the states with edges report."""
    touching = [state for state in states if state.edges]
    known = [exact(posed, state, wave) for state in touching]
    scale = {quantity: max(abs(values[quantity]) for values in known) for quantity in WORDS}
    found = []
    for state, values in zip(touching, known, strict=True):
        for quantity, estimate in asdict(state.error_estimate).items():
            if estimate is None or scale[quantity] == 0 or (quantity.startswith("adhesion") and posed.adhesion is None):
                continue
            if quantity == "stress_intensity_max" and posed.adhesion is None:
                continue  # zero but for rounding: judged by the certificate
            true = abs(getattr(state, quantity) - values[quantity]) / scale[quantity]
            found.append(
                Number(quantity, name, posed.accuracy.tolerance, posed.leaps, true, estimate / scale[quantity])
            )
    return found


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


def _error_estimate() -> Outcome:
    found: list[Number] = []
    errors: dict[float, float] = {}
    effort = {tolerance: [0, 0] for tolerance in TOLERANCES}
    tight = {name: bem.solve(posed).targets for name, posed, _ in scenes(TIGHT)}
    for tolerance in TOLERANCES:
        for name, posed, wave in scenes(tolerance):
            result = bem.solve(posed)
            effort[tolerance][0] += sum(state.unknowns for state in result.targets)
            effort[tolerance][1] += sum(state.evaluations for state in result.states)
            found += numbers(name, posed, wave, result.targets)
            miss = distance(posed, result.targets, tight[name])
            errors[tolerance] = max(errors.get(tolerance, 0.0), miss)
    return Outcome(
        rows=_rows(found, errors),
        figures=(_figure(found), _tolerance_figure(errors)),
        tables=(_table(found), _effort_table(errors, effort)),
        counts={"numbers": len(found), "evaluations": sum(spent for _, spent in effort.values())},
    )


def _rows(found: list[Number], errors: dict[float, float]) -> tuple[Row, ...]:
    known = Reference(kind="exact", source="closed forms; dense algebra for layers and rough profiles")
    bounded = float(np.mean([number.bounded for number in found]))
    close = float(np.mean([number.ratio <= ORDERS for number in found if not number.leaps]))
    same = Reference(kind="self", source=f"the same path at tolerance {TIGHT:g}")
    return (
        compared(f"share of {len(found)} reported numbers whose true error is below the estimate", "", known, [1.0],
                 [bounded], 0.05, 1 - MEASURED_BOUNDED, "absolute", basis="required", pinned="unconverged"),
        compared("share of estimates at most a hundred times the true error", "", known, [1.0], [close], 0.05,
                 1 - MEASURED_CLOSE, "absolute", basis="required", pinned="unconverged"),
        *(
            compared(f"true error of contact fraction and mean pressure at tolerance {tolerance:g}", "", same, [0.0],
                     [error], tolerance, MEASURED_ERROR[tolerance], "absolute", basis="required", pinned="unconverged")
            for tolerance, error in errors.items()
        ),
    )  # fmt: skip


def _table(found: list[Number]) -> Table:
    rows: list[list[str | float | int | None]] = []
    for quantity, words in WORDS.items():
        of = [number for number in found if number.quantity == quantity]
        ratios = [number.ratio for number in of]
        rows.append(
            [
                words,
                len(of),
                sum(number.bounded for number in of),
                float(f"{np.median(ratios):.2g}"),
                float(f"{max(ratios):.2g}"),
                float(f"{max(number.true for number in of):.2g}"),
            ]
        )
    return Table(
        caption="Estimated over true errors of every number reported; 1e-14 of the largest value counts as no error.",
        columns=["quantity", "numbers", "bounded", "median of estimate/true", "largest",
                 "largest true error, relative"],
        rows=rows
    )  # fmt: skip


def _effort_table(errors: dict[float, float], effort: dict[float, list[int]]) -> Table:
    return Table(
        caption="What a tolerance costs: unknowns of all states at targets, evaluations of all paths.",
        columns=["tolerance", "true error", "unknowns", "evaluations"],
        rows=[[tolerance, float(f"{errors[tolerance]:.2g}"), *effort[tolerance]] for tolerance in errors],
    )


def _figure(found: list[Number]) -> Figure:
    kinds = {
        "pressure, contact fraction": ("mean_pressure", "contact_fraction"),
        "displacements": ("penetration", "separation", "total_displacement"),
        "energies": ("elastic_energy", "adhesion_energy", "total_energy"),
        "stress intensity, stiffness": ("stress_intensity_max", "contact_stiffness"),
    }
    span = [RESOLUTION, 1e-7]
    series = [
        marks(label, [max(number.true, RESOLUTION) for number in found if number.quantity in names],
              [number.estimate for number in found if number.quantity in names])
        for label, names in kinds.items()
    ]  # fmt: skip
    return drawn("error-estimates",
                 "Estimated against true errors, over the largest value of the scene: good ones lie between the lines.",
                 loglog("true error (1e-14: that or less)", "estimated error",
                        *series,
                        trace("true error", span, span),
                        trace("a hundred times that", span, [ORDERS * value for value in span], "dashed")))  # fmt: skip


def _tolerance_figure(errors: dict[float, float]) -> Figure:
    tolerances = sorted(errors)
    return drawn("tolerance-met",
                 "Largest true error of contact fraction and mean pressure at the targets of all scenes.",
                 loglog("tolerance asked for", "error",
                        marks("largest true error", tolerances, [errors[t] for t in tolerances]),
                        trace("tolerance", tolerances, tolerances, "dashed")))  # fmt: skip


MEASURED_BOUNDED, MEASURED_CLOSE = 0.997, 0.99
MEASURED_ERROR = {1e-3: 2.7e-9, 1e-6: 2.7e-9, 1e-8: 8.4e-11, 1e-10: 1.8e-12}

CASES = (
    Case(id="error-estimate", group="accuracy", level="quick",
         question="Do the error estimates of a state bound its true errors closely, and is the tolerance met?",
         equations=r"true error $\le$ estimate $\le$ 100 true error in 95 % of the numbers; error $\le$ tolerance",
         sources=("johnson1995", "carbone2009"), compute=_error_estimate,
         effects=("half_space", "layer", "adhesion", "slope_term", "unloading", "load_control"),
         scene=adapters.scene_text("rough_100")),
)  # fmt: skip
