"""Statements that hold for any profile: energy release rate, mean gap and dissipation along a path with events."""

from itertools import pairwise

import numpy as np

import bem
from validation.cases.shared.checks import OVER_STATES, Against, case, column, posed, touching, work
from validation.harness.arrays import FloatArray
from validation.harness.case import Outcome
from validation.harness.figure_data import axes, drawn, marks, trace

STEP = 2e-4  # of the width of the narrowest patch, in differences of fourth order
SOLID = bem.Solid(1e6, 0.5)
MEAN_GAP = Against("exact", "integral of the gap over a period")


def _cut(profile: bem.Profile) -> tuple[FloatArray, float]:
    """Edges (n_patches, 2) where a profile is above three quarters of its heights, and the penetration there."""
    x = np.linspace(0, profile.period, 4001)
    height = profile.height(x)
    level = np.quantile(height, 0.75)
    above = height > level
    start, stop = np.flatnonzero(above & ~np.roll(above, 1)), np.flatnonzero(above & ~np.roll(above, -1))
    if stop[0] < start[0]:
        stop = np.roll(stop, -1)
    edges = np.stack([x[start], np.where(x[stop] < x[start], x[stop] + profile.period, x[stop])], axis=1)
    return edges[np.argsort(edges[:, 0])], profile.max_height - float(level)


def _energy_release() -> Outcome:
    profile = bem.Profile.self_affine(period=0.01, hurst=0.7, rms_height=50e-6, harmonics=60, seed=4)
    adhesion = bem.Adhesion(0.03, slope_term=True)
    edges, penetration = _cut(profile)

    def state(changed: FloatArray, depth: float) -> bem.ContactState:
        return bem.ContactState(profile, SOLID, changed, depth, adhesion=adhesion)

    here, step = state(edges, penetration), STEP * float(np.min(edges[:, 1] - edges[:, 0]))
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
    moved_edges = Against("self", "central differences of the energy at moved edges")
    # rounding over the step of a difference: the largest over the BLAS kernels of five processors (least: 9.2e-12)
    rows = (
        moved_edges.row("dU/d(edge) = G - w at every edge, over the largest", "J/m^2", difference, gradient, 1.8e-11,
                        scale=float(np.abs(gradient).max())),
        Against("self", "central differences of G - w at moved edges").row(
            "d2U/d(edge)d(edge) at every pair of edges, over the largest", "J/m^3", np.ravel(curvature),
            here.hessian.T.ravel(), 1.2e-10, scale=float(np.abs(curvature).max())),
        moved_edges.row("dU/d(penetration) = load, relative", "N/m", (ahead.energy - back.energy) / (2 * depth_step),
                        here.load, 2.6e-12, scale=abs(here.load)),
        MEAN_GAP.row("mean gap = highest crest less penetration, over rms height", "m",
                     profile.max_height - penetration, _mean_gap(edges, penetration, profile), 2e-14,
                     scale=profile.rms_height),
    )  # fmt: skip
    order = np.arange(edges.size)
    figure = drawn("energy-release",
                   "Derivative of the energy by each edge: from the stress intensity, and by differences.",
                   axes("edge", "dU/d(edge) / (J/m^2)", trace("central difference", order, difference),
                        marks("G - w", order, gradient)),
                   axes("edge", "signed error / (J/m^2)", marks("bem", order, gradient - difference)))  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), counts={"unknowns": here.evaluation.unknowns})


def _mean_gap(edges: FloatArray, depth: float, profile: bem.Profile) -> float:
    """Mean gap over a period, by Gauss-Legendre in the angle that clusters points at the edges."""
    solved = bem.ContactState(profile, SOLID, edges, depth)
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
    scene = posed("rough_100")
    result, profile = bem.solve(scene), scene.surface()
    states = touching(result.targets)
    rows = (
        MEAN_GAP.row("mean gap = separation, over rms height", "m", column(states, "separation"),
                     [_mean_gap(np.array(state.edges), state.penetration, profile) for state in states], 2e-13,
                     OVER_STATES, profile.rms_height),
        Against("exact", "second law").count("events that would release negative energy", 0.0,
                                             min(event.energy_released or 0.0 for event in result.events) < 0),
    )  # fmt: skip
    ways = {way: [state for state in result.states if state.branch == way] for way in ("loading", "unloading")}
    figure = drawn(
        "hysteresis", "Mean pressure against separation: adhesion makes loading and unloading differ.",
        axes("separation / um", "mean pressure / kPa",
             *(trace(way, column(states, "separation", 1e-6), column(states, "mean_pressure", 1e3), style)
               for (way, states), style in zip(ways.items(), ("line", "dashed"), strict=True))),
    )  # fmt: skip
    return Outcome(rows=rows, figures=(figure,), counts=work("evaluations events states", result))


CASES = (
    case("energy-release-rate", "identities", _energy_release,
         "Do stress intensities and their sensitivities give the derivatives of the energy by edges?",
         r"$\frac{\partial U}{\partial b} = G - w$, $\frac{\partial U}{\partial a} = -(G - w)$, "
         r"$G = \frac{K^2}{2 E^\ast}$, $w = \gamma \sqrt{1 + h'^2}$, $\frac{\partial U}{\partial \Delta}$ = load; "
         r"$\frac{\partial^2 U}{\partial b \, \partial e} = \frac{\partial (G - w)}{\partial e}$ for every edge $e$",
         "carbone2009", "half_space adhesion slope_term"),
    case("path-identities", "identities", _path_identities,
         "Do mean gap and dissipation hold along a loading and unloading path with events?",
         r"$s$ = mean gap; energy released $\ge 0$",
         "carbone2009", "half_space adhesion slope_term unloading", scene="rough_100"),
)  # fmt: skip
