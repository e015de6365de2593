"""Maps beyond the paper, computed: slope of the area curve, hysteresis loop and pull-off (validation/corpus/maps.py).

The loop of every path is compared with the closed integral of p dDelta, which is coarse, since jumps are spread over
an increment, but independent: a difference beyond `BALANCE` is a failure.  Cost of the 396 realisations: 40 core
minutes, measured.  They are stored one by one, on any executor (ensemble.py), and a second run continues where the
first ended.  maps.json, copied to validation/corpus, is what the case `hysteresis-maps` shows.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from validation.corpus.maps import FULL_AXES, TINY_AXES, Axes, Run, maps_over, member_of, planes, reduced
from validation.harness.ensemble import Gathered, read_member, run_ensemble
from validation.harness.execution import Listener, Note
from validation.harness.executors import Opener, local_processes
from validation.harness.store import write_json
from validation.report.map_figures import Map, write_map
from validation.studies.shown import text_table

SCHEMA = "linecontact-maps/1"
FILE = "maps.json"
BALANCE = 0.5  # largest difference of the two loop areas, of the larger; 0.38 measured from layers of 0.1 periods on
COARSE = 0.01  # and of int |p| dDelta, of which the trapezoidal rule misses up to 0.011 in thinner layers (both count)


def run(folder: Path, quick: bool, report: Listener, jobs: int = 1, opener: Opener = local_processes) -> int:
    """Run the study; 1 when a realisation failed, is not certified, or its energies do not balance.

    Quick: small maps that show that everything runs.
    """
    return run_over(TINY_AXES if quick else FULL_AXES, folder, report, jobs, opener)


def run_over(axes: Axes, folder: Path, report: Listener, jobs: int = 1, opener: Opener = local_processes) -> int:
    """Run the study over given axes: members/, maps.json, and every map as SVG, PDF and CSV go to the folder."""
    members = [member_of(point, k) for plane in planes(axes) for point in plane.points for k in range(axes.seeds)]
    each = {member.name: member for member in members}
    ordered = sorted(each.values(), key=lambda member: -int(member.scene["profile"]["harmonics"]))  # long ones first
    outcome = run_ensemble(ordered, folder / "members", jobs, report, opener)
    runs = {
        name: reduced(name, read_member(member, folder / "members"))
        for name, member in each.items()
        if name not in outcome.failed
    }
    failures = list(_failures(outcome, list(runs.values())))
    maps = maps_over(axes, runs)
    for found in maps:
        write_map(found, folder)
        print(text_table([found.row_label, *map(str, found.columns)], _shown(found)))
    write_json(folder / FILE, {"schema": SCHEMA, "runs": [vars(one) for one in runs.values()], "failures": failures})
    for line in failures:
        report(Note(f"FAILED {line}"))
    print(f"{len(runs)} realisations, {len(maps)} maps, {len(failures)} failures; {folder / FILE}")
    return 1 if failures else 0


def _failures(outcome: Gathered, runs: Sequence[Run]) -> Iterator[str]:
    for name, why in outcome.failed.items():
        yield f"{name}: {why}"
    for one in runs:
        if one.not_certified:
            yield f"{one.name}: {one.not_certified} of {one.states} states are not certified"
        if one.loop is not None and one.work_of_adhesion:
            difference = abs(one.loop - one.integral)
            if difference > BALANCE * max(abs(one.loop), abs(one.integral)) + COARSE * one.work:
                yield f"{one.name}: {one.loop:.4g} J/m^2 released at instabilities, loop {one.integral:.4g} J/m^2"


def _shown(found: Map) -> list[list[Any]]:
    return [
        [row, *(note if value is None else value for value, note in zip(values, notes, strict=True))]
        for row, values, notes in zip(found.rows, found.values, found.notes, strict=True)
    ]
