"""A catalogue of faults and cases of its own, importable by worker processes."""

import os
from functools import cached_property, lru_cache
from functools import partial as bound

import example_cases

from validation.harness.case import Outcome
from validation.harness.schema import Reference, Row, Tolerance
from validation.studies.faults.fault_injection import Fault


def right(x):
    return x


def never():
    return 0.0


@lru_cache
def table(n):
    return 2.0 * n


FUNCTIONS = {"right": right}


class Thing:
    value = 3.0

    @property
    def size(self):
        return self.value

    @cached_property
    def kept(self):
        return self.value

    @classmethod
    def made(cls, value):
        return value

    def method(self):
        return self.value


def off(original, size):
    return lambda *given: original(*given) + size


def crash(original, size):
    def wrong(*given):
        raise ZeroDivisionError("a fault divides by zero")

    return wrong


def die(original, size):
    def wrong(*given):
        os._exit(9)

    return wrong


def blank(original, size):
    return lambda *given: None


def compared(expected, *computed, tolerance=1e-3):
    row = Row(
        quantity="answer",
        unit="",
        reference=Reference(kind="exact", source="by hand"),
        norm="absolute",
        expected=[expected] * len(computed),
        computed=list(computed),
        tolerance=Tolerance(value=tolerance, measured=0.0),
    )
    return Outcome(rows=(row,))


def use_function():
    return compared(1.0, right(1.0))


def use_function_loosely():
    return compared(1.0, right(1.0), tolerance=0.3)


def use_table():
    return compared(4.0, table(2))


def red():
    return compared(1.0, 2.0)


CATALOGUE = (
    Fault("off", "one too many", "example_faults:right", off, "one"),
    Fault("crash", "crashes", "example_faults:right", crash),
    Fault("blank", "no number", "example_faults:right", blank),
    Fault("die", "ends the process", "example_faults:table", die),
    Fault("never", "is not called", "example_faults:never", off),
)
QUICK = ("off",)

case = bound(example_cases.case, sources=("s",))
CASES = (
    case("uses-function", use_function),
    case("uses-function-loosely", use_function_loosely),
    case("uses-table", use_table),
)
