"""The figure of a scan before and after its preparation, from what a result stores."""

import numpy as np
import pytest

import bem
from bem.scene.scene import parse_scene
from validation.report.figures import svg_of
from validation.report.run_figures import figures_of, preparation_figure, spectrum_figure


def test_what_a_result_stores_is_drawn(tmp_path):
    count = 10_000
    x = np.arange(count) * 1e-3  # mm
    heights = np.cos(2 * np.pi * x / 5) + 0.1 * x  # um
    cells = [f"{value:.6f}" for value in heights]
    cells[4321] = "NaN"
    rows = (f"{place:.4f};{cell}" for place, cell in zip(x, cells, strict=True))
    (tmp_path / "scan.csv").write_text("x [mm];h [um]\n" + "\n".join(rows))
    scene = parse_scene(
        {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": {
                **{"kind": "samples", "file": "scan.csv", "missing": "interpolate", "detrend": "line"},
                **{"periodic": "mirror", "harmonics": 10},
            },
            "loading": {"control": "penetration", "targets": [1e-8]},
        },
        tmp_path,
    )
    result = bem.solve(scene)
    figure = preparation_figure(result.fields)
    before, after = figure.solution.series
    assert (figure.solution.xlabel, figure.solution.ylabel) == ("x / mm", "height / µm")
    assert (len(before.x), len(after.x)) == (4000, 4000)
    assert (before.x[-1], after.x[-1]) == pytest.approx((9.999, 19.999), rel=1e-3)  # the mirrored line is twice as long
    assert "as prepared" in svg_of(figure, "a")


def noisy_result(folder, noise, **profile):
    """A run on a piece of a self-affine line at steps of 1 um, with white noise of an rms height."""
    h = bem.Profile.self_affine(8e-3, 0.8, 5e-7, 3999, 0).height(1e-6 * np.arange(5600))
    h += noise * np.random.default_rng(100).normal(size=h.size)
    (folder / "scan.csv").write_text("\n".join(f"{1e-6 * k:.9g},{value:.12g}" for k, value in enumerate(h)))
    table = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "detrend": "line", **profile}
    scene = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
        "profile": table,
        "loading": {"control": "mean_pressure", "targets": [1e2]},
    }
    return bem.solve(parse_scene(scene, folder))


def test_spectrum_is_drawn_with_its_floor_and_the_cuts(tmp_path):
    result = noisy_result(tmp_path, 2e-8, periodic="mirror", cutoff_short=1e-4, cutoff_long=2e-3)
    facts = next(step for step in result.profile_preparation if step["step"] == "spectrum")
    figure = spectrum_figure(result.fields, result.profile_preparation)
    panel = figure.solution
    assert (panel.xlabel, panel.xscale, panel.yscale) == ("wavelength / µm", "log", "log")
    lines = {series.label: series for series in panel.series}
    spectrum, floor, cut, short, long, suggested = lines.values()
    assert list(lines)[3:5] == ["cutoff_short, 100 µm", "cutoff_long, 2e+03 µm"]
    np.testing.assert_allclose(spectrum.y, result.fields["scan_density"])
    assert floor.y == [facts["noise_density"]] * 2
    assert (short.x, long.x) == (pytest.approx([100] * 2), pytest.approx([2000] * 2))
    assert cut.x[0] == pytest.approx(11200 / result.scene["profile"]["harmonics"])
    assert suggested.x[0] == pytest.approx(1e6 * facts["suggested_cutoff"])
    assert [figure.id for figure in figures_of(result, [])][-2:] == ["preparation", "spectrum"]
    assert "noise floor" in svg_of(figure, "a")


def test_spectrum_without_a_floor_is_drawn_without(tmp_path):
    result = noisy_result(tmp_path, 0.0, harmonics=50)
    figure = spectrum_figure(result.fields, result.profile_preparation)
    assert [series.label for series in figure.solution.series] == [
        "power spectrum of the scan",
        "harmonics end, 112 µm",
    ]


def test_result_stored_without_a_spectrum_is_drawn_as_before(tmp_path):
    result = noisy_result(tmp_path, 0.0, harmonics=20)
    fields = {name: values for name, values in result.fields.items() if name not in ("scan_wavelength", "scan_density")}
    steps = [step for step in result.profile_preparation if step["step"] != "spectrum"]
    assert preparation_figure(fields) is not None
    assert spectrum_figure(fields, steps) is None
