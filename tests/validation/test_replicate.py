"""The replication: exponents and fits on data with known answers, rows and verdicts, a short form from end to end."""

import csv
import errno
import io
import json
import os
import re
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from in_this_process import here

import bem
from persson import double_gaussian
from validation import __main__ as command_line
from validation.harness.ensemble import Gathered
from validation.harness.schema import CaseRecord, Figure, Panel, Reference, Report, Series
from validation.harness.verdict import verdict_of
from validation.references.paper_problem import MODULUS
from validation.references.paper_sketch import mean_displacement, sketch_scene
from validation.replicate import (
    gather,
    members,
    posed_problem,
    realisations,
    scene_text,
    statements,
    vanishing_adhesion,
)
from validation.replicate.area import departures, line_through
from validation.replicate.double_gaussian_fit import WAYS, Sample, window_figure, window_table
from validation.replicate.evidence import Realisation, jackknife, joined, mean_and_error
from validation.replicate.members import LOADS, PAPER, Size
from validation.replicate.paper_spectra import (
    _power_law,
    _shift_rows,
    banded,
    exponent,
    exponent_of,
    exponent_of_mean,
)
from validation.replicate.pressure import decay_power, density
from validation.replicate.statements import Alternative, disagreement, stale, statement
from validation.report.figures import linked, table_of, write_figure
from validation.report.render import render

TINY = Size(seeds=2, harmonics=16, fewer_harmonics=12, hurst_seeds=2)


def test_ensemble_is_the_papers():
    planned = members.loading(PAPER)
    assert [one.scene["profile"]["seed"] for one in planned] == list(range(11))
    assert {one.scene["profile"]["harmonics"] for one in planned} == {1000}
    assert {one.scene["loading"]["stop_at_mean_pressure"] for one in planned} == {0.025 * 1e6 / 0.75}


def test_shapes_are_of_the_first_profile_above_90_micrometres():
    planned = members.shapes(PAPER)
    assert planned.scene["profile"]["seed"] == 2  # seeds 0 and 1 have crests of 84.4 and 85.1 um
    assert planned.scene["output"]["shapes"] == [86e-6, 48e-6, 38e-6, 9.6e-6]


def test_names_of_members_differ():
    names = [one.name for one in members.all_members(PAPER)]
    assert len(set(names)) == len(names) == 11 + 1 + 1 + 12 + 36 + 1


def test_exponent_of_noisy_lines_is_within_its_error():
    order = np.arange(1.0, 201.0)
    noise = np.random.default_rng(3).exponential(size=(11, 200))
    found = exponent_of(order**-2.7 * noise, [(3, 30), (10, 100)])
    assert abs(found.value + 2.7) < 3 * found.error
    assert 0.01 < found.error < 0.2


def test_windows_of_a_curved_spectrum_are_told():
    curved = np.exp(-0.1 * np.log(np.arange(1.0, 200.0)) ** 2)
    found = exponent_of(np.array([curved, curved]), [(3, 30), (10, 100)])
    assert found.low == pytest.approx(exponent(curved, (10, 100)), rel=1e-12)
    assert found.high - found.low > 0.1
    assert f"{found.low:.3f} to {found.high:.3f}" in found.reported()


def test_scatter_that_grows_with_the_order_steepens_single_fits_and_not_that_of_the_mean():
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
def test_power_of_the_decay_is_found(power):
    sigma = np.linspace(0.1, 0.5, 30)
    assert decay_power(sigma, np.exp(2 - 40 * sigma**power)) == pytest.approx(power, abs=1e-4)


def test_drawn_power_law_is_the_fitted_one():
    ends, values = _power_law(exponent(np.arange(1.0, 200.0) ** -2.7, (10.0, 100.0)), 0.0, (10.0, 100.0))
    assert ends == [10.0, 100.0]
    assert np.log(values[1] / values[0]) / np.log(10.0) == pytest.approx(-2.7, abs=1e-10)


SIGMA = np.linspace(-0.29, 0.69, 50)


@pytest.fixture(scope="module")
def sample():
    """Three realisations of one double Gaussian that ends at -0.075, where the theory's sigma_a is 0.05."""
    shape = double_gaussian(SIGMA, 0.02, 0.075, 0.018 / (2 * 0.02**2))
    return Sample(0.02, SIGMA, np.outer([0.9, 1.0, 1.1], shape), 0.05, 0.13)


@pytest.mark.parametrize(("name", "free", "logarithmic"), WAYS)
def test_end_of_a_double_gaussian_depends_neither_on_window_nor_on_weights(sample, name, free, logarithmic):
    for start in (-0.05, 0.0):
        assert sample.over(start, None, free, logarithmic).detachment_stress == pytest.approx(0.075, abs=1e-6), name


def test_end_of_a_distribution_with_a_tail_depends_on_the_window(sample):
    tail = sample.mean + 0.05 * np.exp(10 * SIGMA) * (SIGMA < 0.05)
    ends = [sample.over(start, tail, True, False).detachment_stress for start in (-0.3, 0.0)]
    assert abs(ends[0] - ends[1]) > 0.004  # 0.0104 and more measured


def test_scatter_in_size_alone_is_no_error_of_the_end(sample):
    assert sample.ratio(-0.3, True, False) == pytest.approx((1.5, 0.0), abs=1e-5)


@pytest.mark.parametrize(
    ("end", "verdict"), [(0.075, "agrees"), (0.062, "agrees"), (0.059, "deviates"), (0.05, "deviates")]
)
def test_the_factor_is_judged_by_what_is_nearer(end, verdict):
    shape = double_gaussian(SIGMA, 0.02, end, 0.018 / (2 * 0.02**2))
    one = Sample(0.02, SIGMA, np.array([shape, shape]), 0.05, 0.13)
    assert verdict_of(one.rows("")[0]) == verdict


def test_a_factor_that_depends_on_the_window_is_no_test(sample):
    tail = sample.mean + 0.05 * np.exp(10 * SIGMA) * (SIGMA < 0.05)
    factor, _, _ = Sample(0.02, SIGMA, np.array([tail, tail]), 0.05, 0.13).rows("")
    assert verdict_of(factor) == "not run"
    assert factor.message.startswith("no test: ")
    assert re.search(r"the paper states no window and no weights: \d\.\d\d to \d\.\d\d over ours", factor.message)
    assert factor.uncertainty > 0.3  # 0.73: half the spread, where two equal realisations have no standard error


def test_a_double_gaussian_is_a_good_approximation_of_itself_and_not_of_twice_itself(sample):
    _, close, carried = sample.rows("")
    assert verdict_of(close) == "changed"  # it agrees too well
    load = np.sum(SIGMA * sample.mean) * (SIGMA[1] - SIGMA[0])
    assert carried.computed == pytest.approx([load / 0.02] * len(carried.computed), rel=1e-3)
    twice = Sample(0.02, SIGMA, 2 * sample.values, 0.05, 0.13).rows("")[1]
    assert verdict_of(twice) == "expected deviation"


def test_a_straight_line_departs_from_none():
    assert departures(lambda load: 7 * load) == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.fixture(scope="module")
def drawn_problem():
    return Realisation("sketch", bem.solve(sketch_scene()))


def posed(one):
    return posed_problem.compute(SimpleNamespace(sketch=one, shortfall="", missing={}))


def test_the_problem_is_drawn_from_a_solution_that_has_its_heights(drawn_problem):
    outcome = posed(drawn_problem)
    assert [verdict_of(row) for row in outcome.rows] == ["agrees"] * 3
    layer, heights = outcome.figures
    bars = {
        series.label: (series.y[0], series.upper[0]) for series in heights.solution.series if series.style == "bars"
    }
    assert bars["$s$"][1] == bars["$u_m$"][1] == bars[r"$\Delta$"][0] == pytest.approx(0.16)  # mm
    assert bars["$h_{max}$"][1] == bars[r"$\Delta$"][1] == pytest.approx(0.3585, abs=1e-4)
    assert bars["$u_m$"][1] - bars["$u_m$"][0] == pytest.approx(0.022, abs=1e-4)
    face, profile = (
        next(s for s in layer.solution.series if s.label.startswith(name)) for name in ("elastic", "rigid")
    )
    gaps = np.subtract(face.y, profile.upper)
    assert gaps.min() > -1e-12 and gaps.max() > 0.3


def test_a_layer_that_may_spread_has_another_mean_displacement(drawn_problem, monkeypatch):
    free = posed_problem.SPREADING
    monkeypatch.setattr(posed_problem, "mean_displacement", lambda pressure: free * mean_displacement(pressure))
    assert verdict_of(posed(drawn_problem).rows[0]) == "deviates"


@pytest.mark.parametrize(("power", "verdicts"), [(0.5, ["agrees", "agrees"]), (0.1, ["deviates", "deviates"])])
def test_adhesion_vanishes_as_its_square_root(power, verdicts):
    def of(work, seed):
        gain = (3.0 + 0.1 * seed) * work**power if work else 0.0
        return SimpleNamespace(value_at=lambda load, number: load * (1 + gain))

    faint = [[of(work, seed) for work in members.FAINT_WORKS] for seed in range(3)]
    outcome = vanishing_adhesion.compute(SimpleNamespace(faint=faint, shortfall=""))
    assert [verdict_of(row) for row in outcome.rows] == verdicts


def test_window_is_drawn_and_listed_with_the_theory_fitted_alike(sample):
    theory = double_gaussian(SIGMA, 0.02, 0.035, 0.02 / (2 * 0.02**2))
    listed = {line[1]: line for line in window_table([sample], [theory]).rows}
    assert listed["ours: Persson's own P, printed, P"][5] == pytest.approx(0.7, abs=1e-5)
    labels = [series.label for series in window_figure([sample]).solution.series]
    assert labels == [
        "0.02 E*, standard error", "0.02 E*, as printed, ln P", "0.02 E*, as printed, P",
        "0.02 E*, free amplitude, P",
        "above: half the detached width is closer",
    ]  # fmt: skip


def test_straight_line_is_found():
    assert line_through([1.0, 2.0, 4.0], [3.0, 4.0, 6.0]) == pytest.approx((2.0, 1.0))


def test_joined_curves_have_gaps_between_them():
    assert joined([([1.0, 2.0], [3.0, 4.0]), ([5.0], [6.0])]) == ([1.0, 2.0, None, 5.0], [3.0, 4.0, None, 6.0])


def claimed(ours, error=0.0, **more):
    full = Alternative(-2.4, "full contact")
    return statement("exponent", ours, error, -2.73, 0.1, full, measured=0.05, where="section 5", **more)


@pytest.mark.parametrize(
    ("row", "verdict"),
    [
        (claimed(-2.65), "agrees"),
        (claimed(-2.5), "deviates"),
        (claimed(-2.6, error=0.15), "agrees"),
        (claimed(-2.6, error=0.14), "marginal"),
        (claimed(-2.6, error=0.04), "deviates"),
        (claimed(-2.6, error=0.17), "not run"),
        (claimed(-2.65, shortfall="only 3 of 11 realisations"), "not run"),
        (disagreement("moment", 2.1, 0.0, 3.0, (0.6, 0.8), "few waves", where="section 5"), "expected deviation"),
        (disagreement("moment", 3.0, 0.0, 3.0, (0.6, 0.8), "few waves", where="section 5"), "changed"),
    ],
    ids=[
        "within",
        "outside",
        "within its error",
        "just within its error",
        "beyond its error",
        "no test",
        "short",
        "known",
        "agrees too well",
    ],
)
def test_verdict_of_a_statement(row, verdict):
    assert verdict_of(row) == verdict


def test_what_is_told_stands_beside_the_verdict():
    assert claimed(-2.65, reported="window moved: 0.04").message == "excludes -2.4, full contact; window moved: 0.04"
    assert claimed(-2.65, reported="window moved: 0.04", shortfall="only 3").message == "only 3"


def test_tolerance_that_reaches_the_alternative_is_refused():
    with pytest.raises(ValueError, match=r"does not exclude -2\.6"):
        statement("exponent", -2.7, 0.0, -2.73, 0.1, Alternative(-2.6, "another"), measured=0.03, where="section 5")


@pytest.mark.parametrize(("ours", "counts"), [(-2.68, 0), (-2.66, 0), (-2.65, 1), (-2.73, 1)])
def test_stored_difference_that_moved_is_counted(ours, counts):
    found = stale([claimed(ours), claimed(ours, shortfall="short")])
    assert found.computed == [counts]
    assert verdict_of(found) == ("deviates" if counts else "agrees")


def test_band_that_holds_agreement_is_refused():
    with pytest.raises(ValueError, match="holds 1, where the two agree"):
        disagreement("moment", 2.1, 0.0, 3.0, (0.6, 1.1), "few waves", where="section 5")


def test_difference_within_two_standard_errors_is_no_finding():
    row = disagreement("moment", 2.1, 0.5, 3.0, (0.6, 0.8), "few waves", where="section 5")
    assert (verdict_of(row), row.message) == ("not run", "no finding: 1.8 errors apart")


@pytest.mark.parametrize(("factor", "verdict"), [(1.5, "agrees"), (1.0, "deviates"), (1.15, "deviates")])
def test_shift_of_a_spectrum_is_found_whatever_its_exponent(factor, verdict):
    order = np.arange(1.0, 201.0)
    power = np.outer([0.99, 1.0, 1.01], factor * order**-2.7)
    (row,) = _shift_rows(0.02, power, order**-2.7, "")
    assert verdict_of(row) == verdict
    assert row.message == f"over the theory's: {factor:.2f} +- 0.01"


def test_shift_within_its_scatter_is_not_found():
    order = np.arange(1.0, 201.0)
    power = np.outer([0.5, 2.3], order**-2.7)
    assert verdict_of(_shift_rows(0.02, power, order**-2.7, "")[0]) == "deviates"


def test_every_statement_of_the_paper_is_on_the_page_with_its_verdict():
    ours = claimed(-2.65).model_copy(update={"reference": Reference(kind="exact", source="JKR edges")})
    known = disagreement("moment", [2.9, 2.1], 0.1, [3.0, 3.0], (0.6, 0.8), "few waves", where="section 4: Gaussian")
    case = CaseRecord(id="replicate-one", group="paper", level="full", question="One?", equations="a = b", sources=[],
                      rows=[claimed(-2.5), ours, known])  # fmt: skip
    outcome = statements.summary_of([case])
    assert outcome.tables[0].rows == [
        ["one", "section 5", "exponent", -2.73, -2.5, None, "+- 0.1", "deviates", "excludes -2.4, full contact", "☐"],
        ["one", "section 4: Gaussian", "moment", 3.0, 2.1, 0.1, "x 0.6 to 0.8", "changed", "few waves", "☐"],
    ]
    assert outcome.rows[0].computed == [1.0]


def test_scene_is_shown_as_it_would_be_read():
    import tomllib

    scene = members.loading(PAPER)[0].scene
    assert tomllib.loads(scene_text(scene)) == scene


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


def test_csv_has_every_point():
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


def test_full_disk_leaves_the_old_figure_whole(tmp_path, monkeypatch):
    write_figure(FIGURE, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert len(before) == 3

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_figure(
            FIGURE.model_copy(update={"solution": FIGURE.solution.model_copy(update={"xlabel": "z"})}), tmp_path
        )
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_full_disk_ends_a_replication_with_its_message(tmp_path, monkeypatch, capsys):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(import_module("validation.replicate"), "run_ensemble", full)
    assert command_line.main(["replicate", "--quick", "--out", str(tmp_path)]) == 1
    assert "No space left on device" in capsys.readouterr().err


def page_of(row):
    """A page with one case, its figure with files beside the report."""
    case = CaseRecord(
        id="replicate-one", group="paper", level="full", question="One?", equations="a = b", sources=[], rows=[row],
        figures=[linked(FIGURE, "figures")],
    )  # fmt: skip
    command = "python -m validation replicate --out paper"
    return render(Report(level="replicate", command=command, planned=1, provenance=FACTS, cases=[case]))


FACTS = {"date": "2026-11-21T00:00:00", "commit": "0" * 40}


def test_page_links_the_files_of_a_figure():
    page = page_of(claimed(-2.65))
    assert all(f'<a href="figures/one.{kind}">{kind.upper()}</a>' in page for kind in ("svg", "pdf", "csv"))


def test_page_shows_the_uncertainty_of_a_number():
    assert page_of(claimed(-2.65, error=0.031)).count("± 0.031") == 2
    assert "± " not in page_of(claimed(-2.65))  # as after a number


def test_page_tells_how_a_replication_is_repeated():
    page = page_of(claimed(-2.65))
    assert "<dt>reproduce</dt><dd><code>python -m validation replicate --out paper</code></dd>" in page


@pytest.fixture(scope="module")
def replicated(tmp_path_factory):
    """The folder of a tiny replication, its report, and the exit code."""
    folder = tmp_path_factory.mktemp("replicate")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(members, "QUICK", TINY)
        patch.setattr(command_line, "opener_of", lambda spec: here)
        code = command_line.main(["replicate", "--quick", "--out", str(folder)])
    return folder, json.loads((folder / "report.json").read_text()), code


@pytest.mark.slow
def test_short_form_runs_from_end_to_end(replicated):
    folder, report, code = replicated
    assert code == 0
    assert report["level"] == "replicate, short form"
    assert [case["status"] for case in report["cases"]] == ["run"] * 11
    assert (folder / "report.html").stat().st_size > 1e5


@pytest.mark.slow
def test_short_form_states_that_it_replicates_nothing(replicated):
    _, report, _ = replicated
    rows = [row for case in report["cases"] for row in case["rows"] if "Carbone" in row["reference"]["source"]]
    assert len(rows) >= 15
    assert {row["status"] for row in rows} == {"not run"}
    assert all("2 realisations with 16 harmonics" in row["message"] for row in rows)


@pytest.mark.slow
def test_report_states_harmonics_and_final_load_of_every_realisation(replicated):
    _, report, _ = replicated
    table = report["cases"][1]["tables"][0]
    stated = [dict(zip(table["columns"], row, strict=True)) for row in table["rows"]]
    assert [line["harmonics"] for line in stated] == [16, 16]
    assert [line["highest load / E*"] for line in stated] == pytest.approx([0.025, 0.025])


@pytest.mark.slow
def test_every_figure_is_there_as_vectors_and_data(replicated):
    folder, report, _ = replicated
    drawn = [figure["id"] for case in report["cases"] for figure in case["figures"]]
    assert len(drawn) >= 18
    assert sorted(path.name for path in (folder / "figures").iterdir()) == sorted(
        f"{name}.{kind}" for name in drawn for kind in ("svg", "pdf", "csv")
    )


@pytest.mark.slow
def test_every_link_of_the_page_leads_to_a_file(replicated):
    folder, report, _ = replicated
    page = (folder / "report.html").read_text()
    links = set(re.findall(r'href="(figures/[^"]+)"', page))
    assert len(links) == 3 * sum(len(case["figures"]) for case in report["cases"])
    assert all((folder / link).stat().st_size > 0 for link in links)


@pytest.mark.slow
def test_shares_of_the_pressure_are_kept_by_other_bins(replicated):
    folder, _, _ = replicated
    one = gather(TINY, folder / "members", {}).loading[0]
    bounds = np.linspace(-50.0, 5.0, 40001)
    share = float(np.sum(density(one, 0.02, bounds) * np.diff(bounds)))
    k = one.index_of(0.02)
    assert share == pytest.approx(one.result.targets[k].contact_fraction, rel=1e-3)


@pytest.mark.slow
def test_load_that_is_jumped_over_lies_on_the_line_between(replicated):
    folder, _, _ = replicated
    one = gather(TINY, folder / "members", {}).loading[0]
    states = sorted(one.touching, key=lambda state: state.mean_pressure)
    loads = [state.mean_pressure / MODULUS for state in states]
    middle = (loads[-2] + loads[-1]) / 2
    assert one.index_of(middle) is None
    area = one.value_at(middle, lambda state: state.contact_fraction)
    assert area == pytest.approx((states[-2].contact_fraction + states[-1].contact_fraction) / 2, rel=1e-12)


@pytest.mark.slow
def test_realisation_that_is_missing_makes_the_row_not_run(replicated):
    folder, _, _ = replicated
    evidence = gather(PAPER, folder / "members", {"loading-00": "ZeroDivisionError: the matrix is singular"})
    outcome = realisations.compute(evidence)
    assert verdict_of(outcome.rows[0]) == "not run"
    assert outcome.rows[0].message == f"only 0 of 11 realisations reached {LOADS[-1]:g} E*"
    assert len(evidence.missing) == len(members.all_members(PAPER)) - 1  # the sketch is of no size


def test_unknown_executor_is_bad_input(tmp_path):
    assert command_line.main(["replicate", "--executor", "slurm", "--out", str(tmp_path)]) == 2


def test_topics_without_an_ensemble_are_not_run_with_the_reason(tmp_path, monkeypatch):
    replicate = import_module("validation.replicate")
    monkeypatch.setattr(replicate, "run_ensemble", lambda *_: Gathered((), (), (), {"loading-00": "no memory"}))
    report = replicate.replicate(tmp_path, TINY, 1, here, lambda note: None, "replicate")
    assert {case.status for case in report.cases[2:]} == {"not run"}
    assert all("2 at least are needed" in case.message for case in report.cases[2:])
    assert [line[7] for line in report.cases[0].tables[0].rows] == ["not run"] * 9
