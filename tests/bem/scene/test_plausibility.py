"""Groups of a scene by independent formulas, and what is named when a unit, a cut or a size is not what was meant."""

import copy

import numpy as np
import pytest

import bem
from bem.command_line.console import groups_text
from bem.scene.plausibility import MEANINGS, cautions_of, groups_of
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
}  # fmt: skip


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
    curvature = -3e-5 * q**2 * np.cos(q * x) + 16e-5 * q**2 * np.cos(4 * q * x + 1.0)
    modulus = 1e6 / (1 - 0.3**2)
    pressure = modulus / 2 * (3e-5 * q * np.cos(q * x) - 4e-5 * q * np.cos(4 * q * x + 1.0))  # that presses it flat
    expected = {
        "rms_height": np.sqrt(np.mean(h**2)),
        "rms_height_over_period": np.sqrt(np.mean(h**2)) / 0.02,
        "rms_slope": np.sqrt(np.mean(slope**2)),
        "pressure_scale": modulus * np.sqrt(np.mean(slope**2)),
        "thickness_over_period": 0.2,
        "adhesion_over_elastic_energy": 0.05 / np.mean(pressure * h / 2),
        "tabor_parameter": (0.05**2 / np.sqrt(np.mean(curvature**2)) / (modulus**2 * 3e-10**3)) ** (1 / 3),
        "least_target": 1e-5 / np.sqrt(np.mean(h**2)),
        "largest_target": 3e-5 / np.sqrt(np.mean(h**2)),
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


def test_mean_pressures_of_the_states_are_groups_of_the_result(folder):
    result = bem.solve(scan_scene(folder, harmonics=10))
    scale = result.groups["pressure_scale"]
    pressures = [state.mean_pressure / scale for state in result.states]
    assert result.groups["least_mean_pressure"] == pytest.approx(min(pressures), rel=1e-12)
    assert result.groups["largest_mean_pressure"] == pytest.approx(max(pressures), rel=1e-12)
    assert result.profile_preparation[-1]["step"] == "cut"
    assert [caution.about for caution in result.warnings] == ["profile.harmonics"]


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


def test_short_scan_in_mm_read_as_m_is_named(tmp_path):
    """0.5 mm and 2.5 um rms, read as m under mean pressures: slope, pressures and adhesion are ordinary."""
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, ROUGH.height(X)]) / 20, delimiter=",", fmt="%.12g")
    assert said(scan_scene(tmp_path, loading=PRESSURE)) == {}
    found = said(scan_scene(tmp_path, "m", "m", PRESSURE))
    assert sorted(found) == ["profile.period", "rms_height"]
    assert 'above 0.1 m: unit_x = "m"?' in found["profile.period"]
    assert 'above 0.0001 m: unit_h = "m"?' in found["rms_height"]


@pytest.mark.parametrize(
    ("units", "remedy"),
    [
        (("mm", "m"), 'unit_h = "m"? read as "mm" it is 0.'),
        (("um", "mm"), 'unit_h = "mm"? read as "um" it is 0.'),
        (("um", "mm"), 'unit_x = "um"? read as "mm" it is 0.'),
    ],
)
def test_one_of_two_units_mistaken_is_named_with_what_would_do(units, remedy, folder):
    assert remedy in said(scan_scene(folder, *units))["rms_slope"]


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
    assert ("everything touches" in message) == all_of_it


@pytest.mark.parametrize(("harmonics", "told"), [(10, True), (40, False), ("all", False)])
def test_cut_that_loses_slope_is_named(harmonics, told, folder):
    scene = scan_scene(folder, harmonics=harmonics)
    assert ("profile.harmonics" in said(scene)) == told == (groups_of(scene)["slope_share_kept"] < 0.9)


@pytest.mark.parametrize(("periodic", "told"), [("as_is", True), ("mirror", False), ("window", False)])
def test_jump_at_the_end_of_the_period_is_named(periodic, told, tmp_path):
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, ROUGH.height(X) + 0.02 * X]), delimiter=",", fmt="%.12g")
    scene = scan_scene(tmp_path, periodic=periodic, harmonics="all")
    assert ("profile.periodic" in said(scene)) == told
    assert (groups_of(scene)["end_jump_over_step"] > 3) == told


@pytest.mark.parametrize(
    ("count", "periodic", "told"), [(COUNT + 1, "as_is", True), (COUNT, "as_is", False), (COUNT + 1, "mirror", False)]
)
def test_period_with_its_end_point_is_named(count, periodic, told, tmp_path):
    x = LENGTH / COUNT * np.arange(count)
    np.savetxt(tmp_path / "scan.csv", np.column_stack([x, ROUGH.height(x)]), delimiter=",", fmt="%.9g")
    found = said(scan_scene(tmp_path, periodic=periodic))
    assert ("the last height equals the first" in found.get("profile.file", "")) == told


OWN_TILT = float(np.polyfit(X, ROUGH.height(X), 1)[0])
TILTS = [(0.06, "mean", True), (0.06, "none", True), (0.06, "line", False), (0.0, "mean", False)]


@pytest.mark.parametrize("periodic", ["as_is", "mirror", "window"])
@pytest.mark.parametrize(("tilt", "detrend", "told"), TILTS)
def test_tilt_that_dominates_is_named_with_its_remedy(tilt, detrend, told, periodic, tmp_path):
    """A tilt of 0.06 over 10 mm is 0.17 mm rms, beside 0.05 mm of roughness with a tilt of its own."""
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, ROUGH.height(X) + (tilt - OWN_TILT) * X]), delimiter=",")
    message = said(scan_scene(tmp_path, periodic=periodic, detrend=detrend, harmonics="all")).get("profile.detrend", "")
    assert ('detrend = "line" takes it away' in message, "a tilt of 0.06 makes up most" in message) == (told, told)


@pytest.mark.parametrize("phase", np.linspace(0, np.pi, 7))
def test_wave_of_one_period_is_no_tilt(phase, tmp_path):
    """A line takes at most 6 / pi^2 of its mean square: the rms height falls by 1.6 at most."""
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, RMS * np.sin(2 * np.pi * X / LENGTH + phase)]), delimiter=",")
    assert "profile.detrend" not in said(scan_scene(tmp_path, harmonics="all"))


def test_heights_that_alternate_are_named(tmp_path):
    """Two scans in turn: all harmonics keep little of the slope, so more of them is no remedy."""
    h = ROUGH.height(X) + 0.01 * np.cos(np.pi * np.arange(COUNT))
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, h]), delimiter=",", fmt="%.12g")
    found = said(scan_scene(tmp_path, harmonics="all"))
    assert "alternate from sample to sample" in found["profile.file"]
    assert "profile.harmonics" not in found


def test_rounded_positions_are_told(tmp_path):
    (tmp_path / "scan.csv").write_text(
        "\n".join(f"{a:.1f},{b:.6g}" for a, b in zip(X * 6.6, ROUGH.height(X), strict=True))
    )
    message = said(scan_scene(tmp_path))["profile.unequal_spacing"]
    assert "positions are printed to 0.0001 m; within that they are at equal steps of 0.000165 m" in message


def test_dropouts_that_are_kept_are_named(tmp_path):
    h = ROUGH.height(X)
    h[30:35] = -99.0
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, h]), delimiter=",", fmt="%.12g")
    assert (
        "5 samples may be dropouts, -99 mm in lines 31 to 35"
        in said(scan_scene(tmp_path, dropouts="keep"))["profile.dropouts"]
    )
    assert "profile.dropouts" not in said(scan_scene(tmp_path, missing="interpolate"))


def test_spikes_that_are_kept_are_named(tmp_path):
    h = ROUGH.height(X)
    h[30] += 1.0
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, h]), delimiter=",", fmt="%.12g")
    assert "1 of 400 samples are spikes, the first at line 31" in said(scan_scene(tmp_path))["profile.outliers"]
    assert "profile.outliers" not in said(scan_scene(tmp_path, outliers="replace"))


@pytest.mark.parametrize(("last", "told"), [(1.3, True), (1.4, False)])
def test_equal_heights_are_named(last, told, tmp_path):
    heights = np.append(np.full(COUNT - 1, 1.3), last)
    np.savetxt(tmp_path / "scan.csv", np.column_stack([X, heights]), delimiter=",", fmt="%.12g")
    assert ("all heights are equal: another column?" in said(scan_scene(tmp_path)).values()) == told


def test_missing_unit_is_refused_by_name(folder):
    with pytest.raises(SceneError) as caught:
        parse_scene(WAVE | {"profile": {"kind": "samples", "file": "scan.csv", "unit_x": "mm"}}, folder)
    assert [mistake.path for mistake in caught.value.mistakes] == ["profile.unit_h"]


def test_unit_of_the_file_is_resolved(tmp_path):
    columns = np.column_stack([X, ROUGH.height(X)])
    np.savetxt(tmp_path / "scan.csv", columns, delimiter=",", fmt="%.12g", header="x [mm],h [mm]")
    scene = parse_scene(WAVE | {"profile": {"kind": "samples", "file": "scan.csv"}}, tmp_path)
    assert (scene.resolved()["profile"]["unit_x"], scene.profile.unit_h) == ("mm", "mm")
    assert scene.profile.period == pytest.approx(0.01, rel=1e-12)


def test_work_beyond_sense_is_refused():
    profile = {"kind": "self_affine", "period": 0.01, "hurst": 0.8, "rms_height": 1e-5, "harmonics": 20_000}
    path = {"control": "separation", "start": 3e-5, "stop": 1e-5, "count": 100_000}
    with pytest.raises(SceneError, match=r"loading\.targets are 100000; allowed: 50000 with 20000 harmonics"):
        parse_scene(WAVE | {"profile": profile, "loading": path})


@pytest.mark.parametrize(("slope", "told", "unit"), [(0.49, False, False), (0.51, True, False), (1.1, True, True)])
def test_slopes_that_are_not_small_are_named(slope, told, unit):
    factor = slope / groups_of(parse_scene(WAVE))["rms_slope"]
    scene = changed("profile.amplitudes", [factor * height for height in WAVE["profile"]["amplitudes"]])
    message = said(scene).get("rms_slope", "")
    assert ("beyond the limit of small slopes" in message, "unit of the heights" in message) == (told, unit)


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


def test_every_group_is_explained_where_it_is_printed(folder):
    groups = bem.solve(scan_scene(folder, loading=PRESSURE, harmonics=10)).groups | groups_of(parse_scene(WAVE))
    assert set(groups) == set(MEANINGS) - {"noise_share_of_slope"}  # that of scans with a noise floor
    lines = groups_text(groups, ()).splitlines()
    assert all(MEANINGS[name] and line.endswith(MEANINGS[name]) for name, line in zip(groups, lines, strict=True))


def test_the_share_of_slope_is_that_of_the_cut(folder):
    """One definition: the slope after the cut over that before it is the group."""
    scene = scan_scene(folder, harmonics=10)
    cut = scene.preparation()[-1]
    assert cut["rms_slope"][1] / cut["rms_slope"][0] == pytest.approx(cut["slope_share_kept"], rel=1e-12)
    assert cut["slope_share_kept"] == groups_of(scene)["slope_share_kept"]
    assert cut["rms_slope"][1] == pytest.approx(groups_of(scene)["rms_slope"], rel=1e-12)


@pytest.mark.parametrize(("tabor", "told"), [(5.1, False), (4.9, True)])
def test_forces_that_reach_beyond_the_edge_are_named(tabor, told):
    """From the work of adhesion that gives a Tabor parameter: mu grows as its power 2/3."""
    scene = parse_scene(WAVE)
    work = 0.05 * (tabor / groups_of(scene)["tabor_parameter"]) ** 1.5
    scene = changed("adhesion.work_of_adhesion", work)
    assert groups_of(scene)["tabor_parameter"] == pytest.approx(tabor, rel=1e-12)
    assert ("tabor_parameter" in said(scene)) == told


def test_all_harmonics_are_for_scans():
    profile = {"kind": "self_affine", "period": 0.01, "hurst": 0.8, "rms_height": 1e-5, "harmonics": "all"}
    with pytest.raises(SceneError, match=r'profile\.harmonics = "all"'):
        parse_scene(WAVE | {"profile": profile})


def test_persson_sees_the_same_profile(folder):
    from persson import DiscreteSpectrum

    scene = scan_scene(folder, detrend="line", periodic="mirror", harmonics="all")
    lines, groups = DiscreteSpectrum.of_profile(scene.surface()), groups_of(scene)
    assert (lines.h_rms, lines.slope_rms) == pytest.approx((groups["rms_height"], groups["rms_slope"]), rel=1e-12)
