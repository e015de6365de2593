"""The price list: what each effect costs in seconds on a rough scene, and how many digits it holds on an exact one.

Seconds: the self-affine profile of the registry, loaded to two separations; CPU seconds, the least of a few runs after
a warm-up, against the scene without the effect.  Digits: the same effect on one sinusoid, where its answer is known,

- bare: Westergaard's contact; adhesion and unloading: Johnson's; slope term: Johnson's with the work of adhesion
  gamma sqrt(1 + h'^2) at the edge;
- layer: finite elements, digits up to their uncertainty;
- shapes: the gap, 2 D (v sqrt(v^2 - S) - S arcosh(v S^-1/2)), v = sin(pi x / wavelength);
- spectra: the first line of the pressure, p* (2 S - S^2);
- pressure distribution: the share of the period above a pressure, from p = 2 p* cos v sqrt(S - sin^2 v), and the
  highest pressure, 2 p* sqrt(S);
- error estimate: the estimated error of Johnson's contact fraction less the true one.

The scenes of the effects stand in corpus/effects.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

import bem
import fem_reference
from bem.scene.result import Result
from fem_reference import Resolution
from validation.corpus.effects import ADHESIVE, EFFECTS, LAYER, Changes, rough, seconds_of, solved
from validation.references import adapters
from validation.references.closed_forms import Sinusoid
from validation.studies.stages import timed_stages

DEPTH = 6e-5  # penetration of the sinusoid, m
NU = 0.45


@dataclass(frozen=True)
class Price:
    """A line of the list."""

    effect: str
    on_top_of: str
    seconds: float  # CPU seconds of the scene
    extra: float  # those more than of the one it is priced against
    ratio: float  # of the two
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
    seconds: dict[str, float] = {}
    evaluations: dict[str, int] = {}
    for effect in EFFECTS:
        seconds[effect.name], evaluations[effect.name] = seconds_of(rough(effect.changes, harmonics), runs)
    prices = []
    for effect in EFFECTS:
        own, base = seconds[effect.name], seconds.get(effect.on_top_of, math.nan)
        error, floor, reference = DIGITS[effect.name]()
        prices.append(
            Price(effect.name, effect.on_top_of, own, own - base, own / base, evaluations[effect.name],
                  error, floor, reference)
        )  # fmt: skip
    with timed_stages() as times:
        bem.solve(rough(ADHESIVE, harmonics))
    whole = times.whole["error estimate"]
    error, floor, reference = DIGITS["error estimate"]()
    without = times.total - whole
    calls = times.calls["error estimate"]
    return [
        *prices,
        Price(
            "error estimate", "slope term", times.total, whole, times.total / without, calls, error, floor, reference
        ),
    ]


def sentences(prices: Sequence[Price], loaded: Sequence[str]) -> list[str]:
    """The list in words."""
    reported = [
        f"{price.effect}: {price.ratio:.2f} times the scene without it ({price.on_top_of}), "
        f"{price.extra:+.2g} s; digits: {digits_of(price)} ({price.reference})."
        for price in prices
        if price.on_top_of
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


def _wave(alpha: float) -> Sinusoid:
    return Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=alpha)


def _sinusoid(changes: Changes) -> Result:
    return solved(adapters.scene("sinusoid", {"loading": {"targets": [DEPTH]}} | changes))


def _fraction_error(result: Result, psi: float) -> float:
    """Relative error of the contact fraction at the last target."""
    return abs(result.targets[-1].contact_fraction / (psi * 2 / np.pi) - 1)


def _angle(wave: Sinusoid) -> float:
    return float(brentq(lambda psi: float(wave.penetration(psi)) - DEPTH, 0.3, 1.4, xtol=1e-16, rtol=1e-15))


def _bare() -> tuple[float, float, str]:
    return _fraction_error(_sinusoid({"adhesion": None}), _angle(_wave(0.0))), 1e-15, "Westergaard 1939"


def _adhesion() -> tuple[float, float, str]:
    wave = _wave(0.3)
    found = _sinusoid({"adhesion": {"work_of_adhesion": wave.work_of_adhesion}})
    return _fraction_error(found, _angle(wave)), 1e-15, "Johnson 1995"


def _slope_term() -> tuple[float, float, str]:
    wave = _wave(0.3)

    def excess(psi: float) -> float:
        share = np.sin(psi) ** 2
        slope = 2 * np.pi * wave.amplitude / wave.wavelength * np.sin(2 * psi)
        work = wave.work_of_adhesion * np.sqrt(1 + slope**2)
        tension = np.sqrt(2 * wave.modulus * work * np.tan(psi) / wave.wavelength)
        lift = wave.wavelength * tension * np.log(share) / (np.pi * wave.modulus)
        return float(wave.amplitude * share * (1 - np.log(share)) + lift - DEPTH)

    found = _sinusoid({"adhesion": {"work_of_adhesion": wave.work_of_adhesion, "slope_term": True}})
    psi = float(brentq(excess, 0.3, 1.4, xtol=1e-16, rtol=1e-15))
    return _fraction_error(found, psi), 1e-15, "Johnson 1995 with gamma sqrt(1 + h'^2) at the edge"


def _layer() -> tuple[float, float, str]:
    found = _sinusoid(
        {"solid": {"poisson_ratio": NU}, "layer": {"thickness": LAYER}, "adhesion": {"work_of_adhesion": 0.5}}
    )
    reference = fem_reference.solve(
        youngs_modulus=1e6, poisson_ratio=NU, thickness=LAYER, period=0.01, harmonics=([1], [1e-4], [0.0]),
        control="penetration", value=DEPTH, work_of_adhesion=0.5, resolution=Resolution(4, 8, 18),
    )  # fmt: skip
    error = abs(found.targets[-1].contact_fraction / reference.contact_fraction - 1)
    floor = float(np.max(reference.uncertainty["contact_fraction"])) / reference.contact_fraction
    return error, floor, "finite elements, quartic, three meshes up to 8 cells"


def _unloading() -> tuple[float, float, str]:
    wave = _wave(0.3)
    changes: Changes = {
        "adhesion": {"work_of_adhesion": wave.work_of_adhesion},
        "loading": {"targets": [1.2 * DEPTH, DEPTH]},
    }
    return _fraction_error(_sinusoid(changes), _angle(wave)), 1e-15, "Johnson 1995, on the way back"


def _shapes() -> tuple[float, float, str]:
    wave = _wave(0.0)
    edge = np.sin(_angle(wave))
    found = _sinusoid({"adhesion": None, "output": {"shapes": [wave.amplitude - DEPTH]}}).fields
    sine = np.abs(np.sin(np.pi * found["x_0"] / wave.wavelength))
    reach = np.maximum(sine, edge)  # on the contact the gap is that of its edge: zero
    root = np.sqrt((reach - edge) * (reach + edge))
    gap = reach * root - edge**2 * np.arcsinh(root / edge)
    error = float(np.max(np.abs(found["gap_0"] / (2 * wave.amplitude) - gap)))
    return error, 1e-15, "Westergaard 1939, gap along the period"


def _spectra() -> tuple[float, float, str]:
    wave = _wave(0.0)
    share = np.sin(_angle(wave)) ** 2
    line = (wave.full_contact_pressure * (2 * share - share**2) / 2) ** 2 * wave.wavelength / (2 * np.pi)
    found = _sinusoid({"adhesion": None, "output": {"spectra": True}})
    return abs(float(found.fields["C_sigma_0"][0]) / line - 1), 1e-15, "Westergaard 1939, first line of the pressure"


def _distribution() -> tuple[float, float, str]:
    wave = _wave(0.0)
    edge = np.sin(_angle(wave))
    found = _sinusoid({"adhesion": None, "output": {"pressure_distribution": True}}).fields
    bounds, density = found["sigma_bounds_0"], found["P_0"]
    above = np.cumsum((density * np.diff(bounds))[::-1])[::-1]
    reduced = bounds / (2 * wave.full_contact_pressure)
    # at the highest pressure the share is the square root of a difference that is all rounding: it is compared itself
    below, highest = reduced[:-1], reduced[-1]
    square = 2 * (edge - below) * (edge + below) / (1 + edge**2 + np.hypot(1 - edge**2, 2 * below))
    exact = 2 / np.pi * np.arcsin(np.sqrt(square))
    error = max(float(np.max(np.abs(above - exact))), abs(float(highest) / edge - 1))
    return error, 1e-15, "Westergaard 1939, share of the period above a pressure, and the highest pressure"


def _widths() -> tuple[float, float, str]:
    wave = _wave(0.0)
    found = _sinusoid({"adhesion": None, "output": {"width_distributions": True}})
    width = float(found.fields["patch_width_0"][0])
    return (
        abs(width / (_angle(wave) * 2 / np.pi * wave.wavelength) - 1),
        1e-15,
        "Westergaard 1939, width of the contact",
    )


def _estimate() -> tuple[float, float, str]:
    wave = _wave(0.3)
    state = _sinusoid({"adhesion": {"work_of_adhesion": wave.work_of_adhesion}}).targets[-1]
    estimated = state.error_estimate.contact_fraction or math.nan
    true = abs(state.contact_fraction - _angle(wave) * 2 / np.pi)
    reported = f"Johnson 1995: estimated {estimated:.1e}, true {true:.1e}; the error listed is their difference"
    return abs(estimated - true), 1e-15, reported


DIGITS = {
    "bare": _bare,
    "layer": _layer,
    "adhesion": _adhesion,
    "slope term": _slope_term,
    "unloading": _unloading,
    "shapes": _shapes,
    "spectra": _spectra,
    "pressure distribution": _distribution,
    "width distributions": _widths,
    "error estimate": _estimate,
}
