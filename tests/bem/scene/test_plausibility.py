"""Groups of a scene by independent formulas, and what is named when a unit, a cut or a size is not what was meant."""

import copy

import numpy as np
import pytest

import bem
from bem.scene.plausibility import cautions_of, groups_of
from bem.scene.scene import SceneError, parse_scene

LENGTH, RMS = 10.0, 0.05  # of the scan, mm
COUNT = 400
X = LENGTH / COUNT * np.arange(COUNT)
ROUGH = bem.Profile.self_affine(LENGTH, 0.8, RMS, 60, 5)
SEPARATION = {"control": "separation", "targets": [60e-6, 30e-6]}
PRESSURE = {"control": "mean_pressure", "targets": [1e4]}
WAVE = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3},
    "profile": {
        **{"kind": "harmonics", "period": 0.02, "orders": [1, 4]},
        **{"amplitudes": [3e-5, -1e-5], "phases": [0.0, 1.0]},
    },
    "layer": {"thickness": 0.004},
    "adhesion": {"work_of_adhesion": 0.05},
    "loading": {"control": "separation", "targets": [3e-5, 1e-5]},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    np.savetxt(folder / "scan.csv", np.column_stack([X, ROUGH.height(X)]), delimiter=",", fmt="%.12g")
    return folder


def scan_scene(folder, unit_x="mm", unit_h="mm", loading=SEPARATION, **profile):
    return parse_scene(
        {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": {"kind": "samples", "file": "scan.csv", "unit_x": unit_x, "unit_h": unit_h, **profile},
            "adhesion": {"work_of_adhesion": 0.03},
            "loading": loading,
        },
        folder,
    )


def said(scene):
    return {caution.about: caution.message for caution in cautions_of(scene, groups_of(scene))}


def changed(path, value):
    data = copy.deepcopy(WAVE)
    table, key = path.split(".")
    data[table][key] = value
    return parse_scene(data)


def test_groups_are_those_of_the_surface():
    """Heights, slopes and the energy of complete contact by sums over points of the surface, not over harmonics."""
    scene = parse_scene(WAVE)
    x = np.linspace(0, 0.02, 1000, endpoint=False)
    q = 2 * np.pi / 0.02
    h = 3e-5 * np.cos(q * x) - 1e-5 * np.cos(4 * q * x + 1.0)
    slope = -3e-5 * q * np.sin(q * x) + 4e-5 * q * np.sin(4 * q * x + 1.0)
    modulus = 1e6 / (1 - 0.3**2)
    pressure = modulus / 2 * (3e-5 * q * np.cos(q * x) - 4e-5 * q * np.cos(4 * q * x + 1.0))  # that presses it flat
    expected = {
        "rms_height": np.sqrt(np.mean(h**2)),
        "rms_slope": np.sqrt(np.mean(slope**2)),
        "pressure_scale": modulus * np.sqrt(np.mean(slope**2)),
        "adhesion_over_elastic_energy": 0.05 / np.mean(pressure * h / 2),
    }
    assert groups_of(scene) == pytest.approx(expected, rel=1e-12)
    assert said(scene) == {}


def test_adhesion_group_of_a_wave_is_that_of_johnson():
    data = {key: copy.deepcopy(WAVE[key]) for key in ("solid", "adhesion", "loading")}
    data["profile"] = {"kind": "harmonics", "period": 0.02, "orders": [1], "amplitudes": [3e-5], "phases": [0.0]}
    modulus = 1e6 / (1 - 0.3**2)
    closing = np.pi * modulus * 3e-5 / 0.02  # p* of the wave
    alpha = np.sqrt(2 * modulus * 0.05 / (closing**2 * 0.02))
    assert groups_of(parse_scene(data))["adhesion_over_elastic_energy"] == pytest.approx(
        2 * np.pi * alpha**2, rel=1e-12
    )


def test_a_result_has_the_groups_of_its_scene(folder):
    scene = scan_scene(folder, harmonics=10)
    assert bem.solve(scene).groups == groups_of(scene)


def test_right_unit_is_passed(folder):
    assert said(scan_scene(folder)) == {}


@pytest.mark.parametrize("loading", [SEPARATION, PRESSURE], ids=["separation", "pressure"])
@pytest.mark.parametrize(
    ("unit", "about"),
    [
        ("m", "profile.period"),
        ("um", {"separation": "loading.targets", "mean_pressure": "adhesion_over_elastic_energy"}),
    ],
)
def test_scan_read_in_another_unit_is_named(unit, about, loading, folder):
    """One scan in mm, read as m and as um: the three readings of one file."""
    found = said(scan_scene(folder, unit, unit, loading))
    about = about if isinstance(about, str) else about[loading["control"]]
    assert about in found
    assert "unit" in found[about]


@pytest.mark.parametrize(
    ("path", "value", "about"),
    [
        ("profile.amplitudes", [3e-2, -1e-3], "rms_slope"),
        ("profile.amplitudes", [3e-11, -1e-12], "rms_slope"),
        ("profile.period", 2.0, "profile.period"),
        ("profile.period", 1e-10, "profile.period"),
        ("solid.youngs_modulus", 50.0, "solid.youngs_modulus"),
        ("solid.youngs_modulus", 2e14, "solid.youngs_modulus"),
        ("adhesion.work_of_adhesion", 30.0, "adhesion.work_of_adhesion"),
        ("adhesion.work_of_adhesion", 9.0, "adhesion_over_elastic_energy"),
        ("loading.targets", [0.06, 0.03], "loading.targets"),
        ("loading.targets", [6e-8, 3e-8], "loading.targets"),
    ],
)
def test_what_is_out_of_the_ordinary_is_named(path, value, about):
    assert about in said(changed(path, value))


@pytest.mark.parametrize(("targets", "all_of_it"), [([5e6], True), ([1e-4], False)])
def test_pressures_of_another_order_are_named(targets, all_of_it):
    message = said(parse_scene(WAVE | {"loading": {"control": "mean_pressure", "targets": targets}}))["loading.targets"]
    assert ("all touches" in message) == all_of_it


def test_work_beyond_sense_is_refused():
    profile = {"kind": "self_affine", "period": 0.01, "hurst": 0.8, "rms_height": 1e-5, "harmonics": 20_000}
    path = {"control": "separation", "start": 3e-5, "stop": 1e-5, "count": 100_000}
    with pytest.raises(SceneError, match=r"loading\.targets are 100000; allowed: 50000 with 20000 harmonics"):
        parse_scene(WAVE | {"profile": profile, "loading": path})


@pytest.mark.parametrize(("thickness", "about"), [(3e-4, set()), (2e-4, {"layer.thickness"})])
def test_a_layer_that_is_thin_beside_its_heights_is_named(thickness, about):
    """The wave has an rms height of 2.2e-5 m."""
    assert set(said(changed("layer.thickness", thickness))) == about


@pytest.mark.parametrize(("slope", "about"), [(0.49, set()), (0.51, {"rms_slope"})])
def test_slopes_that_are_not_small_are_named(slope, about):
    factor = slope / groups_of(parse_scene(WAVE))["rms_slope"]
    scene = changed("profile.amplitudes", [factor * height for height in WAVE["profile"]["amplitudes"]])
    assert set(said(scene)) - {"loading.targets", "layer.thickness"} == about


@pytest.mark.parametrize("by_file", [False, True])
@pytest.mark.parametrize(
    ("unit_x", "unit_h", "about"),
    [("m", "mm", {"profile.period"}), ("mm", "m", {"rms_height", "rms_slope"}), ("um", "um", {"loading.targets"})],
)
def test_units_that_the_file_states_are_not_doubted(unit_x, unit_h, about, by_file, tmp_path):
    """What is out of the ordinary in any case is told, without a question for the unit."""
    columns, heading = np.column_stack([X, ROUGH.height(X)]), f"x [{unit_x}],h [{unit_h}]"
    np.savetxt(tmp_path / "scan.csv", columns, delimiter=",", fmt="%.12g", header=heading if by_file else "")
    units = {} if by_file else {"unit_x": unit_x, "unit_h": unit_h}
    profile = {"kind": "samples", "file": "scan.csv", "harmonics": "all", **units}
    found = said(parse_scene({**WAVE, "profile": profile}, tmp_path))
    assert about & set(found)
    assert any("unit_" in message and '"?' in message for message in found.values()) != by_file


@pytest.mark.parametrize(
    ("heights", "detrend"), [(np.zeros(64), "mean"), (np.full(64, 0.1), "mean"), (0.1 + np.arange(64) / 3, "line")]
)
def test_scan_of_constant_heights_is_told(heights, detrend):
    x = np.arange(64.0) * 1e-6

    def scene(h):
        profile = {"kind": "samples", "x": x, "h": h, "detrend": detrend}
        return parse_scene(
            {
                "solid": {"youngs_modulus": 1e9, "poisson_ratio": 0.4},
                "profile": profile,
                "loading": {"control": "mean_pressure", "targets": [1e5]},
            }
        )

    assert "the heights are constant" in said(scene(heights))["rms_height"]
    assert "rms_height" not in said(scene(heights + 1e-6 * (np.arange(64) % 7)))
