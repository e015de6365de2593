"""Points of a path as the states of a result: SI units, energies, stability, error estimate and certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem.audit import certificate, gap_certificate
from bem.elastic.collocation import Evaluation
from bem.flat import FlatState
from bem.loading.assessment import Assessment, Quantities
from bem.loading.complete_contact import CompleteContact
from bem.loading.path_events import PathEvent
from bem.nonadhesive.gap_series import GapEvaluation
from bem.problem import Problem
from bem.scene.result import Certificate, ErrorEstimate, Event, EventError, State

FloatArray = NDArray[np.float64]

SAFETY = 3.0  # error estimates are this multiple of what a finer evaluation still changes
ROUNDING = 1e-13  # floor of error estimates, dimensionless
CLOSURE = 1e-8


@dataclass(frozen=True)
class Cost:
    """What a state took: unknowns of its system, evaluations and CPU seconds since the last one."""

    unknowns: int
    evaluations: int
    cpu_seconds: float


def equilibrium_state(
    problem: Problem,
    state: Evaluation | GapEvaluation,
    assessment: Assessment,
    tolerance: float,
    branch: str,
    target: bool,
    cost: Cost,
) -> State:
    """A state with contact patches and gaps; `converged` only if its certificate, which is independent, says so too.

    Parameters
    ----------
    problem, state, assessment
        What was solved.
    tolerance : float
        accuracy.tolerance of the scene.
    branch : {"loading", "unloading"}
    target : bool
        Whether the scene asks for it.
    cost : Cost
    """
    scales = problem.scales
    judged = _judged(problem, state, assessment, tolerance)
    patches = state.patches.canonical()
    mean_pressure = problem.mean_pressure(state.load)
    penetration = state.penetration * scales.height
    apart = state.separation * scales.height if isinstance(state, GapEvaluation) else None  # no difference of heights
    return State(
        branch=branch,
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
        elastic_energy=state.elastic_energy * scales.energy_per_area,
        adhesion_energy=assessment.adhesion_energy * scales.energy_per_area,
        total_energy=(state.elastic_energy + assessment.adhesion_energy) * scales.energy_per_area,
        stress_intensity_max=float(np.max(state.stress_intensity)) * scales.stress_intensity,
        contact_stiffness=assessment.stiffness / (2 * np.pi) * scales.stiffness,
        stable_at_fixed_load=assessment.stable_at_fixed_load,
        error_estimate=_error_estimate(problem, assessment.correction, apart),
        certificate=Certificate(
            closure=judged.closure,
            min_gap=judged.min_gap * scales.height,
            min_eigenvalue=judged.min_eigenvalue,
            truncation=judged.truncation,
            hessian_asymmetry=judged.hessian_asymmetry,
            ok=judged.ok,
            reasons=judged.reasons,
        ),
        unknowns=cost.unknowns,
        evaluations=cost.evaluations,
        cpu_seconds=cost.cpu_seconds,
        status="converged" if judged.ok else "not_converged",
        target=target,
    )


def _judged(
    problem: Problem, state: Evaluation | GapEvaluation, assessment: Assessment, tolerance: float
) -> certificate.Certificate:
    """The certificate, by pressures or by gaps, whichever were the unknowns."""
    if isinstance(state, GapEvaluation):
        gaps = state.gaps
        return gap_certificate.certify_gaps(
            problem.profile,
            gap_certificate.OpenGaps(gaps.anchor, gaps.shift, gaps.half_width, state.opening),
            state.deficit,
            state.mean_pressure,
            state.separation,
            penetration=state.penetration,
            compliance_ratio=problem.compliance_ratio,
        )
    return certificate.certify(
        problem.profile,
        state.pressure(),
        state.penetration,
        assessment.work,
        min_eigenvalue=assessment.min_eigenvalue,
        hessian_asymmetry=assessment.hessian_asymmetry,
        compliance_ratio=problem.compliance_ratio,
        intensity_rounding=state.rounding(problem.control.penetration_rate(state)),
        demands=certificate.Demands(closure=CLOSURE, interpenetration=max(1e-10, 1e-3 * tolerance)),
    )


def _error_estimate(problem: Problem, correction: Quantities, separation: float | None) -> ErrorEstimate:
    """The size of each correction in SI units, with a margin, never below rounding.

    The separation is that of a state given by its gaps, which rounds relative to itself.
    """
    scales = problem.scales
    stress, height, energy = scales.stress / (2 * np.pi), scales.height, scales.energy_per_area
    penetration = _margin(correction.penetration) * height
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
        contact_stiffness=_margin(correction.stiffness) * stress / height,
    )


def _margin(correction: float) -> float:
    return SAFETY * abs(correction) + ROUNDING


def separated_state(problem: Problem, penetration: float, branch: str, target: bool, status: str, cost: Cost) -> State:
    """Surfaces apart, `penetration` <= 0 in units of the rms height."""
    depth = penetration * problem.scales.height
    return _bare_state(
        penetration=depth,
        separation=problem.surface.max_height - depth,
        total_displacement=_total_displacement(problem, depth, 0.0),
        mean_pressure=0.0,
        contact_fraction=0.0,
        energies=(0.0, 0.0),
        branch=branch,
        target=target,
        status=status,
        cost=cost,
    )


def complete_state(
    problem: Problem, complete: CompleteContact, load: float, branch: str, target: bool, cost: Cost
) -> State:
    """Complete contact under a dimensionless load (nan where penetration control leaves it open)."""
    scales = problem.scales
    mean_pressure = problem.mean_pressure(load)
    return _bare_state(
        penetration=problem.surface.max_height,
        separation=0.0,
        total_displacement=_total_displacement(problem, problem.surface.max_height, mean_pressure),
        mean_pressure=mean_pressure,
        contact_fraction=1.0,
        energies=(complete.elastic_energy * scales.energy_per_area, complete.adhesion_energy * scales.energy_per_area),
        left_out=complete.left_out * scales.energy_per_area,
        branch=branch,
        target=target,
        status="complete_contact",
        cost=cost,
    )


def flat_state(flat: FlatState, adhesion_energy: float, branch: str) -> State:
    """A state of two flat surfaces."""
    joined = flat.status == "complete_contact"
    return _bare_state(
        penetration=flat.penetration,
        separation=-flat.penetration,
        total_displacement=flat.total_displacement,
        mean_pressure=flat.mean_pressure,
        contact_fraction=1.0 if joined else 0.0,
        energies=(0.0, adhesion_energy if joined else 0.0),
        branch=branch,
        target=True,
        status=flat.status,
        cost=Cost(0, 0, 0.0),
    )


def event_of(problem: Problem, event: PathEvent) -> Event:
    """An event of the path in SI units."""
    height, energy = problem.scales.height, problem.scales.energy_per_area
    at, error = event.at, event.error
    bounded, known = math.isfinite(at.load), math.isfinite(event.energy_released)
    return Event(
        kind=event.kind,
        penetration=float(at.penetration * height),
        mean_pressure=float(problem.mean_pressure(at.load)),
        position=event.position * problem.scales.length if math.isfinite(event.position) else None,
        energy_released=float(event.energy_released * energy) if known else None,
        error_estimate=EventError(
            penetration=float(_margin(error.penetration) * height),
            mean_pressure=float(problem.mean_pressure(_margin(error.load))) if bounded else None,
            energy_released=float(_margin(event.energy_error) * energy)
            if known and math.isfinite(event.energy_error)
            else None,
        ),
    )


def _bare_state(
    penetration: float,
    separation: float,
    total_displacement: float | None,
    mean_pressure: float,
    contact_fraction: float,
    energies: tuple[float, float],
    branch: str,
    target: bool,
    status: str,
    cost: Cost,
    left_out: float = 0.0,
) -> State:
    """A state without edges: exact but for the energy of elastic effects that are left out."""
    return State(
        branch=branch,
        penetration=penetration,
        separation=separation,
        total_displacement=total_displacement,
        mean_pressure=mean_pressure,
        contact_fraction=contact_fraction,
        n_patches=0,
        edges=(),
        elastic_energy=energies[0],
        adhesion_energy=energies[1],
        total_energy=sum(energies),
        stress_intensity_max=None,
        contact_stiffness=None,
        stable_at_fixed_load=None,
        error_estimate=ErrorEstimate(0.0, 0.0, elastic_energy=left_out, total_energy=left_out),
        certificate=Certificate(None, None, None, None, None, ok=status != "unreachable"),
        unknowns=cost.unknowns,
        evaluations=cost.evaluations,
        cpu_seconds=cost.cpu_seconds,
        status=status,
        target=target,
    )


def _total_displacement(problem: Problem, penetration: float, mean_pressure: float) -> float | None:
    """Delta + c(0) sigma_0 of a layer, m; None for a half-space, or where any pressure would do (nan)."""
    if problem.mean_compliance is None:
        return None
    if math.isnan(mean_pressure):
        return None if problem.mean_compliance else penetration
    return penetration + problem.mean_compliance * mean_pressure
