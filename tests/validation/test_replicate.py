"""The replication: exponents and fits on data with known answers, rows and verdicts, a short form from end to end."""

import csv
import errno
import io
import json
import os
import re
from importlib import import_module

import numpy as np
import pytest
from example_members import here

from validation import __main__ as command_line
from validation.harness.ensemble import Outcome
from validation.harness.schema import CaseRecord, Figure, Panel, Report, Series
from validation.harness.verdict import verdict_of
from validation.replicate import gather, members, realisations, scene_text
from validation.replicate.area import line_through
from validation.replicate.double_gaussian_fit import Fit, Sample, window_figure, window_table
from validation.replicate.evidence import jackknife, joined, mean_and_error
from validation.replicate.members import LOADS, PAPER, Size
from validation.replicate.pressure import decay_power, density
from validation.replicate.spectra import THIN, _power_law, _thin_once, banded, exponent, sensitivity
from validation.replicate.statements import disagreement, statement
from validation.report.figure_files import linked, table_of, write_figure
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
    assert planned.scene["output"]["shapes"] == [86e-6, 48e-6, 9.6e-6]


def test_names_of_members_differ():
    names = [one.name for one in members.all_members(PAPER)]
    assert len(set(names)) == len(names) == 11 + 1 + 1 + 12


def test_sensitivity_is_the_change_of_a_curved_spectrum():
    order = np.arange(1.0, 200.0)
    curved = np.exp(-0.1 * np.log(order) ** 2)
    moved = [exponent(curved, (10 * 2**0.5, 100 * 2**0.5)), exponent(curved, (10 / 2**0.5, 100 / 2**0.5))]
    expected = max(abs(value - exponent(curved, (10, 100))) for value in moved)
    assert sensitivity(curved, (10, 100)) == pytest.approx(expected, rel=1e-12)
    assert expected > 0.05


def test_exponent_of_noisy_lines_is_within_its_error():
    order = np.arange(1.0, 201.0)
    noise = np.random.default_rng(3).exponential(size=(11, 200))
    value, error = jackknife(lambda mean: exponent(mean, (10, 100)), order**-2.7 * noise)
    assert abs(value + 2.7) < 3 * error
    assert 0.01 < error < 0.2


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
    ends, values = _power_law(np.arange(1.0, 200.0) ** -2.7, (10.0, 100.0))
    assert ends == [10.0, 100.0]
    assert np.log(values[1] / values[0]) / np.log(10.0) == pytest.approx(-2.7, abs=1e-10)


def test_thin_curves_of_all_loads_become_one_series():
    thin = [Series(label=THIN, x=[k, k + 1.0], y=[0.0, 1.0], style="thin") for k in (0.0, 5.0)]
    merged = _thin_once([thin[0], Series(label="line", x=[1.0], y=[1.0]), thin[1]])
    assert [one.label for one in merged] == ["line", THIN]
    assert merged[-1].x == [0.0, 1.0, None, 5.0, 6.0]


SIGMA = np.linspace(-0.29, 0.69, 50)


@pytest.fixture(scope="module")
def sample():
    """Three realisations of one double Gaussian that ends at -0.1, where the theory's sigma_a is 0.05."""
    shape = Fit(0.02, 0.2, 0.018, 0.4, 0.0)(SIGMA)
    return Sample(0.02, SIGMA, np.outer([0.9, 1.0, 1.1], shape), 0.05, 0.13)


@pytest.mark.parametrize("logarithmic", [False, True], ids=["P", "ln P"])
@pytest.mark.parametrize("start", [-0.1, 0.0])
def test_end_of_a_double_gaussian_does_not_depend_on_window_or_weights(sample, start, logarithmic):
    assert sample.over(start, logarithmic=logarithmic).end == pytest.approx(0.1, abs=1e-6)  # 3e-8 measured


def test_end_of_a_distribution_with_a_tail_depends_on_the_window(sample):
    tail = sample.mean + 0.05 * np.exp(10 * SIGMA) * (SIGMA < 0.05)
    assert abs(sample.over(-0.3, tail).end - sample.over(0.0, tail).end) > 0.004  # 0.0104 and more measured


def test_size_of_realisations_is_no_error_of_the_end(sample):
    ratio, error = sample.end(-0.3)
    assert (ratio, error) == pytest.approx((2.0, 0.0), abs=1e-5)


def test_window_is_drawn_and_listed_with_the_theory_fitted_alike(sample):
    theory = Fit(0.02, 0.07, 0.02, 0.4, 0.0)(SIGMA)
    listed = {line[1]: line for line in window_table([sample], [theory]).rows}
    assert listed["Persson's own P, weights of P"][5] == pytest.approx(0.7, abs=1e-5)
    labels = [series.label for series in window_figure([sample]).solution.series]
    assert labels == [
        "0.02 E*, standard error", "0.02 E*, equal weights of P", "0.02 E*, equal weights of ln P",
        "the paper's factor",
    ]  # fmt: skip


def test_straight_line_is_found():
    assert line_through([1.0, 2.0, 4.0], [3.0, 4.0, 6.0]) == pytest.approx((2.0, 1.0))


def test_joined_curves_have_gaps_between_them():
    assert joined([([1.0, 2.0], [3.0, 4.0]), ([5.0], [6.0])]) == ([1.0, 2.0, None, 5.0], [3.0, 4.0, None, 6.0])


def claimed(ours, error=0.0, **more):
    return statement("exponent", ours, error, -2.73, 0.1, measured=0.05, where="section 5", **more)


@pytest.mark.parametrize(
    ("row", "verdict"),
    [
        (claimed(-2.65), "agrees"),
        (claimed(-2.5), "deviates"),
        (claimed(-2.5, error=0.12), "agrees"),
        (claimed(-2.5, error=0.06), "deviates"),
        (claimed(-2.5, error=0.06, same_ensemble=True), "agrees"),
        (claimed(-2.65, shortfall="only 3 of 11 realisations"), "not run"),
        (disagreement("moment", 2.1, 0.0, 3.0, (0.6, 0.8), "few waves", where="section 5"), "expected deviation"),
        (disagreement("moment", 3.0, 0.0, 3.0, (0.6, 0.8), "few waves", where="section 5"), "changed"),
    ],
    ids=[
        "within",
        "outside",
        "within its error",
        "beyond its error",
        "within both errors",
        "short",
        "known",
        "agrees too well",
    ],
)
def test_verdict_of_a_statement(row, verdict):
    assert verdict_of(row) == verdict


def test_what_is_told_stands_beside_the_verdict():
    assert claimed(-2.65, told="window moved: 0.04").message == "window moved: 0.04"
    assert claimed(-2.65, told="window moved: 0.04", shortfall="only 3").message == "only 3"


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
    assert "±" not in page_of(claimed(-2.65))


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
    assert [case["status"] for case in report["cases"]] == ["run"] * 8
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
    table = report["cases"][0]["tables"][0]
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
    loads = [state.mean_pressure / members.MODULUS for state in states]
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
    assert len(evidence.missing) == len(members.all_members(PAPER))


def test_unknown_executor_is_bad_input(tmp_path):
    assert command_line.main(["replicate", "--executor", "slurm", "--out", str(tmp_path)]) == 2


def test_topics_without_an_ensemble_are_not_run_with_the_reason(tmp_path, monkeypatch):
    replicate = import_module("validation.replicate")
    monkeypatch.setattr(replicate, "run_ensemble", lambda *_: Outcome((), (), (), {"loading-00": "no memory"}))
    report = replicate.replicate(tmp_path, TINY, 1, here, lambda note: None, "replicate")
    assert {case.status for case in report.cases[1:]} == {"not run"}
    assert all("2 at least are needed" in case.message for case in report.cases[1:])
