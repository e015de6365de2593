"""The contacts on which methods are compared at equal achieved error, and their exact answers where there are any.

- sinusoid: Johnson's, alpha = 0.3, on a half-space; exact.
- layer: two unequal crests on a bonded layer a fifth of a period thick.
- rough: a self-affine profile with 60 harmonics on a half-space, nine contacts at the end of a loading path.
- paper: the paper's profile, 1000 harmonics, at six separations of a loading path, up to some forty contacts.
- theory: Persson's theory of the same profile, its two routes against each other.

They are raw data, from which each method derives its own constants; the first three are given at a penetration.
Compared are contact fraction, mean pressure, elastic energy and the gap at one place.  Pressures are compared by their
integrals, load and energy: with edges that differ, pointwise pressures have infinite differences beside them and no
weighted square norm that is the same for all methods.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.harness.arrays import FloatArray
from validation.harness.route import Place, Problem
from validation.references.closed_forms import Sinusoid
from validation.references.paper_method import Surface

Harmonics = tuple[tuple[int, ...], tuple[float, ...], tuple[float, ...]]
QUANTITIES = ("contact_fraction", "mean_pressure", "elastic_energy", "gap")
THEORY_LOAD = 1.0e4  # Pa
PAPER_SEPARATIONS = (6.0e-5, 5.0e-5, 4.5e-5, 4.0e-5, 3.5e-5, 3.0e-5)  # m
Numbers = dict[str, float]  # by quantity; of several targets by quantity and number of the target, "gap 2"


def quantity_of(name: str) -> str:
    """The quantity of a number."""
    return name.partition(" ")[0]


@dataclass(frozen=True)
class Posed(Problem):
    """A problem of the comparison."""

    title: str = ""

    @property
    def penetration(self) -> float:
        """Delta, m."""
        (target,) = self.targets
        return target

    @property
    def trough(self) -> float:
        """Position at which the gap is compared, m."""
        return float(self.asked["gap_at"]["points"][0])

    @property
    def scales(self) -> Numbers:
        """What errors are divided by: 1, E* h'_rms / sqrt 2 (p* of a sinusoid), energy of that, rms height."""
        orders, amplitudes, _ = self.harmonics
        modulus = self.youngs_modulus / (1 - self.poisson_ratio**2)
        height = float(np.sqrt(np.sum(amplitudes**2) / 2))
        slope = float(np.sqrt(np.sum((2 * np.pi / self.period * orders * amplitudes) ** 2) / 2))
        pressure = modulus * slope / np.sqrt(2)
        return answer_of(1.0, pressure, pressure * height, height)

    def surface(self) -> Surface:
        """As the paper's method takes it."""
        return surface_of(self)

    def errors(self, found: Numbers, reference: Numbers) -> Numbers:
        """Errors over their scales, of the quantities that both know; of several targets the largest."""
        scales, largest = self.scales, dict[str, float]()
        for name in found.keys() & reference.keys():
            quantity = quantity_of(name)
            error = abs(found[name] - reference[name]) / scales[quantity]
            largest[quantity] = max(largest.get(quantity, 0.0), error)
        return {quantity: largest[quantity] for quantity in QUANTITIES if quantity in largest}


def answer_of(contact_fraction: float, mean_pressure: float, elastic_energy: float, gap: float) -> Numbers:
    """The four quantities by their names."""
    return dict(zip(QUANTITIES, (contact_fraction, mean_pressure, elastic_energy, gap), strict=True))


def numbers_of(values: Mapping[str, Any]) -> Numbers:
    """The values, or uncertainties, of an answer, by the names of QUANTITIES."""
    found: Numbers = {}
    for name, value in values.items():
        quantity = name.removesuffix("_at")
        if len(value) == 1:
            found[quantity] = float(value[0])
        else:
            found |= {f"{quantity} {k}": float(number) for k, number in enumerate(value, 1) if number is not None}
    return found


def scenes() -> dict[str, Posed]:
    """All, by their ids."""
    rough = _self_affine(60)
    posed = (
        _pressed("sinusoid", "Johnson's sinusoid, alpha = 0.3", 0.5, ((1,), (1e-4,), (0.0,)), 6e-5, 0.005,
                 work_of_adhesion=_johnson().work_of_adhesion),
        _pressed("layer", "two crests on a layer, d = 0.2 periods, nu = 0.45", 0.45, ((1, 2), (2e-5, 6e-5), (0.3, 0.0)),
                 5e-5, 0.0025, work_of_adhesion=0.05, thickness=0.002),
        _pressed("rough", "self-affine profile, 60 harmonics", 0.5, rough, 5.8e-5, _lowest(rough),
                 work_of_adhesion=0.03, slope_term=True),
        Posed("theory", 1e6, 0.5, 0.01, *rough, "mean_pressure", (THEORY_LOAD,),
              {"contact_fraction": {}, "elastic_energy": {}}, work_of_adhesion=0.03, slope_term=True,
              title="Persson's theory of the rough profile, 60 lines"),
        Posed("paper", 1e6, 0.5, 0.01, *_self_affine(1000), "separation", PAPER_SEPARATIONS,
              {"contact_fraction": {}, "mean_pressure": {}, "elastic_energy": {}}, work_of_adhesion=0.03,
              slope_term=True, title="the paper's profile, 1000 harmonics, six separations"),
    )  # fmt: skip
    return {scene.id: scene for scene in posed}


def _self_affine(count: int) -> Harmonics:
    """A realisation of Hurst exponent 0.7 and rms height 50 um."""
    m = np.arange(1, count + 1)
    heights = m**-1.2 * 50e-6 / np.sqrt(np.sum(m**-2.4) / 2)
    phases = np.random.default_rng(1).uniform(-np.pi, np.pi, m.size)
    return tuple(int(order) for order in m), tuple(heights.tolist()), tuple(phases.tolist())


def _pressed(
    name: str, title: str, poisson_ratio: float, harmonics: Harmonics, depth: float, trough: float, **named: Any
) -> Posed:
    """At a penetration, asked for everything, the gap at one place."""
    gap = {"gap_at": {"target": 1, "points": [trough]}}
    asked: dict[str, Place] = dict[str, Place](contact_fraction={}, mean_pressure={}, elastic_energy={}) | gap
    return Posed(name, 1e6, poisson_ratio, 0.01, *harmonics, "penetration", (depth,), asked, title=title, **named)


def scene_tables(posed: Problem) -> dict[str, Any]:
    """Tables of the scene file of the solver."""
    tables: dict[str, Any] = {
        "solid": {"youngs_modulus": posed.youngs_modulus, "poisson_ratio": posed.poisson_ratio},
        "profile": {
            "kind": "harmonics",
            "period": posed.period,
            "orders": list(posed.orders),
            "amplitudes": list(posed.amplitudes),
            "phases": list(posed.phases),
        },
        "loading": {"control": posed.control, "targets": list(posed.targets)},
    }
    if posed.work_of_adhesion is not None:
        tables["adhesion"] = {"work_of_adhesion": posed.work_of_adhesion, "slope_term": posed.slope_term}
    return tables if posed.thickness is None else tables | {"layer": {"thickness": posed.thickness}}


def exact_sinusoid(posed: Posed) -> Numbers:
    """Johnson's answer at the penetration of the scene.

    Examples
    --------
    >>> round(exact_sinusoid(scenes()["sinusoid"])["contact_fraction"], 6)
    0.478107
    """
    wave = _johnson()
    psi = wave.angle(posed.penetration)
    gap = float(wave.gap(0.5 * wave.wavelength, psi))
    return answer_of(psi * 2 / np.pi, float(wave.mean_pressure(psi)), wave.elastic_energy(psi), gap)


def surface_of(problem: Problem) -> Surface:
    """A problem as the paper's method takes it."""
    return Surface(
        problem.youngs_modulus, problem.poisson_ratio, problem.period, problem.orders, problem.amplitudes,
        problem.phases, problem.work_of_adhesion or 0.0, problem.slope_term, problem.thickness,
    )  # fmt: skip


def highest(problem: Problem) -> float:
    """Height of the highest crest above the mean plane, m: separation and penetration together."""
    surface = surface_of(problem)
    return surface.highest * surface.unit_height


def overlap(problem: Problem) -> FloatArray:
    """Where the undeformed profile is above the undeformed face: edges (L, 2) to start from, m."""
    surface = surface_of(problem)
    count = 64 * max(problem.orders)
    x = np.arange(count) * (2 * np.pi / count)
    inside = surface.height(x) - surface.highest + problem.targets[-1] / surface.unit_height > 0
    starts, ends = np.flatnonzero(inside & ~np.roll(inside, 1)), np.flatnonzero(inside & ~np.roll(inside, -1))
    ends = np.where(ends < starts, np.roll(ends, -1), ends) if ends[0] < starts[0] else ends
    ends = np.where(ends < starts, ends + count, ends)
    return np.asarray(np.stack([starts, ends + 1], axis=1) * (problem.period / count), dtype=np.float64)


def _lowest(harmonics: Harmonics) -> float:
    """Place of the lowest of 4096 points of a profile with period 0.01 m."""
    orders, amplitudes, phases = (np.array(values) for values in harmonics)
    x = np.arange(4096) / 4096
    return 0.01 * float(x[np.argmin(np.cos(2 * np.pi * np.outer(x, orders) + phases) @ amplitudes)])


def _johnson() -> Sinusoid:
    return Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.3)
