"""Maps: their axes reach what they promise, loops close against the energies released, cells have a number or a why."""

import csv
import io
import os
from types import SimpleNamespace

import numpy as np
import pytest
from carried import carried, failing
from in_this_process import here
from matplotlib.colors import LogNorm, Normalize

from bem.scene.scene import parse_scene
from bem.solver import solve
from validation import __main__ as command_line
from validation.corpus import maps as corpus
from validation.harness.ensemble import Gathered
from validation.references.paper_problem import MODULUS
from validation.report.map_figures import Map, draw, table_of, write_map
from validation.studies import maps


def test_full_study_covers_the_axes():
    points = [point for plane in corpus.planes(corpus.FULL_AXES) for point in plane.points]
    assert {point.hurst for point in points} >= {0.3, 0.9}
    assert {point.harmonics for point in points} >= {10, 4000}
    assert {point.theta for point in points} >= {0.0, 1.0}
    assert {point.thickness for point in points} >= {None, 0.01}


@pytest.mark.parametrize(
    ("words", "jobs"), [(["--jobs", "3"], 3), ([], os.cpu_count())], ids=["three processes", "as many as cores"]
)
def test_study_runs_on_any_executor(words, jobs, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(maps, "cases", lambda bench: seen.append((bench.quick, bench.jobs)) or [])
    assert command_line.main(["study", "maps", *words, "--out", str(tmp_path)]) == 0
    assert seen == [(False, jobs)]


def test_realisations_of_a_point_differ_in_their_seed_alone():
    one, two = (corpus.member_of(corpus.Point(0.7, 20, 0.1, None), k) for k in range(2))
    assert one.scene["profile"].pop("seed") != two.scene["profile"].pop("seed")
    assert one.scene["profile"] == two.scene["profile"]


def test_names_of_members_differ():
    points = {point for plane in corpus.planes(corpus.FULL_AXES) for point in plane.points}
    assert len({corpus.member_of(point, 0).name for point in points}) == len(points)


def state(penetration, pressure, area, branch="loading"):
    return SimpleNamespace(penetration=penetration, mean_pressure=pressure, contact_fraction=area, branch=branch)


def test_slope_is_that_of_the_loading_branch_within_the_window():
    unit = MODULUS * 0.2
    line = [state(0.0, p * unit, 0.01 + 2.5 * p) for p in (0.01, 0.02, 0.04, 0.05)]
    others = [state(0.0, unit, 0.1, "unloading"), state(0.0, unit, 0.5)]
    assert corpus.area_slope([*line, *others], 0.2) == pytest.approx(2.5, rel=1e-12)


def test_slope_is_of_targets_and_tension_of_events():
    """States between targets lie where the increments do."""
    found = solve(parse_scene(corpus.member_of(corpus.Point(0.7, 12, 0.1, None), 0).scene))
    made = corpus.reduced("one", found)
    shorter = solve(parse_scene(found.scene | {"accuracy": found.scene["accuracy"] | {"max_increment": 0.02}}))
    again = corpus.reduced("one", shorter)
    assert (again.slope, again.loop, again.tension) == pytest.approx((made.slope, made.loop, made.tension), rel=1e-9)


def test_slope_of_two_states_is_none():
    assert corpus.area_slope([state(0.0, 1.0, 0.03), state(0.0, 2.0, 0.05)], 0.2) is None


def test_integral_of_a_rectangular_loop_is_its_area():
    loop = [
        state(0.0, 0.0, 0.1),
        state(0.0, 3.0, 0.1),
        state(2.0, 3.0, 0.1),
        state(2.0, 1.0, 0.1),
        state(0.0, 1.0, 0.1),
    ]
    assert corpus.loop_integral(loop) == pytest.approx(4.0)


@pytest.mark.parametrize(("integral", "failures"), [(0.9, 0), (0.3, 1), (-1.0, 1), (float("nan"), 1)])
def test_loop_that_does_not_balance_is_named(integral, failures):
    made = corpus.Run("one", "converged", 2.0, 1.0, 0.1, integral, 10.0, 0.03, 1.0, 20, 0)
    assert len(list(maps._unbalanced([made]))) == failures


def test_states_that_are_not_certified_and_missing_realisations_fail(tmp_path, monkeypatch):
    made = corpus.Run("one", "converged", 2.0, 1.0, 0.1, 1.0, 10.0, 0.03, 1.0, 20, 1)

    def gathered(members, *_):
        return Gathered((), (), (), {member.name: "no memory" for member in members[1:]})

    monkeypatch.setattr(maps, "run_ensemble", gathered)
    monkeypatch.setattr(maps, "read_member", lambda *_: None)
    monkeypatch.setattr(maps, "reduced", lambda *_: made)
    told = failing(carried(maps, tmp_path))
    assert "no memory" in told[0]
    assert told[1] == "realisations with states that are not certified: deviates, one: 1 of 20"


@pytest.mark.slow
@pytest.mark.parametrize(("theta", "k"), [(0.003, 1), (0.03, 0), (0.3, 2)])
def test_events_on_the_thinnest_layers_do_not_depend_on_the_increment(theta, k):
    """Without a look at crests that edges pass, and at what curvature hides, loops differed by 2e-3, 9e-5 and 1e-3."""
    scene = corpus.member_of(corpus.Point(0.7, 100, theta, 0.01), k).scene
    shorter = scene | {"accuracy": {"max_increment": 0.0125}}
    coarse, fine = (solve(parse_scene(one)).events for one in (scene, shorter))
    assert [event.kind for event in coarse] == [event.kind for event in fine]
    loops = [sum(event.energy_released for event in events) for events in (coarse, fine)]
    assert loops[0] == pytest.approx(loops[1], rel=3e-8)  # measured 1.1e-8, 2e-11 and 8e-12


@pytest.mark.slow
def test_a_small_snap_of_a_layer_is_an_event_at_any_increment():
    """Of its fold a finer tolerance changed more than what it releases; of five increments one had it as an event."""
    scene = corpus.member_of(corpus.Point(0.7, 100, 0.3, 0.01), 2).scene
    scene |= {"loading": {"control": "penetration", "targets": [4.5e-5]}}
    snaps = [solve(parse_scene(scene | {"accuracy": {"max_increment": largest}})).events[-1] for largest in (0.1, 0.2)]
    for snap in snaps:
        assert (snap.kind, snap.penetration) == ("bifurcation", pytest.approx(4.45548386511e-5, rel=1e-11))
        assert snap.energy_released == pytest.approx(9.899e-8, abs=2e-10)  # spread over six increments: 7e-11
        assert snap.error_estimate.energy_released < 1e-9  # up to 4e-10


MAP = Map(
    "one", "slope", "H", "harmonics", ["0.3"], ["10", "20"], [[2.0, None]], [[0.1, None]], [["", "1 complete contact"]]
)


def test_csv_says_why_a_value_is_missing():
    lines = list(csv.reader(io.StringIO(table_of(MAP))))
    assert lines[1:] == [["0.3", "10", "2.0", "0.1", ""], ["0.3", "20", "", "", "1 complete contact"]]


def map_of(*values, errors=None):
    missing = [None] * len(values)
    columns = list("abcdef"[: len(values)])
    return Map("one", "loop", "H", "theta", ["0.3"], columns, [values], [errors or missing], [[""] * len(values)])


@pytest.mark.parametrize(
    ("values", "scale"),
    [((1.0, 2.0), Normalize), ((0.0, 0.5, 40.0), LogNorm), ((-1.0, 0.1, 40.0), Normalize), ((3.0, 3.0), Normalize)],
    ids=["narrow", "wide", "negative", "equal"],
)
def test_colours_are_logarithmic_where_values_spread_widely(values, scale):
    (mesh,) = draw(map_of(*values)).axes[0].collections
    assert type(mesh.norm) is scale


def test_cell_shows_its_standard_error():
    texts = [text.get_text() for text in draw(map_of(1.0, 2.0, errors=[0.25, None])).axes[0].texts]
    assert texts == ["1\n± 0.25", "2"]


def test_map_files_are_vectors(tmp_path):
    write_map(MAP, tmp_path)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".csv", ".pdf", ".svg"]


def test_executor_of_a_study_that_has_none_is_refused(tmp_path):
    words = ["study", "convergence", "--executor", "dask://127.0.0.1:1", "--out", str(tmp_path)]
    assert command_line.main(words) == 2


@pytest.mark.slow
def test_quick_study_balances_and_goes_on_where_it_ended(tmp_path):
    notes = []
    report = carried(maps, tmp_path, say=notes.append, opener=here)
    assert failing(report) == []
    assert len(report.cases[0].tables) == 9
    assert {path.name for path in tmp_path.glob("*.csv")} == {
        f"{plane}-{quantity}.csv"
        for plane in ("roughness", "adhesion", "layer")
        for quantity in ("slope", "loop", "tension")
    }
    again = []
    assert failing(carried(maps, tmp_path, say=again.append, opener=here)) == []
    assert again[0].text == f"{len(notes)} of {len(notes)} members are there already"
    values = list(csv.reader(io.StringIO((tmp_path / "adhesion-loop.csv").read_text())))[1:]
    assert [float(line[2]) for line in values if float(line[1]) == 0.0] == [0.0, 0.0]
    assert all(float(line[2]) > 0 for line in values if float(line[1]) > 0)
    assert np.isfinite([float(line[2]) for line in values]).all()


def test_stored_maps_are_whole_and_without_failures():
    stored = corpus.stored_runs()
    points = {point for plane in corpus.planes(corpus.FULL_AXES) for point in plane.points}
    names = {corpus.member_of(point, k).name for point in points for k in range(corpus.FULL_AXES.seeds)}
    assert set(stored) == names
    assert all(run.not_certified == 0 for run in stored.values())
    assert list(maps._unbalanced(stored.values())) == []


def test_stored_tension_is_none_where_the_loop_does_not_close():
    stored = corpus.stored_runs().values()
    assert all((run.tension is None) == (run.status != "converged") for run in stored)
    assert all(run.tension == 0 for run in stored if run.work_of_adhesion == 0)
    assert all(run.tension > 0 for run in stored if run.work_of_adhesion > 0 and run.tension is not None)
