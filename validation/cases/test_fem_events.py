"""Pull-off and energy release rate by both codes.

- One wave on a layer of two periods (D = 50 um, period 10 mm, E = 1 MPa, nu = 0.3, alpha = 0.3), a half-space to 1e-8:
  pull-off under penetration and under load, against Johnson's curve and against the event of the boundary elements.
  The finite elements follow the path by themselves (test_fem_path.py has all jumps of rough profiles).
- G at the edges that each code found for itself, of finite elements by differences of energies: it is the work
  of adhesion w = gamma sqrt(1 + h'^2).  A closure imposes its own K, but no difference of energies.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import bem
from fem_reference import Resolution
from fem_reference.energy_difference import energy_difference
from fem_reference.jumps import locate
from validation.cases.bem_beside_fem import compare_codes
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.fem_scenes import follow_fem, solve_fem
from validation.routes.scenes import contact_state, posed

WAVE = Sinusoid(amplitude=50e-6, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
STAR, HALF_SPACE = WAVE.full_contact_pressure, 1e-8
MANY = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 8, 16)}  # where an answer takes many meshes
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


@pytest.mark.parametrize(
    ("control", "elements"),
    [pytest.param("penetration", "P2/P1", marks=pytest.mark.quick),
     pytest.param("penetration", "P4/P3", marks=pytest.mark.standard),
     pytest.param("mean_pressure", "P2/P1", marks=pytest.mark.standard)],
)
def test_pull_off(rows, control, elements):
    """Do both codes and Johnson's curve lose the contact of a wave at the same place?"""
    exact = johnson(WAVE.fold() if control == "penetration" else least_load())
    end = -2 * WAVE.amplitude if control == "penetration" else -0.5 * STAR
    scene = wave_scene(control, [0.0, end])
    problem, path, unit = follow_fem(scene)
    last = locate(problem, control, path.jumps[-1], unit, MANY[elements])
    event = next(event for event in bem.solve(scene).events if event.kind == "pull_off")
    for name, (quantity, unit_name, scale) in QUANTITIES.items():
        u_fem, by_curve = last.uncertainty[name], HALF_SPACE * scale
        compare_codes(rows, name.replace("_", " "), last.values[name], exact[name], (u_fem, by_curve), scale,
                      quantity=quantity, of=Code.FEM, by=Code.EXACT, unit=unit_name,
                      source="Johnson 1995")
        if name != "contact_fraction":
            own = getattr(event.error_estimate, name)
            compare_codes(rows, name.replace("_", " "), getattr(event, name), last.values[name], (own, u_fem), scale,
                          quantity=quantity, unit=unit_name, source=elements)
            rows.compare(name.replace("_", " "), getattr(event, name), exact[name], of=Code.BEM, by=Code.EXACT,
                         quantity=quantity, unit=unit_name, uncertainty=(own, by_curve), source="Johnson 1995")
    near = np.linspace(0.02, 0.5, 200)
    rows.curves("Johnson's curve near pull-off and the last state by finite elements", "penetration / um",
                "mean pressure / Pa",
                {"Johnson": (WAVE.penetration(near) * 1e6, WAVE.mean_pressure(near)),
                 "finite elements": ([last.values["penetration"] * 1e6], [last.values["mean_pressure"]])})


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
    rows.compare("G by K^2 / 2 E*", elastic.energy_release_rate, rate.ravel(), of=Code.BEM, by=Code.FEM, unit="J/m^2",
                 quantity=Quantity.INTENSITY, uncertainty=(2e-7 * work.ravel(), u_fem),
                 source=f"{elements}, differences of its energies")
    rows.compare("G by differences of energies", rate, work.ravel(), of=Code.FEM, by=Code.EXACT, unit="J/m^2",
                 quantity=Quantity.INTENSITY, uncertainty=u_fem, source="work of adhesion at the edges")
