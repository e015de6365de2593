"""The replication: its members, rows and verdicts, its page, and a short form from end to end."""

import csv
import errno
import io
import json
import os
import re
from importlib import import_module

import numpy as np
import pytest
from in_this_process import here

from validation import __main__ as command_line
from validation.harness.ensemble import Gathered
from validation.harness.schema import CaseRecord, Figure, Panel, Reference, Report, Series
from validation.harness.verdict import verdict_of
from validation.references.paper_problem import MODULUS
from validation.replicate import (
    gather,
    members,
    realisations,
    scene_text,
    statements,
)
from validation.replicate.members import LOADS, PAPER, Size
from validation.replicate.paper_spectra import (
    _shift_rows,
)
from validation.replicate.pressure import density
from validation.replicate.statements import Alternative, Passage, stale
from validation.report.figures import linked, table_of, write_figure
from validation.report.render import render
from validation.studies.bench import Bench

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


def claimed(ours, error=0.0, shortfall="", **more):
    full = Alternative(-2.4, "full contact")
    return Passage("section 5", shortfall).states("exponent", ours, error, -2.73, 0.1, full, measured=0.05, **more)


def otherwise(ours, error=0.0, paper=3.0, band=(0.6, 0.8), where="section 5"):
    return Passage(where).is_otherwise("moment", ours, error, paper, band, "few waves")


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
        (otherwise(2.1), "expected deviation"),
        (otherwise(3.0), "changed"),
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
        Passage("section 5").states("exponent", -2.7, 0.0, -2.73, 0.1, Alternative(-2.6, "another"), measured=0.03)


@pytest.mark.parametrize(("ours", "counts"), [(-2.68, 0), (-2.66, 0), (-2.65, 1), (-2.73, 1)])
def test_stored_difference_that_moved_is_counted(ours, counts):
    found = stale([claimed(ours), claimed(ours, shortfall="short")])
    assert found.computed == [counts]
    assert verdict_of(found) == ("deviates" if counts else "agrees")


def test_band_that_holds_agreement_is_refused():
    with pytest.raises(ValueError, match="holds 1, where the two agree"):
        otherwise(2.1, band=(0.6, 1.1))


def test_difference_within_two_standard_errors_is_no_finding():
    row = otherwise(2.1, error=0.5)
    assert (verdict_of(row), row.message) == ("not run", "no finding: 1.8 errors apart")


@pytest.mark.parametrize(("factor", "verdict"), [(1.5, "agrees"), (1.0, "deviates"), (1.15, "deviates")])
def test_shift_of_a_spectrum_is_found_whatever_its_exponent(factor, verdict):
    order = np.arange(1.0, 201.0)
    power = np.outer([0.99, 1.0, 1.01], factor * order**-2.7)
    (row,) = _shift_rows(0.02, power, order**-2.7, Passage)
    assert verdict_of(row) == verdict
    assert row.message == f"over the theory's: {factor:.2f} +- 0.01"


def test_shift_within_its_scatter_is_not_found():
    order = np.arange(1.0, 201.0)
    power = np.outer([0.5, 2.3], order**-2.7)
    assert verdict_of(_shift_rows(0.02, power, order**-2.7, Passage)[0]) == "deviates"


def test_every_statement_of_the_paper_is_on_the_page_with_its_verdict():
    ours = claimed(-2.65).model_copy(update={"reference": Reference(kind="exact", source="JKR edges")})
    known = otherwise([2.9, 2.1], 0.1, [3.0, 3.0], where="section 4: Gaussian")
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
    report = replicate.replicate(Bench(tmp_path, True, lambda note: None, 1, here), TINY, "replicate")
    assert {case.status for case in report.cases[2:]} == {"not run"}
    assert all("2 at least are needed" in case.message for case in report.cases[2:])
    assert [line[7] for line in report.cases[0].tables[0].rows] == ["not run"] * 9
