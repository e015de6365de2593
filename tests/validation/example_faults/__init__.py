"""Sources with faults and cases of their own, importable by worker processes."""

from functools import partial
from pathlib import Path

import example_cases

from example_faults.sources import FUNCTIONS, Thing, right
from validation.harness.case import Outcome
from validation.harness.schema import Reference, Row, Tolerance
from validation.studies.faults.fault_injection import Fault, Studied


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
    return compared(1.0, FUNCTIONS["right"](1.0), tolerance=0.3)


def use_method():
    return compared(4.0, Thing().double(2))


def red():
    return compared(1.0, 2.0)


fault = partial(Fault, what="wrong", file="example_faults/sources.py", before="return x\n", case="uses-function")
FAULTS = (
    fault("off", after="return x + SIZE\n", size="one", quick=True),
    fault("crash", after="return x / 0\n"),
    fault("blank", after="return None\n"),
    fault("die", before="return 2.0 * n", after="__import__('os')._exit(9)", case="uses-method"),
    fault("never", before="return 0.0", after="return 1.0"),
)
STUDIED = Studied(FAULTS, Path(__file__).parents[1], ("example_faults",), ("example_faults",))

case = partial(example_cases.case, sources=("s",))
CASES = (
    case("uses-function", use_function),
    case("uses-function-loosely", use_function_loosely),
    case("uses-method", use_method),
)
