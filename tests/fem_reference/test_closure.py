"""JKR closure against the closed forms of one sinusoid, its starts, its stability and its outcomes."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import brentq

from fem_reference import factors
from fem_reference.closure import Control, close, difference_jacobian, hessian, residual
from fem_reference.crests import chosen_crests, crest_patches
from fem_reference.mesh import Resolution
from fem_reference.problem import InvalidProblemError
from fem_reference.solve import solve

QUICK = Resolution(2, 10, 10)
ALPHA = 0.3
AMPLITUDE = 0.01
LAYER = {"youngs_modulus": 1.0, "thickness": 2.0, "period": 1.0, "harmonics": ([1], [AMPLITUDE], [0.7])}
TWO_CRESTS = {
    "youngs_modulus": 1.0,
    "poisson_ratio": 0.3,
    "thickness": 0.5,
    "period": 1.0,
    "harmonics": ([1, 2, 3], [0.004, 0.01, 0.002], [0.3, -0.4, 1.0]),
}


def adhesion(alpha, nu):
    """Work of adhesion of Johnson's alpha = sqrt(2 E* gamma / lambda) / p*, p* = pi E* D / lambda."""
    modulus = 1 / (1 - nu**2)
    return (alpha * np.pi * modulus * AMPLITUDE) ** 2 / (2 * modulus)


def johnson_curve(half_width, alpha, nu):
    """Load and penetration of the sinusoid at a half-width (Johnson 1995, doi:10.1016/0020-7683(94)00111-9)."""
    psi, p_star = np.pi * half_width, np.pi * AMPLITUDE / (1 - nu**2)
    s, pull = np.sin(psi) ** 2, alpha * np.sqrt(np.tan(psi))
    return p_star * (s - pull), AMPLITUDE * (s * (1 - np.log(s)) + pull * np.log(s))


def exact_half_width(control, value, alpha, nu):
    which = 0 if control == "mean_pressure" else 1
    grid = np.linspace(0.01, 0.49, 500)
    misfit = johnson_curve(grid, alpha, nu)[which] - value
    k = np.flatnonzero((misfit[:-1] < 0) & (misfit[1:] >= 0))[-1]
    return brentq(lambda a: johnson_curve(a, alpha, nu)[which] - value, grid[k], grid[k + 1], xtol=1e-15)


def found_and_exact(control, value, alpha, nu, resolution):
    result = solve(
        **LAYER,
        poisson_ratio=nu,
        control=control,
        value=value,
        work_of_adhesion=adhesion(alpha, nu),
        resolution=resolution,
    )
    half_width = exact_half_width(control, value, alpha, nu)
    load, penetration = johnson_curve(half_width, alpha, nu)
    return result, half_width, load, penetration


CASES = [("penetration", 0.007, ALPHA, 0.3), ("mean_pressure", -0.0007, ALPHA, 0.5), ("mean_pressure", 0.01, 0.0, 0.3)]
IDS = ["JKR at penetration", "JKR in tension", "no adhesion"]


@pytest.mark.parametrize("case", CASES, ids=IDS)
def test_one_patch_on_the_quick_mesh(case):
    result, half_width, load, penetration = found_and_exact(*case, QUICK)
    assert result.status == "converged"
    width, p_star = np.diff(result.edges[0])[0], np.pi * AMPLITUDE / (1 - case[3] ** 2)
    assert width == pytest.approx(2 * half_width, abs=5e-4)  # measured 6.6e-5 to 2.0e-4
    assert result.load == pytest.approx(load, abs=1e-4 * p_star)  # measured 3.4e-5
    assert result.penetration == pytest.approx(penetration, abs=1e-4 * AMPLITUDE)  # measured 3.4e-5
    centre = -0.7 / (2 * np.pi)
    assert (result.edges.mean() - centre + 0.5) % 1 - 0.5 == pytest.approx(
        0, abs=2e-6
    )  # measured 6.5e-7: the mesh is no mirror image


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=IDS)
def test_one_patch_on_the_default_mesh(case):
    result, half_width, load, penetration = found_and_exact(*case, Resolution(4, 10, 20))
    p_star = np.pi * AMPLITUDE / (1 - case[3] ** 2)
    assert np.diff(result.edges[0])[0] == pytest.approx(2 * half_width, abs=5e-8)  # measured 0.9e-8 to 1.8e-8
    assert result.load == pytest.approx(load, abs=1e-8 * p_star)  # measured 1.0e-9
    assert result.penetration == pytest.approx(penetration, abs=1e-8 * AMPLITUDE)  # measured 3.8e-9


@pytest.fixture(scope="module")
def two_patches():
    cache = {}

    def solved(start_scale=1.0, work_of_adhesion=1e-5):
        key = (start_scale, work_of_adhesion)
        if key not in cache:
            cache[key] = solve(
                **TWO_CRESTS,
                control="penetration",
                value=0.012,
                work_of_adhesion=work_of_adhesion,
                slope_term=True,
                patches=2,
                start_scale=start_scale,
                resolution=QUICK,
            )
        return cache[key]

    return solved


def test_two_starts_end_in_the_same_edges(two_patches):
    one, other = two_patches(), two_patches(1.1)
    np.testing.assert_allclose(one.edges, other.edges, atol=1e-9)  # measured 4e-13: the meshes differ far less


@pytest.mark.parametrize("work_of_adhesion", [0.0, 1e-5], ids=["no adhesion", "JKR"])
def test_two_unequal_patches_close(two_patches, work_of_adhesion):
    result = two_patches(1.0, work_of_adhesion)
    assert result.status == "converged"
    critical = result.problem.critical_stress_intensity(result.edges) * result.problem.unit_stress_intensity
    scale = np.sqrt(2 * 1e-5 / (1 - 0.3**2))
    np.testing.assert_allclose(result.stress_intensity, critical, atol=2e-8 * scale)  # closed to 1e-8
    assert result.min_eigenvalue is None if work_of_adhesion == 0 else result.stable


def test_release_rate_is_the_work_of_opening(two_patches):
    result = two_patches()
    slope = result.problem.slope(result.edges) * result.problem.unit_height
    np.testing.assert_allclose(
        result.energy_release_rate, 1e-5 * np.sqrt(1 + slope**2), rtol=1.5e-2
    )  # measured 6.6e-3: the defect


def test_total_energy_is_stationary_and_its_hessian_symmetric(sinusoid):
    problem = sinusoid(0.3, 2.0, adhesion(ALPHA, 0.3))
    control = Control("penetration", 1.0)
    closure = close(problem, np.array([[-0.27, 0.27]]), QUICK, control)
    form = hessian(problem, dataclasses.replace(closure, jacobian=exact_jacobian(problem, closure, control)))
    assert closure.outcome == "converged"
    assert np.linalg.eigvalsh(0.5 * (form + form.T))[0] > 0
    assert abs(form[0, 1] - form[1, 0]) < 3e-3 * abs(form[0, 1])


def exact_jacobian(problem, closure, control):
    here = closure.evaluation
    return difference_jacobian(problem, here.states.mesh, here.resolution, control, residual(problem, here))


def test_the_small_contact_at_the_same_tension_is_unstable(sinusoid):
    problem = sinusoid(0.3, 2.0, adhesion(ALPHA, 0.3))
    load = -0.0007
    grid = np.linspace(0.0001, 0.12, 2000)
    misfit = johnson_curve(grid, ALPHA, 0.3)[0] - load
    start = grid[np.flatnonzero((misfit[:-1] > 0) & (misfit[1:] <= 0))[0]]
    control = Control("mean_pressure", load / problem.unit_stress)
    closure = close(problem, np.array([[-start, start]]), QUICK, control)
    form = hessian(problem, dataclasses.replace(closure, jacobian=exact_jacobian(problem, closure, control)))
    assert closure.outcome == "converged"
    assert np.diff(closure.evaluation.edges[0])[0] == pytest.approx(2 * start, rel=0.05)
    assert np.linalg.eigvalsh(0.5 * (form + form.T))[0] < 0


def test_a_crest_that_cannot_touch_is_a_named_outcome():
    result = solve(**TWO_CRESTS, control="penetration", value=0.002, patches=2, resolution=QUICK)
    assert result.status == "no_equilibrium"
    assert "detaches" in result.message
    assert result.uncertainty["load"] == np.inf


def test_an_uncovered_crest_that_interpenetrates_is_a_named_outcome():
    result = solve(**TWO_CRESTS, control="penetration", value=0.012, patches=1, resolution=QUICK)
    assert result.status == "interpenetration"


def test_more_penetration_than_height_ends_in_a_closing_gap():
    result = solve(**TWO_CRESTS, control="penetration", value=0.02, patches=2, resolution=QUICK)
    assert result.status == "no_equilibrium"
    assert "gap closes" in result.message


@pytest.mark.parametrize(
    ("arguments", "argument"),
    [
        ({"control": "penetration", "value": -0.001}, "value"),
        ({"control": "mean_pressure", "value": 0.0}, "value"),
        ({"control": "penetration", "value": -0.05, "work_of_adhesion": 1e-6}, "value"),
        ({"control": "mean_pressure", "value": -1.0, "work_of_adhesion": 1e-6}, "value"),
        ({"control": "penetration", "value": 0.005, "patches": 5}, "patches"),
        ({"control": "penetration", "value": 0.005, "patches": 0}, "patches"),
        ({"control": "penetration", "value": 0.005, "start_scale": 0.0}, "start_scale"),
    ],
    ids=["penetration", "load", "penetration with adhesion", "tension", "too many patches", "no patch", "start"],
)
def test_what_cannot_close_names_the_argument(arguments, argument):
    with pytest.raises(InvalidProblemError, match=rf"^{argument}: "):
        solve(**TWO_CRESTS, **arguments, resolution=QUICK)


def test_the_family_of_starts_covers_the_chosen_crests_in_order(two_crests):
    problem = two_crests()
    crests = chosen_crests(problem, 2)
    for depth in (0.1, 1.0, 3.0, 10.0):  # the last deeper than every valley
        edges = crest_patches(problem, crests, depth)
        assert np.all((edges[:, 0] < crests) & (crests < edges[:, 1]))
        assert np.all(np.diff(np.append(edges.ravel(), edges[0, 0] + 1)) > 0)


@pytest.mark.parametrize("fraction", [pytest.param(1e-2, marks=pytest.mark.slow), 1e-4])
def test_small_contacts_are_found(fraction):
    """The smallest contacts of the first family are 0.06 periods wide: at small loads they all open."""
    pressure = np.pi * AMPLITUDE / (1 - 0.3**2) * np.sin(np.pi * fraction / 2) ** 2
    found = solve(**LAYER, poisson_ratio=0.3, control="mean_pressure", value=pressure, resolution=QUICK)
    assert found.status == "converged"
    # measured 4.4e-4, 6.3e-4; 5.2e-4 at 1e-3
    assert found.contact_fraction == pytest.approx(fraction, rel=1.5e-3)


@pytest.mark.slow
def test_four_unequal_patches_close():
    layer = LAYER | {"poisson_ratio": 0.3, "thickness": 0.2, "harmonics": ([1, 4], [0.001, 0.01], [0.3, -0.4])}
    found = solve(
        **layer, control="penetration", value=0.006, work_of_adhesion=1e-6, patches=4, resolution=Resolution(2, 10, 8)
    )
    assert found.status == "converged"
    assert found.stable
    widths = np.diff(found.edges, axis=1)[:, 0]
    assert np.min(np.diff(np.sort(widths))) > 2e-3  # measured 0.070, 0.073, 0.077, 0.079: no two alike
    pull = np.sqrt(2 * 1e-6 / (1 - 0.3**2))
    np.testing.assert_allclose(found.stress_intensity, pull, rtol=2e-8)  # closed to 1e-8


def test_meshes_that_differ_by_little_share_factors(monkeypatch):
    """Jacobians by differences and last steps on each mesh; 18 factorisations for 29 evaluations."""
    made = []
    whole = factors.splu
    monkeypatch.setattr(factors, "splu", lambda *given, **options: made.append(0) or whole(*given, **options))
    state = solve(
        **LAYER,
        poisson_ratio=0.3,
        control="penetration",
        value=0.5 * AMPLITUDE,
        work_of_adhesion=adhesion(ALPHA, 0.3),
        resolution=QUICK,
    )
    assert state.status == "converged"
    assert len(made) <= 20


PULL_OFF = -138.61505301571006  # Pa, of the boundary elements for the wave below


def wave_under(share):
    """One wave on a thick layer under a share of the tension at which it lets go."""
    return solve(
        youngs_modulus=1e6,
        poisson_ratio=0.3,
        thickness=0.02,
        period=0.01,
        harmonics=([1], [5e-5], [0.0]),
        work_of_adhesion=0.003,
        control="mean_pressure",
        value=share * PULL_OFF,
        resolution=QUICK,
    )


@pytest.mark.parametrize("share", [pytest.param(0.95, marks=pytest.mark.slow), 0.99])
def test_contact_near_pull_off_is_found(share):
    found = wave_under(share)
    assert found.status == "converged"
    assert found.min_eigenvalue > 0


def test_tension_beyond_pull_off_is_refused():
    with pytest.raises(InvalidProblemError, match=r"^value: leaves no contact"):
        wave_under(1.01)
