"""Events and energies released by both codes: the fold at which a contact pulls off, the jumps of a loop, G at
equilibrium.

- One wave on a layer of two periods (D = 50 um, period 10 mm, E = 1 MPa, nu = 0.3, alpha = 0.3), a half-space to 1e-8:
  the state just before pull-off, and the fold under penetration and under load, against Johnson's curve and against
  the event of the boundary elements.
- Two unequal crests on a layer, pressed and pulled off: the higher crest jumps into contact at first touch, the lower
  one where the gap above it vanishes, it detaches at a fold, and so does the last patch.  Finite elements find all
  four places by themselves; each releases U(before) - U(after) at fixed penetration, U elastic and adhesive energy.
- G at the edges that each code found for itself, by differences of its energies and by K^2 / (2 E*): it is the work of
  adhesion w = gamma sqrt(1 + h'^2).  A closure imposes its own K, but no difference of energies.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import brentq

import bem
from fem_reference import Resolution
from fem_reference.energy_difference import energy_difference
from fem_reference.fold import fold
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.fem_scenes import solve_fem, uncertain
from validation.routes.scenes import contact_state, edge_scale, posed, solved, values

WAVE = Sinusoid(amplitude=50e-6, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
STAR, HALF_SPACE, TOLERANCE = WAVE.full_contact_pressure, 1e-8, 1e-9
MANY = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 6, 16)}  # of many meshes: folds, moved edges
SINGLE = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 8, 18)}
QUANTITIES = {"contact_fraction": (Quantity.AREA, "", 1.0), "penetration": (Quantity.LENGTH, "m", WAVE.amplitude),
              "mean_pressure": (Quantity.PRESSURE, "Pa", STAR)}


def wave_scene(control, targets):
    """Return the scene of the wave on a layer of two periods."""
    adhesion = {"work_of_adhesion": WAVE.work_of_adhesion, "slope_term": False}
    return posed("layer_sinusoid", adhesion=adhesion, loading={"control": control, "targets": targets})


def johnson(psi):
    """Return the numbers of a state of Johnson's curve."""
    return {"contact_fraction": 2 * psi / np.pi, "penetration": float(WAVE.penetration(psi)),
            "mean_pressure": float(WAVE.mean_pressure(psi))}


def least_load():
    """Return psi at which Johnson's load is least: sin 2 psi = alpha / (2 sqrt(tan psi) cos^2 psi)."""

    def slope(psi):
        return np.sin(2 * psi) - WAVE.alpha / (2 * np.sqrt(np.tan(psi)) * np.cos(psi) ** 2)

    return float(brentq(slope, 0.01, 1.0, xtol=1e-15))


@pytest.mark.quick
def test_state_before_pull_off(rows):
    """Is the finite elements' state just before pull-off Johnson's, and stable?"""
    target = 0.97 * float(WAVE.penetration(WAVE.fold()))
    state = solve_fem(wave_scene("penetration", [target]), MANY["P2/P1"])
    assert state.status == "converged" and state.stable, state.message
    exact = johnson(float(brentq(lambda psi: float(WAVE.penetration(psi)) - target, WAVE.fold(), 1.0)))
    for name in ("contact_fraction", "mean_pressure"):
        quantity, unit, scale = QUANTITIES[name]
        rows.compare(name.replace("_", " "), getattr(state, name), exact[name], of=Code.FEM, by=Code.EXACT,
                     quantity=quantity, unit=unit, source="Johnson 1995",
                     uncertainty=(uncertain(state, name), 10 * HALF_SPACE * scale))


@pytest.mark.parametrize(
    ("control", "elements"),
    [pytest.param("penetration", "P2/P1", marks=pytest.mark.quick),
     pytest.param("penetration", "P4/P3", marks=pytest.mark.standard),
     pytest.param("mean_pressure", "P2/P1", marks=pytest.mark.standard)],
)
def test_fold(rows, control, elements):
    """Do both codes and Johnson's curve lose the contact of a wave at the same place?"""
    psi = WAVE.fold() if control == "penetration" else least_load()
    start = 0.97 * float(WAVE.penetration(psi)) if control == "penetration" else 0.0
    turned = fold(solve_fem(wave_scene("penetration", [start]), MANY[elements]), control)
    exact, end = johnson(psi), -2 * WAVE.amplitude if control == "penetration" else -0.5 * STAR
    events = bem.solve(wave_scene(control, [0.0, end])).events
    event = next(event for event in events if event.kind == "pull_off")
    for name, (quantity, unit, scale) in QUANTITIES.items():
        u_fem, by_curve = float(np.max(turned.uncertainty[name])), HALF_SPACE * scale
        rows.compare(name.replace("_", " "), turned.values[name], exact[name], of=Code.FEM, by=Code.EXACT,
                     quantity=quantity, unit=unit, uncertainty=(u_fem, by_curve), source="Johnson 1995")
        if name != "contact_fraction":
            own = max(getattr(event.error_estimate, name) or 0.0, TOLERANCE * scale)
            rows.compare(name.replace("_", " "), getattr(event, name), turned.values[name], of=Code.BEM, by=Code.FEM,
                         quantity=quantity, unit=unit, uncertainty=(own, u_fem), source=elements)
            rows.compare(name.replace("_", " "), getattr(event, name), exact[name], of=Code.BEM, by=Code.EXACT,
                         quantity=quantity, unit=unit, uncertainty=(own, by_curve), source="Johnson 1995")
    near = np.linspace(0.02, 0.5, 200)
    rows.curves("Johnson's curve near pull-off and the fold by finite elements", "penetration / um",
                "mean pressure / Pa",
                {"Johnson": (WAVE.penetration(near) * 1e6, WAVE.mean_pressure(near)),
                 "fold": ([turned.values["penetration"] * 1e6], [turned.values["mean_pressure"]])})


@dataclass(frozen=True)
class Jump:
    """Event by finite elements: kind, penetration in m, energy released in J/m^2, each with its uncertainty."""

    kind: str
    penetration: tuple[float, float]
    released: tuple[float, float]


PRESSED, APART, LOWER_CREST = 30e-6, -60e-6, (4.5e-3, 7e-3)  # m: penetrations, and the interval of the lower crest


def crests(penetration, elements, patches, near=None):
    """Solve the two crests at a penetration by finite elements, with contact at the higher one or at both."""
    scene = posed("layer_two_crests", loading={"targets": [penetration]})
    state = solve_fem(scene, SINGLE[elements], patches, start=None if near is None else near.edges)
    assert state.closure_residual is not None and state.status in ("converged", "interpenetration"), state.message
    return state


def lowest_gap(state):
    """Return the least gap above the lower crest, m, and its uncertainty."""
    x = np.linspace(*LOWER_CREST, 401)
    k = int(np.argmin(state.gap(x)))
    near = np.linspace(x[k - 1], x[k + 1], 401)
    return float(np.min(state.gap(near))), float(np.max(state.uncertainty_at("gap", near)))


def touch(elements):
    """Return the penetration in m at which the gap above the lower crest vanishes, by secants, and its uncertainty."""
    places = [0.8 * PRESSED, 0.9 * PRESSED]
    first = crests(places[0], elements, 1)
    gaps = [lowest_gap(first), lowest_gap(crests(places[1], elements, 1, first))]

    def slope():
        return (gaps[-1][0] - gaps[-2][0]) / (places[-1] - places[-2])

    while abs(gaps[-1][0]) > gaps[-1][1]:
        places.append(places[-1] - gaps[-1][0] / slope())
        gaps.append(lowest_gap(crests(places[-1], elements, 1, first)))
    return places[-1] - gaps[-1][0] / slope(), gaps[-1][1] / abs(slope())


def jumps(elements):
    """Return the four events of the loop in their order, by finite elements."""

    def energy(state):
        return state.total_energy, uncertain(state, "total_energy")

    def turned(state):
        turning = fold(state, "penetration")
        return [(turning.values[name], float(turning.uncertainty[name])) for name in ("penetration", "total_energy")]

    def jump(kind, place, before, after):
        return Jump(kind, place, ((before[0] - after[0]) / 0.01, (before[1] + after[1]) / 0.01))  # per 10 mm

    nothing = (0.0, 0.0)
    pressed, first, touched = crests(PRESSED, elements, 2), crests(0.0, elements, 1), touch(elements)
    before, after = (energy(crests(touched[0], elements, patches)) for patches in (1, 2))
    detaching, detached = turned(pressed)
    pulled, pulled_energy = turned(first)
    return [jump("first_touch", nothing, nothing, energy(first)),
            jump("new_contact", touched, before, after),
            jump("detachment", detaching, detached, energy(crests(detaching[0], elements, 1))),
            jump("pull_off", pulled, pulled_energy, nothing)]


@pytest.mark.parametrize("elements", [pytest.param("P2/P1", marks=pytest.mark.standard),
                                      pytest.param("P4/P3", marks=pytest.mark.full)])
def test_loop(rows, elements):
    """Do both codes find the same events of a loop of loading and unloading, and the same loss?"""
    events = solved("layer_two_crests", loading={"targets": [PRESSED, APART]}).events
    theirs, height = jumps(elements), posed("layer_two_crests").surface().rms_height
    assert [event.kind for event in events] == [jump.kind for jump in theirs]
    loss = sum(jump.released[0] for jump in theirs)
    both = rows.between(Code.BEM, Code.FEM, elements)
    for jump, event in zip(theirs, events, strict=True):
        own, label = event.error_estimate, jump.kind.replace("_", " ")
        if jump.penetration[1]:  # the first touch is at zero penetration by definition
            both.compare(f"{label}: penetration", event.penetration, jump.penetration[0], quantity=Quantity.LENGTH,
                         unit="m",
                         uncertainty=(max(own.penetration or 0.0, TOLERANCE * height),
                                      jump.penetration[1]))
        both.compare(f"{label}: energy released", event.energy_released, jump.released[0], quantity=Quantity.ENERGY,
                     unit="J/m^2",
                     uncertainty=(max(own.energy_released or 0.0, TOLERANCE * loss), jump.released[1]))
    both.compare("energy lost in the loop", np.sum(values(events, "energy_released")), loss,
                 quantity=Quantity.ENERGY, unit="J/m^2",
                 uncertainty=(TOLERANCE * loss, sum(jump.released[1] for jump in theirs)))
    rows.table("Events of the loop, penetration in um, energy released in mJ/m^2",
               ["event", "penetration, FEM", "U", "BEM", "released, FEM", "U", "BEM"],
               [[jump.kind, *(1e6 * value for value in jump.penetration), event.penetration * 1e6,
                 *(1e3 * value for value in jump.released), (event.energy_released or 0.0) * 1e3]
                for jump, event in zip(theirs, events, strict=True)])


def differences_of_energy(scene, edges, penetration):
    """Return G (n_patches, 2) in J/m^2 by fourth-order differences of the boundary elements' elastic energy."""
    rates, steps = np.zeros(edges.shape), 0.003 * edge_scale(edges, scene.surface().period)
    for place in np.ndindex(*edges.shape):
        total = 0.0
        for k, weight in ((1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0)):
            moved = edges.copy()
            moved[place] += k * steps[place] * (1.0 if place[1] else -1.0)
            total += weight * contact_state(scene, moved, penetration).elastic_energy
        rates[place] = total / (12 * steps[place])
    return rates


@pytest.mark.parametrize(
    ("name", "patches", "changes", "elements"),
    [pytest.param("layer_sinusoid", 1, {"loading": {"targets": [20e-6]}}, "P2/P1", marks=pytest.mark.quick),
     pytest.param("layer_sinusoid", 1, {"loading": {"targets": [20e-6]}}, "P4/P3", marks=pytest.mark.standard),
     pytest.param("layer_two_crests", 2, {}, "P4/P3", marks=pytest.mark.full)],
)
def test_energy_release_rate(rows, name, patches, changes, elements):
    """Is the energy that opening an edge releases the same by differences of both codes' energies?"""
    scene = posed(name, **changes)
    state, fem = bem.solve(scene).targets[-1], solve_fem(scene, MANY[elements], patches)
    assert (state.status, fem.status) == ("converged", "converged"), fem.message
    rate, spread = energy_difference(fem)
    edges, u_fem = np.array(state.edges), float(np.max(spread))
    work = 0.03 * np.sqrt(1 + scene.surface().slope(fem.edges) ** 2)  # both scenes: 0.03 J/m^2, with the slope term
    elastic = contact_state(scene, edges, state.penetration)
    both = rows.between(Code.BEM, Code.FEM, f"{elements}, differences of its energies", unit="J/m^2")
    for words, value in (
        ("K^2 / 2 E*", elastic.energy_release_rate),
        ("differences of energies", differences_of_energy(scene, edges, state.penetration)),
    ):
        both.compare(f"G by {words}", value, rate.ravel(), quantity=Quantity.INTENSITY,
                     uncertainty=(2e-7 * work.ravel(), u_fem))
    rows.compare("G by differences of energies", rate, work.ravel(), of=Code.FEM, by=Code.EXACT, unit="J/m^2",
                 quantity=Quantity.INTENSITY, uncertainty=u_fem, source="work of adhesion at the edges")
