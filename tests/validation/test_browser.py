"""The page in a real browser: headless Chromium opens it, follows every link, sorts, prints; nothing is complained of.

Scripts that look at it from inside, screens of two widths, typing and what a screen reader meets go through the
DevTools of the browser.  The page forbids requests (its content security policy), and the browser puts every attempt
on the console.  Without Chromium these tests are skipped.
"""

import re

import pytest
from browser import BROWSER, allowing
from devtools import found_at, tab
from report_parts import figure, row

from validation.harness.schema import (
    Band,
    CaseRecord,
    Report,
    Table,
    with_checksum,
)
from validation.report.pdf import write_pdf
from validation.report.render import render

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")

LOOK = """
found.folded = [...document.querySelectorAll("main details")].filter((e) => !e.open).length;
document.querySelectorAll("main details").forEach((folded) => { folded.open = true; });
const inside = [...document.querySelectorAll("a[href]")].map((link) => link.getAttribute("href"));
found.outside = inside.filter((target) => !target.startsWith("#") && !target.startsWith("https://doi.org/10."));
found.dead = inside.filter((target) => target.startsWith("#") && !document.getElementById(target.slice(1)));
found.links = inside.length;
const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
found.repeated = ids.filter((id, place) => ids.indexOf(id) !== place);
found.resources = performance.getEntriesByType("resource").map((entry) => entry.name);
found.wide = document.documentElement.scrollWidth > window.innerWidth;
const pictures = [...document.querySelectorAll("figure svg")];
found.drawn = pictures.filter((svg) => svg.getBoundingClientRect().height > 50).length;
const table = document.querySelector("table.summary");
const buttons = [...table.querySelectorAll("thead th button")];
found.headings = table.querySelectorAll("thead th").length;
found.reached = buttons.filter((button) => { button.focus(); return document.activeElement === button; }).length;
const order = () => [...table.tBodies[0].rows].map((row) => row.cells[6].dataset.sort ?? "");
buttons[6].click();
found.up = order();
found.said = buttons[6].parentElement.getAttribute("aria-sort");
buttons[6].click();
found.down = order();
"""


def case(name, group, *rows, **changes):
    plain = {
        "id": name,
        "group": group,
        "level": "quick",
        "question": "Does it stick?",
        "equations": r"$K^2 = 2 E^\ast w$",
        "sources": ["johnson1995"],
        "scene": "[solid]\nyoungs_modulus = 1.0e6 # <E>\n" * 30,
        "rows": list(rows),
        "tables": [Table(caption="Cost.", columns=["unknowns", "s"], rows=[[64, 0.25], [128, None]])],
    }
    return CaseRecord(**(plain | changes))


@pytest.fixture(scope="module")
def page():
    """A page with everything a page can hold."""
    band = Band(low=1.5, high=3.0, cause="mean-field theory", source="the paper", review="2025-01-01")
    cases = [
        case(
            "johnson-0.1", "closed forms", row(1.01), row(1 + 3e-12), figures=[figure("curve"), figure("landing-area")]
        ),
        case("persson", "theory", row(2.0, norm="ratio", tolerance=None, band=band), figures=[figure("area")]),
        case("bad", "theory", row(1.5), row(None)),
        case("crash", "theory", rows=[], status="error", message="the matrix is singular"),
        case("peers", "theory", rows=[], status="not run", message="the extra 'peers' is not installed"),
    ]
    facts = {"date": "2026-11-21T10:00:00+00:00", "commit": "0123456789abcdef" * 2 + "01234567 with changes"}
    changes = ["johnson-0.1: load was 1, is 1.01"]
    made = Report(level="quick", command="run", planned=5, provenance=facts, cases=cases, changes=changes)
    return render(with_checksum(made))


@pytest.fixture(scope="module")
def seen(page, tmp_path_factory):
    """What the looking script found, and the console."""
    return found_at(tmp_path_factory.mktemp("page"), page, LOOK, 1280)


def test_console_is_silent(seen):
    assert seen[1] == []


def test_nothing_is_asked_from_outside(seen):
    assert (seen[0]["resources"], seen[0]["outside"]) == ([], [])


def test_every_link_resolves(seen):
    assert seen[0]["links"] > 20
    assert (seen[0]["dead"], seen[0]["repeated"]) == ([], [])


def test_every_figure_is_drawn(seen):
    assert seen[0]["drawn"] == 4  # three, and all results


def test_page_is_not_wider_than_its_window(seen):
    assert not seen[0]["wide"]


def test_every_heading_is_reached_by_keyboard(seen):
    assert seen[0]["reached"] == seen[0]["headings"] == 9


def test_headings_sort_by_number_both_ways(seen):
    numbers = [[float(value) for value in seen[0][way] if value not in ("", "nan")] for way in ("up", "down")]
    assert numbers[0] == sorted(numbers[0])
    assert numbers[1] == sorted(numbers[0], reverse=True)
    assert len(numbers[0]) == 4
    assert seen[0]["said"] == "ascending"


def test_what_is_behind_the_first_screen_is_folded(seen):
    assert seen[0]["folded"] > 5


def test_page_prints_to_pdf_with_bookmarks(page, tmp_path):
    (tmp_path / "report.html").write_text(page)
    printed = write_pdf(tmp_path).read_bytes()
    assert printed.startswith(b"%PDF")
    assert b"/Type /Outlines" in printed
    for heading in (b"Verification report", b"All rows", b"Cases", b"closed forms", b"Bibliography"):
        assert b"/Title (" + heading + b")" in printed
    assert (
        "johnson-0.1".encode("utf-16-be").hex().upper().encode() in printed
    )  # the heading of a case, which the screen folds away
    sizes = re.findall(rb"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", printed)
    assert {float(width) > float(height) for width, height in sizes} == {True, False}  # the summary lies across
    assert len(sizes) >= 5


UNFOLD = "document.querySelectorAll('main details').forEach((folded) => { folded.open = true; })"


@pytest.fixture(scope="module", params=[(1280, 800), (390, 844)], ids=["desk", "phone"])
def screen(page, tmp_path_factory, request):
    """The page on a screen."""
    path = tmp_path_factory.mktemp("screen") / "page.html"
    path.write_text(page, "utf-8")
    with tab(path) as opened:
        opened.show(*request.param)
        opened.find(UNFOLD)
        yield opened


def test_page_does_not_scroll_sideways(screen):
    wide, width = screen.find("[document.documentElement.scrollWidth, innerWidth]")
    assert wide <= width


def test_verdict_is_on_the_first_screen(screen):
    box = screen.find("(({left, top, right, bottom}) => [left, top, innerWidth - right, innerHeight - bottom])"
                      "(document.getElementById('verdict').getBoundingClientRect())")  # fmt: skip
    assert min(box) >= 0


def test_verdict_figures_and_head_of_the_matrix_are_on_one_screen(tmp_path):
    names = ("centre-wave", "centre-rough")
    cases = [case(name, "closed forms", row(1.01, quantity="edges"), figures=[figure(name)]) for name in names]
    facts = {"date": "2026-11-21T10:00:00+00:00", "commit": "0123abc"}
    made = Report(level="quick", command="run", planned=2, provenance=facts, cases=cases)
    (tmp_path / "page.html").write_text(render(with_checksum(made)), "utf-8")
    with tab(tmp_path / "page.html") as opened:
        opened.show(1280, 900)
        bottoms = opened.find("""["#verdict", ".panels:nth-of-type(1)", ".panels:nth-of-type(2)", ".matrix tbody tr"]
          .map((place) => document.querySelector(place).getBoundingClientRect().bottom)""")
    assert bottoms == sorted(bottoms)
    assert bottoms[-1] < 900


def test_no_column_is_cut_off(screen):
    cut = screen.find("""[...document.querySelectorAll("main table")]
      .filter((table) => table.offsetHeight && table.scrollWidth > table.parentElement.clientWidth + 1)
      .map((table) => table.className + ": " + table.scrollWidth + " of " + table.parentElement.clientWidth)""")
    assert cut == []


def test_typing_filters_the_summary(screen):
    count = "[...document.querySelector('table.summary').tBodies[0].rows].filter((r) => r.offsetHeight).length"
    whole = screen.find(count)
    screen.find("document.querySelector('#summary input').focus()")
    screen.ask("Input.insertText", text="Bad deviates")
    assert (whole, screen.find(count), screen.find("document.querySelector('#summary output').value")) == (
        7,
        1,
        "1 of 7",
    )
    screen.find("document.querySelector('#summary input').select()")
    screen.ask("Input.insertText", text=" ")
    assert screen.find(count) == 7


def test_every_figure_has_a_name_that_is_heard(screen):
    heard = [name for role, name in screen.heard("image")]
    assert len(heard) == screen.find("document.querySelectorAll('figure svg').length") == 4
    assert all(name.startswith(("Caption of ", "All results")) for name in heard)


def test_the_filter_has_a_name_that_is_heard(screen):
    assert ("searchbox", "Filter rows") in screen.heard("searchbox")


def test_nothing_is_complained_of_or_asked_for(screen):
    assert (screen.console, screen.requests) == ([], [])


SPOILT = {
    "too wide": ("<header>", '<p style="width: 2000px">wide</p><header>', test_page_does_not_scroll_sideways),
    "verdict below": ("<header>", '<p style="height: 900px"></p><header>', test_verdict_is_on_the_first_screen),
    "not heard": ('role="img"', 'role="presentation"', test_every_figure_has_a_name_that_is_heard),
    "no filter": ("row.hidden =", "row.unseen =", test_typing_filters_the_summary),
    "too wide a table": ('"summary stacks"', '"summary stacks" style="min-width: 600px"', test_no_column_is_cut_off),
    "request": ("</body>", '<img src="https://example.org/x.png"></body>', test_nothing_is_complained_of_or_asked_for),
}  # fmt: skip


@pytest.mark.parametrize("fault", SPOILT)
def test_a_spoilt_page_would_be_seen(page, tmp_path, fault):
    before, after, check = SPOILT[fault]
    assert before in page
    (tmp_path / "page.html").write_text(allowing(page.replace(before, after)), "utf-8")
    with tab(tmp_path / "page.html") as opened:
        opened.show(390, 844)
        opened.find(UNFOLD)
        with pytest.raises(AssertionError):
            check(opened)


COMPLAINTS = {
    "console": "<script>console.error('a fault')</script>",
    "exception": "<script>missing.call()</script>",
    "request": '<img src="http://example.org/x.png">',
}


@pytest.mark.parametrize("kind", COMPLAINTS)
def test_what_must_not_be_there_would_be_seen(page, tmp_path, kind):
    _, console = found_at(tmp_path, allowing(page.replace("</body>", f"{COMPLAINTS[kind]}</body>")), "", 1280)
    assert len(console) == 1
