"""Points of a path as the states of a result: SI units, energies, stability, error estimate and certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from bem.audit import certificate
from bem.audit.certificate import Certificate, DimensionlessCertificate
from bem.elastic.collocation import Evaluation
from bem.flat import FlatState
from bem.geometry.profile import Profile
from bem.loading.assessment import Assessment
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import SAFETY
from bem.loading.path_events import PathEvent
from bem.problem import Problem
from bem.scene.result import ErrorEstimate, Event, EventError, State

if TYPE_CHECKING:
    from bem.nonadhesive.gap_series import GapEvaluation

ROUNDING = 1e-13  # derived: floor of error estimates, dimensionless and of the number itself
RELEASE_ROUNDING = 1.5e-12  # of an energy released, over the potential before: a difference; measured 4.7e-13
STIFFNESS_ROUNDING = 5e-12  # of a stiffness, relative: it is solved for, edges hardly resisting; measured 2.3e-12
RESIDUAL = 1e-8  # derived: residual that the certificate asks for, ten times that of targets


@dataclass(frozen=True)
class Cost:
    """What a state took: unknowns of its system, evaluations and CPU seconds since the last one."""

    unknowns: int
    evaluations: int
    cpu_seconds: float


@dataclass(frozen=True)
class Place:
    """Where on the path a state was kept, and what it took.

    Attributes
    ----------
    branch : {"loading", "unloading"}
    target : bool
        Whether the scene asks for it.
    cost : Cost
    """

    branch: str
    target: bool
    cost: Cost


def equilibrium_state(
    problem: Problem, state: Evaluation | GapEvaluation, assessment: Assessment, tolerance: float, place: Place
) -> State:
    """A state with contact patches and gaps; `converged` only if its certificate, which is independent, says so too.

    Parameters
    ----------
    problem, state, assessment
        What was solved.
    tolerance : float
        accuracy.tolerance of the scene.
    place : Place
    """
    scales = problem.scales
    judged = _judged(problem, state, assessment, tolerance)
    patches = state.patches.canonical()
    mean_pressure = problem.mean_pressure(state.load)
    penetration = state.penetration * scales.height
    apart = None if isinstance(state, Evaluation) else state.separation * scales.height  # no difference of heights
    return _not_below_rounding(
        State(
            branch=place.branch,
            penetration=penetration,
            separation=problem.surface.max_height - penetration if apart is None else apart,
            total_displacement=_total_displacement(problem, penetration, mean_pressure),
            mean_pressure=mean_pressure,
            contact_fraction=patches.contact_fraction,
            n_patches=patches.count,
            edges=tuple(
                (float(a), float(b))
                for a, b in zip(patches.left * scales.length, patches.right * scales.length, strict=True)
            ),
            peak_pressure=state.pressure().peak() * scales.stress if place.target else None,
            largest_gap=judged.largest_gap * scales.height if place.target else None,
            elastic_energy=state.elastic_energy * scales.energy_per_area,
            adhesion_energy=assessment.adhesion_energy * scales.energy_per_area,
            total_energy=(state.elastic_energy + assessment.adhesion_energy) * scales.energy_per_area,
            stress_intensity_max=float(np.max(state.stress_intensity)) * scales.stress_intensity,
            contact_stiffness=assessment.stiffness / (2 * np.pi) * scales.stiffness,
            stable_at_fixed_load=assessment.stable_at_fixed_load,
            error_estimate=_error_estimate(problem, assessment, apart),
            certificate=judged.of_height(scales.height),
            unknowns=place.cost.unknowns,
            evaluations=place.cost.evaluations,
            cpu_seconds=place.cost.cpu_seconds,
            status="converged" if judged.ok else "not_converged",
            target=place.target,
        )
    )


def _judged(
    problem: Problem, state: Evaluation | GapEvaluation, assessment: Assessment, tolerance: float
) -> DimensionlessCertificate:
    """The certificate, by pressures or by gaps, whichever were the unknowns."""
    if not isinstance(state, Evaluation):
        from bem.audit import gap_certificate  # only the last gaps

        gaps = state.gaps
        return gap_certificate.certify_gaps(
            problem.profile,
            gap_certificate.OpenGaps(gaps.anchor, gaps.shift, gaps.half_width, state.opening),
            gap_certificate.Levels(state.deficit, state.mean_pressure, state.separation, state.penetration),
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
            closure=RESIDUAL,
            intensity=max(3 * RESIDUAL, tolerance),
            interpenetration=max(1e-10, 1e-3 * tolerance),
            intensity_rounding=rounding,
        ),
    )


def _error_estimate(problem: Problem, assessment: Assessment, separation: float | None) -> ErrorEstimate:
    """The size of each correction in SI units, with a margin, never below rounding.

    The separation is that of a state given by its gaps, which rounds relative to itself; so does a stiffness, which is
    large where edges are about to move on their own.
    """
    correction, scales = assessment.correction, problem.scales
    stress, height, energy = scales.stress / (2 * np.pi), scales.height, scales.energy_per_area
    penetration = _margin(correction.penetration) * height
    relative = STIFFNESS_ROUNDING * abs(assessment.stiffness)
    total = None
    if problem.mean_compliance is not None:
        share = problem.mean_compliance * stress / height  # of the mean compression in the displacement of the plate
        moved = correction.penetration + share * correction.load
        total = (_margin(moved) + share * ROUNDING) * height
    apart = penetration
    if separation is not None:
        apart = SAFETY * abs(correction.penetration) * height + ROUNDING * separation
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
    return SAFETY * abs(correction) + ROUNDING * max(1.0, abs(value))


def separated_state(problem: Problem, penetration: float, status: str, place: Place) -> State:
    """Surfaces apart, `penetration` <= 0 in units of the rms height."""
    depth = penetration * problem.scales.height
    surface = problem.surface
    gap, total = surface.max_height - depth, _total_displacement(problem, depth, 0.0)
    lowest = Profile(surface.period, surface.orders, surface.amplitudes, surface.phases + np.pi)  # its crests
    return _bare_state(_Bare(status, depth, gap, total, largest_gap=gap + lowest.max_height), place)


def complete_state(problem: Problem, complete: CompleteContact, load: float, place: Place) -> State:
    """Complete contact under a dimensionless load (nan where penetration control leaves it open)."""
    scales, depth = problem.scales, problem.surface.max_height
    mean_pressure = problem.mean_pressure(load)
    bare = _Bare(
        "complete_contact",
        depth,
        0.0,
        _total_displacement(problem, depth, mean_pressure),
        mean_pressure,
        elastic_energy=complete.elastic_energy * scales.energy_per_area,
        adhesion_energy=complete.adhesion_energy * scales.energy_per_area,
        left_out=complete.left_out * scales.energy_per_area,
        peak_pressure=None if math.isnan(load) else mean_pressure + complete.pressure.max_height * scales.stress,
    )
    return _bare_state(bare, place)


@dataclass(frozen=True)
class Missed:
    """A target that was not met.

    Attributes
    ----------
    control : str
        The quantity under control.
    target : float
        What it should have been, SI.
    status : {"unreachable", "not_converged"}
    reason : str
        Which target of how many, why, and what may help.
    """

    control: str
    target: float
    status: str
    reason: str


def missed_state(missed: Missed, place: Place) -> State:
    """The row of a target at which no state was found: NaN but for what is under control."""
    numbers = ("penetration", "separation", "mean_pressure", "contact_fraction")
    energies = ("elastic_energy", "adhesion_energy", "total_energy")
    unknown: dict[str, Any] = {**dict.fromkeys((*numbers, *energies), math.nan), "total_displacement": None}
    return State(
        branch=place.branch,
        **unknown | {missed.control: missed.target},
        n_patches=0,
        edges=(),
        stress_intensity_max=None,
        contact_stiffness=None,
        stable_at_fixed_load=None,
        error_estimate=ErrorEstimate(),
        certificate=Certificate(None, None, None, None, None, ok=False, reasons=(missed.reason,)),
        unknowns=place.cost.unknowns,
        evaluations=place.cost.evaluations,
        cpu_seconds=place.cost.cpu_seconds,
        status=missed.status,
        target=True,
    )


def flat_state(flat: FlatState, adhesion_energy: float, branch: str) -> State:
    """A state of two flat surfaces."""
    bare = _Bare(
        flat.status,
        flat.penetration,
        -flat.penetration,
        flat.total_displacement,
        flat.mean_pressure,
        adhesion_energy=adhesion_energy if flat.status == "complete_contact" else 0.0,
        peak_pressure=None
        if flat.status != "complete_contact" or math.isnan(flat.mean_pressure)
        else flat.mean_pressure,
        largest_gap=-flat.penetration,
    )
    return _bare_state(bare, Place(branch, True, Cost(0, 0, 0.0)))


def event_of(problem: Problem, event: PathEvent) -> Event:
    """An event of the path in SI units."""
    height, energy = problem.scales.height, problem.scales.energy_per_area
    at, error = event.at, event.error
    bounded, known = math.isfinite(at.load), math.isfinite(event.energy_released)
    doubt = _margin(event.energy_error, event.energy_released) + RELEASE_ROUNDING * abs(at.potential)
    return Event(
        kind=event.kind,
        penetration=float(at.penetration * height),
        mean_pressure=float(problem.mean_pressure(at.load)),
        position=event.position * problem.scales.length if math.isfinite(event.position) else None,
        energy_released=float(event.energy_released * energy) if known else None,
        error_estimate=EventError(
            penetration=float(_margin(error.penetration, at.penetration) * height),
            mean_pressure=float(problem.mean_pressure(_margin(error.load, at.load))) if bounded else None,
            energy_released=float(doubt * energy) if known and math.isfinite(doubt) else None,
        ),
    )


@dataclass(frozen=True)
class _Bare:
    """A state without edges, SI: exact but for the elastic energy of effects that are left out."""

    status: str
    penetration: float
    separation: float
    total_displacement: float | None
    mean_pressure: float = 0.0
    elastic_energy: float = 0.0
    adhesion_energy: float = 0.0
    left_out: float = 0.0
    peak_pressure: float | None = None
    largest_gap: float = 0.0


def _bare_state(bare: _Bare, place: Place) -> State:
    """The same as a state of a result."""
    return _not_below_rounding(
        State(
            branch=place.branch,
            penetration=bare.penetration,
            separation=bare.separation,
            total_displacement=bare.total_displacement,
            mean_pressure=bare.mean_pressure,
            contact_fraction=1.0 if bare.status == "complete_contact" else 0.0,
            n_patches=0,
            edges=(),
            elastic_energy=bare.elastic_energy,
            adhesion_energy=bare.adhesion_energy,
            total_energy=bare.elastic_energy + bare.adhesion_energy,
            stress_intensity_max=None,
            contact_stiffness=None,
            stable_at_fixed_load=None,
            peak_pressure=bare.peak_pressure if place.target else None,
            largest_gap=bare.largest_gap if place.target else None,
            error_estimate=ErrorEstimate(0.0, 0.0, elastic_energy=bare.left_out, total_energy=bare.left_out),
            certificate=Certificate(None, None, None, None, None, ok=bare.status != "unreachable"),
            unknowns=place.cost.unknowns,
            evaluations=place.cost.evaluations,
            cpu_seconds=place.cost.cpu_seconds,
            status=bare.status,
            target=place.target,
        )
    )


def _not_below_rounding(state: State) -> State:
    """With errors of at least `ROUNDING` of their numbers; a sum or difference rounds as what it is made of."""
    found = {name: error for name, error in vars(state.error_estimate).items() if error is not None}
    sizes = {name: abs(getattr(state, name) or 0.0) for name in found}
    sizes["total_energy"] = abs(state.elastic_energy) + abs(state.adhesion_energy)
    known = {name: max(error, ROUNDING * sizes[name]) for name, error in found.items() if math.isfinite(sizes[name])}
    return replace(state, error_estimate=replace(state.error_estimate, **known))


def _total_displacement(problem: Problem, penetration: float, mean_pressure: float) -> float | None:
    """Delta + c(0) sigma_0 of a layer, m; None for a half-space, or where any pressure would do (nan)."""
    if problem.mean_compliance is None:
        return None
    if math.isnan(mean_pressure):
        return None if problem.mean_compliance else penetration
    return penetration + problem.mean_compliance * mean_pressure
