"""Error estimates of states: do they bound the true errors closely?

True errors by dense algebra next to the state (references/dense_equilibrium.py): waves on a half-space (D = 100 um,
period 10 mm, E = 1 MPa, nu = 0.5), a layer of a tenth of the period (nu = 0.3) and a rough profile of 40 harmonics.  An
estimate is good where it is at least the true error and at most a hundred times that.  The reference resolves 1e-14 of
the largest value of a quantity in a scene.
"""

from dataclasses import asdict, dataclass

import numpy as np
import pytest

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.dense_algebra import reference
from validation.routes.scenes import posed, touching

RESOLUTION = 1e-14  # of the reference, over the largest value of a quantity
SCATTER = 0.95 * 0.05  # of a share of 95 %, times the count
ORDERS = 100.0  # most that an estimate may exceed the true error by
TOLERANCES = (1e-3, 1e-6, 1e-10)  # that the scenes ask for
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
    """Return the scenes: a wave dry, with weak and with strong adhesion, and under load; a layer; a rough profile."""

    def at(scene, control, targets, **tables):
        loading = {"control": control, "targets": targets}
        return posed(scene, accuracy={"tolerance": tolerance}, loading=loading, **tables)

    loads, fewer, depths = [2e3, 8e3, 1.5e4], {"harmonics": 40}, [2e-5, 5e-5, 9e-5, 4e-5]
    works = [Sinusoid(1e-4, 0.01, 1e6, 0.5, alpha).work_of_adhesion for alpha in (0.1, 0.5)]
    adhesions = [None, *({"work_of_adhesion": work} for work in works)]
    return [
        *(at("sinusoid", "penetration", depths, adhesion=adhesion) for adhesion in adhesions),
        at("sinusoid", "mean_pressure", loads, adhesion=None),
        at("sinusoid", "total_displacement", [1e-5, 5e-5, 9e-5], **LAYER),
        at("sinusoid", "mean_pressure", [1e3, 2e3, 4e3], **LAYER),
        at("rough_100", "separation", ROUGH, profile=fewer),
        at("rough_100", "separation", ROUGH, profile=fewer, adhesion=None),
        at("rough_100", "mean_pressure", [1e3, 4e3, 9e3], profile=fewer, adhesion=None),
    ]


def numbers(scene):
    """Return every number that the states of a scene with edges report with an estimate."""
    states = touching(bem.solve(scene).targets)
    known = [reference(scene, state) for state in states]
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
    every = [number for tolerance in TOLERANCES for scene in scenes(tolerance) for number in numbers(scene)]
    quantities = sorted({number.quantity for number in every})
    assert len(every) > 500 and len(quantities) == 10
    of = {name: [number for number in every if number.quantity == name] for name in quantities}
    for name, several in of.items():
        rows.compare(f"share of bounded errors: {name.replace('_', ' ')}", np.mean([n.bounded for n in several]), 1.0,
                     of=Code.BEM, by=Code.DENSE, quantity=Quantity.COUNT, source=f"{len(several)} numbers",
                     uncertainty=(2 * np.sqrt(SCATTER / len(several)), 0.0), required=0.05,
                     because="estimates claim 95 %")
    close = np.mean([number.ratio <= ORDERS for number in every])
    rows.compare("share of estimates at most a hundred times the true error", close, 1.0, of=Code.BEM, by=Code.DENSE,
                 quantity=Quantity.COUNT, uncertainty=(2 * np.sqrt(SCATTER / len(every)), 0.0),
                 required=0.05, because="estimates claim 95 %")
    assert max(number.true / number.estimate for number in every) <= 4  # no true error is far above its estimate
    rows.curves("Estimated against true errors, over the largest value", "true error (1e-14: or less)",
                "estimated error",
                {name.replace("_", " "): ([max(n.true, RESOLUTION) for n in several], [n.estimate for n in several])
                 for name, several in of.items()}, log="xy")
    ratios = {name: [number.ratio for number in several] for name, several in of.items()}
    rows.table("Estimated over true errors", ["quantity", "numbers", "bounded", "median", "largest"],
               [[name, len(several), sum(n.bounded for n in several), float(np.median(ratios[name])),
                 max(ratios[name])] for name, several in of.items()])
