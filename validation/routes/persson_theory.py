"""Persson's theory for roughness in one direction, as published.

The theory knows the load, not the path: loading alone, rough profiles on a half-space, and no places.  At a given
separation the route finds the load at which the theory has this separation.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from persson import AdhesiveContact, DiscreteSpectrum
from persson import solve as solve_plain
from persson.adhesive import Route
from validation.harness.route import Answer, Laps, Problem
from validation.references.posed_contacts import highest

LEAST_LINES = 20
LOWEST, HIGHEST = 1e-4, 2.0  # of E* times the rms slope: where loads are looked for
WITHIN = 1e-4  # of a load


def solve(problem: Problem, version: str) -> Answer:
    """Return areas, separations or loads, and energies; the only version is "published"."""
    return solve_by(problem, {"published": solve_plain}[version])


def solve_by(problem: Problem, entry: Any) -> Answer:
    """The same by a function of the theory."""
    if problem.thickness is not None:
        raise NotImplementedError("layers")
    if len(problem.orders) < LEAST_LINES:
        raise NotImplementedError("profiles that are not rough")
    laps = Laps()
    orders, amplitudes, _ = problem.harmonics
    lines = DiscreteSpectrum(2 * np.pi / problem.period * orders, amplitudes)
    modulus = problem.youngs_modulus / (1 - problem.poisson_ratio**2)
    scale = modulus * float(np.sqrt(lines.total_slope_variance))
    laps.end("setup")

    def state(pressure: float) -> Any:
        return entry(
            lines,
            pressure,
            youngs_modulus=problem.youngs_modulus,
            poisson_ratio=problem.poisson_ratio,
            work_of_adhesion=problem.work_of_adhesion,
        )

    def load(separation: float) -> float:
        def miss(exponent: float) -> float:
            return float(state(float(np.exp(exponent))).separation) - separation

        ends = np.log([LOWEST * scale, HIGHEST * scale])
        return float(np.exp(brentq(miss, *ends, xtol=WITHIN)))

    targets, by_load = problem.targets, problem.control == "mean_pressure"
    loading = targets[: int(np.argmax(targets) if by_load else np.argmin(targets)) + 1]
    states = [state(pressure if by_load else load(pressure)) for pressure in loading]
    laps.end("solve")
    if wrong := [one.status for one in states if one.status != "converged"]:
        raise ArithmeticError(wrong[0])
    names = ("contact_fraction", "separation", "mean_pressure", "elastic_energy")
    values = {name: problem.padded(getattr(one, name) for one in states) for name in names}
    values["gap_fraction"] = problem.padded(1 - one.contact_fraction for one in states)
    last, unknowns, counts = states[-1], 0, {}
    if isinstance(last, AdhesiveContact):
        unknowns, counts = last.fields.area.shape[1], {"iterations": last.fields.iterations}
    return Answer(values=problem.answered(values), unknowns=unknowns, counts=counts, parts=laps.parts)


def by_route(name: Route, problem: Problem, resolution: float) -> Answer:
    """By a numerical route of the published theory, `finite_volumes` or `volterra`, without separations."""
    return solve_by(problem, partial(solve_plain, route=name, resolution=resolution, with_separation=False))


def by_separation(problem: Problem, resolution: float) -> Answer:
    """The published theory at separations, or penetrations."""
    if problem.control == "penetration":
        top = highest(problem)
        problem = replace(problem, control="separation", targets=tuple(top - depth for depth in problem.targets))
    return solve_by(problem, partial(solve_plain, route="volterra", resolution=resolution))
