"""Measurements for the study of stability that end at once in every way there is; importable by worker processes."""

import os
import time

from validation.corpus.endings import Task
from validation.corpus.hard.hard_case_run import Outcome

EXPECTED = ("converged", "converged")


def outcome(observed=EXPECTED, correct=True, refused=None, findings=()):
    return Outcome("flat", EXPECTED, observed, observed == EXPECTED, correct, refused, findings, 0.5)


def converge(task: Task) -> Outcome:
    return outcome()


def found(task: Task) -> Outcome:
    """A second scene with two findings, one kind of them twice; the others with none."""
    kinds = ("shift", "shift", "energy balance") if task.id.endswith("_1") else ()
    return Outcome(task.id, EXPECTED, EXPECTED, True, not kinds, None, tuple(kinds), 0.5, kinds)


def die_at_the_second(task: Task) -> Outcome:
    return die(task) if task.id.endswith("_1") else outcome()


def sleep_at_the_second(task: Task) -> Outcome:
    while task.id.endswith("_1"):
        time.sleep(0.1)
    return outcome()


def crash(task: Task) -> Outcome:
    raise ZeroDivisionError("the matrix is singular")


def die(task: Task) -> Outcome:
    os._exit(9)


def one_dies_one_crashes(task: Task) -> Outcome:
    """Each code another ending."""
    return {"bem": die, "fem": crash, "persson": converge}[task.code](task)


def one_never_ends(task: Task) -> Outcome:
    while task.code == "bem":
        time.sleep(0.1)
    return outcome()
