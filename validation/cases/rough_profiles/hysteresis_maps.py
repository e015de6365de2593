"""How loop, pull-off and area depend on Hurst exponent, bandwidth, adhesion and thickness: the stored maps, drawn.

The full study (validation/studies/maps.py) takes 40 core minutes, so what it found is a file of the project
(validation/corpus/maps.json, as the study writes it).  Here every map becomes curves with the standard error of the
mean over its realisations, and some of its members are solved again: what is stored must be what the code still gives.
"""

import numpy as np

from bem.scene.scene import parse_scene
from bem.solver import solve
from validation.cases.shared.checks import Against, Found, case, column
from validation.corpus.maps import FULL_AXES, Point, maps_over, member_of, reduced, stored_runs
from validation.harness.figure_data import bars, drawn, loglog, semilogx, trace
from validation.harness.schema import Figure, Series
from validation.report.map_figures import Map

AGAIN = (Point(0.3, 10, 0.03, None), Point(0.9, 30, 0.03, None))
SAME = (3e-11, 1e-11)  # relative: allowed, and measured between kernels of two processors
MOST_CURVES = 7


def _figure(found: Map) -> Figure:
    """A map as curves, one for each row, or for every other one; zero is not on a logarithmic axis."""
    series: list[Series] = []
    rows = list(zip(found.rows, found.values, found.errors, strict=True))
    for hue, (row, values, errors) in enumerate(rows[:: 1 + len(rows) // MOST_CURVES]):
        there = [(float(x), value, error or 0.0) for x, value, error in zip(found.columns, values, errors, strict=True)
                 if value and float(x) > 0]  # fmt: skip
        if there:
            x, y, spread = np.array(there).T
            series.append(trace(f"{row}", x, y, hue=hue))
            series.append(bars(f"{row}, standard error", x, y - spread, y + spread, hue=hue))
    draw = semilogx if found.name.endswith("slope") else loglog
    caption = f"{found.title[0].upper()}{found.title[1:]} against {found.column_label}; curves: {found.row_label}."
    return drawn(f"maps-{found.name}", caption, draw(found.column_label, found.title, *series))


def _maps() -> Found:
    """All maps, and members solved now against those stored."""
    members, stored = [member_of(point, 0) for point in AGAIN], stored_runs()
    now = [reduced(member.name, solve(parse_scene(member.scene))) for member in members]
    before = [stored[member.name] for member in members]
    for quantity in ("slope", "loop", "tension"):
        yield Against("self", "stored runs of the full maps").row(
            f"{quantity} of members solved again", "", column(before, quantity), column(now, quantity), SAME
        )
    yield from map(_figure, maps_over(FULL_AXES, stored))


CASES = (
    case("hysteresis-maps", "rough profiles", _maps,
         "How do hysteresis, pull-off and area depend on Hurst exponent, bandwidth, adhesion and thickness?",
         "loading to s = h_rms / 2 and back; theta = gamma / (E* sum q_m h_m^2 / 8)",
         "carbone2009 carbone2008", "half_space adhesion layer"),
)  # fmt: skip
