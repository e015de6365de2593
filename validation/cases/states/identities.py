"""Statements that hold for any profile: energy release rate, mean gap and dissipation along a path with events."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import bem
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Reference
from validation.references import adapters

STEP = 2e-4  # of the width of the narrowest patch, in differences of fourth order


def _energy_release() -> Outcome:
    profile = bem.Profile.self_affine(period=0.01, hurst=0.7, rms_height=50e-6, harmonics=60, seed=4)
    solid = bem.Solid(1e6, 0.5)
    x = np.linspace(0, profile.period, 4001)
    height = profile.height(x)
    level = np.quantile(height, 0.75)
    above = height > level
    start, stop = np.flatnonzero(above & ~np.roll(above, 1)), np.flatnonzero(above & ~np.roll(above, -1))
    if stop[0] < start[0]:
        stop = np.roll(stop, -1)
    edges = np.stack([x[start], np.where(x[stop] < x[start], x[stop] + profile.period, x[stop])], axis=1)
    edges = edges[np.argsort(edges[:, 0])]
    penetration = profile.max_height - float(level)
    adhesion = bem.Adhesion(0.03, slope_term=True)

    def state(changed: np.ndarray[tuple[int, int], np.dtype[np.float64]], depth: float) -> bem.ContactState:
        return bem.ContactState(profile, solid, changed, depth, adhesion=adhesion)

    here = state(edges, penetration)
    step = STEP * float(np.min(edges[:, 1] - edges[:, 0]))
    difference, curvature = [], []
    for index in range(edges.size):
        moved = np.zeros(edges.size)
        moved[index] = step
        near, far = (
            [state(edges + sign * times * moved.reshape(edges.shape), penetration) for sign in (1, -1)]
            for times in (1, 2)
        )
        rise = 8 * (near[0].energy - near[1].energy) - (far[0].energy - far[1].energy)
        turn = 8 * (near[0].gradient - near[1].gradient) - (far[0].gradient - far[1].gradient)
        difference.append(rise / (12 * step))
        curvature.append(turn.ravel() / (12 * step))
    depth_step = 1e-4 * profile.rms_height
    ahead, back = state(edges, penetration + depth_step), state(edges, penetration - depth_step)
    gradient = here.gradient.ravel()
    scale = float(np.abs(gradient).max())
    slope = (ahead.energy - back.energy) / (2 * depth_step)
    source = Reference(kind="self", source="central differences of the energy at moved edges")
    rows = (
        compared("dU/d(edge) = G - w at every edge, over the largest", "J/m^2", source, difference, gradient,
                 MEASURED_GRADIENT * 2.5, MEASURED_GRADIENT, scale=scale),
        compared("d2U/d(edge)d(edge) at every pair of edges, over the largest", "J/m^3",
                 Reference(kind="self", source="central differences of G - w at moved edges"), np.ravel(curvature),
                 here.hessian.T.ravel(), MEASURED_HESSIAN * 2.5, MEASURED_HESSIAN,
                 scale=float(np.abs(curvature).max())),
        compared("dU/d(penetration) = load, relative", "N/m", source, [slope], [here.load], MEASURED_LOAD * 2.5,
                 MEASURED_LOAD, scale=abs(here.load)),
        compared("mean gap = highest crest less penetration, over rms height", "m",
                 Reference(kind="exact", source="integral of the gap over a period"),
                 [profile.max_height - penetration], [_mean_gap(edges, penetration, profile)], MEASURED_GIVEN_GAP * 2.5,
                 MEASURED_GIVEN_GAP, scale=profile.rms_height),
    )  # fmt: skip
    order = np.arange(edges.size).tolist()
    figure = drawn("energy-release",
                   "Derivative of the energy by each edge: from the stress intensity, and by differences.",
                   axes("edge", "dU/d(edge) / (J/m^2)",
                        trace("central difference", order, difference),
                        marks("G - w", order, gradient)),
                   axes("edge", "signed error / (J/m^2)",
                        marks("bem", order, gradient - np.array(difference))))  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), counts={"unknowns": here.evaluation.unknowns})


def _mean_gap(edges: np.ndarray[tuple[int, int], np.dtype[np.float64]], depth: float, profile: bem.Profile) -> float:
    """Mean gap over a period, by Gauss-Legendre in the angle that clusters points at the edges."""
    solved = bem.ContactState(profile, bem.Solid(1e6, 0.5), edges, depth)
    total = 0.0
    node, weight = np.polynomial.legendre.leggauss(600)
    theta = np.pi / 2 * (node + 1)
    for (_, left), (right, _) in pairwise([*edges, edges[0] + profile.period]):
        width = right - left
        x = left + width * (1 - np.cos(theta)) / 2
        gap = solved.displacement(x) - (profile.height(x) - profile.max_height + depth)
        total += float(np.sum(weight * gap * np.sin(theta))) * np.pi / 4 * width
    return total / profile.period


def _path_identities() -> Outcome:
    posed = adapters.scene("rough_100")
    result = bem.solve(posed)
    profile = posed.surface()
    touching = [state for state in result.targets if state.n_patches]
    gaps = [_mean_gap(np.array(state.edges), state.penetration, profile) for state in touching]
    separations = [state.separation for state in touching]
    released_least = min(event.energy_released or 0.0 for event in result.events)
    rows = (
        compared("mean gap = separation, over rms height", "m",
                 Reference(kind="exact", source="integral of the gap over a period"), separations, gaps,
                 MEASURED_GAP * 2.5, MEASURED_GAP, "maximum over states", profile.rms_height),
        counted("events that would release negative energy", Reference(kind="exact", source="second law"), [0.0],
                [float(released_least < 0)]),
    )  # fmt: skip
    loading = [state for state in result.states if state.branch == "loading"]
    unloading = [state for state in result.states if state.branch == "unloading"]
    figure = drawn("hysteresis", "Mean pressure against separation: adhesion makes loading and unloading differ.",
                   axes("separation / um", "mean pressure / kPa",
                        *(
                            trace(label, [state.separation * 1e6 for state in states],
                                  [state.mean_pressure / 1e3 for state in states], style)
                            for label, states, style in (("loading", loading, "line"),
                                ("unloading", unloading, "dashed"))
                        )))  # fmt: skip
    counts = {
        "evaluations": sum(state.evaluations for state in result.states),
        "events": len(result.events),
        "states": len(result.states),
    }
    return Outcome(rows=rows, figures=(figure,), counts=counts)


# rounding over the step of a difference: the largest over the BLAS kernels of five processors (least: 9.2e-12, 2e-13)
MEASURED_GRADIENT, MEASURED_LOAD, MEASURED_HESSIAN = 1.8e-11, 2.6e-12, 1.2e-10
MEASURED_GAP, MEASURED_GIVEN_GAP = 2e-13, 2e-14

CASES = (
    Case(id="energy-release-rate", group="identities", level="quick",
         question="Do stress intensities and their sensitivities give the derivatives of the energy by edges?",
         equations=r"$\frac{\partial U}{\partial b} = G - w$, $\frac{\partial U}{\partial a} = -(G - w)$, "
         r"$G = \frac{K^2}{2 E^\ast}$, $w = \gamma \sqrt{1 + h'^2}$, $\frac{\partial U}{\partial \Delta}$ = load; "
         r"$\frac{\partial^2 U}{\partial b \, \partial e} = \frac{\partial (G - w)}{\partial e}$ for every edge $e$",
         sources=("carbone2009",), compute=_energy_release, effects=("half_space", "adhesion", "slope_term")),
    Case(id="path-identities", group="identities", level="quick",
         question="Do mean gap and dissipation hold along a loading and unloading path with events?",
         equations=r"$s$ = mean gap; energy released $\ge 0$",
         sources=("carbone2009",), compute=_path_identities,
         effects=("half_space", "adhesion", "slope_term", "unloading"), scene=adapters.scene_text("rough_100")),
)  # fmt: skip
