"""Errors and counts over many reports: what rises, what does not, by which reports it is judged, and the page."""

import json
import math

import pytest
from browser import BROWSER
from devtools import found_at
from report_parts import row

from validation.command_line.front_door import main
from validation.harness.schema import CaseRecord, Report, Tolerance, with_checksum
from validation.report.history import FACTOR, PAGE, history_of, render_history

TIGHT = Tolerance(value=0.1, measured=0.001)


def case(error=0.01, count=7, name="one", **changes):
    """A case whose only row has this error."""
    plain = {"id": name, "group": "g", "level": "quick", "question": "?", "equations": "=", "sources": ["johnson1995"]}
    rows = [row(1.0 + error, tolerance=TIGHT)]
    return CaseRecord(**(plain | {"rows": rows, "counts": {"evaluations": count}} | changes))


def report(day, *cases, **facts):
    told = {
        "date": f"2026-01-{day:02d}T10:00:00+00:00",
        "commit": f"{day:040d}",
        "blas": "b Haswell",
        "kernels": "NumPy",
    }
    return with_checksum(
        Report(level="quick", command="run", planned=len(cases), provenance=told | facts, cases=list(cases))
    )


def rises(*reports):
    return history_of(reports).rises(-1)


def test_equal_reports_rise_nowhere():
    found = history_of([report(day, case()) for day in (1, 2, 3)])
    assert [found.rises(k) for k in range(3)] == [[], [], []]
    assert found.unjudged == 0


@pytest.mark.parametrize(("times", "rose"), [(0.2, False), (0.99 * FACTOR, False), (1.01 * FACTOR, True)])
def test_an_error_rises_beyond_a_factor_of_the_largest_before(times, rose):
    assert bool(rises(report(1, case(0.01)), report(2, case(0.002)), report(3, case(0.01 * times)))) is rose


@pytest.mark.parametrize(("error", "rose"), [(0.99 * FACTOR * 0.001, False), (1.01 * FACTOR * 0.001, True)])
def test_an_error_below_that_stated_beside_the_tolerance_is_no_rise(error, rose):
    assert bool(rises(report(1, case(1e-9)), report(2, case(error)))) is rose


@pytest.mark.parametrize(("count", "rose"), [(6, False), (7, False), (8, True)])
def test_a_count_rises_beyond_the_largest_before(count, rose):
    found = rises(report(1, case(count=7)), report(2, case(count=5)), report(3, case(count=count)))
    assert found == (["one: evaluations: count 8, the earlier reports allow 7"] if rose else [])


@pytest.mark.parametrize("other", [{"blas": "b Nehalem"}, {"kernels": "compiled"}])
def test_counts_are_judged_by_reports_on_the_same_kernels(other):
    before, now = report(1, case(count=7)), report(2, case(count=9), **other)
    assert rises(before, now) == []
    assert history_of([before, now]).unjudged == 1
    assert len(rises(before, report(1, case(count=8), **other), now)) == 1


def test_what_is_no_number_and_a_case_that_ends_in_an_error_rise():
    assert rises(report(1, case()), report(2, case(math.nan))) == [
        "one: load < K & friends: error nan, the earlier reports allow 0.05"
    ]
    failed = case(rows=[], counts={}, status="error", message="ZeroDivisionError: no")
    assert rises(report(1, case()), report(2, failed)) == ["one: error, ZeroDivisionError: no"]


def test_reports_are_taken_by_date_and_only_the_newest_decides():
    reports = [report(3, case(count=7)), report(1, case(count=7)), report(2, case(count=9))]
    found = history_of(reports)
    assert [len(found.rises(k)) for k in range(3)] == [0, 1, 0]


def test_cases_that_are_gone_are_told_and_quantities_of_one_name_are_kept_apart():
    twice = case(rows=[row(1.01, tolerance=TIGHT), row(1.02, tolerance=TIGHT)])
    found = history_of([report(1, twice, case(name="other")), report(2, twice)])
    assert found.gone == ("other",)
    errors = {line.quantity: line.values for line in found.lines if line.case == "one" and line.kind == "error"}
    assert errors == {
        "load < K & friends": pytest.approx((0.01, 0.01)),
        "load < K & friends #2": pytest.approx((0.02, 0.02)),
    }


@pytest.fixture
def stored(tmp_path):
    """Three reports in a folder, the last with more evaluations."""
    for name, content in {"a": report(1, case()), "b": report(2, case()), "c": report(3, case(count=8))}.items():
        (tmp_path / "kept" / name).mkdir(parents=True)
        (tmp_path / "kept" / name / "report.json").write_text(content.model_dump_json(by_alias=True))
    return tmp_path / "kept"


def test_compare_tells_the_history_of_more_than_two(stored, capsys):
    three = [str(stored / name) for name in "abc"]
    for words in (three, [str(stored)]):
        assert main(["compare", *words]) == 1
        lines = capsys.readouterr().out.splitlines()
        assert lines[0] == "RISES one: evaluations: count 8, the earlier reports allow 7"
        assert lines[1].startswith("3 reports, 2 errors and counts: 1 rose in the newest, report 3 (2026-01-03 10:00,")
    assert main(["compare", *three[:2], three[0]]) == 0
    assert main(["compare", *three, "--json"]) == 1
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["rises"] == [lines[0].removeprefix("RISES ")]


def test_two_reports_have_a_history_where_a_page_is_asked_for(stored, tmp_path, capsys):
    words = ["compare", str(stored / "a"), str(stored / "b")]
    assert main([*words, "--out", str(tmp_path / "page")]) == 0
    assert "none rose in the newest" in capsys.readouterr().out
    assert "nowhere above" in (tmp_path / "page" / PAGE).read_text()


def test_what_has_no_history_is_told(stored, tmp_path, capsys):
    changed = stored / "b" / "report.json"
    changed.write_text(changed.read_text().replace('"evaluations":7', '"evaluations":6'))
    for words, said in (
        ([str(stored)], "b/report.json: changed after it was written"),
        ([str(tmp_path / "nowhere")], "found 0"),
        ([str(stored / "a")], "found 1"),
        ([str(stored / "a"), str(stored / "c"), str(tmp_path)], "no report there"),
    ):
        assert main(["compare", *words]) == 2
        assert said in capsys.readouterr().err


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
def test_the_page_shows_what_rose_and_fits_a_phone(tmp_path):
    reports = [report(day, case(0.01 * day), case(name="other", count=day)) for day in range(1, 13)]
    text = render_history(history_of(reports))
    look = """
    found.wide = document.documentElement.scrollWidth > window.innerWidth;
    found.verdict = document.getElementById("verdict").getBoundingClientRect().bottom < window.innerHeight;
    found.rises = document.querySelectorAll("#rises li").length;
    const all = (chosen) => [...document.querySelectorAll(chosen)];
    found.drawn = all("figure svg").filter((svg) => svg.getBoundingClientRect().height > 50).length;
    found.dead = all("a").filter((link) => !document.querySelector(link.getAttribute("href"))).length;
    """
    for width in (390, 1280):
        found, console = found_at(tmp_path, text, look, width)
        assert found == {"wide": False, "verdict": True, "rises": 11, "drawn": 2, "dead": 0}
        assert console == []
