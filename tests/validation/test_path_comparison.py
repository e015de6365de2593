"""Comparison of paths: a difference of each kind is counted as what it is."""

from dataclasses import replace

import pytest

from validation.studies.path_comparison import compare, scenes, solved


@pytest.fixture(scope="module")
def result():
    """A random scene with events, solved."""
    _, tables, folder = next(iter(scenes(57, 1)))
    result = solved(tables, folder, 1.0, None)
    assert result.events
    assert len(result.targets) > 1
    return result


def test_a_result_is_like_itself(result):
    differences = {key for key, count in compare(result, result).items() if count}
    assert differences == {"targets", "events"}


@pytest.mark.parametrize("change", [{"n_patches": 77}, {"status": "separated"}, {"contact_fraction": 0.9}])
def test_a_target_on_another_branch_is_counted(result, change):
    last = result.targets[-1]
    states = tuple(replace(state, **change) if state is last else state for state in result.states)
    assert compare(result, replace(result, states=states))["on another branch"] == 1


def test_an_event_that_is_absent_or_added_is_counted(result):
    fewer = replace(result, events=result.events[1:])
    assert compare(result, fewer)["events absent"] == 1
    assert compare(fewer, result)["events added"] == 1


@pytest.mark.parametrize(("errors", "beyond"), [(1.0, (0, 0)), (5.0, (1, 0)), (50.0, (1, 1))])
def test_an_event_beyond_its_errors_is_counted(result, errors, beyond):
    """The errors of both events count, so that one error of each is within them."""
    last = result.events[-1]
    own = 1e-6 * max(event.penetration for event in result.events)
    wide = replace(last, error_estimate=replace(last.error_estimate, penetration=own))
    moved = replace(wide, penetration=last.penetration + 1.999 * errors * own)
    first, second = (replace(result, events=(*result.events[:-1], event)) for event in (wide, moved))
    count = compare(first, second)
    assert (count["beyond their errors"], count["beyond ten errors"]) == beyond
