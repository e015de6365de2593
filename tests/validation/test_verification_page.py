"""The page of a verification run and its report.json: kinds apart, failures first, hostile text, a real browser."""

import json
import math
import re
import subprocess
from shutil import which

import pytest
from browser import BROWSER, QUIET
from devtools import tab

from validation.plugin.rows import VERDICTS, Code, Quantity, Rows
from validation.plugin.study_report import Part, write_study
from validation.report.verification_page import prices

HOSTILE = "<script>alert(1)</script> \"' & <img src=x onerror=alert(2)> {{ 7*7 }} \x00"
DEAD_LINKS = """[...document.querySelectorAll("a[href]")].map((a) => a.getAttribute("href"))
.filter((to) => !to.startsWith("#") || !document.getElementById(to.slice(1)))"""
REPEATED_IDS = (
    """[...document.querySelectorAll("[id]")].map((e) => e.id).filter((id, k, all) => all.indexOf(id) != k)"""
)
AREA = {"of": Code.BEM, "by": Code.FEM, "quantity": Quantity.AREA, "uncertainty": (1e-3, 0.0)}


def parts(text="text"):
    good, bad = Rows(), Rows()
    good.compare(f"area {text}", [1.0, 1.0], [1.0, 1.0005], **AREA, source=text, unit=text)
    good.compare("load", 1.0, 1.0008, **AREA | {"quantity": Quantity.PRESSURE})
    good.known("gap", 2.2, 2.0, band=(1.05, 1.2), cause=text, **AREA | {"by": Code.THEORY, "uncertainty": (0.1, 0.1)})
    good.compare(
        "closure",
        1.0,
        1.0,
        required=1e-9,
        because="its tolerance",
        kind="construction",
        of=Code.BEM,
        by=Code.IDENTITY,
        quantity=Quantity.INTENSITY,
    )
    good.count("steps", 12, of=Code.BEM)
    good.curves(f"curve {text}", text, "y", {text: ([1.0, 2.0], [1.0, 4.0])}, log="xy")
    good.table(text, [text, "b"], [[text, 1.5], [None, 2]])
    good.cost("smooth wave", Code.BEM, "1e-6", 1e-7, 0.25, 0.01)
    bad.compare("area", math.nan, 1.0, **AREA)
    bad.compare("energy", 1.0, 2.0, **AREA | {"quantity": Quantity.ENERGY})
    return [
        Part("good", f"Is it so? {text}", good, text),
        Part("bad", "Is it?", bad),
        Part("broken", "?", message=text),
    ]


@pytest.fixture
def written(tmp_path):
    statements = [
        {"statement": "area grows linearly", "printed": 3.3, "ours": 3.4, "uncertainty": 0.2, "verdict": "reproduced"}
    ]

    def write(text="text"):
        write_study(tmp_path, "a command", parts(text), statements=statements)
        return json.loads((tmp_path / "report.json").read_text()), (tmp_path / "report.html").read_text()

    return write


def test_kinds_of_rows_are_counted_apart_and_accuracy_makes_the_headline(written):
    content, page = written()
    assert content["counts"] == {
        "accuracy": {"agrees": 2, "expected deviation": 1, "deviates": 1, "error": 2},
        "regression": {"agrees": 1},
        "construction": {"agrees": 1},
    }
    agree, cases = content["headline"].split("; ")
    assert agree == "2 of 4 independent comparisons agree, 1 known deviation inside the band"
    assert cases == "2 of 3 cases failed"
    assert f"<h1>Failed: {content['headline']}</h1>" in page


def test_a_row_holds_what_other_programs_read(written):
    content, _ = written()
    row = content["rows"][0]
    expected = {
        "case": "good",
        "quantity": "contact fraction",
        "unit": "text",
        "kind": "accuracy",
        "value": 1.0,
        "value_uncertainty": 1e-3,
        "reference": 1.0005,
        "reference_uncertainty": 0.0,
        "routes": ["bem", "fem"],
        "allowed": 1e-3,
        "reason": "U of both sides",
        "verdict": "agrees",
        "seconds": 0.0,
    }
    assert expected.items() <= row.items()
    assert content["statements"][0]["verdict"] == "reproduced"
    assert content["costs"][0] == {
        "problem": "smooth wave",
        "route": "bem",
        "setting": "1e-6",
        "error": 1e-7,
        "seconds": 0.25,
        "spread": 0.01,
    }
    assert content["provenance"]["commit"]


def test_contents_name_cases_by_their_questions_and_keys_of_symbols_stand_on_the_page(written):
    content, page = written()
    contents = page.partition("<nav")[2].partition("</nav>")[0]
    assert all(f">{case['question']}</a>" in contents for case in content["cases"])
    assert "U: expanded uncertainty, k = 2." in page


def test_a_paper_of_which_nothing_was_selected_is_left_out(tmp_path):
    write_study(tmp_path, "a command", [])
    assert 'id="paper"' not in (tmp_path / "report.html").read_text()


def test_json_has_no_numbers_that_are_none(written, tmp_path):
    written()
    assert json.loads((tmp_path / "report.json").read_text(), parse_constant=pytest.fail)["rows"]


def test_failures_come_before_everything_else_and_cells_count_what_they_hold(written):
    _, page = written()
    order = [
        page.index(f'id="{name}"')
        for name in ("failures", "centre", "ways", "paper", "prices", "costs", "others", "case-1")
    ]
    assert order == sorted(order)
    failures = page[order[0] : order[1]]
    assert failures.count("<tr>") == 1 + 3
    cells = re.findall(r'<td data-label="(contact fraction|energy)">.*?<small>(.*?)</small>', page[order[1] : order[2]])
    assert cells == [("contact fraction", ".50; 2"), ("energy", "1e+03; 1"), ("contact fraction", ".33; 1")]


def test_every_verdict_is_defined_on_the_page(written):
    _, page = written()
    defined = re.findall(r"<dt>(.*?)</dt><dd>(.+?)</dd>", page.partition('id="verdicts"')[2].partition("</dl>")[0])
    assert [name for name, _ in defined] == list(VERDICTS)


def test_a_failure_says_why(tmp_path):
    rows = Rows({"area [bem, fem]": 1e-6, "energy [bem, fem]": 1.0})
    rows.compare("area", 1.0, 1.0005, **AREA)
    rows.compare("load", 1.0, 1.0, **AREA)
    rows.compare("energy", 1.0, 2.0, **AREA)
    rows.known("gap", 2.2, 2.0, band=(1.2, 1.8), cause="mean field", **AREA)
    rows.not_converged("fold", "none found", of="bem", by="fem", quantity="energy")
    failures = [row["failure"] for row in write_study(tmp_path, "a command", [Part("bad", "?", rows)])["rows"]]
    assert failures == [
        "error 0.0005, stored error 1e-06, limit 5e-06",
        "no error is stored: verify with --store --reason TEXT",
        "beyond the allowed 0.001 (U of both sides)",
        "outside the band 1.2 to 1.8; known cause: mean field",
        "none found",
    ]
    assert all(words in (tmp_path / "report.html").read_text() for words in failures)


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
def test_a_browser_shows_hostile_text_as_text_and_follows_every_link(written, tmp_path):
    written(HOSTILE)
    with tab(tmp_path / "report.html") as page:
        page.show(1280, 800)
        assert page.find("document.querySelector('h3').textContent").startswith(f"Is it so? {HOSTILE[:20]}")
        assert page.find("document.querySelectorAll('script').length") == 1
        assert page.find("document.querySelectorAll('main img').length") == 0
        assert page.find(DEAD_LINKS) == []
        assert page.find(REPEATED_IDS) == []
        assert page.find(
            "[...document.querySelectorAll('figure svg')].every((f) => f.getBoundingClientRect().height > 50)"
        )
        assert page.find("document.documentElement.scrollWidth <= window.innerWidth")
        page.show(390, 844)
        assert page.find("document.documentElement.scrollWidth <= window.innerWidth")
        assert page.console == []
        assert page.requests == []


def test_the_price_of_digits_is_the_cheapest_line_that_has_them():
    lines = [
        {"problem": "wave", "route": "bem", "setting": setting, "error": error, "seconds": seconds, "spread": 0.0}
        for setting, error, seconds in (("a", 1e-3, 3.0), ("b", 1e-5, 2.0), ("c", 1e-5, 4.0))
    ]
    (price,) = prices(lines)
    settings = [None if line is None else line["setting"] for line in price["cheapest"]]
    assert settings == ["b", "b", None]


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
def test_codes_three_ways_the_paper_and_costs_stand_on_the_first_screen(written, tmp_path):
    written()
    page = tmp_path / "report.html"
    page.write_text(
        re.sub('<section id="failures">.*?</section>', "", page.read_text("utf-8"), flags=re.DOTALL), "utf-8"
    )
    with tab(page) as opened:
        opened.show(1280, 800)
        bottoms = opened.find(
            """["centre", "ways", "paper", "prices"].map((id) => {
                const body = document.querySelector(`#${id} tbody`);
                for (let k = 0; id !== "centre" && k < 30; k++) body?.append(body.rows[0].cloneNode(true));
                return document.getElementById(id);
            }).map((section) => section.getBoundingClientRect().bottom)"""
        )
    assert max(bottoms) < 800


@pytest.mark.skipif(BROWSER is None or which("pdftotext") is None, reason="no Chromium or no pdftotext")
def test_paper_shows_what_the_screen_folds(written, tmp_path):
    content, _ = written()
    made = tmp_path / "report.pdf"
    page = (tmp_path / "report.html").as_uri()
    subprocess.run([BROWSER, *QUIET, f"--print-to-pdf={made}", page], check=True, capture_output=True, timeout=60)
    command = ["pdftotext", "-layout", str(made), "-"]
    text = " ".join(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())
    for row in content["rows"]:
        if row["routes"] and row["value"] is not None:
            assert f"{row['value']:.9g}" in text
    assert "1; 1 | 2; 4" in text  # the numbers of the figure
    assert "closure" in text  # a construction, folded on the screen
    assert content["provenance"]["commit"] in text
