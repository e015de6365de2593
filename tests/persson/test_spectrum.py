"""Spectra: what they say of a profile, that the two kinds are not taken for one another, and what they refuse."""

import numpy as np
import pytest
from scipy.integrate import quad

from persson import ContinuousSpectrum, DiscreteSpectrum, solve_nonadhesive

NAN, INF = float("nan"), float("inf")


def test_lines_carry_the_variances_of_their_profile():
    lines = DiscreteSpectrum([628.0, 1256.0, 1884.0], [5e-5, 0.0, 1e-5])
    x = np.linspace(0, 0.01, 4000, endpoint=False) * (2 * np.pi / 628.0 / 0.01)
    phase = np.array([0.3, 1.1, 2.0])
    height = np.sum(lines.amplitudes * np.cos(np.outer(x, lines.wavenumbers) + phase), axis=1)
    slope = -np.sum(lines.amplitudes * lines.wavenumbers * np.sin(np.outer(x, lines.wavenumbers) + phase), axis=1)
    assert lines.h_rms == pytest.approx(np.sqrt(np.mean(height**2)), rel=1e-12)
    assert lines.slope_rms == pytest.approx(np.sqrt(np.mean(slope**2)), rel=1e-12)


def test_power_of_the_lines_integrates_to_the_height_variance(spectra):
    lines, q0 = spectra["paper"], float(spectra["paper"].wavenumbers[0])
    assert 2 * np.sum(lines.power(q0)) * q0 == pytest.approx(lines.h_rms**2, rel=1e-12)


@pytest.mark.parametrize("hurst", [0.2, 0.5, 0.8])
def test_moments_of_a_power_spectrum_are_its_integrals(hurst):
    spectrum = ContinuousSpectrum.self_affine(100.0, 1e4, hurst, 1e-5)

    def moment(power):
        value, _ = quad(
            lambda t: 2 * np.exp(t) ** (power + 1) * spectrum.power_at(np.exp(t)),
            np.log(100.0),
            np.log(1e4) - 1e-13,
            epsabs=0,
            epsrel=1e-12,
            limit=200,
        )
        return value

    assert spectrum.h_rms**2 == pytest.approx(moment(0), rel=1e-11)
    assert spectrum.total_slope_variance == pytest.approx(moment(2), rel=1e-11)
    assert spectrum.full_contact_energy == pytest.approx(moment(1) / 4, rel=1e-11)


def test_wavenumber_and_slope_variance_are_inverse_of_one_another():
    spectrum = ContinuousSpectrum([100.0, 300.0, 2000.0, 9000.0], [1e-12, 1e-13, 1e-15, 1e-18])
    q = np.geomspace(101.0, 8999.0, 40)
    variance = np.array([spectrum.resolved_variance(float(value)) for value in q])
    np.testing.assert_allclose(spectrum.wavenumber_at(variance), q, rtol=1e-11)


def test_lowest_line_is_resolved_at_magnification_one(spectra):
    lines = spectra["paper"]
    first = float(lines.wavenumbers[0])
    assert lines.resolved_variance(first) == lines.slope_variance[0]
    assert lines.resolved_variance(first * 0.999) == 0.0


def test_lines_and_power_spectrum_of_one_h_rms_have_different_slopes_and_contact(spectra, solid, modulus):
    lines, continuous = spectra["paper"], spectra["continuous"]
    assert lines.h_rms == pytest.approx(continuous.h_rms, rel=1e-12)
    assert (round(lines.slope_rms, 3), round(continuous.slope_rms, 3)) == (0.272, 0.378)
    areas = [solve_nonadhesive(s, 0.005 * modulus, **solid).contact_fraction for s in (lines, continuous)]
    assert areas[1] / areas[0] == pytest.approx(0.72, abs=0.005)  # 28 % less


def test_lines_have_a_power_only_for_a_period(spectra, solid, modulus):
    state = solve_nonadhesive(spectra["paper"], 0.01 * modulus, **solid)
    with pytest.raises(ValueError, match="period_wavenumber: None"):
        state.displacement_power()


def test_a_power_spectrum_has_no_period(spectra, solid, modulus):
    state = solve_nonadhesive(spectra["continuous"], 0.01 * modulus, **solid)
    with pytest.raises(ValueError, match=r"period_wavenumber: 628\.0"):
        state.displacement_power(628.0)


@pytest.mark.parametrize("kind", [DiscreteSpectrum, ContinuousSpectrum])
@pytest.mark.parametrize(
    ("wavenumbers", "values", "message"),
    [
        ([2.0, 1.0], [1.0, 1.0], r"wavenumbers\[1\]: 1.0 is unsorted; values must increase"),
        ([1.0, 1.0], [1.0, 1.0], r"wavenumbers\[1\]: 1.0 is a duplicate; values must increase"),
        ([1.0, NAN], [1.0, 1.0], r"wavenumbers\[1\]: nan must be finite and > 0"),
        ([0.0, 1.0], [1.0, 1.0], r"wavenumbers\[0\]: 0.0 must be finite and > 0"),
        ([-1.0, 1.0], [1.0, 1.0], r"wavenumbers\[0\]: -1.0 must be finite and > 0"),
        ([1.0, INF], [1.0, 1.0], r"wavenumbers\[1\]: inf must be finite and > 0"),
        ([1.0, 2.0], [1.0, NAN], r"\[1\]: nan must be finite"),
        ([1.0, 2.0], [1.0, -1.0], r"\[1\]: -1.0 must be finite"),
        ([1.0, 2.0], [0.0, 0.0], r"(amplitudes|power\[0\]): .*0\.0.*must be > 0"),
        ([1.0, 2.0], [1.0], r"(amplitudes|power): shape \(1,\)"),
        ([], [], r"wavenumbers: shape \(0,\)"),
    ],
)
def test_bad_tables_are_refused_with_value_and_range(kind, wavenumbers, values, message):
    with pytest.raises(ValueError, match=message):
        kind(wavenumbers, values)


@pytest.mark.parametrize(
    ("make", "values", "message"),
    [
        *((DiscreteSpectrum, (1.0, h, 1e-5, 10), rf"hurst: {h} must lie in \(0, 1\)") for h in (0.0, 1.0, -0.5, NAN)),
        (ContinuousSpectrum, (1.0, 10.0, 1.5, 1e-5), r"hurst: 1.5 must lie in \(0, 1\)"),
        *((DiscreteSpectrum, (1.0, 0.7, h, 10), rf"h_rms: {h} must be finite and > 0 \(m\)") for h in (0.0, NAN, INF)),
        (DiscreteSpectrum, (1.0, 0.7, 1e-5, 0), "n_lines: 0 must be >= 1"),
        (ContinuousSpectrum, (10.0, 5.0, 0.7, 1e-5), r"highest: 5.0 must be finite and > lowest = 10.0"),
    ],
)
def test_self_affine_spectra_refuse_values_by_name_and_range(make, values, message):
    with pytest.raises(ValueError, match=message):
        make.self_affine(*values)
