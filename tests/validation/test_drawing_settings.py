"""Pictures do not depend on the settings of Matplotlib that a user has."""

import os
import subprocess
import sys

DRAW = """
import sys
from pathlib import Path
from types import SimpleNamespace

from bem.scene import plots
from validation.harness.figure_data import Figure, Panel, Series
from validation.report.figures import svg_of

error = SimpleNamespace(mean_pressure=0.0)
states = [
    SimpleNamespace(branch="loading", contact_fraction=x, separation=1e-6 * x, mean_pressure=x, error_estimate=error)
    for x in (0.1, 0.2)
]
folder = Path(sys.argv[1])
plots.curves(states).savefig(folder / "curves.png")
series = Series(label="mean_pressure", x=[1.0, 2.0], y=[1.0, 4.0])
panel = Panel(xlabel="x", ylabel="$p$", series=[series])
(folder / "figure.svg").write_text(svg_of(Figure(id="figure", caption="A figure.", solution=panel), "a"), "utf-8")
"""
RC = """
text.usetex: True
svg.fonttype: none
axes.facecolor: red
figure.dpi: 30
savefig.dpi: 30
font.size: 20
"""


def drawn(folder, **environment):
    folder.mkdir()
    subprocess.run([sys.executable, "-c", DRAW, folder], check=True, env=os.environ | environment)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_pictures_are_equal_whatever_a_matplotlibrc_says(tmp_path):
    settings = tmp_path / "matplotlibrc"
    settings.write_text(RC)
    plain = drawn(tmp_path / "plain")
    assert sorted(plain) == ["curves.png", "figure.svg"]
    assert drawn(tmp_path / "other", MATPLOTLIBRC=str(settings), MPLBACKEND="pdf") == plain
