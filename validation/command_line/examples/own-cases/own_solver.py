"""A solver of your own, here Westergaard's closed form: a problem in SI numbers in, numbers or lists of them out.

The problem has the tables and keys of a problem.toml of the challenge (`linecontact challenge list` names the folder).
"""

from math import asin, pi, sqrt
from typing import Any


def solve(problem: dict[str, Any]) -> dict[str, list[float]]:
    """Return the contact fraction at every mean pressure asked for."""
    solid, profile, path = problem["solid"], problem["profile"], problem["path"]
    if {"adhesion", "layer"} & problem.keys() or len(profile["orders"]) > 1 or path["control"] != "mean_pressure":
        raise NotImplementedError("other than one wave under a load, without adhesion, on a half-space")
    modulus = solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)
    complete = pi * modulus * profile["orders"][0] * profile["amplitudes"][0] / profile["period"]
    shares = [pressure / complete for pressure in list(path["targets"])]
    return {"contact_fraction": [2 / pi * asin(sqrt(share)) if share < 1 else 1.0 for share in shares]}
