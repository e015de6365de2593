"""Error estimates of states: do they bound the true errors closely?

True errors: waves on a half-space (D = 100 um, period 10 mm, E = 1 MPa, nu = 0.5) by the formulas of Johnson and
Westergaard at the prescribed control; a layer of a tenth of the period (nu = 0.3) and a rough profile of 40 harmonics
by dense algebra next to the state (references/dense_equilibrium.py).  An estimate is good where it is at least the
true error and at most a hundred times that.  The references resolve 1e-14 of the largest value of a quantity in a
scene.
"""

from dataclasses import asdict, dataclass

import numpy as np
import pytest
from scipy.optimize import brentq

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.dense_algebra import reference
from validation.routes.scenes import posed, touching

RESOLUTION, ORDERS = 1e-14, 100.0
TOLERANCES = (1e-3, 1e-6, 1e-10)
LAYER = {"layer": {"thickness": 0.001}, "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3}}
ROUGH = [70e-6, 45e-6, 30e-6, 50e-6]  # m, separations


@dataclass(frozen=True)
class Number:
    """Reported number: true and estimated error over the largest value of its quantity in the scene."""

    quantity: str
    true: float
    estimate: float

    @property
    def bounded(self) -> bool:
        """True where the estimate is at least the true error, as far as the reference resolves it."""
        return self.true <= self.estimate + RESOLUTION

    @property
    def ratio(self) -> float:
        """Estimate over the true error, or over what the reference resolves."""
        return self.estimate / max(self.true, RESOLUTION)


def scenes(tolerance):
    """Return scenes by name, each with its closed form where it has one."""

    def at(scene, control, targets, **tables):
        loading = {"control": control, "targets": targets}
        return posed(scene, accuracy={"tolerance": tolerance}, loading=loading, **tables)

    waves = {alpha: Sinusoid(1e-4, 0.01, 1e6, 0.5, alpha) for alpha in (0.0, 0.1, 0.5)}
    adhesion = {alpha: {"work_of_adhesion": wave.work_of_adhesion} if alpha else None for alpha, wave in waves.items()}
    loads, fewer, depths = [2e3, 8e3, 1.5e4], {"harmonics": 40}, [2e-5, 5e-5, 9e-5, 4e-5]
    return {
        **{f"wave, alpha = {alpha:g}": (at("sinusoid", "penetration", depths, adhesion=adhesion[alpha]), wave)
           for alpha, wave in waves.items()},
        "wave under load": (at("sinusoid", "mean_pressure", loads, adhesion=None), waves[0.0]),
        "layer": (at("sinusoid", "total_displacement", [1e-5, 5e-5, 9e-5], **LAYER), None),
        "layer under load": (at("sinusoid", "mean_pressure", [1e3, 2e3, 4e3], **LAYER), None),
        "rough": (at("rough_100", "separation", ROUGH, profile=fewer), None),
        "rough, no adhesion": (at("rough_100", "separation", ROUGH, profile=fewer, adhesion=None), None),
        "rough under load": (at("rough_100", "mean_pressure", [1e3, 4e3, 9e3], profile=fewer, adhesion=None), None),
    }


def exact(scene, state, wave):
    """Return the exact numbers of a state, by dense algebra, and by the closed form where there is one."""
    known = reference(scene, state)
    if wave is None:
        return known
    loaded, near = scene.loading.control == "mean_pressure", state.contact_fraction * np.pi / 2
    prescribed = wave.mean_pressure if loaded else wave.penetration
    reached = state.mean_pressure if loaded else state.penetration
    target = min(scene.loading.targets, key=lambda value: abs(value - reached))
    psi = brentq(lambda p: float(prescribed(p)) - target, near * (1 - 1e-5), near * (1 + 1e-5), xtol=1e-16, rtol=1e-15)
    known |= {"contact_fraction": psi * 2 / np.pi, "mean_pressure": float(wave.mean_pressure(psi))}
    if loaded:
        penetration = float(wave.penetration(psi))
        known |= {"penetration": penetration, "separation": wave.amplitude - penetration}
    return known


def numbers(scene, wave, states):
    """Return every number that the states with edges report with an estimate."""
    states = touching(states)
    known = [exact(scene, state, wave) for state in states]
    scale = {name: max(abs(values[name]) for values in known) for name in known[0]}
    zero = ("adhesion_energy", "stress_intensity_max") if scene.adhesion is None else ()
    return [
        Number(name, abs(getattr(state, name) - values[name]) / scale[name], estimate / scale[name])
        for state, values in zip(states, known, strict=True)
        for name, estimate in asdict(state.error_estimate).items()
        if estimate is not None and scale[name] != 0 and name not in zero
    ]


@pytest.mark.quick
def test_estimates_bound_true_errors(rows):
    """Is the true error of nearly every reported number at most its estimate, and the estimate not far too large?"""
    every = [number for tolerance in TOLERANCES for scene, wave in scenes(tolerance).values()
             for number in numbers(scene, wave, bem.solve(scene).targets)]
    quantities = sorted({number.quantity for number in every})
    assert len(every) > 500 and len(quantities) == 10
    of = {name: [number for number in every if number.quantity == name] for name in quantities}
    for name, several in of.items():
        rows.compare(f"share of bounded errors: {name.replace('_', ' ')}", np.mean([n.bounded for n in several]), 1.0,
                     of=Code.BEM, by=Code.EXACT, quantity=Quantity.COUNT, uncertainty=0.0, required=0.05,
                     because="estimates claim 95 %", source=f"{len(several)} numbers")
    close = np.mean([number.ratio <= ORDERS for number in every])
    rows.compare("share of estimates at most a hundred times the true error", close, 1.0, of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.COUNT, uncertainty=0.0, required=0.05, because="estimates claim 95 %")
    assert max(number.true / number.estimate for number in every) <= 4  # no true error is far above its estimate
    rows.curves("Estimated against true errors, over the largest value", "true error (1e-14: or less)",
                "estimated error",
                {name.replace("_", " "): ([max(n.true, RESOLUTION) for n in several], [n.estimate for n in several])
                 for name, several in of.items()}, log="xy")
    ratios = {name: [number.ratio for number in several] for name, several in of.items()}
    rows.table("Estimated over true errors", ["quantity", "numbers", "bounded", "median", "largest"],
               [[name, len(several), sum(n.bounded for n in several), float(np.median(ratios[name])),
                 max(ratios[name])] for name, several in of.items()])
