"""Methods and references for the tests of the work-precision study; importable by name, they run in processes."""

import time

from validation.harness.route import Answer
from validation.studies.work_precision.methods import Method
from validation.studies.work_precision.references import Source, Yardstick

TRUE = {"contact_fraction": 0.5, "mean_pressure": 1000.0, "elastic_energy": 0.1}


def off_by(posed, error):
    """Contact fraction wrong by `error`, slower the better; 0.25 fails."""
    if error == 0.25:
        raise ArithmeticError("the matrix is singular")
    begun = time.process_time()
    while time.process_time() - begun < (0.002 if error > 1e-6 else 0.03):
        pass
    values = {name: [value] for name, value in (TRUE | {"contact_fraction": 0.5 + error}).items()}
    return Answer(values=values, unknowns=round(1 / error), counts={"evaluations": 3})


def never(posed, setting):
    raise ArithmeticError("no equilibrium")


def truth(posed):
    return Yardstick("manufactured", "made so", TRUE, dict.fromkeys(TRUE, 1e-9))


def lost(posed):
    raise ArithmeticError("reference not converged")


def method(name="halving", solve=off_by, settings=(0.1, 0.25, 1e-4, 1e-12), scenes=("sinusoid",), code="halving"):
    return Method(name, code, "error", "nothing", settings, solve, scenes, {"theory": "it is no theory"})


TRUTH = {"sinusoid": (Source("truth", "truth", truth),), "theory": (Source("truth", "truth", truth),)}
LOST = {"sinusoid": (Source("lost", "lost", lost),), "theory": (Source("lost", "lost", lost),)}
