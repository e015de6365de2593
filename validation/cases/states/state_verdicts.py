"""What is said of a state: stable at fixed load or not, its stiffness, and whether its certificate is ok.

On Johnson's curve both sides of the largest tension are stable at fixed penetration; at fixed load only those whose
mean pressure rises with the contact.  The stiffness is (dp/dpsi) / (dDelta/dpsi).

A certificate that accepts everything is found by states that are wrong on purpose, each in one way: closed forms of one
patch (one_patch.py) that have tension inside or a crest inside the other body, and solved states of which an edge, the
penetration or the smallest eigenvalue were changed.  SI units.

And where it stops accepting (dimensionless).  Westergaard's two patches on a wave cos 2x, each half as wide as the
wave, leave at x = pi/2 and 3 pi/2 gaps of depth

    g = 2 sqrt(1 - s^2) - 2 s^2 log((1 + sqrt(1 - s^2)) / s),   s^2 = 1/2,

lengths of the wave's amplitude.  A bump B exp(-((x - x_0) / b)^2) on the profile in the middle of one gap is felt
nowhere else.  It is accepted for B below g, refused for B beyond it by twice the limit of the certificate, and the gap
is named.  A series cut short, a penetration that is no number, patches a little too narrow or too deep are refused too.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.fft import dct
from scipy.optimize import brentq

import bem
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.equilibrium_assessment import assess_equilibrium
from bem.audit.certificate import Certificate, Demands, certify
from bem.certified_states import equilibrium_state
from bem.elastic.collocation import evaluate
from bem.geometry.patches import Patches, PatchPressure
from bem.nonadhesive.contact_assessment import assess_contact
from bem.problem import pose
from bem.scene.result import State
from validation.cases.shared.checks import Against, Found, case, column, posed, solved
from validation.references.closed_forms import Sinusoid
from validation.references.one_patch import OnePatch

WAVE = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3)
BESIDE = (1.3, 1.1, 1.02, 0.98, 0.9)  # psi over that of the largest tension; pull-off lies at 0.80
STEP = 1e-5  # of psi, in differences of fourth order
RATIOS = (7e-14, 2.7e-14)  # tolerance and error measured
# a at which the dip is in compression, and at which its tension is a thousandth of the largest pressure
DENTED = (2.5, 1.57)
OPENS = (1.575, 1.57)
UNSTABLE, INSIDE = 0.5, 0.44  # a on a falling branch, and just before an edge takes a crest
HALF = np.pi / 4  # half width of each patch
MIDDLES = np.array([np.pi / 2, 3 * np.pi / 2])  # of the gaps behind the patches
DEPTH = float(np.sqrt(2) - np.log(1 + np.sqrt(2)))  # of either gap
WIDTH, ORDERS = 0.15, 90  # of a bump; its harmonics beyond are below 1e-19
LIMIT = Demands().interpenetration
NODES = 60


def _slope(quantity: Any, psi: float) -> float:
    near, far = (float(quantity(psi + times * STEP * psi) - quantity(psi - times * STEP * psi)) for times in (1, 2))
    return (8 * near - far) / (12 * STEP * psi)


def _stability() -> Found:
    tension = float(brentq(lambda psi: _slope(WAVE.mean_pressure, psi), WAVE.fold(), 0.6, xtol=1e-14))
    psi, work = tension * np.array(BESIDE), WAVE.work_of_adhesion
    targets = [float(WAVE.penetration(2 * tension)), *WAVE.penetration(psi).tolist()]
    states = solved("sinusoid", adhesion={"work_of_adhesion": work}, loading={"targets": targets}).targets[1:]
    slopes = [_slope(WAVE.mean_pressure, p) for p in psi.tolist()]
    johnson = Against("exact", "Johnson 1995: the mean pressure rises with the contact width")
    yield johnson.count("stable at fixed load (1: yes), from compression to pull-off past the largest tension",
                        [slope > 0 for slope in slopes], column(states, "stable_at_fixed_load"))  # fmt: skip
    yield johnson.row("contact stiffness, over the largest", "Pa/m",
                      [slope / _slope(WAVE.penetration, p) for slope, p in zip(slopes, psi.tolist(), strict=True)],
                      column(states, "contact_stiffness"), (1.2e-10, 4e-11))  # fmt: skip
    yield Against("exact", "K^2 = 2 E* w, U_ad = -w f").row(
        "largest stress intensity over critical, adhesion energy over -w f, total over both energies", "",
        [1.0] * 3 * len(states), [ratio for state in states for ratio in _ratios(state)], RATIOS)  # fmt: skip
    loading = {"control": "mean_pressure", "targets": [1.2 * WAVE.full_contact_pressure],
               "initial": "complete_contact", "flaw": 1e-5}  # fmt: skip
    (state,) = solved("sinusoid", adhesion={"work_of_adhesion": work}, loading=loading).targets
    yield Against("exact", "p* D / 4 and -w").row(
        "elastic energy and adhesion energy of complete contact, over the larger", "J/m^2",
        [WAVE.full_contact_pressure * WAVE.amplitude / 4, -work], [state.elastic_energy, state.adhesion_energy],
        RATIOS)  # fmt: skip
    # stiffness where the work of adhesion grows with the slope
    steep = replace(WAVE, amplitude=1e-3)
    middle, step = 0.6e-3, 1e-6
    adhesion = {"work_of_adhesion": steep.work_of_adhesion, "slope_term": True}
    states = solved("sinusoid", profile={"amplitudes": [steep.amplitude]}, adhesion=adhesion,
                    loading={"targets": [middle + times * step for times in (-2, -1, 0, 1, 2)]}).targets  # fmt: skip
    p = column(states, "mean_pressure")
    yield Against("self", "differences of fourth order of the mean pressure of neighbouring states").row(
        "contact stiffness on a steep wave with the slope term", "Pa/m",
        (8 * (p[3] - p[1]) - (p[4] - p[0])) / (12 * step), states[2].contact_stiffness, (3e-11, 1e-11))  # fmt: skip


def _ratios(state: State) -> tuple[float, float, float]:
    """What is reported of a state of the wave over what it must be."""
    work = WAVE.work_of_adhesion
    return (
        (state.stress_intensity_max or 0.0) / float(np.sqrt(2 * WAVE.modulus * work)),
        state.adhesion_energy / (-work * state.contact_fraction),
        state.total_energy / (state.elastic_energy + state.adhesion_energy),
    )


@dataclass(frozen=True)
class PosedState:
    """A state handed to the solver's verdict: one patch from the closed form, and what is wrong with it."""

    name: str
    wave: OnePatch  # its harmonics are those of the surface
    angle: float  # pi times the contact fraction
    shift: float = 0.0  # by which the right edge is moved, over the width
    deeper: float = 0.0  # by which the penetration is too large, over the rms height
    adhesive: bool = True  # whether the verdict is that of an adhesive contact
    eigenvalue: float | None = None  # put in place of the smallest one

    def accepted(self) -> bool:
        """Whether the state that the solver would store has a certificate that is ok."""
        orders = np.flatnonzero(self.wave.harmonics) + 1
        heights = np.array(self.wave.harmonics)[orders - 1]
        profile = {"orders": orders.tolist(), "amplitudes": np.abs(heights).tolist(),
                   "phases": np.where(heights > 0, 0.0, np.pi).tolist()}  # fmt: skip
        adhesion = {"work_of_adhesion": self.wave.work} if self.adhesive else None
        scene = posed("sinusoid", profile=profile, adhesion=adhesion)
        problem = pose(scene, scene.surface())
        dip = problem.surface.max_height - float(problem.surface.height(0.0))
        depth = (float(self.wave.penetration(self.angle)) + dip) / problem.scales.height + self.deeper
        edges = np.array([-self.angle]), np.array([self.angle * (1 + 2 * self.shift)])
        patches, fine, finest = Patches(*edges), 1e-12, 1e-14
        if problem.law is None:
            state = evaluate(problem.elastic, patches, depth, fine)
            assessment = assess_contact(problem.elastic, problem.control, state, depth, finest)
        else:
            system = System(problem.elastic, problem.law, problem.control)
            here = balance(system, patches, depth, depth, fine)
            state, assessment = here.state, assess_equilibrium(system, here, depth, finest)
        if self.eigenvalue is not None:
            assessment = replace(assessment, min_eigenvalue=self.eigenvalue)
        stored = equilibrium_state(problem, state, assessment, 1e-10, target=True)
        return stored.certificate.ok


def _refusals() -> Found:
    modulus, length = WAVE.modulus, WAVE.wavelength
    smooth = OnePatch(length, modulus, (1e-4,), WAVE.work_of_adhesion)
    rippled = OnePatch(length, modulus, (1e-4, *[0.0] * 18, 4e-6), 0.06)
    dented = OnePatch(length, modulus, (1e-4, -0.5e-4), 0.0)  # two crests with a dip between them
    free = replace(smooth, work=0.0)
    right = (
        PosedState("adhesive", smooth, 1.2),
        PosedState("without adhesion", free, 1.2, adhesive=False),
        PosedState("two crests pressed together", dented, DENTED[0], adhesive=False),
    )
    wrong = (
        PosedState("an edge moved", smooth, 1.2, shift=1e-6),
        PosedState("too deep", smooth, 1.2, deeper=1e-6),
        PosedState("negative eigenvalue", smooth, 1.2, eigenvalue=-1e-3),
        PosedState("beyond the fold", rippled, UNSTABLE),
        PosedState("crest inside the other body", rippled, INSIDE),
        PosedState("an edge moved without adhesion", free, 1.2, shift=1e-6, adhesive=False),
        PosedState("tension at the edges without adhesion", smooth, 1.2, adhesive=False),
        PosedState("tension inside without adhesion", dented, DENTED[1], adhesive=False),
    )
    known = Against("exact", "equilibria in closed form, and the same with one fault each")
    names = ", ".join(state.name for state in wrong)
    yield known.count("states in equilibrium that are accepted (1: yes)", [1.0] * len(right),
                      [state.accepted() for state in right])  # fmt: skip
    yield known.count(f"states that are refused (1: yes): {names}", [1.0] * len(wrong),
                      [not state.accepted() for state in wrong])  # fmt: skip
    harmonics = ([1, 2], [1e-4, 0.5e-4], [0.0, np.pi])
    profile = dict(zip(("orders", "amplitudes", "phases"), harmonics, strict=True))
    surface = bem.Profile.from_harmonics(length, *harmonics)
    dip = surface.max_height - float(surface.height(0.0))
    loading = {"targets": [float(dented.penetration(angle)) + dip for angle in OPENS]}
    states = solved("sinusoid", profile=profile, adhesion=None, loading=loading).targets
    yield Against("exact", "pressure of one patch, which vanishes at the dip at a = pi / 2").count(
        "patches before and after the dip between two crests opens", [1.0, 2.0], column(states, "n_patches")
    )


def _certified(
    bump: float = 0.0, gap: int = 0, nodes: int = NODES, wider: float = 0.0, deeper: float = 0.0
) -> Certificate:
    """The certificate of the two patches, with a bump in a gap, few coefficients, or another width or penetration."""
    order = np.arange(1, ORDERS + 1)
    heights = bump * WIDTH / np.sqrt(np.pi) * np.exp(-((order * WIDTH / 2) ** 2)) * np.exp(1j * order * MIDDLES[gap])
    heights[1] += 1.0
    profile = bem.Profile.from_harmonics(2 * np.pi, order, np.abs(heights), -np.angle(heights))
    t = np.cos((np.arange(NODES) + 0.5) * np.pi / NODES)
    x = HALF * t
    q = 2 * HALF * np.cos(x) * np.sqrt((0.5 - np.sin(x) ** 2) * (1 - t * t)) * 2
    series = (dct(q, type=2) / NODES / np.where(np.arange(NODES) == 0, 2, 1))[:nodes]
    half = HALF * (1 + wider)
    centres = np.array([0.0, np.pi])
    pressure = PatchPressure(centres - half, centres + half, (series, series))
    return certify(profile, pressure, 0.5 * (1 + np.log(2)) + deeper, None)


def _limits() -> Found:
    accepted = {
        "as they are": _certified(),
        "bump short of the other body by half the limit": _certified(DEPTH - LIMIT / 2),
        "in the other gap": _certified(DEPTH - LIMIT / 2, gap=1),
    }
    refused = {
        "interpenetration 2.00e-10 exceeds 1e-10 in the gap behind patch 0": _certified(DEPTH + 2 * LIMIT),
        "interpenetration 2.00e-10 exceeds 1e-10 in the gap behind patch 1": _certified(DEPTH + 2 * LIMIT, gap=1),
        "truncation": _certified(nodes=8),
        "contact residual 1.00e-07": _certified(deeper=1e-7),
        "contact residual 9.53e-08": _certified(wider=1e-7),
        "mean gap less separation nan": _certified(deeper=float("nan")),
    }
    known = Against("exact", "Westergaard's two patches, and a bump as high as the gap is deep")
    named = [any(said.startswith(reason) for said in found.reasons) for reason, found in refused.items()]
    alone = [len(refused[reason].reasons) == 1 for reason in list(refused)[:2]]
    yield known.count(f"accepted (1: yes): {', '.join(accepted)}", [1.0] * 3, [found.ok for found in accepted.values()])
    yield known.count(f"refused with this reason (1: yes): {', '.join(refused)}", [1.0] * len(refused), named)
    yield known.count("a bump is the only reason (1: yes)", [1.0, 1.0], alone)


CASES = (
    case("stability-flag", "closed forms", _stability,
         "Are states stable at fixed load up to the largest tension and not beyond it, and how stiff are they?",
         r"stable at fixed load where $dp / d\psi > 0$; stiffness $= \frac{dp / d\psi}{d\Delta / d\psi}$",
         "johnson1995", "half_space adhesion unloading", scene="sinusoid"),
    case("refused-states", "identities", _refusals,
         "Does the certificate accept equilibria and refuse states that are wrong in one way each?",
         r"$G = w$ or $K = 0$ at edges, $u = h - h_{\text{max}} + \Delta$ on patches, gap $\ge 0$, "
         r"$H > 0$ or $p \ge 0$",
         "carbone2009 muskhelishvili1953", "half_space adhesion", scene="sinusoid"),
    case("refusal-limits", "identities", _limits,
         "Does the certificate accept what is just within its limits, and refuse and name what is just beyond?",
         r"gap $\ge -10^{-10}$ rms heights, $u = h - h_{\text{max}} + \Delta$ on patches, every figure a number",
         "westergaard1939", "half_space"),
)  # fmt: skip
