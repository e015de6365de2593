"""Measurements for the cost study that converge, fail or die at once; importable by worker processes."""

import os

from validation.studies.cost import Cost, PaperRun
from validation.studies.cost_breakdown import Breakdown, Evaluated


def converge(task: PaperRun) -> Cost:
    return Cost(
        **vars(task),
        status="converged",
        wall_seconds=2.0,
        cpu_seconds=1e-6 * task.harmonics**2,
        peak_megabytes=100.0,
        unknowns=task.harmonics,
        patches=7,
        evaluations=5,
        states=3,
        worst_closure=1e-10,
        contact_fractions=(0.1, 0.2),
        separations=(3e-5, 2e-5 * (1 + 1e-8 * task.increment)),
        loads_asked_for=2,
    )


def crash(task: PaperRun) -> Cost:
    if task.seed == 1:
        raise ZeroDivisionError("the matrix is singular")
    return converge(task)


def die(task: PaperRun) -> Cost:
    if task.seed == 1:
        os._exit(9)
    return converge(task)


def apart(harmonics: int) -> Breakdown:
    stages = {"factorisation": 1e-6 * harmonics**3, "gap search": 5e-3 * harmonics}
    evaluated = tuple(Evaluated(n, 30 * n, 1e-6 * n**2, 1e-3 * n**2) for n in (8, 16, 32))
    few = Evaluated(2, 60, 1.0, 10.0)  # overhead rules
    return Breakdown(harmonics, "converged", stages, {"factorisation": 3}, (few, *evaluated))


def never_apart(harmonics: int) -> Breakdown:
    raise ZeroDivisionError("no stages")


def crash_without_adhesion(task: PaperRun) -> Cost:
    if task.load is not None:
        raise ZeroDivisionError("the grid")
    return converge(task)
