"""One adhesive wave three ways: boundary elements, finite elements and Johnson's closed form.

Every code is told E, nu, the wave, the work of adhesion and the mean pressure, and finds its own edges.  The layer is
three periods thick, which is a half-space to 1e-12.  Energies of the finite elements are per period.  SI units.
"""

import numpy as np
import pytest

import bem
import fem_reference
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid

E, NU, PERIOD, AMPLITUDE, THICKNESS = 1e6, 0.3, 0.01, 50e-6, 0.03
WAVE = Sinusoid(amplitude=AMPLITUDE, wavelength=PERIOD, youngs_modulus=E, poisson_ratio=NU, alpha=0.3)
HALF = np.pi / 4  # contact fraction 1/2
PRESSURE = float(WAVE.mean_pressure(HALF))
SOURCE = "Johnson 1995"
EXACT = {
    "contact_fraction": (0.5, Quantity.AREA, ""),
    "penetration": (float(WAVE.penetration(HALF)), Quantity.LENGTH, "m"),
    "elastic_energy": (float(WAVE.elastic_energy(HALF)), Quantity.ENERGY, "J/m^2"),
}


@pytest.fixture(scope="module")
def bem_state():
    """Solve by boundary elements."""
    scene = {
        "title": "Johnson's wave",
        "solid": {"youngs_modulus": E, "poisson_ratio": NU},
        "profile": {"kind": "harmonics", "period": PERIOD, "orders": [1], "amplitudes": [AMPLITUDE], "phases": [0.0]},
        "layer": {"thickness": THICKNESS},
        "adhesion": {"work_of_adhesion": WAVE.work_of_adhesion, "slope_term": False},
        "loading": {"control": "mean_pressure", "targets": [PRESSURE]},
        "accuracy": {"tolerance": 1e-9},
    }
    return bem.solve(bem.parse_scene(scene)).targets[-1]


@pytest.fixture(scope="module")
def fem_state():
    """Solve by finite elements, 4 s, once for the cases of this file."""
    return fem_reference.solve(
        youngs_modulus=E,
        poisson_ratio=NU,
        thickness=THICKNESS,
        period=PERIOD,
        harmonics=([1], [AMPLITUDE], [0.0]),
        work_of_adhesion=WAVE.work_of_adhesion,
        control="mean_pressure",
        value=PRESSURE,
        resolution=fem_reference.Resolution(4, 8, 18),
    )


def test_bem_against_fem(rows, bem_state, fem_state):
    """Do boundary and finite elements find the same adhesive contact under a load?"""
    pair = rows.between(Code.BEM, Code.FEM, f"P4/P3, {fem_state.unknowns} unknowns")
    for name, (_, quantity, unit) in EXACT.items():
        per = PERIOD if "energy" in name else 1.0
        u_bem, u_fem = getattr(bem_state.error_estimate, name), np.max(fem_state.uncertainty[name]) / per
        pair.compare(name.replace("_", " "), getattr(bem_state, name), getattr(fem_state, name) / per,
                     quantity=quantity, unit=unit, uncertainty=(u_bem, u_fem))  # fmt: skip
    rows.count("unknowns", bem_state.unknowns, of=Code.BEM)


def test_bem_against_closed_form(rows, bem_state):
    """Do boundary elements give Johnson's state to ten digits?"""
    pair = rows.between(Code.BEM, Code.EXACT, SOURCE)
    for name, (exact, quantity, unit) in EXACT.items():
        pair.compare(name.replace("_", " "), getattr(bem_state, name), exact, quantity=quantity, unit=unit,
                     uncertainty=getattr(bem_state.error_estimate, name), required=1e-10 * exact,
                     because="ten digits, promised by the README")  # fmt: skip


def test_fem_against_closed_form(rows, fem_state):
    """Is the true error of finite elements within the uncertainty that they state?"""
    pair = rows.between(Code.FEM, Code.EXACT, SOURCE)
    for name, (exact, quantity, unit) in EXACT.items():
        per = PERIOD if "energy" in name else 1.0
        u_fem = np.max(fem_state.uncertainty[name]) / per
        pair.compare(name.replace("_", " "), getattr(fem_state, name) / per, exact, quantity=quantity, unit=unit,
                     uncertainty=u_fem)  # fmt: skip
