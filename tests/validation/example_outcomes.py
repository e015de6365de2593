"""Measurements for the study of stability that end at once in every way there is; importable by worker processes."""

import os

from validation.cases.hard_case_run import Outcome
from validation.studies.stability import Task

EXPECTED = ("converged", "converged")


def outcome(observed=EXPECTED, correct=True, refused=None, findings=()):
    return Outcome("flat", EXPECTED, observed, observed == EXPECTED, correct, refused, findings, 0.5)


def converge(task: Task) -> Outcome:
    return outcome()


def crash(task: Task) -> Outcome:
    raise ZeroDivisionError("the matrix is singular")


def die(task: Task) -> Outcome:
    os._exit(9)
