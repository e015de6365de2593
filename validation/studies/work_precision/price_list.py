"""The price list: what each effect costs in seconds on a rough scene, and how many digits it holds on an exact one.

Seconds: the self-affine profile of the registry, loaded to two separations; CPU seconds, the least of a few runs in
alternation, against the scene without the effect (corpus/effects.py).  Digits: the same effect on one sinusoid, where
its answer is known,

- bare: Westergaard's contact; adhesion and unloading: Johnson's; slope term: Johnson's with the work of adhesion
  gamma sqrt(1 + h'^2) at the edge;
- layer: finite elements, digits up to their uncertainty;
- shapes: the gap along the period;
- spectra: the first line of the pressure, p* (2 S - S^2);
- pressure distribution: the share of the period above a pressure, from p = 2 p* cos v sqrt(S - sin^2 v), and the
  highest pressure, 2 p* sqrt(S);
- error estimate: the estimated error of Johnson's contact fraction less the true one.

The scenes of the effects stand in corpus/effects.py.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

import bem
import fem_reference
from bem.scene.result import Result
from fem_reference import Resolution
from validation.corpus.effects import ADHESIVE, EFFECTS, LAYER, Changes, Cost, Times, costs_of, rough, solved
from validation.references.closed_forms import Sinusoid
from validation.routes.scenes import posed
from validation.studies.stages import timed_stages

DEPTH = 6e-5  # penetration of the sinusoid, m
NU = 0.45
ROUNDING = 1e-15
DRY, STICKY = (Sinusoid(1e-4, 0.01, 1e6, 0.5, alpha) for alpha in (0.0, 0.3))
JOHNSON: Changes = {"adhesion": {"work_of_adhesion": STICKY.work_of_adhesion}}
Digits = tuple[float, float, str]  # relative error on the sinusoid, uncertainty of the reference, and what that is


@dataclass(frozen=True)
class Price:
    """A line of the list."""

    effect: str
    on_top_of: str
    seconds: float  # CPU seconds of the scene
    times: Times | None  # those of the one it is priced against
    evaluations: int  # of the patch system
    error: float = math.nan  # on the sinusoid, relative
    floor: float = 0.0  # uncertainty of the reference of the error
    reference: str = ""

    @property
    def digits(self) -> float:
        """-log10 of the error, no more than the reference resolves."""
        known = max(self.error, self.floor)
        return -math.log10(known) if known > 0 else math.nan


def priced(item: tuple[int, int]) -> list[Price]:
    """The list, for (harmonics, runs of each scene); in a process of its own."""
    harmonics, runs = item
    costs = costs_of({effect.name: rough(effect.changes, harmonics) for effect in EFFECTS}, runs)
    prices = []
    for effect in EFFECTS:
        own, base = costs[effect.name], costs.get(effect.on_top_of)
        times = Times.of(own, base) if base else None
        prices.append(Price(effect.name, effect.on_top_of, own.least, times, own.evaluations, *DIGITS[effect.name]()))
    own, base = _with_and_without_estimate(harmonics, runs)
    estimate = Price("error estimate", "slope term", own.least, Times.of(own, base), own.evaluations,
                     *DIGITS["error estimate"]())  # fmt: skip
    return [*prices, estimate]


def _with_and_without_estimate(harmonics: int, runs: int) -> tuple[Cost, Cost]:
    """What the scene takes as a whole, with how often errors are estimated, and what remains of the same runs."""
    whole, rest, calls = [], [], 0
    for _ in range(runs):
        with timed_stages() as stages:
            bem.solve(rough(ADHESIVE, harmonics))
        whole.append(stages.total)
        rest.append(stages.total - stages.whole["error estimate"])
        calls = stages.calls["error estimate"]
    return Cost(tuple(whole), calls), Cost(tuple(rest), calls)


def sentences(prices: Sequence[Price], loaded: Sequence[str]) -> list[str]:
    """The list in words."""
    reported = [
        f"{price.effect}, times the scene without it ({price.on_top_of}): {price.times}; digits: {digits_of(price)} "
        f"({price.reference})."
        for price in prices
        if price.times
    ]
    if loaded:
        return [*reported, f"Absent effects are not absent: the bare scene loads {', '.join(loaded)}."]
    return [*reported, "Absent effects cost nothing: the bare scene loads no module of theirs."]


def digits_of(price: Price) -> str:
    """Digits as printed in the list."""
    if math.isnan(price.error):
        return "no exact answer"
    more = ", all that the reference resolves" if price.error <= price.floor else ""
    return f"{price.digits:.1f}{more}"


def _solved(changes: Changes) -> Result:
    return solved(posed("sinusoid", **({"loading": {"targets": [DEPTH]}} | changes)))


def _area(changes: Changes, psi: float, by: str) -> Digits:
    """Relative error of the contact fraction at the last target."""
    found = _solved(changes).targets[-1].contact_fraction
    return abs(found / (psi * 2 / np.pi) - 1), ROUNDING, by


def _sloped() -> float:
    """psi of Johnson's wave with the slope term."""

    def excess(psi: float) -> float:
        share = np.sin(psi) ** 2
        slope = 2 * np.pi * STICKY.amplitude / STICKY.wavelength * np.sin(2 * psi)
        work = STICKY.work_of_adhesion * np.sqrt(1 + slope**2)
        tension = np.sqrt(2 * STICKY.modulus * work * np.tan(psi) / STICKY.wavelength)
        lift = STICKY.wavelength * tension * np.log(share) / (np.pi * STICKY.modulus)
        return float(STICKY.amplitude * share * (1 - np.log(share)) + lift - DEPTH)

    return float(brentq(excess, 0.3, 1.4, xtol=1e-16, rtol=1e-15))


def _layer() -> Digits:
    work, layer = 0.5, {"thickness": LAYER}
    found = _solved({"solid": {"poisson_ratio": NU}, "layer": layer, "adhesion": {"work_of_adhesion": work}})
    reference = fem_reference.solve(
        youngs_modulus=1e6, poisson_ratio=NU, thickness=LAYER, period=0.01, harmonics=([1], [1e-4], [0.0]),
        control="penetration", value=DEPTH, resolution=Resolution(4, 8, 18), work_of_adhesion=work,
    )  # fmt: skip
    error = abs(found.targets[-1].contact_fraction / reference.contact_fraction - 1)
    floor = float(np.max(reference.uncertainty["contact_fraction"])) / reference.contact_fraction
    return error, floor, "finite elements, quartic, three meshes up to 8 cells"


def _fields(**output: Any) -> Any:
    """Fields of Westergaard's contact."""
    return _solved({"adhesion": None, "output": output}).fields


def _shapes() -> Digits:
    found = _fields(shapes=True)
    error = float(np.max(np.abs(found["gap_0"] - DRY.gap(found["x_0"], DRY.angle(DEPTH))))) / (2 * DRY.amplitude)
    return error, ROUNDING, "Westergaard 1939, gap along the period"


def _spectra() -> Digits:
    share = np.sin(DRY.angle(DEPTH)) ** 2
    line = (DRY.full_contact_pressure * (2 * share - share**2) / 2) ** 2 * DRY.wavelength / (2 * np.pi)
    error = abs(float(_fields(spectra=True)["C_sigma_0"][0]) / line - 1)
    return error, ROUNDING, "Westergaard 1939, first line of the pressure"


def _distribution() -> Digits:
    edge, found = np.sin(DRY.angle(DEPTH)), _fields(pressure_distribution=True)
    bounds, density = found["sigma_bounds_0"], found["P_0"]
    above = np.cumsum((density * np.diff(bounds))[::-1])[::-1]
    reduced = bounds / (2 * DRY.full_contact_pressure)
    # at the highest pressure the share is the square root of a difference that is all rounding: it is compared itself
    below, highest = reduced[:-1], reduced[-1]
    square = 2 * (edge - below) * (edge + below) / (1 + edge**2 + np.hypot(1 - edge**2, 2 * below))
    exact = 2 / np.pi * np.arcsin(np.sqrt(square))
    error = max(float(np.max(np.abs(above - exact))), abs(float(highest) / edge - 1))
    return error, ROUNDING, "Westergaard 1939, share of the period above a pressure, and the highest pressure"


def _estimate() -> Digits:
    state = _solved(JOHNSON).targets[-1]
    estimated = state.error_estimate.contact_fraction or math.nan
    true = abs(state.contact_fraction - STICKY.angle(DEPTH) * 2 / np.pi)
    reported = f"Johnson 1995: estimated {estimated:.1e}, true {true:.1e}; the error listed is their difference"
    return abs(estimated - true), ROUNDING, reported


BACK: Changes = {"loading": {"targets": [1.2 * DEPTH, DEPTH]}}
SLOPED: Changes = {"adhesion": {"work_of_adhesion": STICKY.work_of_adhesion, "slope_term": True}}
DIGITS: dict[str, Callable[[], Digits]] = {
    "bare": lambda: _area({"adhesion": None}, DRY.angle(DEPTH), "Westergaard 1939"),
    "layer": _layer,
    "adhesion": lambda: _area(JOHNSON, STICKY.angle(DEPTH), "Johnson 1995"),
    "slope term": lambda: _area(SLOPED, _sloped(), "Johnson 1995 with gamma sqrt(1 + h'^2) at the edge"),
    "unloading": lambda: _area(JOHNSON | BACK, STICKY.angle(DEPTH), "Johnson 1995, on the way back"),
    "shapes": _shapes,
    "spectra": _spectra,
    "pressure distribution": _distribution,
    "error estimate": _estimate,
}
