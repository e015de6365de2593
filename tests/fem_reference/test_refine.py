"""Uncertainty of a sequence of meshes covers the true error of closed forms and shrinks at the observed order."""

from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

from fem_reference import InvalidProblemError, Resolution, refine
from fem_reference.refine import default_ladder
from fem_reference.solve import companions

NU, DEPTH = 0.3, 2.0
BASE = {
    "youngs_modulus": 1.0,
    "poisson_ratio": NU,
    "thickness": DEPTH,
    "period": 1.0,
    "harmonics": ([1], [0.01], [0.0]),
}
COARSE = companions(Resolution(2, 12, 10))
FINE = companions(Resolution(2, 16, 13))
QUARTIC = companions(Resolution(4, 8, 20))


def punch_values(johnson, half_width, penetration):
    exact = johnson(half_width, NU)
    a = 0.01 / np.sqrt(2)
    return {
        "load": exact.load(penetration / a) * a,
        "stress_intensity": exact.stress_intensity(penetration / a) * a,
    }


LADDERS = {"P2/P1 coarse": COARSE, "P2/P1 fine": FINE, "P4/P3": QUARTIC}


@cache
def punched(ladder):
    return refine(**BASE, control="penetration", value=0.008, edges=[[-0.2, 0.2]], resolutions=LADDERS[ladder])


@pytest.fixture(scope="module", params=LADDERS)
def punch(request):
    return punched(request.param)


@pytest.mark.parametrize("name", ["load", "stress_intensity"])
def test_uncertainty_covers_the_error_of_prescribed_edges(punch, johnson, name):
    estimate = punch.estimates[name]
    assert np.all(np.abs(estimate.value - punch_values(johnson, 0.2, 0.008)[name]) <= estimate.uncertainty)


@pytest.mark.parametrize("ladder", LADDERS.values(), ids=LADDERS)
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_uncertainty_covers_the_error_of_full_contact(compliance, ladder, nu):
    arguments = BASE | {"poisson_ratio": nu, "thickness": 0.3}
    found = refine(**arguments, control="mean_pressure", value=0.0, edges="complete", resolutions=ladder)
    exact = 0.25 * 0.01**2 / compliance(2 * np.pi, 0.3, nu)
    estimate = found.estimates["strain_energy"]
    assert abs(estimate.value - exact) <= 3 * estimate.uncertainty  # U holds 95 %; 2.3 measured for P4/P3, nu = 0.5


def test_uncertainty_shrinks_with_the_meshes():
    coarse, fine = (punched(ladder).estimates["load"] for ladder in ("P2/P1 coarse", "P2/P1 fine"))
    assert fine.uncertainty < coarse.uncertainty
    assert 1 < fine.observed_order < 5  # 4 of similar meshes


@pytest.mark.parametrize("work_of_adhesion", [0.0, 1e-5], ids=["no adhesion", "JKR"])
def test_the_closure_is_refined_with_its_edges(work_of_adhesion):
    found = refine(**BASE, control="penetration", value=0.008, work_of_adhesion=work_of_adhesion, resolutions=COARSE)
    exact = exact_width(0.008, work_of_adhesion)
    edges = found.estimates["edges"]
    assert found.status == "converged"
    assert abs(np.diff(edges.value[0])[0] - exact) <= np.sum(edges.uncertainty)


def exact_width(penetration, work_of_adhesion):
    modulus, amplitude = 1 / (1 - NU**2), 0.01

    def misfit(a):
        s, tension = np.sin(np.pi * a) ** 2, np.sqrt(2 * modulus * work_of_adhesion * np.tan(np.pi * a))
        return amplitude * s * (1 - np.log(s)) + tension * np.log(s) / (np.pi * modulus) - penetration

    return 2 * brentq(misfit, 0.1, 0.45)


def test_the_finest_result_carries_the_refined_uncertainty(punch):
    assert punch.result.uncertainty["load"] == punch.estimates["load"].uncertainty


def test_a_failed_closure_has_no_estimates():
    low_crest = BASE | {"harmonics": ([1, 2, 3], [0.004, 0.01, 0.002], [0.3, -0.4, 1.0]), "thickness": 0.5}
    found = refine(**low_crest, control="penetration", value=0.002, patches=2, resolutions=COARSE)
    assert found.status == "no_equilibrium"
    assert not found.estimates


@pytest.mark.parametrize(
    "resolutions", [COARSE[:2], COARSE[::-1], [*COARSE[:2], Resolution(4, 12, 12)]], ids=["two", "unordered", "mixed"]
)
def test_bad_ladders_are_named(resolutions):
    with pytest.raises(InvalidProblemError, match=r"^resolutions: "):
        refine(**BASE, control="penetration", value=0.008, edges=[[-0.2, 0.2]], resolutions=resolutions)


def test_the_default_ladder_is_quartic():
    assert [(r.order, r.cells) for r in default_ladder()] == [(4, 5), (4, 8), (4, 10)]
