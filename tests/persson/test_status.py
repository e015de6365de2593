"""Where the theory has no answer or more than one, it says so; bad input is refused by name, value and range."""

import pytest

from persson import DiscreteSpectrum, gaussian_slope_1d, solve

NAN, INF = float("nan"), float("inf")


@pytest.fixture(scope="module")
def lines():
    return DiscreteSpectrum.self_affine(628.0, 0.7, 50e-6, 30)


@pytest.fixture(scope="module")
def work(lines, modulus):
    """gamma in J/m^2 whose gain in complete contact is a multiple of the elastic energy there."""
    return lambda ratio: ratio * modulus * lines.full_contact_energy / float(gaussian_slope_1d(lines.slope_rms**2))


def test_an_ordinary_state_needs_no_advice(adhesive):
    assert (adhesive("paper", 0.02).status, adhesive("paper", 0.02).advice) == ("converged", "")


@pytest.mark.parametrize("adhesion", [None, 0.03])
def test_one_line_is_no_roughness_for_the_theory(solid, modulus, adhesion):
    line = DiscreteSpectrum([628.0, 1256.0], [1e-4, 0.0])
    state = solve(line, 0.005 * modulus, work_of_adhesion=adhesion, **solid)
    assert state.status == "single_line"
    assert "Westergaard" in state.advice


@pytest.mark.parametrize("adhesion", [None, 0.03])
def test_complete_contact_is_named(lines, solid, modulus, adhesion):
    state = solve(lines, 2 * modulus, work_of_adhesion=adhesion, **solid)
    assert state.status == "complete_contact"
    assert "full-contact" in state.advice
    assert state.contact_fraction == pytest.approx(1.0, abs=1e-12)
    assert abs(state.separation) < 1e-9 * lines.h_rms


def test_complete_contact_stores_the_energy_of_every_line(lines, solid, modulus):
    state = solve(lines, 2 * modulus, work_of_adhesion=0.03, **solid)
    assert state.elastic_energy == pytest.approx(modulus * lines.full_contact_energy, rel=1e-12)
    factor = float(gaussian_slope_1d(lines.total_slope_variance))
    assert state.adhesion_energy == pytest.approx(-0.03 * factor, rel=1e-12)


@pytest.mark.parametrize(("ratio", "status"), [(1.2, "converged"), (1.45, "converged"), (1.7, "branches")])
def test_contact_stays_at_zero_load_above_one_and_a_half_energies(lines, solid, modulus, work, ratio, status):
    state = solve(lines, 0.005 * modulus, work_of_adhesion=work(ratio), with_separation=False, resolution=0.5, **solid)
    assert state.status == status
    assert (state.zero_load_contact_fraction is None) == (status == "converged")


def test_branches_state_the_contact_of_zero_load(lines, solid, modulus, work):
    tiny, small = (
        solve(lines, p * modulus, work_of_adhesion=work(2.5), with_separation=False, resolution=0.5, **solid)
        for p in (1e-6, 0.005)
    )
    assert small.zero_load_contact_fraction == pytest.approx(tiny.contact_fraction, abs=1e-3)
    assert small.zero_load_contact_fraction > 0.3
    assert "zero load" in small.advice


def test_without_branches_contact_vanishes_with_the_load(lines, solid, modulus, work):
    areas = [
        solve(
            lines, p * modulus, work_of_adhesion=work(1.2), with_separation=False, resolution=0.5, **solid
        ).contact_fraction
        for p in (1e-6, 1e-5)
    ]
    assert areas[1] / areas[0] == pytest.approx(10.0, rel=0.01)


def test_a_fixed_point_that_is_not_met_is_named(lines, solid, modulus, work):
    state = solve(lines, 0.005 * modulus, work_of_adhesion=work(1.4), with_separation=False, max_iterations=2, **solid)
    assert state.status == "not_converged"
    assert "max_iterations" in state.advice


@pytest.mark.parametrize("adhesion", [None, 0.03])
@pytest.mark.parametrize("load", [0.0, -1.0, NAN, INF])
def test_loads_that_do_not_press_are_refused(lines, solid, load, adhesion):
    with pytest.raises(ValueError, match=rf"mean_pressure: {load} must be finite and > 0 \(Pa\); .* diverges"):
        solve(lines, load, work_of_adhesion=adhesion, **solid)


@pytest.mark.parametrize(
    ("argument", "value", "message"),
    [
        ("youngs_modulus", 0.0, r"youngs_modulus: 0.0 must be finite and > 0 \(Pa\)"),
        ("youngs_modulus", NAN, r"youngs_modulus: nan must be finite and > 0 \(Pa\)"),
        ("poisson_ratio", 0.6, r"poisson_ratio: 0.6 must lie in \(-1, 0.5\]"),
        ("poisson_ratio", -1.0, r"poisson_ratio: -1.0 must lie in \(-1, 0.5\]"),
        ("work_of_adhesion", 0.0, r"work_of_adhesion: 0.0 must be finite and > 0 \(J/m\^2\)"),
        ("work_of_adhesion", -1.0, r"work_of_adhesion: -1.0 must be finite and > 0 \(J/m\^2\)"),
        ("work_of_adhesion", NAN, r"work_of_adhesion: nan must be finite and > 0 \(J/m\^2\)"),
        ("area_factor", "3d", r"area_factor: '3d' must be one of gaussian_slope_1d, isotropic_2d"),
        ("detached_width", 0.0, r"detached_width: 0.0 must lie in \(0, 1\]"),
        ("detached_width", 1.5, r"detached_width: 1.5 must lie in \(0, 1\]"),
        ("route", "spectral", r"route: 'spectral' must be one of finite_volumes, volterra"),
        ("resolution", 0.0, r"resolution: 0.0 must be finite and > 0"),
        ("max_iterations", 0, r"max_iterations: 0 must be >= 1"),
    ],
)
def test_arguments_out_of_range_are_refused(lines, argument, value, message):
    arguments = {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "work_of_adhesion": 0.03, argument: value}
    with pytest.raises(ValueError, match=message):
        solve(lines, 1e4, **arguments)


def test_a_negative_separation_is_named(lines, solid, modulus, work):
    """With a gain of 1.2 times the elastic energy of complete contact the work balance fails at intermediate loads."""
    state = solve(lines, 0.02 * modulus, work_of_adhesion=work(1.2), resolution=0.5, **solid)
    assert state.separation < -1e-3 * lines.h_rms
    assert state.status == "below_zero"
    assert "separation" in state.advice


@pytest.mark.parametrize("route", ["finite_volumes", "volterra"])
def test_a_barrier_that_outruns_all_paths_absorbs_none(solid, modulus, route):
    """Roughness of nanometres: the detachment stress rises by hundreds of standard deviations within a cell."""
    fine = DiscreteSpectrum.self_affine(628.0, 0.7, 1e-9, 125)
    state = solve(fine, 4e-7 * modulus, work_of_adhesion=0.03, with_separation=False, route=route, **solid)
    assert state.status == "complete_contact"
    assert state.contact_fraction == 1.0
