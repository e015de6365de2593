"""Hard cases of the finite element reference: thin and nearly incompressible layers, contacts that vanish or close.

As for the boundary elements (hard_cases.py) the expectation stands here beforehand: the status of the result, or
`refused: ARGUMENT` where an error that names the argument is the right answer.  Reduced: P2/P1 on a coarse mesh; full:
the default resolution, P4/P3.  Correct means: within the uncertainty that the result states of a closed form
(waves on a layer of two periods, where the half-space is met to exp(-8 pi) = 1e-11; complete contact) or of the
boundary elements at the same edges and penetration.  SI units.
"""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np

import fem_reference
from bem.contact_state import ContactState
from bem.elastic.layer import Layer
from bem.geometry.profile import Profile
from bem.geometry.scaling import Solid
from fem_reference import Resolution
from validation.corpus.hard.hard_case_run import Answered, Asked, Check
from validation.corpus.hard.hard_case_scenes import (
    JOHNSON,
    MODULUS,
    WAVE,
    WAVE_WORK,
    johnson_penetration,
    westergaard_pressure,
)
from validation.references.closed_forms import Sinusoid, layer_compliance
from validation.references.paper_problem import PERIOD, Table

COARSE = Resolution(2, 10, 10)
HALF_SPACE = 1e-10  # relative, by which a layer of two periods differs from it
ROUGH_ORDERS = 20


WAVE_LAYER: Table = {
    "youngs_modulus": MODULUS,
    "poisson_ratio": 0.5,
    "thickness": 2 * PERIOD,
    "period": PERIOD,
    "harmonics": ([1], [WAVE], [0.0]),
    "control": "penetration",
    "work_of_adhesion": 0.0,
}


def wave(found: Answered) -> Iterator[str]:
    """Mean pressure and contact fraction of one wave on a thick layer: Westergaard, Johnson."""
    arguments, result = found.tables, found.result
    amplitude, period = arguments["harmonics"][1][0], arguments["period"]
    alpha = JOHNSON if arguments["work_of_adhesion"] else 0.0
    exact = Sinusoid(amplitude, period, arguments["youngs_modulus"], arguments["poisson_ratio"], alpha)
    psi = np.pi / 2 * result.contact_fraction
    # at the contact fraction found, which is uncertain itself: what that moves the pressure by is allowed for
    spread = np.pi / 2 * float(result.uncertainty["contact_fraction"])
    near = [float(exact.mean_pressure(at)) for at in (psi - spread, psi, min(psi + spread, np.pi / 2))]
    pressure = float(result.uncertainty["mean_pressure"]) + float(np.ptp(near))
    pressure += HALF_SPACE * max(exact.full_contact_pressure, abs(near[1]))
    depths = [float(exact.penetration(at)) for at in (psi - spread, psi, min(psi + spread, np.pi / 2))]
    depth = float(result.uncertainty["penetration"]) + float(np.ptp(depths)) + HALF_SPACE * amplitude
    yield from _beyond("mean pressure", result.mean_pressure, near[1], pressure)
    yield from _beyond("penetration", result.penetration, depths[1], depth)


def complete(found: Answered) -> Iterator[str]:
    """Elastic energy of complete contact: sum h_m^2 / (4 c(q_m)) times the period."""
    arguments, result = found.tables, found.result
    period = arguments["period"]
    orders, amplitudes, _ = (np.asarray(series, dtype=float) for series in arguments["harmonics"])
    layer = (arguments[name] for name in ("thickness", "youngs_modulus", "poisson_ratio"))
    compliance = layer_compliance(2 * np.pi * orders / period, *layer)
    energy = float(np.sum(amplitudes**2 / (4 * compliance)) * period)
    # sinh y - y for a thin layer loses digits in the closed form: eps / y^3
    allowed = float(result.uncertainty["elastic_energy"]) + 1e-12 * energy
    yield from _beyond("elastic energy", result.elastic_energy, energy, allowed)


def boundary_elements(found: Answered) -> Iterator[str]:
    """Mean pressure of the boundary elements at the same edges and penetration, both as found here."""
    arguments, result = found.tables, found.result
    orders, amplitudes, phases = (np.asarray(series) for series in arguments["harmonics"])
    profile = Profile(arguments["period"], orders, amplitudes.astype(float), phases.astype(float))
    solid = Solid(arguments["youngs_modulus"], arguments["poisson_ratio"])
    layer = Layer(arguments["thickness"])
    edges = [(float(a), float(b)) for a, b in result.edges]
    prescribed = "edges" in arguments

    def at(shift: float) -> float:
        moved = [(a - shift, b + shift) for a, b in edges]
        return ContactState(profile, solid, moved, result.penetration, layer, tolerance=1e-12).mean_pressure

    pressure = at(0.0)
    spread = 0.0 if prescribed else float(np.max(np.asarray(result.uncertainty["edges"])))
    moved = abs(at(spread) - pressure) if spread else 0.0
    allowed = float(result.uncertainty["mean_pressure"]) + moved
    yield from _beyond("mean pressure", result.mean_pressure, pressure, allowed)


def _beyond(name: str, found: float, expected: float, allowed: float) -> Iterator[str]:
    error = abs(found - expected)
    if not error <= allowed:
        yield f"{name} off by {error:.1e}, allowed {allowed:.1e}"


CHECKS: dict[str, Check] = {check.__name__: check for check in (wave, complete, boundary_elements)}


class FemCase(Asked):
    """A hard case of the reference: arguments of `fem_reference.solve`."""

    refusals: ClassVar[tuple[type[Exception], ...]] = (
        fem_reference.InvalidProblemError,
        fem_reference.SingularSystemError,
    )
    known: ClassVar[Mapping[str, Check]] = CHECKS
    forms: ClassVar[tuple[Table, Table]] = ({"resolution": COARSE}, {})

    @staticmethod
    def ask(question: Table) -> fem_reference.Result:
        """The layer solved."""
        return fem_reference.solve(**question)


def _case(name: str, reason: str, changes: Table, *checks: str, **named: Any) -> FemCase:
    return FemCase(name, reason, WAVE_LAYER | changes, checks, **named)


# fmt: off
def _fem_cases() -> Iterator[FemCase]:
    edges = [[-0.05 * PERIOD, 0.08 * PERIOD]]
    thin = {"thickness": 0.02 * PERIOD, "edges": edges, "value": 2e-7}
    rough_orders = np.arange(1, ROUGH_ORDERS + 1)
    heights = rough_orders**-1.2 * WAVE / np.sqrt(np.sum(rough_orders**-2.4) / 2)
    rough = (rough_orders.tolist(), heights.tolist(), np.random.default_rng(0).uniform(-3, 3, ROUGH_ORDERS).tolist())
    pressed = {"control": "mean_pressure"}
    adhesive = {"work_of_adhesion": WAVE_WORK}
    for ratio in (-0.9, 0.0, 0.499999, 0.5):
        yield _case(f"poisson_ratio_{ratio:g}",
                    "volumetric locking towards incompressibility; an auxetic layer at the other end",
                    {"poisson_ratio": ratio, "thickness": 0.1 * PERIOD, "edges": edges, "value": 2e-6},
                    "boundary_elements")
    yield _case("thin_incompressible_layer", "a layer of 0.02 periods and nu = 0.5 is stiff by its third power",
                thin, "boundary_elements")
    yield _case("thin_incompressible_layer_in_complete_contact", "the same, pressed flat",
                {"thickness": 0.02 * PERIOD, "edges": "complete", "value": 1e4, **pressed}, "complete",
                expected=("complete_contact",))
    yield _case("rough_thin_layer", "twenty harmonics on a layer thinner than most of their wavelengths",
                {"thickness": 0.05 * PERIOD, "poisson_ratio": 0.45, "edges": edges, "value": 4e-6, "harmonics": rough},
                "boundary_elements")
    yield _case("nearly_complete_contact", "the last gap closes without adhesion",
                {"value": westergaard_pressure(0.95), **pressed}, "wave", full={"value": westergaard_pressure(0.999)})
    yield _case("nearly_complete_contact_with_adhesion", "the load grows tensile without limit as the last gap closes",
                {"value": johnson_penetration(0.9), **adhesive}, "wave", full={"value": johnson_penetration(0.99)})
    yield _case("tiny_load", "a contact of a thousandth of the period, and of a ten-thousandth",
                {"value": westergaard_pressure(1e-3), **pressed}, "wave", full={"value": westergaard_pressure(1e-4)})
    yield _case("tension_before_pull_off", "a small adhesive contact in tension, near the fold",
                {"value": johnson_penetration(0.1), **adhesive}, "wave")
    yield _case("weak_adhesion", "1e-8 J/m^2", {"value": 2e-5, "work_of_adhesion": 1e-8}, "boundary_elements")
    yield _case("strong_adhesion", "100 J/m^2", {"value": 2e-5, "work_of_adhesion": 100.0}, "boundary_elements")
    yield _case("units_times_1e6", "lengths and stresses in units a million times smaller",
                {"youngs_modulus": MODULUS * 1e6, "thickness": 2e6 * PERIOD, "period": 1e6 * PERIOD,
                "harmonics": ([1], [WAVE * 1e6], [0.0]), "value": 1e6 * johnson_penetration(0.5),
                "work_of_adhesion": 1e12 * WAVE_WORK}, "wave")
    yield _case("uncovered_crest", "two equal crests and one patch: the other crest enters the layer",
                {"harmonics": ([2], [WAVE], [0.0]), "value": 2e-5}, expected=("interpenetration",))
    yield _case("beyond_pull_off", "a penetration at which no contact is left",
                {"value": -5e-5, **adhesive}, expected=("refused: value",))
    yield _case("apart", "nothing in contact, no adhesion", {"value": -1e-6}, expected=("refused: value",))
    yield _case("narrower_than_the_mesh", "a patch of 1e-7 periods",
                {"edges": [[0.0, 1e-7 * PERIOD]], "value": 1e-6}, expected=("refused: edges",))
    yield _case("incompressible_by_displacement",
                "complete contact of an incompressible layer knows no displacement but one",
                {"edges": "complete", "control": "total_displacement", "value": 1e-6},
                expected=("refused: control",))
# fmt: on


FEM_CASES: tuple[FemCase, ...] = tuple(_fem_cases())
