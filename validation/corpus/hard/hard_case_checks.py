"""Independent checks of the hard cases: closed forms, the dense route, invariances, restarts.

A check takes the scene and its result and returns findings, one text for each that fails; an empty list means that
nothing was found against the result.  Tolerances are stated beside the error measured.  SI units.
"""

import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bem.contact_state import ContactState
from bem.elastic.layer import Layer
from bem.geometry.scaling import Scales, Solid
from bem.scene.result import Result, State
from bem.scene.result_file import write_result
from bem.scene.scene import Scene, parse_scene
from bem.solver import solve
from validation.corpus.hard.hard_case_scenes import in_units, waves_of
from validation.references.closed_forms import full_contact_amplitudes
from validation.references.dense import evaluate_dense
from validation.references.isolated_crack import closing, crack, valleys
from validation.references.paper_problem import Table

Check = Callable[[Table, Scene, Result], list[str]]
Carried = Callable[[NDArray[np.float64]], NDArray[np.float64]]

CLOSED_FORM = 2e-8  # of p* (or of the pressure where larger) and the amplitude; measured 7.6e-9 at fraction 0.9999
DENSE = 1.5e-10  # of the pressure unit, or of the pressure where larger; measured 5.5e-11 at an rms height of 1 nm
INVARIANCE = 2.5e-11  # of contact fraction and pressure unit; measured 8.8e-12 (last target alone), others 9e-15
SAME_END = 1e-10  # the same along other increments and after a restart, as asked for; measured 5e-15
# Of the penetration, which in SI is the difference of rounded numbers, and of heights by expansion; measured 10.
ROUNDINGS, EPS = 24, np.finfo(float).eps
HEIGHT_NOISE = 1e-13  # of the rms height, as seen in pressures; 4e-14 measured on a patch of 1e-5 periods
# Of the pressure unit, or of the pressure where larger, and of the separation, a difference of rounded heights;
# measured 6.9e-7 at a separation of 3e-13 m, 1.6e-8 at 1e-11 m.
LAST_GAP = 2e-6
CLOSING_LOAD, CLOSING_WIDTH = 2.5e-14, 5e-9  # measured 8.4e-15 of the load (1000 harmonics) and 1.6e-9 of the width
WITHIN = 2000  # points within a patch, and again about its lowest pressure
TENSION = 1e-9  # of the mean pressure of a patch: pressure that must not be tensile without adhesion
EQUAL = 8e-12  # of the widths of patches; measured 2.9e-12 at 100 Pa, 2e-13 at larger loads


def with_edges(result: Result) -> list[State]:
    """Target states that have patches and gaps."""
    return [state for state in result.targets if state.edges]


def pressure_unit(scene: Scene) -> float:
    """h'_rms E* / 2, the pressure against which errors are measured."""
    return 0.5 * scene.surface().rms_slope * plane_strain_modulus(scene)


def plane_strain_modulus(scene: Scene) -> float:
    """E / (1 - nu^2), of its own."""
    return scene.solid.youngs_modulus / (1 - scene.solid.poisson_ratio**2)


def wave(tables: Table, scene: Scene, result: Result) -> list[str]:
    """Pressure and penetration of one wave at the solver's own contact width: Westergaard's; with adhesion Johnson's.

    K. L. Johnson, Int. J. Solids Struct. 32 (1995) 423.
    """
    surface, modulus = scene.surface(), plane_strain_modulus(scene)
    work = 0.0 if scene.adhesion is None else scene.adhesion.work_of_adhesion
    amplitude, period = float(surface.amplitudes[0]), surface.period
    peak = np.pi * modulus * amplitude / period
    alpha = np.sqrt(2 * modulus * work / period) / peak
    findings = []
    for state in with_edges(result):
        gap = np.pi / 2 * (1 - state.contact_fraction)  # the complement keeps the digits near complete contact
        share, tangent = np.cos(gap) ** 2, np.sqrt(1 / np.tan(gap))
        pressure = peak * (share - alpha * tangent)
        penetration = amplitude * (share * (1 - np.log(share)) + alpha * tangent * np.log(share))
        error = abs(state.mean_pressure - pressure) / max(peak, abs(pressure))
        shift = abs(state.penetration - penetration) / amplitude
        if not (error <= CLOSED_FORM and shift <= CLOSED_FORM):
            findings.append(f"closed form missed by {error:.1e} p*, {shift:.1e} D at {state.contact_fraction:.6g}")
    return findings


def dense(tables: Table, scene: Scene, result: Result) -> list[str]:
    """Mean pressure at the edges of every target by the dense route, beyond what rounding of the penetration moves it.

    Next to complete contact that is much: the pressure has a pole where the last gap closes.
    """
    surface = scene.surface()
    scales = Scales(surface.period, surface.rms_height, plane_strain_modulus(scene))
    findings = []
    for state in with_edges(result):
        edges = np.array(state.edges) / scales.length

        def at(penetration: float, edges: NDArray[np.float64] = edges) -> float:
            there = evaluate_dense(surface.scaled(), edges[:, 0], edges[:, 1], penetration / scales.height)
            return there.load / (2 * np.pi) * scales.stress

        pressure, unit = at(state.penetration), pressure_unit(scene)
        error = abs(pressure - state.mean_pressure) / max(unit, abs(pressure))
        if error <= DENSE:
            continue
        rounded = abs(at(state.penetration * (1 + ROUNDINGS * EPS)) - pressure) / max(unit, abs(pressure))
        if not error <= DENSE + rounded:
            findings.append(f"dense route differs by {error:.1e} at separation {state.separation:.4g}")
    return findings


def doubled(tables: Table, scene: Scene, result: Result) -> list[str]:
    """Mean pressure at the edges of every target with a layer, at the finest resolution."""
    solid = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio)
    layer = Layer(tables["layer"]["thickness"])
    findings = []
    for state in with_edges(result):
        fine = ContactState(scene.surface(), solid, state.edges, state.penetration, layer, tolerance=1e-13)
        error = abs(fine.mean_pressure - state.mean_pressure) / max(pressure_unit(scene), abs(fine.mean_pressure))
        if not error <= DENSE:
            findings.append(f"doubled resolution differs by {error:.1e} at separation {state.separation:.4g}")
    return findings


def uniform_load(tables: Table, scene: Scene, result: Result) -> list[str]:
    """A flat profile carries exactly the load asked for, at separation zero."""
    expected = [(target, 0.0, 1.0) for target in scene.loading.targets]
    found = [(state.mean_pressure, state.separation, state.contact_fraction) for state in result.targets if state.found]
    return [] if found == expected else [f"flat profile gives {found}"]


def equal_patches(tables: Table, scene: Scene, result: Result) -> list[str]:
    """All patches of every target are equally wide."""
    return [text for state in with_edges(result) for text in _unequal(state)]


def compressive(tables: Table, scene: Scene, result: Result) -> list[str]:
    """Without adhesion no pressure inside a patch is tensile; it vanishes at the edges, and is weighted by their roots.

    Noise of the heights h leaves a pressure of h E* over the width of the patch.
    """
    solid = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio)
    noise = HEIGHT_NOISE * scene.surface().rms_height * plane_strain_modulus(scene)
    findings = []
    for state in with_edges(result):
        contact = ContactState(scene.surface(), solid, state.edges, state.penetration, tolerance=1e-12)
        angle = np.pi * (np.arange(WITHIN) + 0.5) / WITHIN
        for a, b in state.edges:
            pressure = _weighted_pressure(contact, a, b, angle)
            dips = 1 + np.flatnonzero((pressure[1:-1] <= pressure[:-2]) & (pressure[1:-1] <= pressure[2:]))
            closer = [np.linspace(angle[k - 1], angle[k + 1], WITHIN) for k in dips[np.argsort(pressure[dips])][:1]]
            near = [_weighted_pressure(contact, a, b, points).min() for points in closer]
            lowest, mean = float(min([pressure.min(), *near])), float(pressure.mean())
            if not lowest >= -TENSION * mean - noise / (b - a):
                share = lowest / mean
                findings.append(f"pressure {share:.1e} of the mean of its patch at separation {state.separation:.4g}")
    return findings


def _weighted_pressure(contact: ContactState, a: float, b: float, angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pressure at a + (b - a) (1 - cos angle) / 2, times the root of the distances from both edges."""
    return np.asarray(contact.pressure(a + (b - a) * (1 - np.cos(angle)) / 2) * np.sin(angle))


def tension_at_the_end(tables: Table, scene: Scene, result: Result) -> list[str]:
    """The load is compressive before and tensile at the target of largest contact."""
    states = with_edges(result)
    last = max(states, key=lambda state: state.contact_fraction)
    pressed = any(state.mean_pressure > 0 for state in states)
    return [] if pressed and last.mean_pressure < 0 else [f"mean pressure {last.mean_pressure:.4g} at the end"]


def last_gap(tables: Table, scene: Scene, result: Result) -> list[str]:
    """At the largest contact one gap is left; load and separation are those of an isolated crack of its width."""
    state = max(with_edges(result), key=lambda state: state.contact_fraction)
    if state.n_patches != 1:
        return [f"{state.n_patches} gaps at the target of largest contact"]
    surface, ((start, end),) = scene.surface(), state.edges
    work = tables["adhesion"]["work_of_adhesion"]
    pressure, separation = crack(surface, plane_strain_modulus(scene), work, end, start + surface.period)
    error = abs(pressure - state.mean_pressure) / max(pressure_unit(scene), abs(pressure))
    wider = abs(separation - state.separation) / state.separation
    if error <= LAST_GAP and wider <= LAST_GAP:
        return []
    return [f"crack missed by {error:.1e} of the pressure, {wider:.1e} of the separation at {state.separation:.4g}"]


def closing_gaps(tables: Table, scene: Scene, result: Result) -> list[str]:
    """Without adhesion, at the largest contact: missing load and widths of gaps are those of isolated cracks."""
    state = max(with_edges(result), key=lambda state: state.contact_fraction)
    surface, modulus = scene.surface(), plane_strain_modulus(scene)
    amplitudes = full_contact_amplitudes(surface.orders, surface.amplitudes, surface.period, modulus)
    complete = replace(surface, amplitudes=amplitudes)
    pressure, widths = closing(complete, modulus, state.separation)
    share = abs(pressure - state.mean_pressure) / (valleys(complete)[0].min() * -1)
    narrower = abs((1 - state.contact_fraction) * surface.period / float(widths.sum()) - 1)
    if state.n_patches == widths.size and share <= CLOSING_LOAD and narrower <= CLOSING_WIDTH:
        return []
    return [f"{state.n_patches} gaps, load off by {share:.1e}, widths by {narrower:.1e} at {state.separation:.4g}"]


def equal_until_bifurcation(tables: Table, scene: Scene, result: Result) -> list[str]:
    """The patches are equally wide before the first bifurcation, and not after it."""
    first = next((event.penetration for event in result.events if event.kind == "bifurcation"), np.inf)
    findings = []
    for state in with_edges(result):
        if state.branch != "loading":
            break
        if state.penetration < first:
            findings += _unequal(state)
            if not (state.certificate.min_eigenvalue or 0.0) > 0:
                findings.append("smallest eigenvalue not positive before the bifurcation")
        elif state.n_patches == max(scene.profile.orders or (1,)) and not _unequal(state):
            findings.append(f"still symmetric beyond the bifurcation at {first:.4g} m")
    return findings


def _unequal(state: State) -> list[str]:
    widths = np.array([b - a for a, b in state.edges])
    spread = float(np.ptp(widths) / widths.mean())
    return [] if spread <= EQUAL else [f"patches differ by {spread:.1e} at separation {state.separation:.4g}"]


def shift(tables: Table, scene: Scene, result: Result) -> list[str]:
    """A profile shifted along the period gives the same states."""
    surface = scene.surface()
    moved = replace(surface, phases=surface.phases + 1.0 * surface.orders)
    other = solve(parse_scene(tables | {"profile": waves_of(moved)}))
    return _compare("shift", result, other, scene, carried=lambda edges: edges + surface.period / (2 * np.pi))


def mirror(tables: Table, scene: Scene, result: Result) -> list[str]:
    """A mirrored profile gives the same states."""
    surface = scene.surface()
    other = solve(parse_scene(tables | {"profile": waves_of(replace(surface, phases=-surface.phases))}))
    return _compare("mirror", result, other, scene, carried=lambda edges: -edges[:, ::-1])


def units(tables: Table, scene: Scene, result: Result, factor: float) -> list[str]:
    """Lengths and stresses in units so many times larger."""
    other = solve(parse_scene(in_units(tables, factor, factor)))
    return _compare(f"units times {factor:g}", result, other, scene, factor)


def plane_strain_only(tables: Table, scene: Scene, result: Result) -> list[str]:
    """The same E* with nu = 0 gives the same states on a half-space."""
    other = {"youngs_modulus": plane_strain_modulus(scene), "poisson_ratio": 0.0}
    return _compare("nu = 0 with the same E*", result, solve(parse_scene(tables | {"solid": other})), scene)


def target_alone(tables: Table, scene: Scene, result: Result) -> list[str]:
    """Without adhesion every target alone gives the same state, within the errors estimated where they are larger."""
    findings = []
    for k, target in enumerate(tables["loading"]["targets"]):
        alone = tables["loading"] | {"targets": [target]}
        other = solve(parse_scene(tables | {"loading": alone}))
        one = replace(result, states=(result.targets[k],), status=other.status)
        estimates = [state.error_estimate.contact_fraction or 0.0 for state in (*one.targets, *other.targets)]
        allowed = max(INVARIANCE, *estimates)
        findings += _compare(f"target {target:g} alone", one, other, scene, tolerance=allowed)
    return findings


def smaller_increments(tables: Table, scene: Scene, result: Result) -> list[str]:
    """Ten times smaller increments give the same states."""
    finer = {"max_increment": scene.accuracy.max_increment / 10}
    other = solve(parse_scene(tables | {"accuracy": finer}))
    return _compare("ten times smaller increments", result, other, scene, tolerance=SAME_END)


def restart(tables: Table, scene: Scene, result: Result) -> list[str]:
    """The path taken up from a stored target state in mid-path ends in the same state."""
    middle = [k for k, state in enumerate(result.states) if state.target][-2]
    rest = tables["loading"] | {
        "targets": tables["loading"]["targets"][-1:],
        "initial": {"result": "stored", "state": middle},
    }
    with tempfile.TemporaryDirectory() as folder:
        write_result(result, Path(folder) / "stored")
        again = solve(parse_scene(tables | {"loading": rest}, folder))
    return _compare("restart", result, again, scene, last_only=True, tolerance=SAME_END)


def _compare(
    name: str,
    result: Result,
    other: Result,
    scene: Scene,
    factor: float = 1.0,
    last_only: bool = False,
    tolerance: float = INVARIANCE,
    carried: Carried = np.asarray,
) -> list[str]:
    """Contact fractions, pressures and edges of two results; `carried` takes the edges of the other to ours."""
    if other.status != result.status:
        return [f"{name}: status {other.status}, not {result.status}"]
    ours, theirs = ([state for state in each.targets if state.found] for each in (result, other))
    if last_only:
        ours, theirs = ours[-1:], theirs[-1:]
    if len(ours) != len(theirs):
        return [f"{name}: {len(theirs)} targets, not {len(ours)}"]
    findings = []
    for one, two in zip(ours, theirs, strict=True):
        fraction = abs(two.contact_fraction - one.contact_fraction)
        unit = max(pressure_unit(scene), abs(one.mean_pressure))
        pressure = abs(two.mean_pressure / factor - one.mean_pressure) / unit if one.edges else 0.0
        moved = _moved(one, carried(np.array(two.edges) / factor), scene) if one.edges and two.edges else 0.0
        if not (fraction <= tolerance and pressure <= tolerance and moved <= tolerance):
            differs = f"area differs by {fraction:.1e}, pressure by {pressure:.1e}, edges by {moved:.1e}"
            findings.append(f"{name}: {differs} at {one.separation:.4g}")
    return findings


def _moved(state: State, other: NDArray[np.float64], scene: Scene) -> float:
    """Largest distance of the edges of a state from the nearest of others, round the period, in periods."""
    if len(state.edges) != len(other):
        return np.inf
    period = scene.surface().period
    apart = (np.array(state.edges)[:, None, :] - other[None, :, :] + period / 2) % period - period / 2
    return float(np.max(np.min(np.max(np.abs(apart), axis=2), axis=1)) / period)


IN_UNITS: dict[str, Check] = {"units_up": partial(units, factor=1e6), "units_down": partial(units, factor=1e-6)}
CHECKS = IN_UNITS | {
    check.__name__: check
    for check in (
        *(wave, dense, doubled, uniform_load, equal_patches, equal_until_bifurcation, shift, mirror),
        *(compressive, tension_at_the_end, last_gap, closing_gaps),
        *(plane_strain_only, target_alone, smaller_increments, restart),
    )
}
