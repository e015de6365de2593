"""Statements that hold for any profile: energy release rate, mean gap and dissipation along a path with events.

And that it matters not where the period begins, while realisations have phases of their own.
"""

from dataclasses import replace
from itertools import chain, combinations, pairwise

import numpy as np

import bem
from validation.cases.shared.checks import (
    OVER_STATES,
    Against,
    Found,
    case,
    column,
    posed,
    refused,
    solved,
    touching,
    work,
)
from validation.corpus.hard.hard_case_scenes import waves_of
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.references.adapters import NOT_SELF_AFFINE

STEP = 2e-4  # of the width of the narrowest patch, in differences of fourth order
SOLID = bem.Solid(1e6, 0.5)
SHIFTS = (0.0, 0.1672, 0.86)  # periods; at the second two patches merge across the end of the period
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


def _energy_release() -> Found:
    profile = bem.Profile.self_affine(period=0.01, hurst=0.7, rms_height=50e-6, harmonics=60, seed=4)
    adhesion = bem.Adhesion(0.03, slope_term=True)
    edges, penetration = _cut(profile)

    def state(changed: FloatArray, depth: float) -> bem.ContactState:
        return bem.ContactState(profile, SOLID, changed, depth, adhesion=adhesion)

    def moved(index: int, by: float) -> FloatArray:
        """The energy and its gradient with one edge moved, (1 + 2 n_patches,)."""
        one = state(edges + by * (np.arange(edges.size) == index).reshape(edges.shape), penetration)
        return np.array([one.energy, *one.gradient.ravel()])

    here, step = state(edges, penetration), STEP * float(np.min(edges[:, 1] - edges[:, 0]))
    differences = []
    for index in range(edges.size):
        near, far = (moved(index, times * step) - moved(index, -times * step) for times in (1, 2))
        differences.append((8 * near - far) / (12 * step))
    difference, curvature = np.array(differences)[:, 0], np.array(differences)[:, 1:]
    depth_step = 1e-4 * profile.rms_height
    ahead, back = state(edges, penetration + depth_step), state(edges, penetration - depth_step)
    gradient = here.gradient.ravel()
    moved_edges = Against("self", "central differences of the energy at moved edges")
    # rounding over the step of a difference: the largest over the BLAS kernels of five processors (least: 9.2e-12)
    yield moved_edges.row("dU/d(edge) = G - w at every edge, over the largest", "J/m^2", difference, gradient, 1.8e-11,
                          scale=float(np.abs(gradient).max()))  # fmt: skip
    yield Against("self", "central differences of G - w at moved edges").row(
        "d2U/d(edge)d(edge) at every pair of edges, over the largest", "J/m^3", np.ravel(curvature),
        here.hessian.T.ravel(), 1.2e-10, scale=float(np.abs(curvature).max()))  # fmt: skip
    yield moved_edges.row("dU/d(penetration) = load, relative", "N/m", (ahead.energy - back.energy) / (2 * depth_step),
                          here.load, 2.6e-12, scale=abs(here.load))  # fmt: skip
    yield MEAN_GAP.row("mean gap = highest crest less penetration, over rms height", "m",
                       profile.max_height - penetration, _mean_gap(edges, penetration, profile), 2e-14,
                       scale=profile.rms_height)  # fmt: skip
    order = np.arange(edges.size)
    yield drawn("energy-release",
                "Derivative of the energy by each edge: from the stress intensity, and by differences.",
                axes("edge", "dU/d(edge) / (J/m^2)", trace("central difference", order, difference),
                     marks("G - w", order, gradient)),
                axes("edge", "signed error / (J/m^2)", marks("bem", order, gradient - difference)))  # fmt: skip
    yield {"unknowns": here.evaluation.unknowns}


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


def _path_identities() -> Found:
    scene = posed("rough_100")
    result, profile = bem.solve(scene), scene.surface()
    states = touching(result.targets)
    yield MEAN_GAP.row("mean gap = separation, over rms height", "m", column(states, "separation"),
                       [_mean_gap(np.array(state.edges), state.penetration, profile) for state in states], 2e-13,
                       OVER_STATES, profile.rms_height)  # fmt: skip
    yield Against("exact", "second law").count(
        "events that would release negative energy", 0.0,
        min(event.energy_released or 0.0 for event in result.events) < 0)  # fmt: skip
    ways = {way: [state for state in result.states if state.branch == way] for way in ("loading", "unloading")}
    yield drawn("hysteresis", "Mean pressure against separation: adhesion makes loading and unloading differ.",
                axes("separation / um", "mean pressure / kPa",
                     *(trace(way, column(states, "separation", 1e-6), column(states, "mean_pressure", 1e3), style)
                       for (way, states), style in zip(ways.items(), ("line", "dashed"), strict=True))))  # fmt: skip
    yield work("evaluations events states", result)


def _shifted() -> Found:
    surface = posed("rough_100", profile={"harmonics": 40}).surface()
    moved = [replace(surface, phases=surface.phases - 2 * np.pi * shift * surface.orders) for shift in SHIFTS]
    results = [solved("rough_100", profile=NOT_SELF_AFFINE | waves_of(one), adhesion={"work_of_adhesion": 0.01},
                      loading={"targets": [60e-6, 45e-6, 60e-6]}) for one in moved]  # fmt: skip
    first, *others = results
    known, equal = Against("self", "the same profile elsewhere in the period"), (1e-12, 0.0)
    for quantity, name, unit, measured in (
        ("contact fraction", "contact_fraction", "", (2e-13, 7.4e-14)),
        ("mean pressure", "mean_pressure", "Pa", (3e-14, 1e-14)),
        ("patches", "n_patches", "", equal),
    ):
        yield known.row(f"{quantity}, over all shifts", unit, column(first.targets, name) * len(others),
                        chain.from_iterable(column(one.targets, name) for one in others), measured)  # fmt: skip
    met = [[column(result.events, "kind").count(kind)
            for kind in ("new_contact", "coalescence", "detachment", "pull_off")] for result in results]  # fmt: skip
    yield known.row(
        "events of each kind, over all shifts", "", met[0] * len(others), chain.from_iterable(met[1:]), equal
    )
    yield Against("exact", "every state of a path is an equilibrium without interpenetration").row(
        "states whose certificate is not ok, per shift", "", [0.0] * len(results), map(refused, results), (0.5, 0.0),
        "absolute")  # fmt: skip
    yield {"states": sum(len(result.states) for result in results)}


def _realisations() -> Found:
    phases = [bem.Profile.self_affine(0.01, 0.7, 50e-6, 400, seed).phases for seed in range(8)]
    alike = [float(np.mean(np.cos(one - other))) for one, other in combinations(phases, 2)]
    yield Against("exact", "independent phases, n = 400: zero within 1 / sqrt(2 n) each").row(
        "mean cosine of the phase differences of any two of eight realisations", "", [0.0] * len(alike), alike,
        (0.15, 0.07), "absolute")  # fmt: skip


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
    case("shifted-profile", "identities", _shifted,
         "Is a profile the same wherever the period begins, also when patches merge across its end?",
         "$h(x - s)$ has the contact fractions, loads and patches of $h(x)$",
         "carbone2009", "half_space adhesion slope_term unloading", scene="rough_100"),
    case("independent-realisations", "identities", _realisations,
         "Are the phases of different realisations independent?",
         r"mean over $m$ of $\cos(\varphi_m - \varphi'_m) = 0$ within $1 / \sqrt{2 n}$", "carbone2009"),
)  # fmt: skip
