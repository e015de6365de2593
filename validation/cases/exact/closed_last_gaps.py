"""The last gaps before complete contact without adhesion, against closed forms that share no code with the solver.

One wave is Westergaard's at any load: with S = p/p* the gap is (2/pi) asin(sqrt(1 - S)) of the period wide and the
separation is D (1 - S + S ln S).  Elsewhere gaps are isolated cracks as they close (isolated_crack.py), at the lowest
pressures of complete contact, with a layer too: every mode carries h_m over its compliance.  What the closed form
leaves out is of the order of the missing load, what rounding leaves is 1e-16 over it: together least at 1e-8.  And of
two equal gaps one is taken for contact: the certificate has to find the tension that is left there.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

import bem
from bem.audit.certificate import certify
from bem.contact_state import ContactState
from bem.geometry.profile import Profile
from bem.geometry.scaling import Solid
from bem.scene.result import State
from bem.scene.scene import parse_scene
from validation.cases.shared.checks import Against, Found, case, column
from validation.corpus.hard.hard_case_scenes import MODULUS, rough, scene, waves
from validation.harness.schema import Row
from validation.references.closed_forms import layer_compliance
from validation.references.isolated_crack import closing, valleys
from validation.references.paper_problem import PERIOD

AMPLITUDE = 1e-4
DEFICITS = (1e-3, 1e-6, 1e-9, 1e-12)
ONE_TAKEN = 86393.78  # Pa, 2e-7 from complete contact
NEAR = 1e-8  # missing load at which isolated cracks are compared
PROFILES: dict[str, tuple[dict[str, Any], float | None, float]] = {
    "two equal gaps": (waves([1, 2], [AMPLITUDE, AMPLITUDE]), None, 0.5),
    "two gaps of orders 2 and 3": (waves([2, 3], [AMPLITUDE, AMPLITUDE]), None, 0.5),
    "100 harmonics": (rough(100, seed=1), None, 0.5),
    "layer of 0.05 periods": (waves([1, 2], [AMPLITUDE, AMPLITUDE]), 0.05 * PERIOD, 0.3),
}
CLOSED = Against("exact", "Westergaard (1939); isolated cracks as the gaps close")
BY_LOAD, FRACTION = (1.5e-15, 4.9e-16), (5e-16, 1.6e-16)  # pressures and contact fractions round to 1e-16
ISOLATED = (6e-7, 2e-7)  # what the closed form leaves out


def _states(profile: dict[str, Any], control: str, targets: list[float], layer: float | None, nu: float) -> list[State]:
    posed = parse_scene(scene(profile, control, targets, thickness=layer, poisson_ratio=nu))
    return [state for state in bem.solve(posed).states if state.target]


def complete_pressure(surface: Profile, layer: float | None, nu: float) -> Profile:
    """Pressure of complete contact less its mean, Pa: h_m / c(q), Carbone and Mangialardi (2008)."""
    q = 2 * np.pi / surface.period * surface.orders
    compliance = 2 * (1 - nu**2) / (MODULUS * q) if layer is None else layer_compliance(q, layer, MODULUS, nu)
    return Profile(surface.period, surface.orders, surface.amplitudes / compliance, surface.phases)


def _one_wave() -> Iterator[Row]:
    """Gap and separation of one wave down to 1e-12 from complete contact, as errors of a load or of the period."""
    highest = np.pi * MODULUS / (1 - 0.5**2) * AMPLITUDE / PERIOD
    loads = [highest * (1 - deficit) for deficit in DEFICITS]
    missing = np.array([(highest - load) / highest for load in loads])  # the difference of floating point numbers
    k = np.arange(2, 30)
    heights = AMPLITUDE * np.sum(missing[:, None] ** k / (k * (k - 1.0)), axis=1)
    gaps, profile = 2 / np.pi * np.arcsin(np.sqrt(missing)), waves([1], [AMPLITUDE])
    states = _states(profile, "mean_pressure", loads, None, 0.5)
    back = _states(profile, "separation", heights.tolist(), None, 0.5)
    wider = (1 - np.array(column(states, "contact_fraction"))) / gaps - 1
    apart, kept = (np.array(column(each, "separation")) / heights - 1 for each in (states, back))
    fraction = np.array(column(back, "contact_fraction")) - (1 - gaps)
    for name, errors, allowed in (
        ("one wave at given load: relative error of the gap times missing load", wider * missing, BY_LOAD),
        ("one wave at given load: relative error of s times missing load", apart * missing, BY_LOAD),
        ("one wave at given separation: error of the contact fraction", fraction, FRACTION),
        ("one wave at given separation: relative error of s", kept, FRACTION),
    ):
        yield CLOSED.row(name, "", [0.0] * len(loads), errors, allowed, "absolute")


def _isolated_cracks() -> Iterator[Row]:
    """Number and widths of gaps, separation, and the load at that separation, at 1e-8 from complete contact."""
    for name, (profile, layer, nu) in PROFILES.items():
        posed = parse_scene(scene(profile, "mean_pressure", [1.0], thickness=layer, poisson_ratio=nu))
        modulus = MODULUS / (1 - nu**2)
        complete = complete_pressure(posed.surface(), layer, nu)
        value, curvature = valleys(complete)
        highest = -float(value.min())
        (state,) = _states(profile, "mean_pressure", [highest * (1 - NEAR)], layer, nu)
        separation = 2 * np.pi / PERIOD * (highest * NEAR) ** 2 * float(np.sum(1 / curvature)) / modulus
        (back,) = _states(profile, "separation", [separation], layer, nu)
        pressure, widths = closing(complete, modulus, separation)
        gap = (1 - state.contact_fraction) * PERIOD / float(widths.sum())
        missing = (highest - back.mean_pressure) / (highest - pressure)
        yield CLOSED.row(f"{name}: gap, separation, missing load over those of lone cracks", "", [1.0] * 3,
                         [gap, state.separation / separation, missing], ISOLATED, "absolute")  # fmt: skip
        good = [one.n_patches == value.size and one.certificate.ok for one in (state, back)]
        yield CLOSED.row(f"{name}: all gaps there and certified", "", [1.0] * 2, good, 0.0, "absolute", required=0.5)


def _last_gaps() -> Found:
    yield from _one_wave()
    yield from _isolated_cracks()
    # of two equal gaps one taken for contact, on the edges of the other: whether tension is found in it
    posed = parse_scene(scene(PROFILES["two equal gaps"][0], "mean_pressure", [ONE_TAKEN]))
    (state,) = (state for state in bem.solve(posed).states if state.target)
    surface = posed.surface()
    edges = [[state.edges[0][0], state.edges[1][1]]]
    joined = ContactState(surface, Solid(MODULUS, 0.5), edges, state.penetration, tolerance=1e-8)
    depth = state.penetration / surface.rms_height
    reasons = certify(surface.scaled(), joined.evaluation.pressure(), depth, None).reasons
    found = any(reason.startswith("tension") for reason in reasons)
    yield CLOSED.row("one of two gaps taken for contact: tension found (1: yes)", "", 1.0, found, 0.0, "absolute",
                      required=0.5)  # fmt: skip


CASES = (
    case("last-gaps", "closed forms", _last_gaps,
         "Do the last gaps before complete contact without adhesion close as the closed forms say?",
         r"gap $= \frac{2}{\pi} \arcsin \sqrt{1 - p / p^\ast}$; "
         r"$T = k c^2 / 4$, $s = \frac{2 \pi T^2}{\lambda E^\ast k}$",
         "westergaard1939 tada2000 carbone2008", "half_space layer load_control"),
)  # fmt: skip
