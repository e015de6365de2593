"""Objects refuse what a scene refuses, in the words of the scene."""

import math

import numpy as np
import pytest

import bem
from bem.geometry.ranges import RANGES

GOOD = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": 10, "seed": 1},
    "layer": {"thickness": 1e-3},
    "adhesion": {"work_of_adhesion": 0.03},
}
MAKE = {"solid": bem.Solid, "profile": bem.Profile.self_affine, "layer": bem.Layer, "adhesion": bem.Adhesion}
BAD = {
    "solid.youngs_modulus": (0.0, -1.0, math.nan, math.inf, 1e61, True, "1e6"),
    "solid.poisson_ratio": (-1.0, 0.51, math.nan),
    "profile.period": (0.0, 1e-61, math.nan),
    "profile.hurst": (1.7, 0.0, 1.0, math.nan),
    "profile.rms_height": (-5e-5, 0.0, math.nan),
    "profile.harmonics": (0, 2.5, 1_000_001),
    "profile.seed": (-1, 0.5),
    "layer.thickness": (0.0, math.inf, math.nan),
    "adhesion.work_of_adhesion": (-0.03, 0.0, math.nan),
}
PROFILE = bem.Profile.from_harmonics(0.01, [1], [1e-5])
SOLID = bem.Solid(1e6, 0.5)


def said_of_scene(table, **changed):
    """What a scene says of a table with some keys changed."""
    data = {name: dict(values) for name, values in GOOD.items()}
    data[table] = data[table] | changed
    if "orders" in changed:
        data["profile"] = {"kind": "harmonics", "period": 0.01, **changed}
    else:
        data["profile"]["kind"] = "self_affine"
    with pytest.raises(bem.SceneError) as error:
        bem.parse_scene(data | {"loading": {"control": "separation", "targets": [1e-5]}})
    return list(map(str, error.value.mistakes))


@pytest.mark.parametrize(("path", "value"), [(path, value) for path, values in BAD.items() for value in values])
def test_a_number_is_refused_in_the_words_of_the_scene(path, value):
    table, key = path.split(".")
    with pytest.raises(ValueError, match="allowed") as error:
        MAKE[table](**GOOD[table] | {key: value})
    (said,) = said_of_scene(table, **{key: value})
    assert said.partition(", of samples")[0] == str(error.value)  # a scan may be more


@pytest.mark.parametrize(
    "changed",
    [
        {"orders": [0], "amplitudes": [1e-5], "phases": [0.0]},
        {"orders": [1, 2.5], "amplitudes": [1e-5, 1e-5], "phases": [0.0, 0.0]},
        {"orders": [1, 2], "amplitudes": [1e-5, math.nan], "phases": [0.0, 0.0]},
        {"orders": [1], "amplitudes": [1e-5], "phases": [math.inf]},
        {"orders": [1, 2], "amplitudes": [1e-5], "phases": [0.0]},
        {"orders": [3, 3], "amplitudes": [1e-5, 1e-5], "phases": [0.0, 0.0]},
        {"orders": [], "amplitudes": [], "phases": []},
    ],
    ids=["order", "fraction", "nan", "infinite", "lengths", "repeated", "empty"],
)
def test_harmonics_are_refused_in_the_words_of_the_scene(changed):
    with pytest.raises(ValueError, match="allowed") as error:
        bem.Profile.from_harmonics(0.01, **changed)
    allowed = {mistake.split("; allowed: ")[1] for mistake in said_of_scene("profile", **changed)}
    assert str(error.value).split("; ")[1].removeprefix("allowed: ") in allowed


@pytest.mark.parametrize("name", ["amplitudes", "phases"])
def test_a_profile_by_its_constructor_is_checked_too(name):
    given = {"orders": np.array([1]), "amplitudes": np.array([1e-5]), "phases": np.array([0.0])}
    with pytest.raises(ValueError, match=rf"profile.{name}\[0\] = NaN"):
        bem.Profile(0.01, **given | {name: np.array([math.nan])})


def test_numbers_of_numpy_are_numbers():
    period, height = np.float32(0.5), np.float64(1e-5)
    profile = bem.Profile.self_affine(period, np.float64(0.7), height, np.int64(10), np.int64(1))
    assert profile.rms_height == pytest.approx(1e-5, rel=1e-14)


def test_a_contact_state_refuses_what_a_scene_refuses():
    with pytest.raises(ValueError, match="penetration = NaN; allowed: a finite number"):
        bem.ContactState(PROFILE, SOLID, [[0.0, 0.001]], math.nan)
    with pytest.raises(ValueError, match=r"layer.thickness = 1e-12") as error:
        bem.ContactState(PROFILE, SOLID, [[0.0, 0.001]], 1e-6, layer=bem.Layer(1e-12))
    data = {"solid": GOOD["solid"], "layer": {"thickness": 1e-12}}
    data["profile"] = {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]}
    with pytest.raises(bem.SceneError) as told:
        bem.parse_scene(data | {"loading": {"control": "separation", "targets": [1e-6]}})
    assert [str(error.value)] == list(map(str, told.value.mistakes))


def test_every_range_has_words():
    assert all(allowed.words for allowed in RANGES.values())
    assert set(BAD) | {"profile.orders", "profile.amplitudes", "profile.phases", "penetration"} == set(RANGES)
