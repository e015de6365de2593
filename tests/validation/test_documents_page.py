"""`linecontact docs`: the documents of the packages in a terminal and on one page, as they are beside the code."""

import re
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest

from bem.command_line.answer_table import QUANTITIES
from validation.command_line.front_door import main
from validation.report.documents import TOPICS, document, sections
from validation.report.formulas import formula

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("docs") / "docs.html"
    assert main(["docs", "--html", str(path)]) == 0
    return path.read_text("utf-8")


def test_a_topic_is_the_document_beside_the_code(capsys):
    assert main(["docs", "theory"]) == 0
    assert capsys.readouterr().out == (ROOT / "persson" / "README.md").read_text("utf-8") + "\n"


@pytest.mark.parametrize(
    ("words", "hit"),
    [
        (["detrend"], r"\[keys\] \[profile\]:\n    - `detrend`"),
        (["separation"], r"\[answer\] Reading and quoting an answer:\n    .*separation"),
        (["OPEN", "gap:", "mean"], r"\[answer\] .*:\n    \| open gap: mean"),
        (["PULLOFF"], r"\[answer\] .*:\n    \| pull-off"),
        (["sweep"], r"linecontact example:\n    guide-sweep "),
        (["largest_tension"], r"\[python\] Result:\n    largest_tension : "),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_words_of_a_line_find_it_with_its_place(words, hit, capsys):
    assert main(["docs", *words]) == 0
    told = capsys.readouterr().out
    assert re.search(f"^{hit}", told, re.MULTILINE), told
    assert max(map(len, told.splitlines())) < 240


def test_the_answer_has_a_screen_with_each_of_its_rows(capsys):
    """Every heading of the answer, without what is prescribed, is in the table of the page in its order."""
    assert main(["docs", "answer"]) == 0
    printed = capsys.readouterr().out
    assert len(printed.splitlines()) <= 50
    table = " ".join(line.split("|")[1] for line in printed.splitlines() if line.startswith("| "))
    heads = [*(head.partition(":")[0].partition(" for ")[0] for head in QUANTITIES.values()), "pull-off"]
    assert [head for head in heads if head not in table] == []


def test_an_unknown_topic_is_refused_with_all_topics(capsys):
    assert main(["docs", "weather"]) == 2
    refusal = capsys.readouterr().err
    assert all(topic in refusal for topic in TOPICS)


def test_the_page_has_every_heading_and_its_links_lead_there(page):
    places = re.findall(r'<h\d id="([^"]+)"', page)
    assert len(places) == sum(len(sections(document(topic))) for topic in TOPICS)
    assert len(set(places)) == len(places)
    links = re.findall(r'href="#([^"]+)"', page)
    assert len(links) > 40
    assert set(links) <= {*places, "limits"}
    assert not re.search(r'(?:src|href)="(?!https://|#|data:)', page)


def test_no_mark_of_markdown_is_left_on_the_page(page):
    text = re.sub(r"<(pre|code|style|script|math)\b.*?</\1>", "", page, flags=re.DOTALL)
    assert not re.search(r"\$|\*\*|```|\]\(|^\| ", text, flags=re.MULTILINE)
    assert len(re.findall("<math", page)) > 300


@pytest.mark.parametrize(
    ("tex", "tags"),
    [
        (r"\frac12 a_n^{2}", ["mfrac", "mn", "mn", "msubsup", "mi", "mi", "mrow", "mn"]),
        (r"\sum_m x'", ["munder", "mo", "mi", "msup", "mi", "mrow", "mo"]),
    ],
    ids=["fraction", "sum"],
)
def test_formulas_are_mathml(tex, tags):
    assert [element.tag for element in ElementTree.fromstring(str(formula(tex))).iter()] == ["math", *tags]


def test_documents_are_in_the_package():
    """The names of the files are in the data of their packages."""
    data = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    for package, name in filter(all, TOPICS.values()):
        top, _, inner = package.partition(".")
        assert any(
            Path(f"{inner}/{name}".strip("/")).match(pattern) for pattern in data[top] if pattern.endswith(".md")
        )
