"""Statements of the theory on rough contacts in general: linear area and power laws.

Contact at short wavelengths: validation/cases/test_theory.py.
"""

import numpy as np
import pytest

from persson import ContinuousSpectrum, solve

Q0 = 2 * np.pi / 0.01


@pytest.mark.parametrize("name", ["paper", "hurst 0.5", "continuous"])
def test_area_is_linear_in_load_up_to_a_fifth_of_the_nominal_area(adhesive, name):
    def area_over_load(load):
        return adhesive(name, load).contact_fraction / load

    small = area_over_load(1e-4)
    load = 0.2 / small
    assert 0.18 < adhesive(name, load).contact_fraction < 0.2
    assert area_over_load(load) / small == pytest.approx(1.0, abs=0.015)  # measured 1.1 % less
    assert area_over_load(3 * load) / small < 0.95  # and not further: measured 9 % less


@pytest.mark.parametrize("hurst", [0.3, 0.7])
def test_spectra_are_power_laws_where_adhesion_is_negligible(solid, modulus, hurst):
    spectrum = ContinuousSpectrum.self_affine(Q0, 1e5 * Q0, hurst, 50e-6)
    state = solve(spectrum, 0.005 * modulus, work_of_adhesion=1e-4, with_separation=False, **solid)
    q = spectrum.wavenumbers
    negligible = (q > 1e3 * Q0) & (q < 3e4 * Q0) & (spectrum.slope_variance < state.fields.onset())
    assert np.count_nonzero(negligible) > 10
    displacement, pressure = (
        np.polyfit(np.log(q[negligible]), np.log(power[negligible]), 1)[0]
        for power in (state.displacement_power(), state.pressure_power())
    )
    assert displacement == pytest.approx(-(2 + hurst), abs=0.01)  # measured 0.005 at most
    assert pressure == pytest.approx(-hurst, abs=0.01)


@pytest.mark.parametrize("load", [0.005, 0.02])
def test_contact_with_adhesion_stays_above_the_power_law_of_the_closed_form(adhesive, load):
    fractions = adhesive("paper", load).contact_fractions
    without = np.sqrt(8 / np.pi) * load / np.sqrt(adhesive("paper", load).spectrum.slope_variance)
    assert fractions[-1] > 1.1 * without[-1]
    assert fractions[99] == pytest.approx(without[99], rel=0.03)
