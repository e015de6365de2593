"""Points of a path as the states of a result: SI units, energies, stability, error estimate and certificate."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from bem.audit import certificate
from bem.audit.certificate import Certificate, DimensionlessCertificate
from bem.elastic.collocation import Evaluation
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.assessment import Assessment
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import SAFETY
from bem.loading.path_events import PathEvent, PathTension
from bem.observables import gaps
from bem.observables.gaps import GapStatistics
from bem.problem import Problem
from bem.scene.result import Event, EventError, EventKind, JumpEnd, LargestTension, TensionError
from bem.scene.state import CLOSED, ErrorEstimate, FinalStatus, GapNumbers, GapQuantiles, State, Status

if TYPE_CHECKING:
    from bem.nonadhesive.gap_series import GapEvaluation

ERROR_FLOOR = 1e-13  # derived: floor of error estimates, dimensionless and of the number itself
RELEASE_ROUNDING = 1.5e-12  # of an energy released, over the potential before: a difference; measured 4.7e-13
STIFFNESS_ROUNDING = 2e-11  # of a stiffness, relative: it is solved for, edges hardly resisting; measured 1.3e-11
EXACT = ErrorEstimate(mean_pressure=0.0, contact_fraction=0.0, elastic_energy=0.0, total_energy=0.0)
CLOSURE = 1e-8  # derived: residual that the certificate asks for, ten times that of targets


def equilibrium_state(
    problem: Problem, state: Evaluation | GapEvaluation, assessment: Assessment, tolerance: float, target: bool
) -> State:
    """Return a state with contact patches and gaps, `converged` only if its independent certificate is ok.

    Parameters
    ----------
    problem, state, assessment
        Problem, its solution, and the assessment of the solution.
    tolerance : float
        accuracy.tolerance of the scene.
    target : bool
        Whether the largest pressure and gap are computed.
    """
    scales = problem.scales
    judged = _judged(problem, state, assessment, tolerance)
    patches = state.patches.canonical()
    mean_pressure = problem.mean_pressure(state.load)
    penetration = state.penetration * scales.height
    apart = None if isinstance(state, Evaluation) else state.separation * scales.height  # no difference of heights
    return State(
        status="converged" if judged.ok else "not_converged",
        penetration=penetration,
        separation=problem.surface.max_height - penetration if apart is None else apart,
        total_displacement=total_displacement(problem, penetration, mean_pressure),
        mean_pressure=mean_pressure,
        contact_fraction=patches.contact_fraction,
        n_patches=patches.count,
        edges=_edges(problem, patches),
        elastic_energy=state.elastic_energy * scales.energy_per_area,
        adhesion_energy=assessment.adhesion_energy * scales.energy_per_area,
        total_energy=(state.elastic_energy + assessment.adhesion_energy) * scales.energy_per_area,
        stress_intensity_max=float(np.max(state.stress_intensity)) * scales.stress_intensity,
        contact_stiffness=assessment.stiffness / (2 * np.pi) * scales.stiffness,
        stable_at_fixed_load=assessment.stable_at_fixed_load,
        peak_pressure=state.pressure().peak() * scales.stress if target else None,
        largest_gap=judged.largest_gap * scales.height if target else None,
        gaps=_gaps(problem, state) if target else None,
        error_estimate=_error_estimate(problem, assessment, apart),
        certificate=judged.of_height(scales.height),
        unknowns=state.unknowns,
    )


def _gaps(problem: Problem, state: Evaluation | GapEvaluation) -> GapNumbers:
    """Return the gaps of a state with contact patches, from the unknowns: its pressure or its gaps."""
    if isinstance(state, Evaluation):
        open_gaps = gaps.open_gaps(problem.profile, state.pressure(), state.penetration, problem.compliance_ratio)
        widths = gaps.gap_widths(state.pressure())
        statistics = gaps.statistics(np.split(open_gaps.height, np.cumsum(open_gaps.count)[:-1]), widths)
        separation = problem.profile.max_height - state.penetration
    else:
        widths = 2 * state.gaps.half_width
        statistics = gaps.statistics_of_openings(state.gaps.half_width, state.opening)
        separation = state.separation
    return _gaps_of(problem, statistics, separation * problem.scales.height, float(np.sum(widths)) / (2 * np.pi))


def _gaps_of(problem: Problem, statistics: GapStatistics, separation: float, open_fraction: float) -> GapNumbers:
    """Return gap statistics in SI units."""
    height = problem.scales.height
    return GapNumbers(
        mean_open=separation / open_fraction,
        mean_cubic_root=float(np.cbrt(statistics.mean_cube)) * height,
        quantiles=GapQuantiles(*(float(quantile) * height for quantile in statistics.quantiles)),
        widest_channel=statistics.widest * problem.scales.length,
        open_fraction=open_fraction,
    )


def _judged(
    problem: Problem, state: Evaluation | GapEvaluation, assessment: Assessment, tolerance: float
) -> DimensionlessCertificate:
    """Return the certificate from the unknowns: pressures or gaps."""
    if not isinstance(state, Evaluation):
        from bem.audit import gap_certificate  # only the last gaps

        return gap_certificate.certify_gaps(
            problem.profile,
            state.gaps,
            state.opening,
            deficit=state.deficit,
            mean_pressure=state.mean_pressure,
            separation=state.separation,
            penetration=state.penetration,
            compliance_ratio=problem.compliance_ratio,
        )
    adhesion: certificate.AdhesiveEdges | None = None
    rounding = state.rounding(problem.control.penetration_rate(state))
    if assessment.work is not None:
        stability = assessment.min_eigenvalue, assessment.hessian_asymmetry
        adhesion = certificate.AdhesiveEdges(assessment.work, *stability)
    return certificate.certify(
        problem.profile,
        state.pressure(),
        state.penetration,
        adhesion,
        compliance_ratio=problem.compliance_ratio,
        demands=certificate.Demands(
            closure=CLOSURE,
            intensity=max(3 * CLOSURE, tolerance),
            interpenetration=max(1e-10, 1e-3 * tolerance),
            intensity_rounding=rounding,
        ),
    )


def _error_estimate(problem: Problem, assessment: Assessment, separation: float | None) -> ErrorEstimate:
    """Return the size of each correction in SI units, with a margin, never below rounding.

    `separation` is given for a state whose unknowns are gaps: its rounding is relative to itself.  The rounding of a
    stiffness is relative too, because the stiffness is large where edges are about to move on their own.
    """
    correction, scales = assessment.correction, problem.scales
    stress, height, energy = scales.stress / (2 * np.pi), scales.height, scales.energy_per_area
    penetration = _margin(correction.penetration) * height
    relative = STIFFNESS_ROUNDING * abs(assessment.stiffness)
    total = None
    if problem.mean_compliance is not None:
        share = problem.mean_compliance * stress / height  # of the mean compression in the displacement of the plate
        moved = correction.penetration + share * correction.load
        total = (_margin(moved) + share * ERROR_FLOOR) * height
    apart = penetration
    if separation is not None:
        apart = SAFETY * abs(correction.penetration) * height + ERROR_FLOOR * separation
    return ErrorEstimate(
        mean_pressure=_margin(correction.load) * stress,
        contact_fraction=_margin(correction.contact_length) / (2 * np.pi),
        penetration=penetration,
        separation=apart,
        total_displacement=total,
        elastic_energy=_margin(correction.elastic_energy) * energy,
        adhesion_energy=_margin(correction.adhesion_energy) * energy,
        total_energy=_margin(correction.total_energy) * energy,
        stress_intensity_max=_margin(correction.stress_intensity) * scales.stress_intensity,
        contact_stiffness=(_margin(correction.stiffness) + relative) * stress / height,
    )


def _margin(correction: float, value: float = 0.0) -> float:
    return SAFETY * abs(correction) + ERROR_FLOOR * max(1.0, abs(value))


def _pressure_margin(problem: Problem, error: float, load: float) -> float:
    """Return the error of the mean pressure (Pa) of an event; its floor is of pressures, a load sums them over 2 pi.

    2e-13 of a load was measured where a jump begins, with a BLAS that rounds each product.
    """
    return float(_margin(error / (2 * np.pi), load / (2 * np.pi)) * problem.scales.stress)


def separated_state(problem: Problem, penetration: float) -> State:
    """Return surfaces apart, at a `penetration` <= 0 in units of the rms height."""
    depth = penetration * problem.scales.height
    surface = problem.surface
    separation = surface.max_height - depth
    lowest = Profile(surface.period, surface.orders, surface.amplitudes, surface.phases + np.pi)  # its crests
    return State(
        status="separated",
        penetration=depth,
        separation=separation,
        total_displacement=total_displacement(problem, depth, 0.0),
        largest_gap=separation + lowest.max_height,
        gaps=_gaps_of(problem, gaps.apart(problem.profile, penetration), separation, 1.0),
        error_estimate=EXACT,
    )


def complete_state(problem: Problem, complete: CompleteContact, load: float) -> State:
    """Return complete contact under a dimensionless load, nan where penetration control leaves it open.

    Complete contact is exact but for the elastic energy of effects that are left out.
    """
    scales, depth = problem.scales, problem.surface.max_height
    mean_pressure = problem.mean_pressure(load)
    elastic, adhesion = (
        energy * scales.energy_per_area for energy in (complete.elastic_energy, complete.adhesion_energy)
    )
    left_out = complete.left_out * scales.energy_per_area
    return State(
        status="complete_contact",
        penetration=depth,
        separation=0.0,
        total_displacement=total_displacement(problem, depth, mean_pressure),
        mean_pressure=mean_pressure,
        contact_fraction=1.0,
        elastic_energy=elastic,
        adhesion_energy=adhesion,
        total_energy=elastic + adhesion,
        peak_pressure=None if math.isnan(load) else mean_pressure + complete.pressure.max_height * scales.stress,
        largest_gap=0.0,
        gaps=CLOSED,
        error_estimate=replace(EXACT, elastic_energy=left_out, total_energy=left_out),
    )


def missed_state(control: str, target: float, status: Status, reason: str, apart: State) -> State:
    """Return the row of a target at which no state was found, SI: NaN but for the quantity under control.

    Where no contact carries the tension asked for, the row has the numbers of the surfaces `apart`.
    """
    certificate = Certificate(ok=False, reasons=(reason,))
    if status == "unreachable" and control == "mean_pressure":
        return replace(apart, status=status, certificate=certificate)
    names = ["penetration", "separation", "mean_pressure", "contact_fraction"]
    names += ["elastic_energy", "adhesion_energy", "total_energy"]
    numbers: dict[str, Any] = dict.fromkeys(names, math.nan) | {control: target}
    return State(status=status, certificate=certificate, **numbers)


def event_of(problem: Problem, event: PathEvent) -> Event:
    """Return an event of the path in SI units."""
    height, energy = problem.scales.height, problem.scales.energy_per_area
    at, error = event.at, event.error
    bounded, known = math.isfinite(at.load), math.isfinite(event.energy_released)
    doubt = _margin(event.energy_error, event.energy_released) + RELEASE_ROUNDING * abs(at.potential)
    return Event(
        kind=cast(EventKind, event.kind),
        penetration=float(at.penetration * height),
        mean_pressure=float(problem.mean_pressure(at.load)),
        position=event.position * problem.scales.length if math.isfinite(event.position) else None,
        energy_released=float(event.energy_released * energy) if known else None,
        error_estimate=EventError(
            penetration=float(_margin(error.penetration, at.penetration) * height),
            mean_pressure=_pressure_margin(problem, error.load, at.load) if bounded else None,
            energy_released=float(doubt * energy) if known and math.isfinite(doubt) else None,
        ),
    )


def jump_end(
    problem: Problem, status: FinalStatus, patches: Patches | None, penetration: float, load: float
) -> JumpEnd:
    """Return an end of a jump in SI units from its patches, if any, and its dimensionless penetration and load."""
    edges = () if patches is None else _edges(problem, patches.canonical())
    return JumpEnd(status, float(penetration * problem.scales.height), float(problem.mean_pressure(load)), edges)


def _edges(problem: Problem, patches: Patches) -> tuple[tuple[float, float], ...]:
    """Return the edges of patches, m."""
    left, right = (ends * problem.scales.length for ends in (patches.left, patches.right))
    return tuple((float(a), float(b)) for a, b in zip(left, right, strict=True))


def tension_of(problem: Problem, tension: PathTension | None) -> LargestTension | None:
    """Return the largest tension of a path in SI units; None where the least load is no tension."""
    if tension is None or tension.at.load >= 0:
        return None
    height, at = problem.scales.height, tension.at
    return LargestTension(
        mean_pressure=float(problem.mean_pressure(at.load)),
        penetration=float(at.penetration * height),
        separation=float(problem.surface.max_height - at.penetration * height),
        kind=tension.kind,
        error_estimate=TensionError(_pressure_margin(problem, tension.error.load, at.load)),
    )


def not_below_rounding(state: State) -> State:
    """Return a state with errors of at least `ERROR_FLOOR` of their numbers; sums round as their terms do."""
    errors = {name: error for name, error in vars(state.error_estimate).items() if error is not None}
    sizes = {name: abs(getattr(state, name) or 0.0) for name in errors}
    sizes["total_energy"] = abs(state.elastic_energy) + abs(state.adhesion_energy)
    known = {
        name: max(error, ERROR_FLOOR * sizes[name]) for name, error in errors.items() if math.isfinite(sizes[name])
    }
    return replace(state, error_estimate=replace(state.error_estimate, **known))


def total_displacement(problem: Problem, penetration: float, mean_pressure: float) -> float | None:
    """Return Delta + c(0) sigma_0 of a layer, m; None for a half-space, or where any pressure would do (nan)."""
    if problem.mean_compliance is None:
        return None
    if math.isnan(mean_pressure):
        return None if problem.mean_compliance else penetration
    return penetration + problem.mean_compliance * mean_pressure
