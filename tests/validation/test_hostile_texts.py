"""Nothing foreign runs: every text of every page replaced by hostile ones, and the pages opened in a real browser.

A text of a report is either refused by the schema, because it names a file, an element or a rule, or stands on the page
as it is written.  What a browser blocks, or would have run, is on its console, and what it made of foreign markup is
in the document: both have to be empty.  Without Chromium these tests are skipped.
"""

import json
from dataclasses import asdict, fields, is_dataclass, replace
from pathlib import Path

import pytest
from browser import BROWSER
from devtools import tab
from markupsafe import Markup, escape
from pydantic import ValidationError
from report_parts import BAND, case, figure, report, row
from rough_scene import ROUGH

import bem
from validation.challenge import standings
from validation.challenge.judging import Judgement, judged
from validation.challenge.problem import problem
from validation.harness.case import Case
from validation.harness.route import Answer
from validation.harness.runner import run_cases
from validation.harness.schema import Report, with_checksum
from validation.report.challenge_page import render_challenge
from validation.report.history import history_of, render_history
from validation.report.render import render
from validation.report.run_page import render_run
from validation.studies import own_scene
from validation.studies.own_scene import study_page

MARKUP = (
    """ran() "'><script>ran()</script></script></style></title></textarea>--><!--"><b class=foreign onclick=ran()>"""
    "<img src=x onerror=ran()><svg onload=ran()></svg><style>*{display:none}</style><base href=//x.org><a class=foreign"
    ' href=javascript:ran()>x</a> {{ 7 * 7 }} {% raw %} &lt;script&gt; javascript:ran() doi:10.1000/"><script>ran()// '
)
EQUATIONS = (
    r"$\text{<script>ran()</script>}$ $a & b$ $\href{javascript:ran()}{x}$ $\style{display:none}{y}$ $x_{$ "
    r"$\text{&lt;img src=x onerror=ran()&gt;}$ $\class{foreign}{z}$ $\color{red\" onload=\"ran()}{q}$"
)
BROKEN = "\x00\x1b[2J\x0c\ud83d \udc80 \ufffe"  # half of a pair, and what no page may hold
TEXTS = {"equations": BROKEN + MARKUP + EQUATIONS, "odd": EQUATIONS + "$" + MARKUP}

LOOK = """(() => {
  const every = [...document.querySelectorAll("*")];
  const links = every.flatMap((e) => ["href", "src", "action", "xlink:href"].map((name) => e.getAttribute(name)));
  return {
    scripts: document.querySelectorAll("script").length,
    styles: document.querySelectorAll("style").length,
    foreign: document.querySelectorAll(".foreign, img, iframe, object, embed, base, form, textarea").length,
    listening: every.filter((e) => e.getAttributeNames().some((name) => name.startsWith("on"))).length,
    links: links.filter((to) => to && !/^(#|data:,$|https:.{2}(doi[.]org|arxiv[.]org)[/]|figures[/])/.test(to)),
    shown: document.body.textContent.split("ran()").length - 1,
    seen: document.body.getBoundingClientRect().height > 400,
  };
})()"""
HARMLESS = {"scripts": 1, "styles": 1, "foreign": 0, "listening": 0, "links": [], "seen": True}


def every_text(value, text, kept=()):
    """The same, each text in it replaced, names too; the values of keys that are `kept` stay."""
    if isinstance(value, str):
        return text
    if is_dataclass(value):
        names = [field.name for field in fields(value) if field.init and field.name not in kept]
        return replace(value, **{name: every_text(getattr(value, name), text, kept) for name in names})
    if isinstance(value, dict):
        return {name: item if name in kept else every_text(item, text, kept) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(every_text(item, text, kept) for item in value)
    return value


def places(value, before=()):
    """Where the texts of plain data are."""
    if isinstance(value, str):
        yield before
    elif isinstance(value, dict | list):
        for name, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places(item, (*before, name))


def put(content, place, text):
    """Put a text at a place; what was there."""
    for name in place[:-1]:
        content = content[name]
    before, content[place[-1]] = content[place[-1]], text
    return before


def spoilt_report(text):
    """A report with the text wherever the schema takes it, and the names of those fields where it does not."""
    files = figure("area").model_copy(update={"files": ["figures/area.svg"]})
    cases = (
        case(figures=[files, figure("landing-area")], message="a note", drawn=["area"]),
        case("persson", row(2.0, norm="ratio", tolerance=None, band=BAND)),
        case("apart", row(9.0), row(None, status="error", message="why")),
        case("crash", rows=[], status="error", message="the matrix is singular"),
    )
    content = report(*cases, changes=["a: moved"], checksum="0").model_dump(by_alias=True)
    refused = set()
    for place in list(places(content)):
        if place[-2:-1] == ("sources",) and " " not in text:
            continue
        before = put(content, place, text)
        try:
            Report.model_validate(content)
        except ValidationError:
            put(content, place, before)
            refused.add(next(name for name in reversed(place) if isinstance(name, str)))
    for named in (*(one["counts"] for one in content["cases"]), content["provenance"]):
        named[text] = 1
    content["provenance"] |= {"date": text, "commit": text}
    return with_checksum(Report.model_validate(content)), refused


NAMES = {"schema", "id", "drawn", "files", "kind", "norm", "basis", "pinned", "status", "style", "xscale", "yscale"}


@pytest.fixture(scope="module")
def solved():
    return bem.solve(ROUGH)


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """The content of study.json of a study of a small scene."""
    folder = tmp_path_factory.mktemp("studied")
    words = {name: table for name, table in ROUGH.items() if name not in ("title", "output")}
    words["profile"] = words["profile"] | {"harmonics": 4}
    lines = ['title = "small"']
    for name, table in words.items():
        lines += [f"[{name}]", *(f"{key} = {json.dumps(value)}" for key, value in table.items())]
    (folder / "scene.toml").write_text("\n".join(lines), "utf-8")
    plan = own_scene.Options(quick=True, seeds=1)
    assert own_scene.run(folder / "scene.toml", folder / "out", plan, lambda text: None) == 0
    return json.loads((folder / "out" / "study.json").read_text("utf-8"))


def judgement(text):
    """The contents of challenge.json and of standings.json."""
    one = problem("westergaard")
    found = judged(one, Answer("crashed", text), 3.0)
    told = asdict(Judgement(text, 3.0, (found,), text, (text,))) | {"outcome": text, "passed": False}
    told["problems"] = [
        told["problems"][0] | {"title": text, "difficulty": text, "what_is_hard": text, "ignored": [text]}
    ]
    told = every_text(told, text, ("problem", "quantity", "status")) | {"provenance": {text: text}}
    return told, dict(standings.recorded()) | {"run_on": {text: text}}


def pages(text, solved, studied):
    """The pages of all commands."""
    checked = text.encode("utf-8", "replace").decode()  # no report holds half of a pair: the schema refuses it
    made, _ = spoilt_report(checked)
    yield "verify", render(made)
    yield "history", render_history(history_of([made, made]))
    kept = ("control", "kind", "initial")
    changed = replace(every_text(solved, text, (*kept, "fields", "states", "events")), status="not_converged")
    yield "run", render_run(replace(changed, events=tuple(replace(event, kind=text) for event in solved.events)))
    chosen = ("figure", *kept, "nodes", "source", "unit")
    yield "study", study_page(every_text(studied, text, chosen))
    yield "challenge", render_challenge(*judgement(text))


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
@pytest.mark.filterwarnings("ignore:constrained_layout not applied")  # labels of a thousand letters leave no axes
@pytest.mark.parametrize("kind", TEXTS)
def test_no_text_of_any_page_is_more_than_text(tmp_path, kind, solved, studied):
    path = tmp_path / "page.html"
    with tab(path) as opened:
        for name, page in pages(TEXTS[kind], solved, studied):
            path.write_text(page, "utf-8")
            opened.show(1280, 800)
            found = opened.find(LOOK)
            assert found.pop("shown") > 20, name
            assert (name, found, opened.console, opened.requests) == (name, HARMLESS, [], [])


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
@pytest.mark.parametrize("what", ["script", "image", "link", "style"])
def test_what_is_more_than_text_would_be_seen(tmp_path, what):
    marks = {
        "script": "<script>ran()</script>",
        "image": "<img src=x onerror=ran()>",
        "link": "<a href=javascript:ran()>",
        "style": "<style>*{display:none}</style>",
    }
    page = render(report(case(question="put here")))
    path = tmp_path / "page.html"
    path.write_text(page.replace("put here", marks[what]), "utf-8")
    with tab(path) as opened:
        opened.show(1280, 800)
        found = opened.find(LOOK)
        found.pop("shown")
        assert found != HARMLESS
        assert bool(opened.console) == (what in ("script", "image", "style"))


def test_texts_that_the_schema_refuses_name_files_elements_and_rules():
    assert spoilt_report(MARKUP)[1] == NAMES | {"code", "level"}


@pytest.mark.parametrize("name", ["../../x", "a b", "", "a/b", '"onload="ran()', "a\n", ".a", "a\udc80"])
def test_an_id_that_is_none_is_refused(name):
    with pytest.raises(ValidationError, match="id"):
        case(name)
    with pytest.raises(ValidationError, match="id"):
        figure(name)


@pytest.mark.parametrize("path", ["javascript:ran()", "/etc/passwd", "../x.svg", "a/../../x", "https://x.org/", "a//b"])
def test_a_file_that_does_not_lie_beside_the_report_is_refused(path):
    with pytest.raises(ValidationError, match="files"):
        type(figure("a")).model_validate(figure("a").model_dump() | {"files": [path]})


def test_no_template_trusts_a_value():
    for path in Path(render.__code__.co_filename).parent.glob("*.jinja"):
        assert "safe" not in path.read_text("utf-8").replace("unsafe-inline", "")


def crash():
    raise RuntimeError(BROKEN + MARKUP + EQUATIONS)


def test_an_exception_of_any_text_is_a_record_on_the_page(tmp_path, in_this_process):
    failing = Case("crash", "g", "quick", "?", "$x_{$ $a & b$", ("johnson1995",), crash)
    (record,) = run_cases([failing], tmp_path, 1, lambda note: None)
    assert (tmp_path / "cases" / "crash.log").exists()
    made = with_checksum(report(record))
    page = render(Report.model_validate_json(made.model_dump_json(by_alias=True)))
    assert escape(MARKUP) in Markup(page)
    page.encode("utf-8")
