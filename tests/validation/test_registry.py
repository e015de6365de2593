"""The registry: incomplete or repeated cases are refused, levels include those below, nothing is chosen silently."""

import sys
import types

import pytest

from validation.harness.case import LEVELS, Case, CaseError, Outcome, registry, select

PLAIN = {
    "id": "a",
    "group": "closed forms",
    "level": "quick",
    "question": "q?",
    "equations": "e",
    "sources": ("s",),
    "compute": Outcome,
}


def case(**changes):
    return Case(**(PLAIN | changes))


@pytest.fixture
def module(monkeypatch):
    def make(*cases):
        made = types.ModuleType("cases_of_a_test")
        made.CASES = cases
        monkeypatch.setitem(sys.modules, made.__name__, made)
        return [made.__name__]

    return make


def test_cases_of_the_project_are_complete():
    assert {found.level for found in registry()} <= set(LEVELS)


@pytest.mark.parametrize("name", ["id", "group", "question", "equations", "sources"])
def test_incomplete_case_is_refused(module, name):
    with pytest.raises(CaseError, match=f"{name} is empty"):
        registry(module(case(**{name: "" if name != "sources" else ()})))


@pytest.mark.parametrize("name", ["../a", "a/b", ".a", "a b", "a\n"])
def test_id_that_could_not_name_a_file_is_refused(module, name):
    with pytest.raises(CaseError, match="names files"):
        registry(module(case(id=name)))


def test_unknown_level_of_a_case_is_refused(module):
    with pytest.raises(CaseError, match="'now'"):
        registry(module(case(level="now")))


def test_two_cases_of_one_name_are_refused(module):
    with pytest.raises(CaseError, match="same name: a"):
        registry(module(case(), case(group="other")))


@pytest.mark.parametrize(("level", "chosen"), [("quick", "q"), ("standard", "qs"), ("full", "qsf")])
def test_level_includes_those_below(level, chosen):
    cases = [case(id=name[0], level=name) for name in LEVELS]
    assert "".join(found.id for found in select(cases, level)) == chosen


@pytest.mark.parametrize(
    ("pattern", "chosen"), [("a", "a"), ("[ab]", "ab"), ("closed*", "abc"), ("c", "c"), ("forms", "abc"), ("b", "b")]
)
def test_pattern_chooses_by_name_or_group_at_any_level(pattern, chosen):
    cases = [case(), case(id="b", level="full"), case(id="c")]
    assert "".join(found.id for found in select(cases, "quick", pattern)) == chosen


def test_pattern_without_a_match_is_refused():
    with pytest.raises(CaseError, match="matches no case of: a"):
        select([case()], "quick", "b*")


def test_unknown_level_is_refused():
    with pytest.raises(CaseError, match="quick, standard, full"):
        select([case()], "now")
