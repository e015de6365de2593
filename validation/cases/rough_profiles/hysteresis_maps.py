"""How loop, pull-off and area depend on Hurst exponent, bandwidth, adhesion and thickness: the stored maps, drawn.

The full study (validation/studies/maps.py) takes 40 core minutes, so what it found is a file of the project
(validation/corpus/maps.json, as the study writes it).  Here every map becomes curves with the standard error of the
mean over its realisations, and some of its members are solved again: what is stored must be what the code still gives.
"""

from __future__ import annotations

from collections.abc import Iterator

from bem.scene.scene import parse_scene
from bem.solver import solve
from validation.corpus.maps import FULL_AXES, Point, maps_over, member_of, reduced, stored_runs
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import bars, drawn, loglog, semilogx, trace
from validation.harness.rows import compared
from validation.harness.schema import Figure, Reference, Row, Series
from validation.report.map_figures import Map

AGAIN = (Point(0.3, 10, 0.03, None), Point(0.9, 30, 0.03, None))
SAME = 1e-11, 3e-11  # relative: between kernels of two processors, measured, and allowed
MOST_CURVES = 7


def _again() -> Iterator[Row]:
    """Members solved now, against those stored."""
    members = [member_of(point, 0) for point in AGAIN]
    now = [reduced(member.name, solve(parse_scene(member.scene))) for member in members]
    stored = stored_runs()
    source = Reference(kind="self", source="stored runs of the full maps")
    for quantity in ("slope", "loop", "tension"):
        before = [getattr(stored[member.name], quantity) for member in members]
        after = [getattr(one, quantity) for one in now]
        yield compared(f"{quantity} of members solved again", "", source, before, after, SAME[1], SAME[0])


def _figure(found: Map) -> Figure:
    """A map as curves, one for each row, or for every other one; zero is not on a logarithmic axis."""
    series: list[Series] = []
    rows = list(zip(found.rows, found.values, found.errors, strict=True))
    for hue, (row, values, errors) in enumerate(rows[:: 1 + len(rows) // MOST_CURVES]):
        there = [
            (float(x), value, error or 0.0)
            for x, value, error in zip(found.columns, values, errors, strict=True)
            if value and float(x) > 0
        ]
        if there:
            x, y, spread = zip(*there, strict=True)
            ends = ([v - e for v, e in zip(y, spread, strict=True)], [v + e for v, e in zip(y, spread, strict=True)])
            series += [trace(f"{row}", x, y, hue=hue), bars(f"{row}, standard error", x, *ends, hue=hue)]
    draw = semilogx if found.name.endswith("slope") else loglog
    caption = f"{found.title[0].upper()}{found.title[1:]} against {found.column_label}; curves: {found.row_label}."
    return drawn(f"maps-{found.name}", caption, draw(found.column_label, found.title, *series))


def _maps() -> Outcome:
    return Outcome(rows=tuple(_again()), figures=tuple(_figure(found) for found in maps_over(FULL_AXES, stored_runs())))


CASES = (
    Case(id="hysteresis-maps", group="rough profiles", level="quick",
         question="How do hysteresis, pull-off and area depend on Hurst exponent, bandwidth, adhesion and thickness?",
         equations="loading to s = h_rms / 2 and back; theta = gamma / (E* sum q_m h_m^2 / 8)",
         sources=("carbone2009", "carbone2008"), compute=_maps, effects=("half_space", "adhesion", "layer")),
)  # fmt: skip
