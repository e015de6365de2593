"""Measurements for the study of stability that end at once in every way there is; importable by worker processes."""

import os
import time

from validation.corpus.endings import Trial
from validation.corpus.hard.hard_case_run import TrialOutcome

EXPECTED = ("converged", "converged")


def outcome(observed=EXPECTED, correct=True, refused=None, findings=()):
    return TrialOutcome("flat", EXPECTED, observed, observed == EXPECTED, correct, refused, findings, 0.5)


def converge(task: Trial) -> TrialOutcome:
    return outcome()


def found(task: Trial) -> TrialOutcome:
    """A second scene with two findings, one kind of them twice; the others with none."""
    kinds = ("shift", "shift", "energy balance") if task.id.endswith("_1") else ()
    return TrialOutcome(task.id, EXPECTED, EXPECTED, True, not kinds, None, tuple(kinds), 0.5, kinds)


def die_at_the_second(task: Trial) -> TrialOutcome:
    return die(task) if task.id.endswith("_1") else outcome()


def sleep_at_the_second(task: Trial) -> TrialOutcome:
    while task.id.endswith("_1"):
        time.sleep(0.1)
    return outcome()


def crash(task: Trial) -> TrialOutcome:
    raise ZeroDivisionError("the matrix is singular")


def die(task: Trial) -> TrialOutcome:
    os._exit(9)


def one_dies_one_crashes(task: Trial) -> TrialOutcome:
    """Each code another ending."""
    return {"bem": die, "fem": crash, "persson": converge}[task.code](task)


def one_never_ends(task: Trial) -> TrialOutcome:
    while task.code == "bem":
        time.sleep(0.1)
    return outcome()
