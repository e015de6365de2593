"""The limits of the model stand on one page of the manual, and on every page that is written."""

import re
from pathlib import Path

import pytest

from validation.report.pages import filled

ROOT = Path(__file__).parents[2]
SECTION = (ROOT / "bem" / "README.md").read_text("utf-8").partition("## 10. Limits of the model")[2]
TEXTS = {path.name: path.read_text("utf-8") for path in (ROOT / "validation" / "report").glob("*.jinja")}
PARTS = re.findall(r'{% (?:include|from) "([^"]+)"', "".join(TEXTS.values()))
PAGES = sorted(TEXTS.keys() - set(PARTS))


def leads(text, begin, end):
    return re.findall(f"{re.escape(begin)}(.+?){re.escape(end)}", text)


def test_a_page_names_the_limits_of_the_manual():
    page = filled("base.jinja")
    listed = leads(page.partition('id="limits"')[2], "<li><b>", "</b>")
    assert listed == leads(SECTION, "- **", "**")
    assert len(listed) == 7


def root(name):
    """The template that a page extends, directly or by another."""
    above = re.match(r'{% extends "([^"]+)" %}', TEXTS[name])
    return root(above[1]) if above else name


@pytest.mark.parametrize("name", PAGES)
def test_every_page_is_such_a_page(name):
    assert root(name) == "base.jinja"
