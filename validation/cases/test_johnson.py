"""Single wave against closed forms: Johnson's curve along whole loops, Westergaard's contact, stability and stiffness.

h = D cos(q0 x) on a half-space, D = 100 um, period 10 mm, E = 1 MPa, nu = 0.5, without slope term.  With psi = pi times
half the contact fraction, S = sin^2 psi, p* = pi E* D / period and alpha = sqrt(2 E* gamma / period) / p*,

    p = p* [S - alpha sqrt(tan psi)],   Delta = D S (1 - ln S) + alpha p* period sqrt(tan psi) ln S / (pi E*);

alpha = 0 is Westergaard's contact without adhesion.  Sources: Westergaard, J. Appl. Mech. 6 (1939) A49; Johnson, Int.
J. Solids Struct. 32 (1995) 423.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.scenes import TEN_DIGITS, estimates, posed, solved, values

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.3)
DEPTH, STAR = WAVE.amplitude, WAVE.full_contact_pressure
BESIDE = (1.3, 1.1, 1.02, 0.98, 0.9)  # psi over that of the largest tension; pull-off lies at 0.80


def derivative(function, psi, step=1e-5):
    """Return the derivative of a function of psi by differences of fourth order."""
    near, far = (float(function(psi * (1 + k * step)) - function(psi * (1 - k * step))) for k in (1, 2))
    return (8 * near - far) / (12 * step * psi)


@pytest.mark.quick
@pytest.mark.parametrize("alpha", [0.1, 0.3, 0.5])
def test_loop(rows, alpha):
    """Do boundary elements follow Johnson's curve from first touch to a contact fraction of 0.95 and to pull-off?"""
    wave = replace(WAVE, alpha=alpha)
    deepest, fold = float(wave.penetration(0.95 * np.pi / 2)), float(wave.penetration(wave.fold()))
    targets = [*np.linspace(0.02 * deepest, deepest, 14),
               *np.linspace(deepest, fold + 1e-3 * (deepest - fold), 16)[1:],
               fold - 0.05 * deepest]
    result = solved("sinusoid", adhesion={"work_of_adhesion": wave.work_of_adhesion}, loading={"targets": targets})
    assert all(state.certificate.ok for state in result.states)
    states = [state for state in result.states if state.n_patches == 1]
    fraction, pressure, penetration = (
        values(states, name) for name in ("contact_fraction", "mean_pressure", "penetration")
    )
    (pull_off,) = (event for event in result.events if event.kind == "pull_off")
    psi = fraction * np.pi / 2
    johnson = rows.between(Code.BEM, Code.EXACT, "Johnson 1995, at the contact width of the boundary elements")
    johnson.compare("mean pressure at every state", pressure, wave.mean_pressure(psi), unit="Pa",
                    quantity=Quantity.PRESSURE, uncertainty=estimates(states, "mean_pressure"),
                    required=1e-10 * STAR, because=TEN_DIGITS)
    johnson.compare("penetration at every state", penetration, wave.penetration(psi), unit="m",
                    quantity=Quantity.LENGTH, uncertainty=estimates(states, "penetration"),
                    required=1e-10 * DEPTH, because=TEN_DIGITS)
    johnson.compare("penetration at pull-off", pull_off.penetration, fold, unit="m", quantity=Quantity.LENGTH,
                    uncertainty=pull_off.error_estimate.penetration, required=1e-10 * DEPTH,
                    because=TEN_DIGITS, source="fold of Johnson's penetration")
    rows.count("evaluations", sum(state.evaluations for state in result.states), of=Code.BEM)
    curve = np.linspace(0.01, 0.97, 300)
    rows.curves(f"Johnson's loop, alpha = {alpha:g}", "contact fraction", "mean pressure / p*",
                {"boundary elements": (fraction, pressure / STAR),
                 "Johnson": (curve, wave.mean_pressure(curve * np.pi / 2) / STAR)})


@pytest.mark.quick
def test_without_adhesion(rows):
    """Do boundary elements give Westergaard's contact at seven given penetrations?"""
    wave = replace(WAVE, alpha=0.0)
    fractions = np.array([0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
    psi = fractions * np.pi / 2
    states = solved("sinusoid", adhesion=None, loading={"targets": wave.penetration(psi).tolist()}).targets
    both = rows.between(Code.BEM, Code.EXACT, "Westergaard 1939")
    both.compare("contact fraction", values(states, "contact_fraction"), fractions, quantity=Quantity.AREA,
                 uncertainty=estimates(states, "contact_fraction"), required=1e-10, because=TEN_DIGITS)
    both.compare("mean pressure", values(states, "mean_pressure"), wave.mean_pressure(psi), unit="Pa",
                 quantity=Quantity.PRESSURE, uncertainty=estimates(states, "mean_pressure"), required=1e-10 * STAR,
                 because=TEN_DIGITS)
    rows.count("unknowns", max(state.unknowns for state in states), of=Code.BEM)


@pytest.mark.quick
def test_stability_and_stiffness(rows):
    """Are states stable at fixed load up to the largest tension and not beyond it, and how stiff are they?"""
    tension = brentq(lambda psi: derivative(WAVE.mean_pressure, psi), WAVE.fold(), 0.6, xtol=1e-14)
    psi = tension * np.array(BESIDE)
    targets = [float(WAVE.penetration(2 * tension)), *WAVE.penetration(psi).tolist()]
    adhesion = {"work_of_adhesion": WAVE.work_of_adhesion}
    states = solved("sinusoid", adhesion=adhesion, loading={"targets": targets}).targets[1:]
    slopes = np.array([derivative(WAVE.mean_pressure, p) for p in psi])
    stiffness = slopes / np.array([derivative(WAVE.penetration, p) for p in psi])
    johnson = rows.between(Code.BEM, Code.EXACT, "Johnson 1995: p rises with the contact width where it is stable")
    johnson.compare("stable at fixed load (1: yes)", values(states, "stable_at_fixed_load"), slopes > 0,
                    quantity=Quantity.COUNT, kind="construction", required=0.5, because="yes or no")
    johnson.compare("contact stiffness", values(states, "contact_stiffness"), stiffness, unit="Pa/m",
                    quantity=Quantity.STIFFNESS, required=1e-9 * np.max(np.abs(stiffness)),
                    uncertainty=(estimates(states, "contact_stiffness"), 1e-10 * np.max(np.abs(stiffness))),
                    because="differences of fourth order of the closed form give ten digits")


@pytest.mark.quick
@pytest.mark.parametrize("alpha", [0.1, 0.5, 1.0])
def test_largest_tension(rows, alpha):
    """Under penetration control, is the largest tension that a result reports the minimum of Johnson's curve?"""
    wave = replace(WAVE, alpha=alpha)  # dp/dpsi = 0 where 4 sin^(3/2) psi cos^(5/2) psi = alpha, below tan^2 psi = 3/5
    psi = brentq(lambda a: 4 * np.sin(a) ** 1.5 * np.cos(a) ** 2.5 - alpha, 0.0, np.arctan(np.sqrt(0.6)), xtol=1e-15)
    tension = solved("sinusoid", adhesion={"work_of_adhesion": wave.work_of_adhesion},
                     loading={"targets": [5e-5, -2e-4]}).largest_tension
    rows.compare("largest tension", tension.mean_pressure, float(wave.mean_pressure(psi)), of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.PRESSURE, uncertainty=tension.error_estimate.mean_pressure, unit="Pa",
                 source="Johnson 1995, dp/dpsi = 0")


@pytest.mark.quick
def test_error_against_unknowns(rows):
    """At Johnson's edges, how many unknowns does an adhesive contact need for a given accuracy?"""
    psi, half = 0.6 * np.pi / 2, 0.3 * WAVE.wavelength
    surface, critical = posed("sinusoid").surface(), np.sqrt(2 * WAVE.modulus * WAVE.work_of_adhesion)
    load, intensity = {}, {}
    for tolerance in (0.3, *(10.0**-k for k in range(1, 14))):
        state = bem.ContactState(surface, bem.Solid(1e6, 0.5), [[-half, half]], float(WAVE.penetration(psi)),
                                 tolerance=tolerance)
        unknowns = state.evaluation.unknowns
        load[unknowns] = abs(state.mean_pressure - float(WAVE.mean_pressure(psi))) / STAR
        intensity[unknowns] = float(np.max(np.abs(state.stress_intensity / critical - 1)))
    johnson = rows.between(Code.BEM, Code.EXACT, "Johnson 1995, contact fraction 0.6, at the finest tolerance")
    johnson.compare("relative error of the mean pressure", list(load.values())[-1], 0.0, quantity=Quantity.PRESSURE,
                    uncertainty=1e-13, required=1e-13, because="tolerance of 1e-13")
    johnson.compare("relative error of the stress intensity", list(intensity.values())[-1], 0.0,
                    quantity=Quantity.INTENSITY, uncertainty=1e-13, required=1e-13,
                    because="tolerance of 1e-13")
    rows.count("unknowns at the finest tolerance", list(load)[-1], of=Code.BEM)
    rows.curves("Error of one adhesive contact against its unknowns", "unknowns", "relative error",
                {name: (list(errors), [max(error, 1e-17) for error in errors.values()])
                 for name, errors in (("mean pressure", load), ("stress intensity", intensity))}, log="y")
