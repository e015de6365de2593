"""Contact without adhesion against an FFT solver on equal footing: separations, and areas extrapolated from grids.

Two comparisons: with figures recorded from such a solver for the paper's profile (seed 2009, 1000 harmonics), and with
the solver itself. Where the extra `peers` is not installed, its grids are those of corpus/fft_grids.json, which
`record` wrote where it was, with its version, the date and the problem.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

import bem
from bem.scene.scene import Scene
from validation.cases.shared.checks import OVER_STATES, Against, Found, case, column, posed
from validation.harness.figure_data import axes, drawn, marks, semilogy, table, trace
from validation.harness.provenance import provenance
from validation.harness.store import write_json
from validation.references.fft_solver import PACKAGES, GridContact, extrapolated, grid_contact, missing

SEED = 2009
MODULUS = 1e6 / (1 - 0.5**2)
SHARES = (0.005, 0.01, 0.02)  # of E*
RECORDED_SEPARATION = (38.27e-6, 24.79e-6, 12.94e-6)  # m, to the last digit
RECORDED_AREA = (0.0415, 0.0797, 0.1533)  # on the finest grid, still falling
POINTS = {100: (4096, 8192, 16384), 1000: (16384, 32768, 65536)}
STORED = Path(__file__).parents[2] / "corpus/fft_grids.json"
MEASURED = {100: (2.4e-7, 2.6e-3), 1000: (1.3e-7, 1.9e-3)}  # separation, ratio of areas


def _posed(harmonics: int, pressures: list[float]) -> Scene:
    """The paper's profile, no adhesion, pressures in Pa as targets."""
    loading = {"control": "mean_pressure", "targets": pressures, "at_mean_pressures": None,
               "stop_at_mean_pressure": None}  # fmt: skip
    return posed("paper_profile", adhesion=None, profile={"seed": SEED, "harmonics": harmonics}, loading=loading)


def _recorded() -> Found:
    scene = _posed(1000, [share * MODULUS for share in SHARES])
    states = bem.solve(scene).targets
    recorded = Against("independent code", "FFT solver, figures recorded for seed 2009")
    yield recorded.row("separation at 0.005, 0.01 and 0.02 E*, over the rms height", "m", RECORDED_SEPARATION,
                       column(states, "separation"), 3.7e-9 / 50e-6, OVER_STATES, scene.surface().rms_height,
                       required=2e-4)  # fmt: skip
    yield recorded.row("contact fraction over that of the grid, which counts too much: ratio", "", [1.0] * len(states),
                       np.divide(column(states, "contact_fraction"), RECORDED_AREA), (0.015, 0.0066), OVER_STATES,
                       1.0)  # fmt: skip
    yield table("Paper's profile without adhesion, seed 2009, and figures recorded from an FFT solver.",
                {"pressure / E*": SHARES, "separation / um": [round(state.separation * 1e6, 5) for state in states],
                 "recorded": [at * 1e6 for at in RECORDED_SEPARATION],
                 "contact fraction": [round(state.contact_fraction, 7) for state in states],
                 "recorded, still falling": RECORDED_AREA})  # fmt: skip
    yield {"unknowns": max(state.unknowns for state in states)}


def _asked(harmonics: int) -> dict[str, Any]:
    """The problem of stored grids."""
    return {"seed": SEED, "harmonics": harmonics, "loads / E*": list(SHARES), "points": list(POINTS[harmonics])}


def _solved(harmonics: int) -> list[list[GridContact]]:
    """Grids at every pressure, by the peer."""
    scene = _posed(harmonics, [share * MODULUS for share in SHARES])
    return [[grid_contact(scene, share * MODULUS, count) for count in POINTS[harmonics]] for share in SHARES]


def record() -> None:
    """Store the grids of all problems, where the peer is installed."""
    versions, facts = {name: metadata.version(name) for name in PACKAGES}, provenance()
    made = [_asked(harmonics) | {"grids": [[asdict(grid) for grid in one] for one in _solved(harmonics)]}
            for harmonics in POINTS]  # fmt: skip
    known = {name: facts[name] for name in ("date", "commit", "python", "numpy")}
    write_json(STORED, {"solver": versions, **known, "problems": made})


def stored(harmonics: int) -> tuple[list[list[GridContact]], str]:
    """Grids at every pressure as stored, and where they are from; LookupError where they are of another problem."""
    content = json.loads(STORED.read_text("utf-8"))
    for problem in content["problems"]:
        if _asked(harmonics).items() <= problem.items():
            made = ", ".join(f"{name} {version}" for name, version in content["solver"].items())
            grids = [[GridContact(**grid) for grid in one] for one in problem["grids"]]
            return grids, f" (stored: {made}, {content['date'][:10]})"
    raise LookupError(f"{STORED.name} holds no grids of {_asked(harmonics)}")


def _peer(harmonics: int) -> Found:
    pressures = [share * MODULUS for share in SHARES]
    scene = _posed(harmonics, pressures)
    states = bem.solve(scene).targets
    points = POINTS[harmonics]
    grids, whence = stored(harmonics) if missing() else (_solved(harmonics), "")
    limits = [extrapolated(sequence) for sequence in grids]
    of_separation, of_area = MEASURED[harmonics]
    finest = Against("independent code", f"ContactMechanics, {points[-1]} points{whence}",
                     max(limit.separation_error for limit in limits))  # fmt: skip
    both = Against("independent code", f"ContactMechanics, from {points[-2]} and {points[-1]} points{whence}",
                   max(limit.contact_fraction_error / limit.contact_fraction for limit in limits))  # fmt: skip
    yield finest.row("separation at 0.005, 0.01 and 0.02 E*, over the rms height", "m", column(limits, "separation"),
                     column(states, "separation"), of_separation, OVER_STATES, scene.surface().rms_height)  # fmt: skip
    yield both.row("contact fraction over that of the grids extrapolated: ratio", "", [1.0] * len(states),
                   np.divide(column(states, "contact_fraction"), column(limits, "contact_fraction")), of_area,
                   OVER_STATES, 1.0)  # fmt: skip
    shown: dict[str, Sequence[Any]] = {
        f"{n} points": [sequence[place] for sequence in grids] for place, n in enumerate(points)
    }
    shown |= {"extrapolated": limits, "bem": states}
    yield table("Contact fraction on grids, their extrapolation, and ours.",
                {"pressure / E*": SHARES} | {name: [round(one.contact_fraction, 6) for one in found]
                                             for name, found in shown.items()})  # fmt: skip
    along = (np.geomspace(SHARES[0] / 2, SHARES[-1] * 1.2, 12) * MODULUS).tolist()
    curve, at = bem.solve(_posed(harmonics, along)).targets, column(limits, "separation", 1e-6)
    yield drawn(f"fft-peer-{harmonics}",
                f"Pressure against separation without adhesion, {harmonics} harmonics, against an FFT solver.",
                semilogy("separation / um", "mean pressure / E*",
                         trace("bem", column(curve, "separation", 1e-6), column(curve, "mean_pressure", MODULUS)),
                         marks("ContactMechanics", at, SHARES)),
                axes("separation / um", "difference / um",
                     marks("bem less FFT", at, np.subtract(column(states, "separation", 1e-6), at))))  # fmt: skip
    series, ratios = [], []
    for share, state, sequence, limit in zip(SHARES, states, grids, limits, strict=True):
        spacing = [1 / grid.points for grid in sequence]
        found, end = (column(of, "contact_fraction", state.contact_fraction) for of in (sequence, [limit]))
        series += [marks(f"{share:g} E*, grids", spacing, found),
                   trace(f"{share:g} E*, extrapolated", [0.0, spacing[-2]], [*end, found[-2]], "dashed")]  # fmt: skip
        ratios.append(end[0] - 1)
    yield drawn(f"fft-peer-area-{harmonics}",
                f"Contact fraction of an FFT solver over that of the boundary elements, {harmonics} harmonics: a grid "
                "counts whole points, and its area falls to the extrapolation with the spacing.",
                axes("spacing / period", "contact fraction, FFT over bem", *series),
                axes("pressure / E*", "extrapolated - 1", marks("extrapolated", SHARES, ratios)))  # fmt: skip
    yield {"patches": states[-1].n_patches}


EQUATIONS = r"$p \ge 0$, $g \ge 0$, $p g = 0$ with the gap $g$; $s$ = mean gap; $A_{\text{grid}}(n) = A + O(1/n)$"
CASES = (
    case("fft-recorded", "peers", _recorded,
         "Does the paper's profile without adhesion give separations and areas recorded from an FFT solver?",
         EQUATIONS, "carbone2009", "half_space load_control", level="standard"),
    case("fft-peer", "peers", partial(_peer, 100),
         "Does an FFT solver find the same separations, and the same areas once extrapolated from its grids?",
         EQUATIONS, "carbone2009", "half_space load_control", level="standard"),
    case("fft-peer-paper", "peers", partial(_peer, 1000),
         "The same with all 1000 harmonics of the paper's profile.",
         EQUATIONS, "carbone2009", "half_space load_control", level="full"),
)  # fmt: skip
