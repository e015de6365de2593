"""Answers of studies on disk: they come back bit by bit, and only those of the same task and the same sources."""

import math
from dataclasses import dataclass, replace

import pytest

from validation.harness import store
from validation.harness.execution import Ended
from validation.harness.route import Answer
from validation.harness.store import Store


@dataclass(frozen=True)
class Measured:
    value: float
    parts: tuple[float, ...] = ()


@pytest.fixture
def reported():
    return []


@pytest.fixture
def answers(tmp_path, reported):
    return Store(tmp_path / "answers", "sources", reported.append)


FOUND = Answer(values={"gap_at": [0.1 + 0.2, None]}, unknowns=3, parts={"setup": 1e-300, "solve": math.inf})


@pytest.mark.parametrize(
    ("form", "answer"),
    [
        (Measured, Measured(0.1 + 0.2, (1 / 3, -0.0))),
        (list[Answer], [FOUND, Answer("crashed", "ArithmeticError: no")]),
        (list[str], []),
    ],
    ids=["data-class", "nested", "empty"],
)
def test_answer_comes_back_as_it_was(answers, form, answer):
    answers.keep(form, answer, "a task", 1)
    assert repr(answers.kept(form, "a task", 1)) == repr(answer)  # nan is not equal to itself


def test_answer_of_another_task_is_not_taken(answers):
    answers.keep(Measured, Measured(1.0), "a task", (4, 8))
    assert answers.kept(Measured, "a task", (4, 16)) is None
    assert answers.kept(Measured, "another", (4, 8)) is None


def test_answer_of_other_sources_is_not_taken(answers):
    answers.keep(Measured, Measured(1.0), "a task")
    assert replace(answers, key="later").kept(Measured, "a task") is None


@pytest.mark.parametrize("damage", [lambda text: text.replace("1.5", "1.6"), lambda text: text[:40], lambda text: "[]"])
def test_damaged_answer_is_told_and_not_taken(answers, reported, damage):
    answers.keep(Measured, Measured(1.5), "a task")
    (path,) = answers.folder.iterdir()
    path.write_text(damage(path.read_text()))
    assert answers.kept(Measured, "a task") is None
    assert "is damaged; computed again" in reported[-1].text


def test_nothing_half_written_is_left(answers):
    answers.keep(Measured, Measured(1.0), "a task / with: signs")
    assert [path.suffix for path in answers.folder.iterdir()] == [".json"]


def test_name_of_a_file_says_what_it_is(answers):
    answers.keep(Measured, Measured(1.0), "layer, reference: finite elements")
    (path,) = answers.folder.iterdir()
    assert path.name.startswith("layer-reference-finite-elements-")


def half(number):
    if number == 0:
        raise ZeroDivisionError("no half")
    return number / 2


@pytest.fixture
def asked(answers, monkeypatch):
    """What a loop over numbers gives, and which of them it worked on; `stop` interrupts it."""
    begun = []

    def loop(numbers, stop=None, **options):
        def work(function, items, jobs, **given):
            for item in items:
                begun.append(item)
                if item == stop:
                    raise KeyboardInterrupt
                try:
                    yield Ended(item, function(item), 1.0)
                except ZeroDivisionError as error:
                    yield Ended(item, error, 1.0)

        monkeypatch.setattr(store, "run_in_processes", work)
        begun.clear()
        found = answers.answers(float, half, numbers, lambda number: (f"half of {number}", number), **options)
        return {item: answer for item, answer, _ in found}

    loop.begun = begun
    return loop


def test_an_interrupted_loop_goes_on_to_the_same_answers(asked):
    with pytest.raises(KeyboardInterrupt):
        asked([1, 2, 3], stop=2)
    assert asked([1, 2, 3]) == {1: 0.5, 2: 1.0, 3: 1.5}
    assert asked.begun == [2, 3]
    assert asked([3, 1]) == {3: 1.5, 1: 0.5} and asked.begun == []


def test_what_failed_or_is_refused_is_tried_again(asked):
    assert isinstance(asked([0])[0], ZeroDivisionError)
    assert asked([4], keeps=lambda answer: answer != 2.0) == {4: 2.0}
    asked([0, 4])
    assert asked.begun == [0, 4]
