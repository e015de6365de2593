"""Persson's theory for roughness in one direction, as published and corrected for partial contact.

It knows the load, not the path: loading alone, rough profiles on a half-space, and no places.  At a given separation
the load is found at which the theory has it.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from persson import DiscreteSpectrum
from persson import solve as solve_plain
from persson.corrected import solve as solve_corrected

LEAST_LINES = 20
LOWEST, HIGHEST = 1e-4, 2.0  # of E* times the rms slope: where loads are looked for
WITHIN = 1e-4  # of a load


def solve(problem: dict[str, Any], entry: Any) -> dict[str, Any]:
    """Areas, separations or loads, and energies."""
    raw, solid, path = problem["profile"], problem["solid"], problem["path"]
    if "layer" in problem:
        raise NotImplementedError("layers")
    if len(raw["orders"]) < LEAST_LINES:
        raise NotImplementedError("profiles that are not rough")
    lines = DiscreteSpectrum(2 * np.pi / raw["period"] * raw["orders"], raw["amplitudes"])
    work = problem.get("adhesion", {}).get("work_of_adhesion")
    modulus = solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)
    scale = modulus * float(np.sqrt(lines.total_slope_variance))

    def state(pressure: float) -> Any:
        return entry(lines, pressure, **solid, work_of_adhesion=work)

    def load(separation: float) -> float:
        def miss(exponent: float) -> float:
            return float(state(float(np.exp(exponent))).separation) - separation

        ends = np.log([LOWEST * scale, HIGHEST * scale])
        return float(np.exp(brentq(miss, *ends, xtol=WITHIN)))

    targets = path["targets"]
    deepest = int(np.argmax(targets)) if path["control"] == "mean_pressure" else int(np.argmin(targets))
    loading = targets[: deepest + 1]
    loads = loading if path["control"] == "mean_pressure" else [load(float(target)) for target in loading]
    states = [state(float(pressure)) for pressure in loads]
    rest = [None] * (len(targets) - len(loading))
    answers = {
        "contact_fraction": [one.contact_fraction for one in states] + rest,
        "gap_fraction": [1 - one.contact_fraction for one in states] + rest,
        "separation": [one.separation for one in states] + rest,
        "mean_pressure": [one.mean_pressure for one in states] + rest,
        "elastic_energy": [one.elastic_energy for one in states] + rest,
    }
    return {name: value for name, value in answers.items() if name in problem["asked"]}


plain, corrected = partial(solve, entry=solve_plain), partial(solve, entry=solve_corrected)
