"""Contact without adhesion against an FFT solver on equal footing: separations, and areas extrapolated from grids.

Two comparisons: with figures recorded from such a solver for the paper's profile (seed 2009, 1000 harmonics), which
needs nothing, and with the solver itself, which needs the extra `peers` and is not run without it.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import bem
from bem.scene.result import State
from bem.scene.scene import Scene
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, semilogy, trace
from validation.harness.rows import compared
from validation.harness.schema import Figure, Reference, Table
from validation.references import adapters
from validation.references.fft_solver import Extrapolated, GridContact, extrapolated, grid_contact, missing

SEED = 2009
SHARES = (0.005, 0.01, 0.02)  # of E*
RECORDED_SEPARATION = (38.27e-6, 24.79e-6, 12.94e-6)  # m, to the last digit
RECORDED_AREA = (0.0415, 0.0797, 0.1533)  # on the finest grid, still falling
POINTS = {100: (4096, 8192, 16384), 1000: (16384, 32768, 65536)}
MEASURED_RECORDED = (3.7e-9, 0.0066)
MEASURED = {100: (2.4e-7, 2.6e-3), 1000: (1.3e-7, 1.9e-3)}


def _posed(harmonics: int) -> Scene:
    """The scene: the paper's profile, no adhesion, the pressures as targets."""
    base = adapters.scene("paper_profile")
    modulus = base.solid.youngs_modulus / (1 - base.solid.poisson_ratio**2)
    pressures = [share * modulus for share in SHARES]
    changes: dict[str, Any] = {
        "adhesion": None,
        "profile": {"seed": SEED, "harmonics": harmonics},
        "loading": {
            "control": "mean_pressure",
            "targets": pressures,
            "at_mean_pressures": None,
            "stop_at_mean_pressure": None,
        },
    }
    return adapters.scene("paper_profile", changes)


def _recorded() -> Outcome:
    posed = _posed(1000)
    states = bem.solve(posed).targets
    recorded = Reference(kind="independent code", source="FFT solver, figures recorded for seed 2009", uncertainty=0.0)
    rows = (
        compared("separation at 0.005, 0.01 and 0.02 E*, over the rms height", "m", recorded, RECORDED_SEPARATION,
                 [state.separation for state in states], 2e-4, MEASURED_RECORDED[0] / 50e-6, "maximum over states",
                 posed.surface().rms_height, basis="required"),
        compared("contact fraction over that of the grid, which counts too much: ratio", "", recorded,
                 [1.0] * len(states),
                 [state.contact_fraction / area for state, area in zip(states, RECORDED_AREA, strict=True)], 0.015,
                 MEASURED_RECORDED[1], "maximum over states", 1.0),
    )  # fmt: skip
    table = Table(
        caption="Paper's profile without adhesion, seed 2009, and figures recorded from an FFT solver.",
        columns=["pressure / E*", "separation / um", "recorded", "contact fraction", "recorded, still falling"],
        rows=[
            [share, round(state.separation * 1e6, 5), at * 1e6, round(state.contact_fraction, 7), area]
            for share, state, at, area in zip(SHARES, states, RECORDED_SEPARATION, RECORDED_AREA, strict=True)
        ],
    )
    return Outcome(rows=rows, tables=(table,), counts={"unknowns": max(state.unknowns for state in states)})


def _peer(harmonics: int) -> Outcome:
    reason = missing()
    if reason:
        return Outcome(skipped=reason)
    posed = _posed(harmonics)
    states = bem.solve(posed).targets
    grids = [
        [grid_contact(posed, pressure, points) for points in POINTS[harmonics]] for pressure in posed.loading.targets
    ]
    limits = [extrapolated(sequence) for sequence in grids]
    rms = posed.surface().rms_height
    measured_separation, measured_area = MEASURED[harmonics]
    rows = (
        compared("separation at 0.005, 0.01 and 0.02 E*, over the rms height", "m",
                 Reference(kind="independent code", source=f"ContactMechanics, {POINTS[harmonics][-1]} points",
                           uncertainty=max(limit.separation_error for limit in limits)),
                 [limit.separation for limit in limits],
                 [state.separation for state in states], 2.5 * measured_separation, measured_separation,
                 "maximum over states", rms),
        compared("contact fraction over that of the grids extrapolated: ratio", "",
                 Reference(kind="independent code",
                           source=f"ContactMechanics, from {POINTS[harmonics][-2]} and {POINTS[harmonics][-1]} points",
                           uncertainty=max(one.contact_fraction_error / one.contact_fraction for one in limits)),
                 [1.0] * len(states),
                 [s.contact_fraction / limit.contact_fraction for s, limit in zip(states, limits, strict=True)],
                 2.5 * measured_area, measured_area, "maximum over states", 1.0),
    )  # fmt: skip
    table = Table(caption="Contact fraction on grids, their extrapolation, and ours.",
                  columns=["pressure / E*", *(f"{n} points" for n in POINTS[harmonics]), "extrapolated", "bem"],
                  rows=[[share, *(round(grid.contact_fraction, 6) for grid in sequence),
                         round(limit.contact_fraction, 6), round(state.contact_fraction, 6)]
                        for share, sequence, limit, state
                        in zip(SHARES, grids, limits, states, strict=True)])  # fmt: skip
    figures = (
        _figure(harmonics, states, [limit.separation for limit in limits], posed),
        _areas(harmonics, states, grids, limits),
    )
    return Outcome(rows=rows, figures=figures, tables=(table,), counts={"patches": states[-1].n_patches})


def _areas(
    harmonics: int, states: tuple[State, ...], grids: list[list[GridContact]], limits: list[Extrapolated]
) -> Figure:
    """Contact fractions on grids over ours against the spacing, which reach the extrapolation at zero."""
    series, ratios = [], []
    for share, state, sequence, limit in zip(SHARES, states, grids, limits, strict=True):
        spacing = [1 / grid.points for grid in sequence]
        found = [grid.contact_fraction / state.contact_fraction for grid in sequence]
        end = limit.contact_fraction / state.contact_fraction
        series.append(marks(f"{share:g} E*, grids", spacing, found))
        series.append(trace(f"{share:g} E*, extrapolated", [0.0, spacing[-2]], [end, found[-2]], "dashed"))
        ratios.append(end - 1)
    return drawn(
        f"fft-peer-area-{harmonics}",
        f"Contact fraction of an FFT solver over that of the boundary elements, {harmonics} harmonics: a grid "
        "counts whole points, and its area falls to the extrapolation with the spacing.",
        axes("spacing / period", "contact fraction, FFT over bem", *series),
        axes("pressure / E*", "extrapolated - 1", marks("extrapolated", SHARES, ratios)),
    )


def _figure(harmonics: int, states: tuple[State, ...], separations: list[float], posed: Scene) -> Figure:
    """Pressure against separation, ours on a finer curve, theirs as points, and the difference in separation."""
    modulus = posed.solid.youngs_modulus / (1 - posed.solid.poisson_ratio**2)
    curve_pressures = (np.geomspace(SHARES[0] / 2, SHARES[-1] * 1.2, 12) * modulus).tolist()
    loading: dict[str, Any] = {"control": "mean_pressure", "targets": curve_pressures}
    changes: dict[str, Any] = {
        "adhesion": None,
        "profile": {"seed": SEED, "harmonics": harmonics},
        "loading": {**loading, "at_mean_pressures": None, "stop_at_mean_pressure": None},
    }
    curve = bem.solve(adapters.scene("paper_profile", changes)).targets
    at = [separation * 1e6 for separation in separations]
    return drawn(f"fft-peer-{harmonics}",
                 f"Pressure against separation without adhesion, {harmonics} harmonics, against an FFT solver.",
                 semilogy("separation / um", "mean pressure / E*",
                          trace("bem", [state.separation * 1e6 for state in curve],
                                [state.mean_pressure / modulus for state in curve]),
                          marks("ContactMechanics", at, SHARES)),
                 axes("separation / um", "difference / um",
                      marks("bem less FFT", at, [state.separation * 1e6 - value
                            for state, value in zip(states, at, strict=True)])))  # fmt: skip


EQUATIONS = r"$p \ge 0$, $g \ge 0$, $p g = 0$ with the gap $g$; $s$ = mean gap; $A_{\text{grid}}(n) = A + O(1/n)$"

CASES = (
    Case(id="fft-recorded", group="peers", level="standard",
         question="Does the paper's profile without adhesion give separations and areas recorded from an FFT solver?",
         equations=EQUATIONS,
         sources=("carbone2009",), compute=_recorded, effects=("half_space", "load_control")),
    Case(id="fft-peer", group="peers", level="standard",
         question="Does an FFT solver find the same separations, and the same areas once extrapolated from its grids?",
         equations=EQUATIONS,
         sources=("carbone2009",), compute=partial(_peer, 100), effects=("half_space", "load_control")),
    Case(id="fft-peer-paper", group="peers", level="full",
         question="The same with all 1000 harmonics of the paper's profile.",
         equations=EQUATIONS,
         sources=("carbone2009",), compute=partial(_peer, 1000), effects=("half_space", "load_control")),
)  # fmt: skip
