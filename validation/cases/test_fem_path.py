"""Paths on a layer by both codes, each from first touch on by itself: targets, jumps and the area of the hysteresis.

Ten random profiles (self-affine, H = 0.5, h_rms = 50 um, period 10 mm, 3 to 8 waves, seed = number of the scene) on a
layer of 1 mm (nu = 0.48, total displacement prescribed) or 5 mm (nu = 0.3, penetration prescribed), E = 1 MPa, are
pressed and pulled off; two of three have w = 0.02 J/m^2. One of twenty waves on the thin layer is under three loads.

The finite elements get the scene alone: `fem_reference.path` finds number and edges of the patches and its jumps on a
coarse mesh, `solve` closes each target from there, `jumps` locates each jump, both on three meshes. Jumps are compared
in their order. Changes at one value of the control are one jump (of the boundary elements: events at one penetration).
Without adhesion the boundary elements list no events but first touch: there is no jump. A target is on another branch
where status or number of patches differ: it is counted, its numbers are not compared, and a table states the branch of
each code and the first jump that the two do not share.

U is a statement of 95 % (test_fem_calibration.py): of some 300 numbers fifteen may be beyond it, and a table counts
them. A number fails beyond twice the combined U.
"""

from dataclasses import dataclass
from itertools import groupby

import numpy as np
import pytest

import bem
from bem.scene.result import Event
from bem.scene.result import Result as Solved
from fem_reference import Resolution, Result, solve
from fem_reference.jumps import LocatedJump, locate
from fem_reference.path import Path
from validation.cases.bem_beside_fem import compare_codes
from validation.plugin.rows import Code, Quantity
from validation.routes.fem_scenes import fem_arguments, follow_fem, uncertain

PERIOD, HEIGHT, TOLERANCE, ELEMENTS = 0.01, 50e-6, 1e-9, Resolution(2, 10, 10)
OF_JUMPS = 0.1  # of all energies released: the ceiling of U of one, beyond which it is not established
AT_TARGETS = Resolution(2, 15, 10)  # ten cells leave U of an energy above a hundredth
TARGETS = np.array([0.3, 0.7, 0.2, -1.0])  # of h_max, 1.6 times as much on the thin layer; the last one is apart
LOADS = [3e3, 1e4, 2e4]  # Pa, of twenty waves
QUANTITIES = {"contact_fraction": (Quantity.AREA, ""), "penetration": (Quantity.LENGTH, "m"),
              "mean_pressure": (Quantity.PRESSURE, "Pa"), "total_energy": (Quantity.ENERGY, "J/m^2")}


def scene(k, waves=None):
    """Return scene k of ten, or one of more waves under loads."""
    rough = waves is not None
    thin = k % 2 == 1 or rough
    waves = waves or 3 + k % 6
    highest = bem.Profile.self_affine(PERIOD, 0.5, HEIGHT, waves, k).max_height
    tables = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.48 if thin else 0.3},
        "profile": {"kind": "self_affine", "period": PERIOD, "hurst": 0.5, "rms_height": HEIGHT,
                    "harmonics": waves, "seed": k},
        "layer": {"thickness": 1e-3 if thin else 5e-3},
        "accuracy": {"tolerance": TOLERANCE},
        "loading": {"control": "total_displacement" if thin else "penetration",
                    "targets": (TARGETS * highest * (1.6 if thin else 1.0)).tolist()},
    }
    if rough:
        tables["loading"] = {"control": "mean_pressure", "targets": LOADS}
    if k % 3 != 2:
        tables["adhesion"] = {"work_of_adhesion": 0.02, "slope_term": True}
    return bem.parse_scene(tables)


@dataclass(frozen=True)
class Both:
    """A scene by both codes: control, result, path, closed targets (None apart), and jumps in pairs."""

    control: str
    bem: Solved
    path: Path
    targets: list[Result | None]
    events: list[list[Event]]
    jumps: list[LocatedJump]


def both_codes(posed):
    """Solve a scene by both codes."""
    problem, path, unit = follow_fem(posed)
    arguments = fem_arguments(posed)
    kind = arguments["control"]
    targets = [solve(**arguments | {"value": float(value)}, start=target.edges * PERIOD, resolution=AT_TARGETS)
               if target.status == "converged" else None
               for value, target in zip(posed.loading.targets, path.targets, strict=True)]
    result = bem.solve(posed)
    events = [list(group) for _, group in groupby(result.events, lambda event: event.penetration)]
    adhesive = posed.adhesion is not None
    jumps = [locate(problem, kind, jump, unit, ELEMENTS) for jump in path.jumps] if adhesive else []
    return Both(kind, result, path, targets, events, jumps)


def compare(rows, name, ours, theirs, uncertainty, quantity, unit, scale=None, **options):
    """Add a row, and return its difference over the combined U.

    A difference has the scale of what it is made of: a total energy that of its parts, an energy released in a jump
    that of all jumps.
    """
    return compare_codes(rows, name, ours, theirs, uncertainty, scale or abs(theirs), quantity=quantity, unit=unit,
                         source="P2/P1, path of its own", **options)


def compare_targets(rows, both, label):
    """Add rows for the numbers of targets on one branch; return targets on another branch, and shares of U."""
    elsewhere, shares = [], []
    for k, (state, target, fem) in enumerate(zip(both.bem.targets, both.path.targets, both.targets, strict=True)):
        if (state.status, state.n_patches) != (target.status, len(target.edges)):
            elsewhere.append(k)
            continue
        if fem is None:
            continue
        assert fem.status == "converged", fem.message
        for name, (quantity, unit) in QUANTITIES.items():
            if name == both.control:
                continue
            share = PERIOD if name == "total_energy" else 1.0
            theirs, u_fem = getattr(fem, name) / share, uncertain(fem, name) / share
            own = getattr(state.error_estimate, name)
            elastic = fem.elastic_energy / PERIOD
            parts = abs(elastic) + abs(theirs - elastic) if name == "total_energy" else None
            shares.append(compare(rows, f"{label}, target {k + 1}: {name.replace('_', ' ')}", getattr(state, name),
                                  theirs, (own, u_fem), quantity, unit, parts))
    return elsewhere, shares


def compare_jumps(rows, both, label):
    """Add rows for jumps of an adhesive path and its hysteresis; return the first jump not shared, and shares of U.

    Energies released of which finite elements establish nothing are listed and counted, not compared.
    """
    shares, shared, unknown = [], 0, []
    areas = [jump.values["energy_released"] / PERIOD for jump in both.jumps if "energy_released" in jump.values]
    for k, (events, jump, at) in enumerate(zip(both.events, both.path.jumps, both.jumps, strict=False)):
        kinds = sorted(event.kind for event in events)
        if kinds != sorted(change.kind for change in jump.changes):
            break
        shared += 1
        name, event = f"{label}, jump {k + 1}, {kinds[0].replace('_', ' ')}", events[0]
        if k:  # first touch is at zero by definition
            for key in ("penetration", "mean_pressure"):
                quantity, unit = QUANTITIES[key]
                own = getattr(event.error_estimate, key)
                shares.append(compare(rows, f"{name}: {key.replace('_', ' ')}", getattr(event, key), at.values[key],
                                      (own, at.uncertainty[key]), quantity, unit))
        if "energy_released" in at.values and event.energy_released is not None:
            released = sum(each.energy_released for each in events)
            own = sum(each.error_estimate.energy_released or 0.0 for each in events)
            theirs, spread = at.values["energy_released"] / PERIOD, at.uncertainty["energy_released"] / PERIOD
            share = compare(rows, f"{name}: energy released", released, theirs, (own, spread), Quantity.ENERGY, "J/m^2",
                            sum(areas), ceiling=OF_JUMPS, unknown=unknown)
            shares += [] if share is None else [share]
    if unknown:  # where there were none, this row has no stored number and fails
        rows.count(f"{label}: energies released that are not established", len(unknown), within=0.0, of=Code.FEM)
        rows.table(f"Energies released in jumps of {label} that finite elements do not establish, J/m^2",
                   ["jump", "boundary elements", "finite elements", "U of both"], unknown)
    if shared == len(both.events) == len(both.jumps) and both.path.targets[-1].status == "separated":
        spread = [jump.uncertainty["energy_released"] / PERIOD for jump in both.jumps]
        every = [event for events in both.events for event in events]
        released = sum(event.energy_released for event in every)
        own = sum(event.error_estimate.energy_released or 0.0 for event in every)
        shares.append(compare(rows, f"{label}: area of the hysteresis", released, sum(areas), (own, sum(spread)),
                              Quantity.ENERGY, "J/m^2", ceiling=OF_JUMPS))
    return None if shared == len(both.events) == len(both.jumps) else shared, shares


def described(code):
    """Return kinds and penetrations, um, of the jumps of a code in a line."""
    return ", ".join(f"{kind.replace('_', ' ')} {1e6 * penetration:.4g}" for kind, penetration in code)


def judge(rows, posed, label):
    """Compare a scene by both codes; count targets on another branch, and state the branch of each code there."""
    both, parted = both_codes(posed), None
    elsewhere, shares = compare_targets(rows, both, label)
    if posed.adhesion is not None:
        parted, of_jumps = compare_jumps(rows, both, label)
        shares += of_jumps
    rows.table(f"Numbers of {label} within U", ["numbers", "within U", "largest error over U", "median"],
               [[len(shares), sum(share <= 1 for share in shares), max(shares), float(np.median(shares))]])
    rows.compare(f"{label}: targets on one branch", len(both.targets) - len(elsewhere), len(both.targets), of=Code.BEM,
                 by=Code.FEM, quantity=Quantity.COUNT, kind="construction", required=0.5, because="a count")
    codes = {"boundary elements": [(event.kind, event.penetration) for event in both.bem.events],
             "finite elements": [(change.kind, at.values["penetration"])
                                 for jump, at in zip(both.path.jumps, both.jumps, strict=False)
                                 for change in jump.changes]}
    reason = "all jumps are shared" if parted is None else f"jump {parted + 1} is the first that is not shared"
    rows.table(f"Jumps of {label}, penetration in um: {reason}", ["code", "jumps"],
               [[code, described(jumps)] for code, jumps in codes.items()])
    if elsewhere:
        rows.table(f"Branches of {label} where the codes differ", ["target", "boundary elements", "finite elements"],
                   [[k + 1, f"{both.bem.targets[k].status}, {both.bem.targets[k].n_patches} patches",
                     f"{both.path.targets[k].status}, {len(both.path.targets[k].edges)} patches"] for k in elsewhere])


@pytest.mark.parametrize("k", [pytest.param(k, marks=pytest.mark.standard if k in (2, 6) else pytest.mark.full)
                               for k in range(10)])
def test_random_path(rows, k):
    """Do both codes follow a random profile through the same jumps, and end in the same states?"""
    judge(rows, scene(k), f"scene {k}")


@pytest.mark.full
def test_twenty_waves_under_loads(rows):
    """Do both codes find the same contacts of twenty adhesive waves under three loads, along paths of their own?"""
    judge(rows, scene(0, waves=20), "twenty waves")
