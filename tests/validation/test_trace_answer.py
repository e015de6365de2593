"""`linecontact answer`: from a measured trace to a page, by a scene in which every choice can be edited."""

import json
import re
import tomllib

import numpy as np
import pytest

import bem
from validation.command_line.front_door import main

SOLID = ("--youngs-modulus", "5e6", "--poisson-ratio", "0.49")
SPACING = 1e-6


def write_trace(folder, name="trace.csv", *, heading="x [mm]; h [um]\n", noise=0.0, slope=3.0, closed=False, n=400):
    """A rough trace of n samples, of which the ends meet where it is closed."""
    rng = np.random.default_rng(5)
    x, orders = np.arange(n) * SPACING, np.arange(1, 60)
    share = 1.0 if closed else 0.83
    waves = np.cos(2 * np.pi * share * orders[:, None] * np.arange(n) / n + rng.uniform(0, 6, orders.size)[:, None])
    h = 0.4e-6 * orders**-1.5 @ waves + 1e-3 * slope * x + rng.normal(0, 1, n) * noise
    lines = (f"{a * 1e3:.4f};{b * 1e6:.6f}" for a, b in zip(x, h, strict=True))
    path = folder / name
    path.write_text(heading + "\n".join(lines) + "\n", "utf-8")
    return path


def answer(*words):
    """Exit code, also where argparse ends the program."""
    try:
        return main(["answer", *map(str, words)])
    except SystemExit as error:
        return error.code


def profile_of(folder):
    return tomllib.loads((folder / "scene.toml").read_text("utf-8"))["profile"]


@pytest.fixture(scope="module")
def answered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("answer")
    trace = write_trace(folder)
    words = (trace, *SOLID, "--pressure", "20e3", "1e5", "--work-of-adhesion", "0.01", "--out", folder / "out")
    assert answer(*words, "--quiet") == 0
    return folder / "out"


def test_a_trace_is_answered_by_a_page(tmp_path, capsys):
    trace = write_trace(tmp_path)
    out = tmp_path / "out"
    assert answer(trace, *SOLID, "--pressure", "20e3", "1e5", "--thickness", "1e-3", "--out", out) == 0
    told = capsys.readouterr()
    assert told.out.splitlines()[-1] == str(out / "report.html")
    assert "three digits" in told.err
    assert told.err.splitlines()[-1].endswith(f"linecontact study scene {out / 'scene.toml'} --quick --out {out}")
    assert {path.name for path in out.iterdir()} >= {"scene.toml", "result.json", "report.html", "answer.csv"}
    scene = tomllib.loads((out / "scene.toml").read_text("utf-8"))
    assert scene["solid"] == {"youngs_modulus": 5e6, "poisson_ratio": 0.49}
    assert (scene["layer"], scene["loading"]["targets"]) == ({"thickness": 1e-3}, [20e3, 1e5])
    assert "adhesion" not in scene
    assert scene["accuracy"]["tolerance"] == 1e-3


def test_pull_off_is_the_tension_at_which_the_contact_comes_apart(tmp_path, capsys):
    words = (write_trace(tmp_path), *SOLID, "--pressure", "5e3", "--pull-off", "--out", tmp_path / "out", "--quiet")
    assert answer(*words) == 2
    assert "--pull-off without adhesion" in capsys.readouterr().err
    assert answer(*words, "--work-of-adhesion", "1e-3") == 0
    result, told = bem.read_result(tmp_path / "out"), capsys.readouterr().out
    assert [state.status for state in result.targets] == ["converged", "converged", "unreachable"]
    assert result.events[-1].kind == "pull_off"
    assert f"largest tension on the way out is {-result.largest_tension.mean_pressure:.4g} Pa" in told
    assert re.search(r"5000 Pa +0 Pa +-6\.6 MPa$", told.splitlines()[0])
    assert "apart" in next(line for line in told.splitlines() if line.startswith("contacts"))


def test_a_map_is_answered_by_the_median_of_its_rows(tmp_path, capsys):
    np.save(tmp_path / "map.npy", 2e-6 * np.random.default_rng(1).normal(size=(64, 6)))
    keys = ("--profile", "row=all", "every=2", "spacing=1", "unit_x=um", "unit_h=m", "harmonics=5")
    words = (tmp_path / "map.npy", *SOLID, "--pressure", "5e4", "--work-of-adhesion", "0.01", "--pull-off", *keys)
    assert answer(*words, "--out", tmp_path / "out", "--jobs", 1) == 0
    told = capsys.readouterr()
    assert "3 of 3 rows answered, each a ridge" in told.out
    assert told.out.splitlines()[-1] == str(tmp_path / "out" / "report.html")
    assert (profile_of(tmp_path / "out")["row"], profile_of(tmp_path / "out")["every"]) == ("all", 2)
    tensions = [-bem.read_result(row).largest_tension.mean_pressure for row in (tmp_path / "out").glob("row-*")]
    last = (tmp_path / "out" / "answer.csv").read_text().splitlines()[-1].split(",")
    assert last[:5] == ["nan", "unloading", "pull_off", "Pa", "3"]
    assert float(last[5]) == pytest.approx(np.median(tensions), rel=1e-15)
    page, rows = (tmp_path / "out" / "report.html").read_text("utf-8"), bem.read_rows(tmp_path / "out")
    assert "3 of 3 rows of the map answered" in page and page.count("<svg") == 3
    for row, result in rows.results.items():
        cells = re.search(rf'<td class="num">{row}</td><td>answered</td><td class="num">(.*?)</td>', page)
        assert float(cells[1]) == pytest.approx(result.targets[0].contact_fraction, rel=0.006)
    (tmp_path / "out" / "report.html").unlink()
    assert main(["report", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "report.html").read_text("utf-8") == page


@pytest.mark.parametrize(
    ("name", "taken"),
    [("map.npy", "the column a[:, 3] of the array"), ("map.txt", "line 4 of the file")],
)
def test_the_line_of_a_map_is_named_wherever_its_row_is(name, taken, tmp_path, capsys):
    heights = 2e-6 * np.random.default_rng(1).normal(size=(64, 6))
    np.save(tmp_path / "map.npy", heights)
    np.savetxt(tmp_path / "map.txt", heights.T)
    words = (tmp_path / name, *SOLID, "--pressure", "5e4", "--out", tmp_path / "out", "--quiet", "--profile")
    assert answer(*words, "row=3", "spacing=1", "unit_x=um", "unit_h=m", "harmonics=5") == 0
    np.testing.assert_allclose(bem.load_scene(tmp_path / "out" / "scene.toml").scan.measured.h, heights[:, 3])
    assert f"row = 3  # as given: {taken}\n" in (tmp_path / "out" / "scene.toml").read_text("utf-8")
    assert f"one row of a map of 6 rows ({taken}), positions in um" in (tmp_path / "out" / "report.html").read_text(
        "utf-8"
    )
    capsys.readouterr()
    assert main(["check", str(tmp_path / "out" / "scene.toml")]) == main(["keys", "profile"]) == 0
    told = capsys.readouterr().out
    assert f"one row of a map of 6 rows ({taken}), " in told
    assert "the fourth line of a text, the column a[:, 3] of a .npy or .mat array" in told
    if name == "map.npy":
        words = (*words[:-4], "--out", tmp_path / "each", "--quiet", "--jobs", "1", "--profile", "row=all", "every=3")
        assert answer(*words, "spacing=1", "unit_x=um", "unit_h=m", "harmonics=5") == 0
        scene = (tmp_path / "each" / "scene.toml").read_text("utf-8")
        assert 'row = "all"  # as given: row 0 is the column a[:, 0] of the array\n' in scene


def test_a_spike_is_replaced_and_told_of_unless_it_is_asked_for(tmp_path, capsys):
    trace = write_trace(tmp_path)
    lines = trace.read_text().splitlines(keepends=True)
    lines[200] = f"{lines[200].partition(';')[0]}; 90\n"
    trace.write_text("".join(lines))
    assert answer(trace, *SOLID, "--pressure", "5e4", "--out", tmp_path / "out") == 0
    assert "note: profile.outliers: spikes (1 of up to 8" in capsys.readouterr().err
    assert profile_of(tmp_path / "out")["outliers"] == "replace"
    words = ("--profile", "outliers=keep", "--out", tmp_path / "kept")
    assert answer(trace, *SOLID, "--pressure", "5e4", *words) == 0
    assert "warning: profile.outliers: a spike of up to 8" in capsys.readouterr().err


def test_a_row_without_an_answer_stands_on_the_page_of_its_map(tmp_path, capsys):
    heights = 2e-6 * np.random.default_rng(1).normal(size=(64, 3))
    heights[5, 1] = np.nan
    np.save(tmp_path / "map.npy", heights)
    keys = ("--profile", "row=all", "spacing=1", "unit_x=um", "unit_h=m", "harmonics=5")
    words = (tmp_path / "map.npy", *SOLID, "--pressure", "5e4", *keys, "--out", tmp_path / "out", "--jobs", 1)
    assert answer(*words) == 1
    page = (tmp_path / "out" / "report.html").read_text("utf-8")
    assert "2 of 3 rows of the map answered" in page
    assert re.search(r'<td class="num">1</td><td class="deviates">profile.missing', page)
    assert "missing" in bem.read_rows(tmp_path / "out").failures[1]
    (tmp_path / "out" / "rows.csv").unlink()
    assert main(["report", str(tmp_path / "out")]) == 2
    assert "holds no map that was solved row by row to its end" in capsys.readouterr().err


def test_the_scene_solved_again_gives_the_same_answer(answered, tmp_path, monkeypatch):
    monkeypatch.chdir(answered)
    assert main(["run", "scene.toml", "--out", str(tmp_path / "again"), "--quiet"]) == 0
    first, second = bem.read_result(answered), bem.read_result(tmp_path / "again")
    numbers = [[(s.mean_pressure, s.contact_fraction, s.edges) for s in result.states] for result in (first, second)]
    assert numbers[0] == numbers[1]
    assert first.provenance["scene_sha256"] == second.provenance["scene_sha256"]


def test_every_choice_is_a_line_of_the_scene(answered):
    text = (answered / "scene.toml").read_text("utf-8")
    profile = profile_of(answered)
    assert (profile["detrend"], profile["periodic"], profile["cutoff_short"]) == ("line", "mirror", 5e-6)
    assert "the tilt of 0.00" in text
    assert '# unit_x = "mm": stated by the file' in text
    assert "# harmonics = " in text


def test_the_cut_is_the_one_that_check_suggests(tmp_path, capsys):
    """With enough noise: the trace falls below it at a wave of more than five samples."""
    write_trace(tmp_path, noise=15e-9, n=3000)
    out = tmp_path / "out"
    assert answer(tmp_path / "trace.csv", *SOLID, "--pressure", "20e3", "--out", out, "--quiet") == 0
    capsys.readouterr()
    assert main(["check", "--json", str(out / "scene.toml")]) == 0
    steps = json.loads(capsys.readouterr().out)["profile_preparation"]
    (suggested,) = (step["suggested_cutoff"] for step in steps if step["step"] == "spectrum")
    assert profile_of(out)["cutoff_short"] == pytest.approx(suggested, rel=1e-3)
    assert suggested > 24 * SPACING


def test_a_long_trace_without_adhesion_is_not_cut_further_and_the_slope_that_is_left_is_told(tmp_path, capsys):
    out = tmp_path / "out"
    assert answer(write_trace(tmp_path, n=1500), *SOLID, "--pressure", "20e3", "--out", out, "--quiet") == 0
    assert profile_of(out)["cutoff_short"] == pytest.approx(5 * SPACING, rel=1e-3)
    steps = {step["step"]: step for step in bem.read_result(out).profile_preparation}
    share = steps["cut"]["rms_slope"][1] / steps["filter"]["rms_slope"][0]
    told = f"filter and cut leave {100 * share:.1f} % of the rms slope"
    assert told in capsys.readouterr().out
    assert told in (out / "report.html").read_text("utf-8")


def test_a_bow_is_told_on_the_terminal_in_the_scene_and_in_the_result(tmp_path, capsys):
    trace, out = write_trace(tmp_path), tmp_path / "out"
    heading, *lines = trace.read_text("utf-8").splitlines()
    pairs = [tuple(map(float, line.split(";"))) for line in lines]
    middle = pairs[len(pairs) // 2][0]
    bowed = (f"{a};{b + 3 * ((a - middle) / middle) ** 2}" for a, b in pairs)
    trace.write_text("\n".join([heading, *bowed]) + "\n", "utf-8")
    words = (trace, *SOLID, "--pressure", "20e3", "--out", out)
    assert answer(*words) == 0
    (warning,) = bem.read_result(out).warnings
    assert warning.about == "profile.detrend" and "of the rms height: form?" in warning.message
    assert warning.message in capsys.readouterr().err
    assert warning.message in (out / "scene.toml").read_text("utf-8").replace("\n# ", " ")
    assert answer(*words, "--overwrite", "--profile", "detrend=quadratic") == 0
    assert "bow of" not in capsys.readouterr().err


def test_a_long_trace_with_adhesion_is_cut_to_what_takes_seconds(tmp_path):
    out = tmp_path / "out"
    words = ("--pressure", "20e3", "--work-of-adhesion", "1e-4", "--out", out, "--quiet")
    assert answer(write_trace(tmp_path, n=1500), *SOLID, *words) == 0
    assert profile_of(out)["cutoff_short"] == pytest.approx(1500 / 125 * SPACING, rel=1e-3)
    text = (out / "scene.toml").read_text("utf-8")
    assert "125 waves along the trace" in text and "leaves an rms slope of" in text.replace("\n# ", " ")


def test_a_trace_whose_ends_meet_repeats_as_it_is(tmp_path):
    trace = write_trace(tmp_path, slope=0.0, closed=True)
    assert answer(trace, *SOLID, "--pressure", "20e3", "--out", tmp_path / "out", "--quiet") == 0
    profile = profile_of(tmp_path / "out")
    assert (profile["detrend"], profile["periodic"]) == ("mean", "as_is")


def test_keys_that_are_given_are_taken(tmp_path):
    trace = write_trace(tmp_path, heading="")
    keys = ("--profile", "unit_x=mm", "unit_h=um", "detrend=quadratic", "harmonics=20")
    assert answer(trace, *SOLID, "--pressure", "20e3", *keys, "--out", tmp_path / "out", "--quiet") == 0
    profile = profile_of(tmp_path / "out")
    assert (profile["detrend"], profile["harmonics"], profile["unit_h"]) == ("quadratic", 20, "um")
    assert "cutoff_short" not in profile


def test_a_trace_that_cannot_be_used_is_refused_as_check_refuses_it(tmp_path, capsys):
    trace = write_trace(tmp_path, heading="")
    assert answer(trace, *SOLID, "--pressure", "20e3", "--out", tmp_path / "out") == 2
    refusal = capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    scene = '[solid]\nyoungs_modulus = 5e6\npoisson_ratio = 0.49\n[profile]\nkind = "samples"\nfile = "trace.csv"\n'
    scene += 'detrend = "line"\n[loading]\ncontrol = "mean_pressure"\ntargets = [20e3]\n'
    (tmp_path / "scene.toml").write_text(scene)
    assert main(["check", str(tmp_path / "scene.toml")]) == 2
    assert refusal.removeprefix(capsys.readouterr().err.rstrip()) == (
        "\n  keys of [profile] are given as: --profile unit_x=.. unit_h=..\n"
    )
    assert "profile.unit_x is missing" in refusal


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--pressure", "1e6", "50e3"), "--pressure: 50000 after 1e+06; allowed: numbers > 0 that rise"),
        (("--pressure", "0"), "--pressure: 0; allowed: numbers > 0 that rise"),
        (("--pressure", "nan"), "--pressure: nan; allowed"),
        (("--pressure", "50kPa"), "--pressure: '50kPa'; allowed: numbers in Pa, as in 50e3 1e6"),
        (("--pressure", "1e4", "--youngs-modulus", "50MPa"), "'50MPa'; allowed: a number in Pa, as in 50e6"),
        (("--pressure", "1e4", "--thickness", "2mm"), "'2mm'; allowed: a number in m, as in 1e-3"),
        ((), "the following arguments are required: --pressure"),
        (("--pressure", "1e4", "--youngs-modulus", "-5e6"), "solid.youngs_modulus"),
        (("--pressure", "1e4", "--thickness", "0"), "layer.thickness = 0"),
        (("--pressure", "1e4", "--work-of-adhesion", "-1"), "adhesion.work_of_adhesion = -1"),
        (("--pressure", "1e4", "--profile", "unit_x"), "allowed: KEY=VALUE"),
        (("--pressure", "1e4", "--profile", "hight=3"), "profile.hight"),
    ],
    ids=lambda value: "-" if isinstance(value, str) else " ".join(value),
)
def test_options_that_cannot_be_used_are_refused(tmp_path, capsys, words, told):
    out = tmp_path / "out"
    assert answer(write_trace(tmp_path), *SOLID, *words, "--out", out) == 2
    assert told in capsys.readouterr().err
    assert not out.exists()


def test_an_answer_is_replaced_only_when_asked(answered, tmp_path, capsys):
    trace, before = answered.parent / "trace.csv", (answered / "scene.toml").read_bytes()
    words = (trace, *SOLID, "--pressure", "20e3", "--out", answered, "--quiet")
    assert answer(*words) == 2
    assert "--overwrite replaces it" in capsys.readouterr().err
    assert (answered / "scene.toml").read_bytes() == before
    assert answer(*words, "--overwrite") == 0
    assert len(bem.read_result(answered).targets) == 1


def test_a_trace_that_does_not_exist_is_named(tmp_path, capsys):
    assert answer(tmp_path / "none.csv", *SOLID, "--pressure", "20e3", "--out", tmp_path / "out") == 2
    assert 'profile.file = "none.csv": cannot be read' in capsys.readouterr().err
