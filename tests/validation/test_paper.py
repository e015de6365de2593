"""Replication of the paper: verdicts of statements, members, fits on known data, a short form to the end."""

import csv
import io
import json
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

import bem
from persson import double_gaussian
from validation import __main__ as command_line
from validation.harness.schema import Figure, Panel, Series
from validation.paper import layer_problem, members, replicate, spectra, vanishing_adhesion
from validation.paper.area import curvature, departures, line_through
from validation.paper.double_gaussian_fit import Sample
from validation.paper.ensemble import Member, read_member, solve_members
from validation.paper.evidence import Evidence, Realisation, jackknife, joined, mean_and_error
from validation.paper.members import LOADS, PAPER, Size
from validation.paper.paper_sketch import sketch_scene
from validation.paper.pressure import decay_power, density
from validation.paper.spectra import banded, exponent, exponent_of, exponent_of_mean
from validation.paper.statements import Check, Statement, headline
from validation.references import paper_problem
from validation.references.paper_problem import MODULUS
from validation.report.figures import table_of, write_figure

TINY = Size(seeds=2, harmonics=16, fewer_harmonics=12, hurst_seeds=2)


def statement(ours, uncertainty, **kind):
    return Statement("section 5", "exponent", 1.0, ours, uncertainty, 0.2, **kind)


@pytest.mark.parametrize(
    ("claim", "verdict"),
    [
        (statement(1.05, 0.1), "reproduced"),
        (statement(1.05, 0.2), "not established"),
        (statement(1.3, 0.05), "not reproduced"),
        (statement(1.3, 0.2), "not established"),
        (statement(np.nan, 0.0), "not run"),
        (statement(1.0, 0.0, shortfall="2 realisations"), "not run"),
        (statement(1.3, 0.05, differs=True), "reproduced"),
        (statement(1.05, 0.1, differs=True), "not reproduced"),
        (statement(1.3, 0.2, differs=True), "not established"),
        (statement(1.05, 0.1, zero=True), "reproduced"),
        (statement(1.15, 0.04, zero=True), "not established"),
        # the curvature of the paper's ensemble, with the standard error that was measured
        (Statement("abstract", "curvature", 0.0, -0.0148, 2 * 0.0063, 0.015, -0.034, zero=True), "not established"),
        # nearly straight, but resolved as bent
        (Statement("abstract", "curvature", 0.0, -0.006, 0.004, 0.015, -0.034, zero=True), "not established"),
    ],
)
def test_verdict_of_a_statement(claim, verdict):
    assert claim.verdict == verdict
    assert claim.row()["verdict"] == verdict


def test_what_is_allowed_must_exclude_the_alternative():
    with pytest.raises(ValueError, match=r"allowed 0\.2 does not exclude 1\.3"):
        statement(1.0, 0.0, alternative=1.3)


def test_headline_never_claims_what_was_not_run():
    rows = [statement(1.0, 0.0, shortfall="short form").row()] * 3
    assert headline(rows, [Check("gap", 2.0, 1.0, 0.1)]) == "0 of 3 statements run; 0 of 1 checks hold"


def test_ensemble_is_the_papers():
    planned = members.loading(PAPER)
    assert [one.scene["profile"]["seed"] for one in planned] == list(range(11))
    assert {one.scene["profile"]["harmonics"] for one in planned} == {1000}
    assert {one.scene["loading"]["stop_at_mean_pressure"] for one in planned} == {0.025 * 1e6 / 0.75}
    shapes = members.shapes(PAPER)
    assert shapes.scene["profile"]["seed"] == 2  # seeds 0 and 1 have crests of 84.4 and 85.1 um
    assert shapes.scene["output"]["shapes"] == [86e-6, 48e-6, 38e-6, 9.6e-6]
    names = [one.name for one in members.all_members(PAPER)]
    assert len(set(names)) == len(names) == 11 + 1 + 1 + 12 + 36 + 1


def test_exponent_of_noisy_lines_is_within_its_error():
    order = np.arange(1.0, 201.0)
    noise = np.random.default_rng(3).exponential(size=(11, 200))
    found = exponent_of(order**-2.7 * noise, [(3, 30), (10, 100)])
    assert abs(found.value + 2.7) < 3 * found.error
    assert 0.01 < found.error < 0.2


EMPTY = Evidence(PAPER, (None,) * 11, (), None, None, {}, (), None, {})
ORDERS = np.arange(1.0, 1001.0)


@pytest.mark.parametrize(
    ("factor", "scatter", "verdict"),
    [(1.5, 0.01, "reproduced"), (1.0, 0.01, "not reproduced"), (1.4, 0.6, "not established")],
)
def test_a_shift_of_a_spectrum_is_judged_whatever_its_exponent(factor, scatter, verdict):
    power = np.outer([1 - scatter, 1.0, 1 + scatter], factor * ORDERS**-2.7)
    (shift,) = spectra._shift(0.02, power, ORDERS**-2.7, EMPTY)
    assert shift.verdict == verdict
    assert shift.ours == pytest.approx(factor, rel=1e-9)


def test_exponents_of_the_middle_and_of_the_high_end_are_judged():
    bent = np.where(ORDERS < 150, ORDERS**-2.7, 150**-0.3 * ORDERS**-2.4)
    power = np.array([bent, 1.1 * bent, 0.9 * bent])
    middle, theory, pressure = spectra._middle(0.02, power, bent, EMPTY)
    assert (middle.verdict, theory.verdict, pressure.verdict) == ("reproduced",) * 3
    assert middle.ours == pytest.approx(-2.7, abs=1e-9)
    high, rise = spectra._high(0.02, power, bent, EMPTY)
    assert (high.verdict, rise.verdict) == ("reproduced",) * 2
    assert (high.ours, rise.ours) == pytest.approx((-0.4, 0.3), abs=1e-9)
    straight = np.array([ORDERS**-2.7] * 3)
    assert [one.verdict for one in spectra._high(0.02, straight, bent, EMPTY)] == ["not reproduced"] * 2


def test_windows_of_a_curved_spectrum_are_told():
    curved = np.exp(-0.1 * np.log(np.arange(1.0, 200.0)) ** 2)
    found = exponent_of(np.array([curved, curved]), [(3, 30), (10, 100)])
    assert found.low == pytest.approx(exponent(curved, (10, 100)), rel=1e-12)
    assert f"{found.low:.3f} to {found.high:.3f}" in found.reported()


def test_scatter_that_grows_with_the_order_steepens_single_fits_and_not_the_fit_of_the_mean():
    order = np.arange(1.0, 201.0)
    spread = 0.9 * order / 200
    power = order**-2.0 * np.array([1 + spread, 1 - spread])
    windows = [(10.0, 100.0), (20.0, 200.0)]
    assert exponent_of_mean(power, windows).value == pytest.approx(-2.0, abs=1e-9)
    assert exponent_of(power, windows).value < -2.1  # -2.169


def test_jackknife_of_a_mean_is_its_standard_error():
    values = np.random.default_rng(0).normal(size=(9, 1))
    mean, error = mean_and_error(values)
    assert jackknife(lambda one: float(one[0]), values) == pytest.approx((float(mean[0]), float(error[0])), rel=1e-12)


def test_bands_keep_the_mean_of_every_order():
    order, value = banded(np.arange(1.0, 101.0), 5)
    assert len(order) == 5
    assert value[-1] == pytest.approx(np.mean(np.arange(41.0, 101.0)))  # 101^(4/5) = 40.1


@pytest.mark.parametrize("power", [1.0, 2.0, 3.0])
def test_power_of_the_decay_is_recovered(power):
    sigma = np.linspace(0.1, 0.5, 30)
    assert decay_power(sigma, np.exp(2 - 40 * sigma**power)) == pytest.approx(power, abs=1e-4)


def test_straight_lines_and_their_departures():
    assert line_through([1.0, 2.0, 4.0], [3.0, 4.0, 6.0]) == pytest.approx((2.0, 1.0))
    assert departures(lambda load: 7 * load) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert curvature([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]) == pytest.approx(0.0, abs=1e-12)


def test_joined_curves_have_gaps_between_them():
    assert joined([([1.0, 2.0], [3.0, 4.0]), ([5.0], [6.0])]) == ([1.0, 2.0, None, 5.0], [3.0, 4.0, None, 6.0])


SIGMA = np.linspace(-0.29, 0.69, 50)


def sample_of(end, factor=1.0, added=0.0):
    """Three realisations of one double Gaussian that ends at -end, where the theory's sigma_a is 0.05."""
    shape = factor * double_gaussian(SIGMA, 0.02, end, 0.018 / (2 * 0.02**2)) + added
    return Sample(0.02, SIGMA, np.outer([0.9, 1.0, 1.1], shape), 0.05, 0.13)


def judged(sample):
    return [one.verdict for one in sample.statements(EMPTY)]


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("logarithmic", [False, True])
def test_end_of_a_double_gaussian_depends_neither_on_window_nor_on_weights(free, logarithmic):
    for start in (-0.05, 0.0):
        end = sample_of(0.075).over(start, None, free, logarithmic).detachment_stress
        assert end == pytest.approx(0.075, abs=1e-6)
    assert sample_of(0.075).ratio(-0.3, True, False) == pytest.approx((1.5, 0.0), abs=1e-5)


@pytest.mark.parametrize(
    ("end", "verdict"),
    [(0.075, "reproduced"), (0.062, "reproduced"), (0.059, "not reproduced"), (0.05, "not reproduced")],
)
def test_the_factor_is_judged_by_the_nearer_number(end, verdict):
    assert judged(sample_of(end))[0] == verdict


def test_a_factor_that_depends_on_the_window_is_not_established():
    tail = 0.05 * np.exp(10 * SIGMA) * (SIGMA < 0.05)
    assert judged(sample_of(0.075, added=tail))[0] == "not established"


def test_a_double_gaussian_approximates_itself_and_not_twice_itself():
    assert judged(sample_of(0.075))[1] == "reproduced"
    assert judged(sample_of(0.075, 2.0))[1] == "not reproduced"


def test_the_layer_is_drawn_from_a_solution_that_has_its_heights():
    topic = layer_problem.compute(SimpleNamespace(sketch=Realisation("sketch", bem.solve(sketch_scene())), missing={}))
    assert [one.verdict for one in topic.statements] == ["reproduced"]
    assert all(check.holds for check in topic.checks)
    layer, heights = topic.figures
    bars = {one.label: (one.y[0], one.upper[0]) for one in heights.solution.series if one.style == "bars"}
    assert bars["$s$"][1] == bars["$u_m$"][1] == bars[r"$\Delta$"][0] == pytest.approx(0.16)  # mm
    assert bars["$h_{max}$"][1] == bars[r"$\Delta$"][1] == pytest.approx(0.3585, abs=1e-4)
    assert bars["$u_m$"][1] - bars["$u_m$"][0] == pytest.approx(0.022, abs=1e-4)
    face, profile = (
        next(s for s in layer.solution.series if s.label.startswith(name)) for name in ("elastic", "rigid")
    )
    gaps = np.subtract(face.y, profile.upper)
    assert gaps.min() > -1e-12 and gaps.max() > 0.3


@pytest.mark.parametrize(("power", "verdict", "holds"), [(0.5, "reproduced", True), (0.1, "not reproduced", False)])
def test_adhesion_vanishes_as_its_square_root(power, verdict, holds):
    def of(work, seed):
        gain = (3.0 + 0.1 * seed) * work**power if work else 0.0
        return SimpleNamespace(value_at=lambda load, number: load * (1 + gain))

    faint = tuple(tuple(of(work, seed) for work in members.FAINT_WORKS) for seed in range(3))
    topic = vanishing_adhesion.compute(Evidence(PAPER, (None,) * 11, (), None, None, {}, faint, None, {}))
    assert [one.verdict for one in topic.statements] == [verdict]
    assert [check.holds for check in topic.checks] == [holds]


FIGURE = Figure(
    id="one",
    caption="Two series.",
    solution=Panel(
        xlabel="x",
        ylabel="y",
        series=[
            Series(label="line", x=[1.0, None, 2.0], y=[3.0, None, 4.0], style="thin"),
            Series(label="band", x=[1.0], y=[2.0], upper=[5.0], style="band"),
        ],
    ),
)


def test_csv_of_a_figure_has_every_point():
    lines = list(csv.reader(io.StringIO(table_of(FIGURE))))
    assert lines[1:] == [
        ["solution", "line", "1.0", "3.0", ""],
        ["solution", "line", "2.0", "4.0", ""],
        ["solution", "band", "1.0", "2.0", "5.0"],
    ]


def test_figure_files_are_vectors_and_repeat(tmp_path):
    for folder in ("a", "b"):
        write_figure(FIGURE, tmp_path / folder)
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == ["one.csv", "one.pdf", "one.svg"]
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()
    assert b"<image" not in (tmp_path / "a" / "one.svg").read_bytes()


@pytest.mark.parametrize("executor", ["slurm", "dask"])
def test_unknown_executor_is_bad_input(executor, tmp_path, capsys):
    assert command_line.main(["replicate", "--executor", executor, "--out", str(tmp_path)]) == 2
    assert "must be local or dask://host:port" in capsys.readouterr().err


def test_members_are_stored_used_again_and_solved_again_where_damaged(tmp_path):
    wave = paper_problem.lines([1], [1e-4], [0.0])
    targets = {"control": "mean_pressure", "targets": [1e4]}
    planned = [Member(name, paper_problem.scene(name, wave, targets)) for name in ("a", "b")]
    refused = Member("c", paper_problem.scene("c", wave, {"control": "mean_pressure", "targets": []}))
    notes = []
    with ThreadPoolExecutor(1) as pool:
        assert solve_members(planned, tmp_path, pool, notes.append) == {}
        (tmp_path / "b" / "result.json").write_text("{}")
        notes.clear()
        assert solve_members(planned, tmp_path, pool, notes.append) == {}
        assert notes == ["1 of 2 members are stored already", "[1/1] b: converged"]
        (failure,) = solve_members([refused], tmp_path, pool, notes.append).values()
    assert failure.startswith("SceneError: ") and "loading.targets" in failure
    assert all(read_member(member, tmp_path).status == "converged" for member in planned)


@pytest.fixture(scope="module")
def replicated(tmp_path_factory):
    """Folder of a tiny replication, its report, and the exit code."""
    folder = tmp_path_factory.mktemp("replicate")
    code = replicate.replicate(folder, quick=True, jobs=2, size=TINY)
    return folder, json.loads((folder / "report.json").read_text()), code


@pytest.mark.slow
def test_short_form_runs_to_the_end_and_says_that_little_was_run(replicated):
    folder, report, code = replicated
    assert code == 0
    rows = replicate.statement_rows(folder)
    assert len(rows) >= 25
    run = [row["statement"] for row in rows if row["verdict"] != "not run"]
    assert len(run) == 1 and "mean displacement u_m" in run[0]
    assert report["headline"].startswith(f"short form: 1 of {len(rows)} statements run: 1 reproduced;")
    page = (folder / "report.html").read_text()
    assert "Passed" not in page and report["headline"] in page
    drawn = [name for topic in report["topics"] for name in topic["figures"]]
    assert len(drawn) >= 15
    assert all((folder / name).with_suffix(kind).stat().st_size for name in drawn for kind in (".svg", ".pdf", ".csv"))


@pytest.mark.slow
def test_stored_realisations_are_used_again_and_damaged_ones_are_not(replicated):
    folder, _, _ = replicated
    (planned, *_) = members.loading(TINY)
    assert read_member(planned, folder / "members").status == "converged"
    assert read_member(members.loading(PAPER)[0], folder / "members") is None  # another scene of this name
    evidence = replicate.gather(PAPER, folder / "members", {"loading-00": "ZeroDivisionError: singular"})
    assert evidence.missing["loading-00"] == "ZeroDivisionError: singular"
    assert evidence.shortfall == f"only 0 of 11 realisations reached {LOADS[-1]:g} E*"
    topics = replicate.topics_of(evidence)
    assert all("2 are needed" in topic.message for topic in topics[1:])


@pytest.mark.slow
def test_numbers_of_a_realisation(replicated):
    folder, report, _ = replicated
    one = replicate.gather(TINY, folder / "members", {}).loading[0]
    bounds = np.linspace(-50.0, 5.0, 40001)
    share = float(np.sum(density(one, 0.02, bounds) * np.diff(bounds)))
    assert share == pytest.approx(one.result.targets[one.index_of(0.02)].contact_fraction, rel=1e-3)
    states = sorted(one.touching, key=lambda state: state.mean_pressure)
    middle = (states[-2].mean_pressure + states[-1].mean_pressure) / 2 / MODULUS  # jumped over: on the line between
    assert one.index_of(middle) is None
    area = one.value_at(middle, lambda state: state.contact_fraction)
    assert area == pytest.approx((states[-2].contact_fraction + states[-1].contact_fraction) / 2, rel=1e-12)
    assert one.final_load == pytest.approx(0.025)
    conventions = report["topics"][1]["tables"][0]["rows"]
    assert [row[0] for row in conventions if row[0]] == [
        "normalisation of a continuous spectrum",
        "area factor in U_ad",
        "a load that an instability jumps over",
    ]
