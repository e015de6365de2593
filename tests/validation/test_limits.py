"""The limits of the model stand on one page of the manual, and on the page that all others extend."""

import re
from pathlib import Path

from validation.report.pages import filled

ROOT = Path(__file__).parents[2]
SECTION = (ROOT / "bem" / "README.md").read_text("utf-8").partition("## 10. Limits of the model")[2]


def leads(text, begin, end):
    return re.findall(f"{re.escape(begin)}(.+?){re.escape(end)}", text)


def test_a_page_names_the_limits_of_the_manual():
    page = filled("base.jinja")
    listed = leads(page.partition('id="limits"')[2], "<li><b>", "</b>")
    assert listed == leads(SECTION, "- **", "**")
    assert len(listed) == 7
