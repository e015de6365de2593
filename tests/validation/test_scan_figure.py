"""The figure of a scan before and after its preparation, from what a result stores."""

import numpy as np
import pytest

import bem
from bem.scene.scene import parse_scene
from validation.report.figures import svg_of
from validation.report.scan_figure import preparation_figure


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
    figure = preparation_figure(result.fields, result.profile_preparation)
    before, after = figure.solution.series
    assert (figure.solution.xlabel, figure.solution.ylabel) == ("x / mm", "height / µm")
    assert (len(before.x), len(after.x)) == (4000, 4000)
    assert (before.x[-1], after.x[-1]) == pytest.approx((9.999, 19.999), rel=1e-3)  # the mirrored line is twice as long
    assert "missing heights interpolated: 1; a line subtracted; mirrored; 10 of 9999 harmonics" in figure.caption
    assert "as prepared" in svg_of(figure, "a")
