"""Maps beyond the paper, computed: slope of the area curve, hysteresis loop and pull-off (validation/corpus/maps.py).

The loop of every path is compared with the closed integral of p dDelta, which is coarse, since jumps are spread over
an increment, but independent: a difference beyond `BALANCE` is a failure.  Cost of the 396 realisations: 40 core
minutes, measured.  They are stored one by one, on any executor (ensemble.py), and a second run continues where the
first ended.  maps.json, copied to validation/corpus, is what the case `hysteresis-maps` shows.
"""

from collections.abc import Iterable, Iterator
from functools import partial

from validation.corpus.maps import FULL_AXES, TINY_AXES, Axes, Run, maps_over, member_of, planes, reduced
from validation.harness.case import Case, Found
from validation.harness.ensemble import read_member, run_ensemble
from validation.harness.schema import Cells, Table
from validation.report.map_figures import Map, write_map
from validation.studies.bench import Bench, none_of, study_case

SCHEMA = "linecontact-maps/1"
FILE, MEMBERS = "maps.json", "members"
BALANCE = 0.5  # largest difference of the two loop areas, of the larger; 0.38 measured from layers of 0.1 periods on
COARSE = 0.01  # and of int |p| dDelta, of which the trapezoidal rule misses up to 0.011 in thinner layers (both count)


def cases(bench: Bench, axes: Axes | None = None) -> list[Case]:
    """The case of the study, over given axes; by default small maps in the short form, which show that all runs.

    The folder gets members/, maps.json, and every map as SVG, PDF and CSV.
    """
    chosen = axes or (TINY_AXES if bench.quick else FULL_AXES)
    return [
        study_case("maps", partial(_maps, bench, chosen),
                   "How do area, hysteresis and pull-off depend on the roughness, the adhesion and the layer?",
                   r"loading to $s = h_{\text{rms}} / 2$ and back; the loop by its jumps, and as $\oint p \, d\Delta$",
                   "carbone2009 carbone2008", "half_space adhesion layer", "bem")
    ]  # fmt: skip


def _maps(bench: Bench, axes: Axes) -> Found:
    members = [member_of(point, k) for plane in planes(axes) for point in plane.points for k in range(axes.seeds)]
    each = {member.name: member for member in members}
    ordered = sorted(each.values(), key=lambda member: -int(member.scene["profile"]["harmonics"]))  # long ones first
    outcome = run_ensemble(ordered, bench.folder / MEMBERS, bench.jobs, bench.say, bench.opener)
    runs = {
        name: reduced(name, read_member(member, bench.folder / MEMBERS))
        for name, member in each.items()
        if name not in outcome.failed
    }
    maps = maps_over(axes, runs)
    for found in maps:
        write_map(found, bench.folder)
    bench.write(FILE, SCHEMA, runs=[vars(one) for one in runs.values()])
    yield none_of("realisations without a result", [f"{name}: {why}" for name, why in outcome.failed.items()])
    refused = [f"{one.name}: {one.not_certified} of {one.states}" for one in runs.values() if one.not_certified]
    yield none_of("realisations with states that are not certified", refused)
    yield none_of("realisations whose energies do not balance", list(_unbalanced(runs.values())))
    yield from map(_shown, maps)
    yield {"realisations": len(runs)}


def _unbalanced(runs: Iterable[Run]) -> Iterator[str]:
    for one in runs:
        if one.loop is not None and one.work_of_adhesion:
            difference = abs(one.loop - one.integral)
            if not difference <= BALANCE * max(abs(one.loop), abs(one.integral)) + COARSE * one.work:
                yield f"{one.name}: {one.loop:.4g} J/m^2 released at instabilities, loop {one.integral:.4g} J/m^2"


def _shown(found: Map) -> Table:
    lines = zip(found.rows, found.values, found.notes, strict=True)
    cells: list[Cells] = [
        [row, *(note if value is None else value for value, note in zip(values, notes, strict=True))]
        for row, values, notes in lines
    ]
    caption = f"{found.title}; across: {found.column_label}. Drawn in {found.name}.svg."
    return Table(caption=caption, columns=[found.row_label, *found.columns], rows=cells)
