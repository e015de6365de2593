"""Contact without adhesion against an FFT solver: separations, and areas extrapolated from its grids.

The paper's profile (H = 0.7, h_rms = 50 um, period 10 mm, E = 1 MPa, nu = 0.5, seed 2009) with 100 or 1000 harmonics
at 0.005, 0.01 and 0.02 E*.  ContactMechanics (Polonsky and Keer, Wear 231 (1999) 206) counts contact to whole points,
so that its area is too large by about a point a patch: compared is 2 A(2n) - A(n) of the two finest grids.  An edge
lies anywhere between two points, so that 2 P edges leave U = 2 sqrt(8) sqrt(2 P / 12) / n (k = 2).  Where the extra
`peers` is not installed, grids stored in corpus/fft_grids.json are taken, which `python -m
validation.cases.test_fft_grids` wrote with the solver's version.
"""

import json
from dataclasses import asdict
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from validation.plugin.rows import Code, Quantity
from validation.references.fft_solver import PACKAGES, GridContact, extrapolated, grid_contact
from validation.routes.scenes import estimates, posed, problem_of, solved, values

SEED, SHARES, MODULUS = 2009, np.array([0.005, 0.01, 0.02]), 1e6 / (1 - 0.5**2)
POINTS = {100: (4096, 8192, 16384), 1000: (16384, 32768, 65536)}
STORED = Path(__file__).parents[1] / "corpus/fft_grids.json"


def tables(harmonics):
    """Return the changes of the scene paper_profile: no adhesion, given loads."""
    loading = {"control": "mean_pressure", "targets": (SHARES * MODULUS).tolist(), "at_mean_pressures": None,
               "stop_at_mean_pressure": None}
    return {"adhesion": None, "profile": {"seed": SEED, "harmonics": harmonics}, "loading": loading}


def asked(harmonics):
    """Return the problem of stored grids."""
    return {"seed": SEED, "harmonics": harmonics, "loads / E*": SHARES.tolist(), "points": list(POINTS[harmonics])}


def computed(harmonics):
    """Return grids at every load by the solver."""
    problem = problem_of(posed("paper_profile", **tables(harmonics)), "the solver on a grid")
    return [[grid_contact(problem, share * MODULUS, count) for count in POINTS[harmonics]] for share in SHARES]


def stored(harmonics):
    """Return stored grids at every load, and their origin; LookupError where they are of another problem."""
    content = json.loads(STORED.read_text("utf-8"))
    for problem in content["problems"]:
        if asked(harmonics).items() <= problem.items():
            origin = ", ".join(f"{name} {version}" for name, version in content["solver"].items())
            return [[GridContact(**grid) for grid in grids] for grids in problem["grids"]], f"stored: {origin}"
    raise LookupError(f"{STORED.name} holds no grids of {asked(harmonics)}")


@pytest.mark.parametrize("harmonics", [pytest.param(100, marks=pytest.mark.standard),
                                       pytest.param(1000, marks=pytest.mark.full)])
def test_extrapolated_grids(rows, harmonics):
    """Does an FFT solver find the same separations, and the same areas once extrapolated from its grids?"""
    states = solved("paper_profile", **tables(harmonics)).targets
    grids, origin = (computed(harmonics), "this run") if all(map(find_spec, PACKAGES)) else stored(harmonics)
    changes = [abs(sequence[-1].separation - sequence[-2].separation) for sequence in grids]
    fft = rows.between(Code.BEM, Code.GRID, f"ContactMechanics, {POINTS[harmonics][-1]} points ({origin})")
    # the change of a separation by one level falls to zero by chance: the largest counts
    fft.compare("separation", values(states, "separation"), [sequence[-1].separation for sequence in grids],
                quantity=Quantity.LENGTH, unit="m", uncertainty=(estimates(states, "separation"), max(changes)))
    lattice = 2 * np.sqrt(8) * np.sqrt(values(states, "n_patches") / 6) / POINTS[harmonics][-1]
    fft.compare("contact fraction", values(states, "contact_fraction"), [*map(extrapolated, grids)],
                quantity=Quantity.AREA, uncertainty=(estimates(states, "contact_fraction"), lattice))
    rows.curves("Contact fraction on grids over that of boundary elements", "spacing / period", "ratio",
                {f"{share:g} E*": ([1 / grid.points for grid in sequence],
                                   values(sequence, "contact_fraction") / state.contact_fraction)
                 for share, sequence, state in zip(SHARES, grids, states, strict=True)})


def record():
    """Store the grids of all problems, where the solver is installed."""
    versions = {name: metadata.version(name) for name in PACKAGES}
    problems = [asked(harmonics) | {"grids": [[asdict(grid) for grid in grids] for grids in computed(harmonics)]}
                for harmonics in POINTS]
    STORED.write_text(json.dumps({"solver": versions, "problems": problems}, indent=1), "utf-8")


if __name__ == "__main__":
    record()
