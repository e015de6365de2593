"""The methods compared, each with its one knob: all else is fixed, and named in `fixed`.

A method is a record; another one (a uniform-grid solver, say) is one more entry of METHODS.  `solve(scene, setting)`
does what a user of it would do and hands back what it found, timed in three parts.  Where a method cannot do a scene,
the reason stands in `cannot`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import bem
from bem.scene.scene import parse_scene
from fem_reference.closure import Evaluation
from fem_reference.face import face_nodes, interpolate
from fem_reference.mesh import Resolution
from fem_reference.result import quantities
from fem_reference.solve import closed, control_of, problem_of
from persson import AdhesiveContact, DiscreteSpectrum
from persson import solve as persson_solve
from persson.adhesive import Route
from validation.references.dense_equilibrium import solve_dense
from validation.references.paper_method import PaperState, follow
from validation.references.paper_method import solve as paper_solve
from validation.references.posed_contacts import Found, MethodError, Posed, answer_of, overlap, scene_tables

HALF_SPACE_DEPTH = 3.0  # periods: a layer so thick is the half-space within 1e-12
PERSSON_LOAD = 1.0e4  # Pa


@dataclass(frozen=True)
class Method:
    """A method and its knob."""

    name: str
    code: str  # names whose numerics it uses: a reference of the same code gives no digits
    knob: str
    fixed: str
    settings: tuple[Any, ...]  # values of the knob, coarsest first
    scenes: tuple[str, ...]  # it takes part in
    solve: Callable[[Posed, Any], Found]
    cannot: Mapping[str, str]  # scenes it cannot do, and why
    slow: int = 0  # how many of its settings, from the finest, the quick form of the study leaves out
    # on scenes where those of `settings` do not fit
    other_settings: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)

    def settings_for(self, scene: str, quick: bool) -> tuple[Any, ...]:
        """Settings on a scene, in full or in the quick form."""
        every = self.other_settings.get(scene, self.settings)
        return every[: len(every) - self.slow] if quick else every


def solve_bem(posed: Posed, tolerance: float) -> Found:
    """The production solver, from first touch to the penetration."""
    begun = time.perf_counter()
    scene = parse_scene(scene_tables(posed) | {"accuracy": {"tolerance": tolerance}})
    ready = time.perf_counter()
    result = bem.solve(scene)
    solved = time.perf_counter()
    if result.status != "converged":
        raise MethodError(result.status)
    state = result.targets[-1]
    profile = bem.Profile.from_harmonics(posed.period, posed.orders, posed.amplitudes, posed.phases)
    solid = bem.Solid(posed.youngs_modulus, posed.poisson_ratio)
    layer = None if posed.thickness is None else bem.Layer(posed.thickness)
    contact = bem.ContactState(profile, solid, state.edges, state.penetration, layer)
    at = np.array([posed.trough])
    gap = contact.displacement(at) - (profile.height(at) - profile.max_height + state.penetration)
    answer = answer_of(state.contact_fraction, state.mean_pressure, state.elastic_energy, float(gap[0]))
    counts = {"evaluations": sum(s.evaluations for s in result.states), "patches": state.n_patches}
    unknowns = max(s.unknowns for s in result.states)
    return Found(answer, unknowns, counts, ready - begun, solved - ready, time.perf_counter() - solved)


def solve_fem(posed: Posed, setting: tuple[int, int, int]) -> Found:
    """The closure on one mesh of the finite element reference, after its scouting mesh; it finds its own edges."""
    begun = time.perf_counter()
    resolution = Resolution(*setting)
    depth = HALF_SPACE_DEPTH * posed.period if posed.thickness is None else posed.thickness
    harmonics = (posed.orders, posed.amplitudes, posed.phases)
    problem = problem_of(
        posed.youngs_modulus, posed.poisson_ratio, depth, posed.period, harmonics, posed.work_of_adhesion,
        posed.slope_term,
    )  # fmt: skip
    control = control_of(problem, "penetration", posed.penetration)
    ready = time.perf_counter()
    closures = closed(problem, control, [resolution], posed.patches, 1.0)
    solved = time.perf_counter()
    if closures[-1].outcome != "converged" or len(closures) < 2:
        raise MethodError(f"{closures[-1].outcome}: {closures[-1].message}")
    evaluation = closures[-1].evaluation
    values = quantities(evaluation)
    fraction, pressure, energy = (
        float(values[name]) for name in ("contact_fraction", "mean_pressure", "elastic_energy")
    )
    answer = answer_of(fraction, pressure, energy / posed.period, _fem_gap(posed, evaluation))
    counts = {"unknowns": evaluation.states.unknowns}
    post = time.perf_counter() - solved
    return Found(answer, evaluation.states.unknowns, counts, ready - begun, solved - ready, post)


def solve_paper(posed: Posed, cells: int) -> Found:
    """The paper's own method: from the geometric overlap, or along a path where the state depends on it."""
    begun = time.perf_counter()
    surface = posed.surface()
    start = overlap(posed)
    ready = time.perf_counter()
    if posed.id == "rough":
        way = np.linspace(0.0, posed.penetration, PATH_STEPS + 1)[1:]
        states = follow(surface, way, cells, PATH_RESIDUAL, PAPER_GAP)
    else:
        states = [paper_solve(surface, posed.penetration, start, cells, PAPER_RESIDUAL, PAPER_GAP)]
    solved = time.perf_counter()
    last = states[-1]
    if last.status != "converged":
        raise MethodError(f"{last.status}: {last.message}")
    gap = last.gap(np.array([posed.trough]))
    answer = answer_of(last.contact_fraction, last.mean_pressure, last.elastic_energy / posed.period, float(gap[0]))
    post = time.perf_counter() - solved
    return Found(answer, last.unknowns, _paper_counts(states), ready - begun, solved - ready, post)


def solve_persson(route: Route, posed: Posed, resolution: float) -> Found:
    """Persson's theory with adhesion on the lines of the profile, at PERSSON_LOAD."""
    begun = time.perf_counter()
    spectrum = DiscreteSpectrum(2 * np.pi / posed.period * np.array(posed.orders), np.array(posed.amplitudes))
    ready = time.perf_counter()
    contact = persson_solve(
        spectrum,
        PERSSON_LOAD,
        youngs_modulus=posed.youngs_modulus,
        poisson_ratio=posed.poisson_ratio,
        work_of_adhesion=posed.work_of_adhesion,
        route=route,
        resolution=resolution,
        with_separation=False,
    )
    solved = time.perf_counter()
    if contact.status != "converged" or not isinstance(contact, AdhesiveContact):
        raise MethodError(contact.status)
    nodes = contact.fields.area.shape[1]
    answer = {"contact_fraction": contact.contact_fraction, "elastic_energy": contact.elastic_energy}
    return Found(answer, nodes, {"iterations": contact.fields.iterations}, ready - begun, solved - ready, 0.0)


def persson_finite_volumes(posed: Posed, resolution: float) -> Found:
    """First route."""
    return solve_persson("finite_volumes", posed, resolution)


def persson_volterra(posed: Posed, resolution: float) -> Found:
    """Second route."""
    return solve_persson("volterra", posed, resolution)


PAPER_RESIDUAL, PAPER_GAP = 1e-7, 1e-3  # of the paper's method: |G/w - 1|, and interpenetration in rms heights
PATH_RESIDUAL, PATH_STEPS = 1e-5, 40
NOT_ROUGH = {"rough": "a dozen contacts of many sizes: its closure looks for given numbers of contacts at crests"}
NOT_THEORY = {
    "sinusoid": "Persson's theory needs roughness on many scales",
    "layer": "Persson's theory is for a half-space",
    "rough": "off by tens of per cent on one realisation; its two routes are compared with each other as `theory`",
}
PERSSON_SETTINGS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0)

METHODS: tuple[Method, ...] = (
    Method(name="bem", code="bem", knob="accuracy.tolerance",
           fixed="path from first touch, increments 0.05 rms heights",
           settings=(1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12), scenes=("sinusoid", "layer", "rough"), solve=solve_bem,
           cannot={}),
    Method(name="bem, dense", code="bem", knob="nodes per patch",
           fixed="Newton on K from the geometric overlap: patches given, no path, no search for contacts",
           settings=(4, 6, 8, 10, 12, 16, 20, 24), scenes=("sinusoid", "layer"), solve=solve_dense,
           cannot={"rough": "without a path and a search for contacts it does not know the patches"}),
    Method(name="fem", code="fem", knob="mesh: order, cells, tip levels",
           fixed="closure from crests on a scouting mesh, then one mesh; half-space: layer of three periods",
           settings=((2, 4, 4), (2, 6, 6), (2, 8, 8), (2, 12, 10), (4, 6, 11), (4, 8, 14), (4, 12, 19)),
           scenes=("sinusoid", "layer"), solve=solve_fem,
           cannot=NOT_ROUGH, slow=1),
    Method(name="paper's method", code="paper's method", knob="cells per patch",
           fixed=f"residual {PAPER_RESIDUAL:g}; rough: {PATH_RESIDUAL:g}, path of {PATH_STEPS} steps from first touch",
           settings=(4, 8, 16, 32, 64, 128, 256), scenes=("sinusoid", "layer", "rough"), solve=solve_paper,
           cannot={}, other_settings={"rough": (4, 6, 8, 12, 16, 24)}),
    Method(name="persson, finite volumes", code="persson, finite volumes", knob="resolution",
           fixed=f"mean pressure {PERSSON_LOAD:g} Pa, no separation",
           settings=PERSSON_SETTINGS, scenes=("theory",), solve=persson_finite_volumes,
           cannot=NOT_THEORY, slow=2),
    Method(name="persson, volterra", code="persson, volterra", knob="resolution",
           fixed=f"mean pressure {PERSSON_LOAD:g} Pa, no separation",
           settings=PERSSON_SETTINGS, scenes=("theory",), solve=persson_volterra,
           cannot=NOT_THEORY, slow=2),
)  # fmt: skip


def _fem_gap(posed: Posed, evaluation: Evaluation) -> float:
    """Gap at the trough, in the elements."""
    states, problem = evaluation.states, evaluation.states.problem
    nodes = face_nodes(states.spaces)
    field = states.fields[0] + evaluation.load * states.fields[1]
    local = np.array([(posed.trough / posed.period - states.mesh.seam) % 1.0])
    face = float(interpolate(local, nodes.x, field[states.spaces.sizes[0] + nodes.index], nodes.order)[0])
    plate = float(states.displacement_of_plate[0] + evaluation.load * states.displacement_of_plate[1])
    rigid = float(problem.height(np.array([posed.trough / posed.period]))[0]) - problem.highest + plate
    return (face - rigid) * problem.unit_height


def _paper_counts(states: list[PaperState]) -> dict[str, int]:
    return {
        "evaluations": sum(state.evaluations for state in states),
        "sweeps": sum(state.sweeps for state in states),
        "patches": len(states[-1].edges),
    }
