"""The two examples of .github/CONTRIBUTING.md, a case and a route, are short, run, and can fail."""

import re
from functools import partial
from pathlib import Path

import pytest

from validation.challenge.judging import judged
from validation.challenge.problem import problem
from validation.challenge.worker import called
from validation.harness.case import checked
from validation.harness.route import Answer, behind_the_door
from validation.harness.runner import record_of
from validation.harness.verdict import case_verdicts

TEXT = (Path(__file__).parents[2] / ".github" / "CONTRIBUTING.md").read_text("utf-8")
CASE, ROUTE = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


def lines_of(text):
    return len([line for line in text.splitlines() if line.strip()])


def place_of(text):
    place = {"__name__": "example"}
    exec(text, place)
    return place


def verdicts(text):
    (case,) = checked(place_of(text)["CASES"])
    return case_verdicts(record_of(case, case.compute(), 0.0))


def test_a_case_takes_25_lines_and_agrees():
    assert lines_of(CASE) <= 25
    assert verdicts(CASE) == ["agrees"]


def test_a_wrong_wave_deviates():
    assert verdicts(CASE.replace("1e-4 / 0.01", "1.001e-4 / 0.01")) == ["deviates"]


@pytest.fixture
def route():
    """The route behind the door of the challenge, at a setting."""
    return partial(behind_the_door, place_of(ROUTE)["solve"])


def test_a_route_takes_40_lines_and_is_right(route):
    assert lines_of(ROUTE) <= 40
    one = problem("westergaard")
    found = judged(one, Answer(**called(route(4096), one.data)), 3.0)
    digits = {row.quantity: row.digits for row in found.rows if row.status == "right"}
    assert digits.keys() == {"contact_fraction", "separation"}
    assert min(digits.values()) > 3.0  # 3.5 of the fraction: whole points


def test_what_a_route_does_not_offer_is_no_wrong_answer(route):
    assert called(route(1024), problem("steep").data)["status"] == "not offered"
