"""What the finite elements release: the fold at which a contact pulls off, all jumps of a loop, and G at equilibrium.

One wave on a layer of two periods, a half-space to 1e-8: the state just before pull-off, and the fold under penetration
and under load, where the derivative by the contact fraction vanishes (fem_reference/fold.py), against Johnson's curve
and against the event of the boundary elements.

Two unequal crests on a layer, pressed and pulled off: the higher crest jumps into contact at first touch, the lower one
where the gap above it vanishes, it detaches at a fold, and so does the last patch. The finite elements find every one
of these places by themselves, and what each releases as the difference of their energies at fixed penetration,

    released = U(before) - U(after),   U elastic and adhesive energy;   the loop loses the sum.

Energy release rate at the edges that each code found for itself: by differences of its energies, and by what it closes
with,

    finite elements   dU/dx of an edge at fixed plate, meshes made anew (fem_reference/energy_difference.py),
    boundary elements K^2 / (2 E*), and dU/dx of an edge at fixed penetration, by differences of their own energy,

which is the work of adhesion w = gamma sqrt(1 + h'^2) there: a closure imposes its own K, but no difference of
energies. SI units.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

import bem
from bem.scene.result import Event
from bem.scene.scene import Scene
from fem_reference import Result
from fem_reference.energy_difference import energy_difference
from fem_reference.fold import Fold, Turning, fold
from validation.cases.finite_elements.fem_closed_forms import JOHNSON, layered
from validation.cases.finite_elements.fem_comparison import COARSER, GROUP, RESOLUTIONS, uncertain, within
from validation.cases.shared.checks import Against, Found, beside, in_forms, posed, solved
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.schema import Table
from validation.references import fem_adapter
from validation.references.closed_forms import Sinusoid

WAVE = Sinusoid(amplitude=50e-6, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
JUST_BEFORE = 0.97  # of the penetration at the fold
TURNING: dict[str, dict[Turning, str]] = {  # what is asked at these elements, and the elements that answer
    "P2/P1": {"penetration": "P2/P1"},
    "P4/P3": {"penetration": "P4/P3", "mean_pressure": "P2/P1"},
}
PRESSED, APART = 30e-6, -60e-6  # m of penetration
LOWER_CREST = (4.5e-3, 7e-3)  # m: between these
TOLERANCE = 1e-9  # of the scenes
SCENES: dict[str, tuple[str, int, dict[str, Any]]] = {  # scene, patches, changes
    "one crest": ("layer_sinusoid", 1, {"loading": {"targets": [20e-6]}}),
    "two crests": ("layer_two_crests", 2, {}),
}
STEP = 0.003  # of the shorter of the patch and the gap beside an edge
BEM_ERROR = 2e-7  # of w: three times what the difference of the energies of boundary elements was off by (7e-8)
Known = tuple[float, float]  # a number and its uncertainty


def _johnson(psi: float) -> dict[str, tuple[str, float, float]]:
    """Units, values and scales of a state of Johnson's curve."""
    return {
        "contact_fraction": ("", 2 * psi / np.pi, 1.0),
        "penetration": ("m", float(WAVE.penetration(psi)), WAVE.amplitude),
        "mean_pressure": ("Pa", float(WAVE.mean_pressure(psi)), WAVE.full_contact_pressure),
    }


def _waves(elements: str) -> Found:
    before = _wave(JUST_BEFORE * float(WAVE.penetration(WAVE.fold())), elements)
    psi = float(brentq(lambda at: float(WAVE.penetration(at)) - before.penetration, WAVE.fold(), 1.0))
    for name, (unit, exact, scale) in _johnson(psi).items():
        if name != "penetration":
            yield within(f"just before pull-off: {_said(name)}", unit, JOHNSON, exact, getattr(before, name),
                         uncertain(before, name), scale, "fem")  # fmt: skip
    folds = {turning: fold(before if turning == "penetration" else _wave(0.0, by), turning)
             for turning, by in TURNING[elements].items()}  # fmt: skip
    for turning, found in folds.items():  # against Johnson's curve and against the event of the boundary elements
        event = _pull_off(turning)
        for name, (unit, exact, scale) in _johnson(WAVE.fold() if turning == "penetration" else _load_fold()).items():
            label, spread = f"fold under {_said(turning)}: {_said(name)}", found.uncertainty[name]
            yield within(label, unit, JOHNSON, exact, found.values[name], spread, scale, "fem")
            if name != "contact_fraction":
                error = max(getattr(event.error_estimate, name) or 0.0, TOLERANCE * scale)
                yield within(f"{label}, boundary elements", unit, _fem(TURNING[elements][turning], spread),
                             found.values[name], getattr(event, name), error, scale)  # fmt: skip
    yield JOHNSON.count("just before pull-off: stable", 1.0, bool(before.stable), code="fem")
    psi_near, turned = np.linspace(0.02, 0.5, 200), folds["penetration"].values
    yield drawn(f"fem-fold-{before.resolution.order}",
                "Johnson's curve near pull-off, the state just before it and the fold, both by finite elements.",
                axes("penetration / um", "mean pressure / Pa",
                     trace("Johnson 1995", WAVE.penetration(psi_near) * 1e6, WAVE.mean_pressure(psi_near)),
                     marks("just before pull-off", [before.penetration * 1e6], [before.mean_pressure]),
                     marks("fold under penetration", [turned["penetration"] * 1e6],
                           [turned["mean_pressure"]])))  # fmt: skip
    yield {"unknowns of the finite elements": before.unknowns}


def _wave(penetration: float, elements: str) -> Result:
    return fem_adapter.solve_fem(layered(WAVE, penetration), COARSER[elements])


def _fem(elements: str, uncertainty: float) -> Against:
    return Against("FEM", f"fem_reference, {elements}", uncertainty)


def _load_fold() -> float:
    """Psi at which Johnson's load is least: sin 2 psi = alpha / (2 sqrt(tan psi) cos^2 psi)."""

    def slope(psi: float) -> float:
        return float(np.sin(2 * psi) - WAVE.alpha / (2 * np.sqrt(np.tan(psi)) * np.cos(psi) ** 2))

    return float(brentq(slope, 0.01, 1.0, xtol=1e-15))


def _pull_off(turning: Turning) -> Event:
    """The event at which the boundary elements lose the contact of the wave, on the way out."""
    end = -2 * WAVE.amplitude if turning == "penetration" else -0.5 * WAVE.full_contact_pressure
    events = bem.solve(layered(WAVE, 0.0, control=turning, targets=[0.0, end])).events
    return next(event for event in events if event.kind == "pull_off")


def _said(name: str) -> str:
    return name.replace("_", " ")


@dataclass(frozen=True)
class FemEvent:
    """An event by the finite elements: m and J/m^2."""

    kind: str
    penetration: Known
    released: Known


def _crests(penetration: float, elements: str, patches: int, near: Result | None = None) -> Result:
    """The two crests at a penetration, with contact at the higher one or at both; from the edges of a state near by."""
    scene = posed("layer_two_crests", loading={"targets": [penetration]})
    start = None if near is None else near.edges
    found = fem_adapter.solve_fem(scene, RESOLUTIONS[elements], patches, start=start)
    if found.closure_residual is None or found.status not in ("converged", "interpenetration"):
        raise ArithmeticError(f"finite elements, {patches} patches at {penetration:g} m: {found.status}")
    return found


def _lowest_gap(found: Result) -> Known:
    """Least gap above the lower crest, m."""
    x = np.linspace(*LOWER_CREST, 401)
    k = int(np.argmin(found.gap(x)))
    near = np.linspace(x[k - 1], x[k + 1], 401)
    return float(np.min(found.gap(near))), float(np.max(found.uncertainty_at("gap", near)))


def touch(elements: str) -> Known:
    """Penetration at which the gap above the lower crest vanishes, m: by secants."""
    places = [0.8 * PRESSED, 0.9 * PRESSED]
    found = _crests(places[0], elements, 1)
    gaps = [_lowest_gap(found), _lowest_gap(_crests(places[1], elements, 1, found))]

    def slope() -> float:
        return (gaps[-1][0] - gaps[-2][0]) / (places[-1] - places[-2])

    while abs(gaps[-1][0]) > gaps[-1][1]:
        places.append(places[-1] - gaps[-1][0] / slope())
        gaps.append(_lowest_gap(_crests(places[-1], elements, 1, found)))
    return places[-1] - gaps[-1][0] / slope(), gaps[-1][1] / abs(slope())


def jumps(elements: str) -> list[FemEvent]:
    """The four events of the loop, in their order."""

    def energy(found: Result) -> Known:
        return found.total_energy, uncertain(found, "total_energy")

    def between(kind: str, place: Known, before: Known, after: Known) -> FemEvent:
        period = pressed.problem.period
        return FemEvent(kind, place, ((before[0] - after[0]) / period, (before[1] + after[1]) / period))

    def turned(found: Fold) -> list[Known]:
        return [(found.values[name], found.uncertainty[name]) for name in ("penetration", "total_energy")]

    nothing = (0.0, 0.0)
    pressed, first, touched = _crests(PRESSED, elements, 2), _crests(0.0, elements, 1), touch(elements)
    at_touch = [energy(_crests(touched[0], elements, patches)) for patches in (1, 2)]
    detaching, detached = turned(fold(pressed, "penetration"))
    pulled, pulled_energy = turned(fold(first, "penetration"))
    return [
        between("first_touch", nothing, nothing, energy(first)),
        between("new_contact", touched, *at_touch),
        between("detachment", detaching, detached, energy(_crests(detaching[0], elements, 1))),
        between("pull_off", pulled, pulled_energy, nothing),
    ]


def _loop(elements: str) -> Found:
    ours = solved("layer_two_crests", loading={"targets": [PRESSED, APART]}).events
    theirs, height = jumps(elements), posed("layer_two_crests").surface().rms_height
    yield Against("FEM", "fem_reference").count("events of the loop", len(theirs), len(ours))
    loss = sum(jump.released[0] for jump in theirs)
    for jump, event in zip(theirs, ours, strict=True):
        if event.kind != jump.kind:
            raise ArithmeticError(f"boundary elements: {event.kind} where finite elements have {jump.kind}")
        estimate = event.error_estimate
        for name, unit, (value, spread), computed, error, scale in (
            ("penetration", "m", jump.penetration, event.penetration, estimate.penetration, height),
            ("energy released", "J/m^2", jump.released, event.energy_released or 0.0, estimate.energy_released, loss),
        ):
            if spread:  # the first touch is at zero penetration by definition
                yield within(f"{_said(jump.kind)}: {name}", unit, _fem(elements, spread), value, computed,
                             max(error or 0.0, TOLERANCE * scale), scale)  # fmt: skip
    lost = sum(event.energy_released or 0.0 for event in ours)
    total = _fem(elements, sum(jump.released[1] for jump in theirs))
    yield within("energy lost in the loop", "J/m^2", total, loss, lost, TOLERANCE * loss, loss)
    yield Table(caption="Events of the loop by both codes; penetration in um, energy released in mJ/m^2.",
                columns=["event", "penetration, FEM", "+-", "BEM", "released, FEM", "+-", "BEM"],
                rows=[[_said(jump.kind), *(float(f"{1e6 * v:.9g}") for v in jump.penetration), event.penetration * 1e6,
                       *(float(f"{1e3 * v:.9g}") for v in jump.released), (event.energy_released or 0.0) * 1e3]
                      for jump, event in zip(theirs, ours, strict=True)])  # fmt: skip


def _difference_of_bem(scene: Scene, edges: FloatArray, penetration: float) -> FloatArray:
    """G (n_patches, 2) in J/m^2: fourth-order differences of the elastic energy at fixed penetration."""
    rates, steps = np.zeros(edges.shape), STEP * beside(edges, scene.surface().period)
    for place in np.ndindex(*edges.shape):
        total = 0.0
        for k, weight in ((1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0)):
            moved = edges.copy()
            moved[place] += k * steps[place] * (1.0 if place[1] else -1.0)
            total += weight * fem_adapter.contact_state(scene, moved, penetration).elastic_energy
        rates[place] = total / (12 * steps[place])
    return rates


def _rates(elements: str, label: str) -> Found:
    name, patches, changes = SCENES[label]
    scene = posed(name, **changes)
    state, fem = bem.solve(scene).targets[-1], fem_adapter.solve_fem(scene, COARSER[elements], patches)
    if state.status != "converged" or fem.status != "converged":
        raise ArithmeticError(f"{label}: boundary elements {state.status}, finite elements {fem.status}")
    found, uncertain = energy_difference(fem)
    spread, edges = float(np.max(uncertain)), np.array(state.edges)
    elastic = fem_adapter.contact_state(scene, edges, state.penetration)
    assert scene.adhesion is not None
    work = scene.adhesion.work_of_adhesion
    slope = scene.surface().slope(fem.edges) if scene.adhesion.slope_term else 0.0 * fem.edges
    by_energies = Against("FEM", f"fem_reference, {elements}, by its energies", spread)
    ours = f"{label}: G of the boundary elements"
    yield within(f"{ours}, K^2 / 2 E*", "J/m^2", by_energies, found, elastic.energy_release_rate, BEM_ERROR * work,
                 work)  # fmt: skip
    yield within(f"{ours}, by differences of energies", "J/m^2", by_energies, found,
                 _difference_of_bem(scene, edges, state.penetration), BEM_ERROR * work, work)  # fmt: skip
    yield within(f"{label}: G of the finite elements, by differences of energies", "J/m^2",
                 Against("exact", "the work of adhesion at the edges"), work * np.sqrt(1 + slope**2), found, spread,
                 work, "fem")  # fmt: skip
    yield {"unknowns of the finite elements": fem.unknowns}


CASES = (
    *in_forms({"fem-fold-coarse": ("quick", "P2/P1"), "fem-fold": ("standard", "P4/P3")}, GROUP, _waves,
              "Do both codes and Johnson's curve lose the contact of a wave at the same place?",
              r"$d\Delta/da = 0$, $dp/da = 0$ at $K = \sqrt{2 E^\ast \gamma}$, $a$ the contact fraction",
              "johnson1995 destuynder1983", "layer adhesion unloading", scene="layer_sinusoid"),
    *in_forms({"fem-loop-coarse": ("standard", "P2/P1"), "fem-loop": ("full", "P4/P3")}, GROUP, _loop,
              "Do both codes find the same events of a loop of loading and unloading, and what it loses?",
              r"$U = U_{el} - \int \gamma \sqrt{1 + h'^2} dx$; released $= U_1 - U_2$ at fixed $\Delta$",
              "carbone2009 destuynder1983", "layer adhesion slope_term unloading", scene="layer_two_crests"),
    *in_forms(
        {"fem-release-rate-coarse": ("quick", "P2/P1", "one crest"),
         "fem-release-rate": ("standard", "P4/P3", "one crest"),
         "fem-release-rate-two": ("full", "P4/P3", "two crests")}, GROUP, _rates,
        "Is the energy that opening an edge releases the same by differences of both codes' energies?",
        r"$G = dU / d\xi = K^2 / (2 E^\ast) = \gamma \sqrt{1 + h'^2}$ at every edge",
        "carbone2009 destuynder1983 shih1986", "layer adhesion slope_term", scene="layer_two_crests"),
)  # fmt: skip
