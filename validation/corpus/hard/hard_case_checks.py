"""Independent checks of the hard cases of the boundary elements: closed forms, the dense route, and copies.

A check takes what was solved and yields texts, one for each that fails; none means that nothing was found against the
result.  Tolerances are stated beside the error measured.  SI units.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bem.contact_state import ContactState
from bem.elastic.layer import Layer
from bem.geometry.scaling import Scales, Solid
from bem.scene.result import State
from bem.solver import solve
from validation.corpus.hard import copies
from validation.corpus.hard.any_result import Solved
from validation.corpus.hard.copies import Copy, Nearness
from validation.corpus.hard.hard_case_run import Check
from validation.references.closed_forms import full_contact_amplitudes
from validation.references.dense import evaluate_dense
from validation.references.isolated_crack import closing, crack, valleys

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


def wave(solved: Solved) -> Iterator[str]:
    """Pressure and penetration of one wave at the solver's own contact width: Westergaard's; with adhesion Johnson's.

    K. L. Johnson, Int. J. Solids Struct. 32 (1995) 423.
    """
    surface, adhesion, modulus = solved.scene.surface(), solved.scene.adhesion, solved.plane_strain_modulus
    amplitude, period = float(surface.amplitudes[0]), surface.period
    peak = np.pi * modulus * amplitude / period
    alpha = np.sqrt(2 * modulus * (0.0 if adhesion is None else adhesion.work_of_adhesion) / period) / peak
    for state in solved.touching:
        gap = np.pi / 2 * (1 - state.contact_fraction)  # the complement keeps the digits near complete contact
        share, tangent = np.cos(gap) ** 2, np.sqrt(1 / np.tan(gap))
        pressure = peak * (share - alpha * tangent)
        penetration = amplitude * (share * (1 - np.log(share)) + alpha * tangent * np.log(share))
        error = abs(state.mean_pressure - pressure) / max(peak, abs(pressure))
        shift = abs(state.penetration - penetration) / amplitude
        if not (error <= CLOSED_FORM and shift <= CLOSED_FORM):
            yield f"closed form missed by {error:.1e} p*, {shift:.1e} D at {state.contact_fraction:.6g}"


def dense(solved: Solved) -> Iterator[str]:
    """Mean pressure at the edges of every target by the dense route, beyond what rounding of the penetration moves it.

    Next to complete contact that is much: the pressure has a pole where the last gap closes.
    """
    surface = solved.scene.surface()
    scales = Scales(surface.period, surface.rms_height, solved.plane_strain_modulus)
    for state in solved.touching:
        edges = np.array(state.edges) / scales.length

        def at(penetration: float, edges: NDArray[np.float64] = edges) -> float:
            there = evaluate_dense(surface.scaled(), edges[:, 0], edges[:, 1], penetration / scales.height)
            return there.load / (2 * np.pi) * scales.stress

        pressure = at(state.penetration)
        unit = max(solved.pressure, abs(pressure))
        error = abs(pressure - state.mean_pressure) / unit
        if error <= DENSE:
            continue
        rounded = abs(at(state.penetration * (1 + ROUNDINGS * EPS)) - pressure) / unit
        if not error <= DENSE + rounded:
            yield f"dense route differs by {error:.1e} at separation {state.separation:.4g}"


def doubled(solved: Solved) -> Iterator[str]:
    """Mean pressure at the edges of every target with a layer, at the finest resolution."""
    for state in solved.touching:
        pressure = _contact(solved, state, 1e-13).mean_pressure
        error = abs(pressure - state.mean_pressure) / max(solved.pressure, abs(pressure))
        if not error <= DENSE:
            yield f"doubled resolution differs by {error:.1e} at separation {state.separation:.4g}"


def uniform_load(solved: Solved) -> Iterator[str]:
    """A flat profile carries exactly the load asked for, at separation zero."""
    expected = [(target, 0.0, 1.0) for target in solved.scene.loading.targets]
    states = [state for state in solved.result.targets if state.found]
    found = [(state.mean_pressure, state.separation, state.contact_fraction) for state in states]
    if found != expected:
        yield f"flat profile gives {found}"


def equal_patches(solved: Solved) -> Iterator[str]:
    """All patches of every target are equally wide."""
    for state in solved.touching:
        yield from _unequal(state)


def compressive(solved: Solved) -> Iterator[str]:
    """Without adhesion no pressure inside a patch is tensile; it vanishes at the edges, and is weighted by their roots.

    Noise of the heights h leaves a pressure of h E* over the width of the patch.
    """
    noise = HEIGHT_NOISE * solved.scene.surface().rms_height * solved.plane_strain_modulus
    for state in solved.touching:
        contact = _contact(solved, state, 1e-12)
        angle = np.pi * (np.arange(WITHIN) + 0.5) / WITHIN
        for a, b in state.edges:
            pressure = _weighted_pressure(contact, a, b, angle)
            dips = 1 + np.flatnonzero((pressure[1:-1] <= pressure[:-2]) & (pressure[1:-1] <= pressure[2:]))
            closer = [np.linspace(angle[k - 1], angle[k + 1], WITHIN) for k in dips[np.argsort(pressure[dips])][:1]]
            near = [_weighted_pressure(contact, a, b, points).min() for points in closer]
            lowest, mean = float(min([pressure.min(), *near])), float(pressure.mean())
            if not lowest >= -TENSION * mean - noise / (b - a):
                yield f"pressure {lowest / mean:.1e} of the mean of its patch at separation {state.separation:.4g}"


def _contact(solved: Solved, state: State, tolerance: float) -> ContactState:
    """The elastic state at the edges and the penetration of a state."""
    solid, layer = solved.scene.solid, solved.scene.layer
    return ContactState(
        solved.scene.surface(),
        Solid(solid.youngs_modulus, solid.poisson_ratio),
        state.edges,
        state.penetration,
        None if layer is None else Layer(layer.thickness),
        tolerance=tolerance,
    )


def _weighted_pressure(contact: ContactState, a: float, b: float, angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pressure at a + (b - a) (1 - cos angle) / 2, times the root of the distances from both edges."""
    return np.asarray(contact.pressure(a + (b - a) * (1 - np.cos(angle)) / 2) * np.sin(angle))


def tension_at_the_end(solved: Solved) -> Iterator[str]:
    """The load is compressive before and tensile at the target of largest contact."""
    last = solved.closest.mean_pressure
    if not (any(state.mean_pressure > 0 for state in solved.touching) and last < 0):
        yield f"mean pressure {last:.4g} at the end"


def last_gap(solved: Solved) -> Iterator[str]:
    """At the largest contact one gap is left; load and separation are those of an isolated crack of its width."""
    state, surface = solved.closest, solved.scene.surface()
    if state.n_patches != 1:
        yield f"{state.n_patches} gaps at the target of largest contact"
        return
    ((start, end),) = state.edges
    work = solved.tables["adhesion"]["work_of_adhesion"]
    pressure, separation = crack(surface, solved.plane_strain_modulus, work, end, start + surface.period)
    error = abs(pressure - state.mean_pressure) / max(solved.pressure, abs(pressure))
    wider = abs(separation - state.separation) / state.separation
    if not (error <= LAST_GAP and wider <= LAST_GAP):
        missed = f"{error:.1e} of the pressure, {wider:.1e} of the separation"
        yield f"crack missed by {missed} at {state.separation:.4g}"


def closing_gaps(solved: Solved) -> Iterator[str]:
    """Without adhesion, at the largest contact: missing load and widths of gaps are those of isolated cracks."""
    state, surface, modulus = solved.closest, solved.scene.surface(), solved.plane_strain_modulus
    amplitudes = full_contact_amplitudes(surface.orders, surface.amplitudes, surface.period, modulus)
    complete = replace(surface, amplitudes=amplitudes)
    pressure, widths = closing(complete, modulus, state.separation)
    share = abs(pressure - state.mean_pressure) / (valleys(complete)[0].min() * -1)
    narrower = abs((1 - state.contact_fraction) * surface.period / float(widths.sum()) - 1)
    if not (state.n_patches == widths.size and share <= CLOSING_LOAD and narrower <= CLOSING_WIDTH):
        yield f"{state.n_patches} gaps, load off by {share:.1e}, widths by {narrower:.1e} at {state.separation:.4g}"


def equal_until_bifurcation(solved: Solved) -> Iterator[str]:
    """The patches are equally wide before the first bifurcation, and not after it."""
    first = next((event.penetration for event in solved.result.events if event.kind == "bifurcation"), np.inf)
    for state in solved.touching:
        if state.branch != "loading":
            break
        if state.penetration < first:
            yield from _unequal(state)
            if not (state.certificate.min_eigenvalue or 0.0) > 0:
                yield "smallest eigenvalue not positive before the bifurcation"
        elif state.n_patches == max(solved.scene.profile.orders or (1,)) and not any(_unequal(state)):
            yield f"still symmetric beyond the bifurcation at {first:.4g} m"


def _unequal(state: State) -> Iterator[str]:
    widths = np.array([b - a for a, b in state.edges])
    spread = float(np.ptp(widths) / widths.mean())
    if not spread <= EQUAL:
        yield f"patches differ by {spread:.1e} at separation {state.separation:.4g}"


def copied(solved: Solved, make: Callable[[Solved], Copy | None], tolerance: float = INVARIANCE) -> Iterator[str]:
    """The states of a copy are the same, exactly."""
    made = make(solved)
    if made is None:
        yield "no target to begin from"
    else:
        yield from _same(solved, made, tolerance)


def target_alone(solved: Solved) -> Iterator[str]:
    """Without adhesion every target alone gives the same state, within the errors estimated where they are larger."""
    for place, target in enumerate(solved.scene.loading.targets):
        for text in _same(solved, copies.alone(solved, place), INVARIANCE, estimated=True):
            yield f"{target:g}, {text}"


def _same(solved: Solved, made: Copy, tolerance: float, estimated: bool = False) -> Iterator[str]:
    """What differs between the states of a copy and the original; errors of the contact fraction, where they count."""
    other = solve(made.scene)
    states = (*made.visited(solved.result), *other.targets) if estimated else ()
    allowed = max([tolerance, *(state.error_estimate.contact_fraction or 0.0 for state in states)])
    units = replace(solved.units, pressure=solved.pressure)
    exactly = replace(made, near=Nearness(allowed, exact=True))
    yield from (finding.text for finding in copies.compared(exactly, solved, other, units))


ITSELF: tuple[Callable[[Solved], Iterator[str]], ...] = (
    *(wave, dense, doubled, uniform_load, equal_patches, equal_until_bifurcation),
    *(compressive, tension_at_the_end, last_gap, closing_gaps, target_alone),
)
CHECKS: dict[str, Check] = {
    **{check.__name__: check for check in ITSELF},
    "shift": partial(copied, make=copies.shifted),
    "mirror": partial(copied, make=copies.mirrored),
    "units_up": partial(copied, make=partial(copies.scaled, length=1e6, modulus=1e6)),
    "units_down": partial(copied, make=partial(copies.scaled, length=1e-6, modulus=1e-6)),
    "plane_strain_only": partial(copied, make=copies.plane_strain),
    "smaller_increments": partial(copied, make=partial(copies.smaller_increment, part=10), tolerance=SAME_END),
    "restart": partial(copied, make=partial(copies.restarted, rest=1), tolerance=SAME_END),
}
