"""A report and its parts, for the tests of its file and its page."""

import re
from html.parser import HTMLParser

from validation.harness.schema import Band, CaseRecord, Figure, Panel, Reference, Report, Row, Series, Table, Tolerance

PUBLISHED = ("https://doi.org/10.", "https://arxiv.org/abs/")

BAND = Band(low=1.5, high=3.0, cause="mean-field theory", source="the paper", review="2027-11-21")


def row(computed=1.01, **changes):
    plain = {
        "quantity": "load < K & friends",
        "unit": "N/m",
        "reference": Reference(kind="exact", source="closed form"),
        "norm": "absolute",
        "expected": [1.0],
        "computed": [computed],
        "tolerance": Tolerance(value=0.1, measured=0.04),
    }
    return Row(**(plain | changes))


def figure(name):
    above = Panel(xlabel="x", ylabel="load", series=[Series(label="solver", x=[0.0, 1.0, None], y=[0.0, 1.0, 2.0])])
    below = Panel(xlabel="x", ylabel="error", series=[Series(label="solver", x=[0.0, 1.0], y=[0.1, -0.1])])
    return Figure(id=name, caption=f"Caption of {name}.", solution=above, error=below)


def case(name="johnson-0.1", *rows, **changes):
    plain = {
        "id": name,
        "group": "closed forms",
        "level": "quick",
        "question": "Does it stick?",
        "equations": r"$K^2 = 2 E^\ast w$ at every edge",
        "sources": ["johnson1995"],
        "effects": ["adhesion"],
        "scene": "[solid]\nyoungs_modulus = 1.0e6 # <E>",
        "rows": list(rows) or [row()],
        "tables": [Table(caption="Cost.", columns=["unknowns", "s"], rows=[[64, 0.25], [128, None]])],
        "counts": {"unknowns": 64},
    }
    return CaseRecord(**(plain | changes))


def report(*cases, **changes):
    cases = cases or (case(), case("persson", row(2.0, norm="ratio", tolerance=None, band=BAND)))
    plain = {"level": "quick", "command": "run", "planned": len(cases), "cases": list(cases)}
    return Report(**(plain | {"provenance": {"date": "2026-11-21", "commit": "0123abc"}} | changes))


class Page(HTMLParser):
    """Ids, references and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.inside, self.outside, self.words, self.tags = [], [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        for name, value in attributes:
            if tag == "a" and value.startswith(PUBLISHED):
                continue  # asked for when a reader follows it
            if name == "id":
                self.ids.append(value)
            elif name in ("href", "src", "xlink:href") and not value.startswith("data:"):
                (self.inside if value.startswith("#") else self.outside).append(value)
            self.inside += [f"#{found}" for found in re.findall(r"url\(#([^)]+)\)", value or "")]

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())
