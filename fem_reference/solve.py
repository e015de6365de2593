"""Solve one contact problem: prescribed edges, complete contact, or the JKR closure, with uncertainties.

The method, in order. The input is checked and made dimensionless (`problem`). For prescribed edges two meshes of
different fineness are graded towards the edges (`mesh`), the layer is solved on each under no load and under unit
load (`elasticity`, `contact`), the two are combined to meet the control, and the signed stress intensity follows from
the energy release rate (`energy_release`). Without edges the closure finds them: from the crests of the profile
(`crests`) by Newton's method on a coarse mesh, then as a chord on the same three meshes (`closure`). The difference
between the meshes is the uncertainty (`result`). Finally the state is judged: an edge with K < 0, a part of the
profile that enters the layer where no contact was assumed, a missing equilibrium.
"""

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from fem_reference.closure import (
    Closure,
    Control,
    ControlKind,
    Evaluation,
    close_on_ladder,
    evaluate,
    hessian,
    start_edges,
)
from fem_reference.contact import contact_indicator
from fem_reference.crests import chosen_crests, scaled_patches
from fem_reference.face import face_nodes
from fem_reference.mesh import FEWEST_LEVELS, LayerMesh, Resolution, check_edges, layer_mesh
from fem_reference.problem import FloatArray, InvalidProblemError, Problem
from fem_reference.result import Quantity, Result, Status, interface_fields, patch_order, quantities, uncertainties

Harmonics = tuple[ArrayLike, ArrayLike, ArrayLike]
Edges = ArrayLike | Literal["complete"] | None

FEWEST_CELLS = {2: 10, 4: 8}  # by order: half of them are the coarsest mesh of the three


def solve(
    *,
    youngs_modulus: float,
    poisson_ratio: float,
    thickness: float,
    period: float,
    harmonics: Harmonics,
    control: ControlKind,
    value: float,
    work_of_adhesion: float = 0.0,
    slope_term: bool = False,
    edges: Edges = None,
    patches: int = 1,
    start: ArrayLike | None = None,
    start_scale: float = 1.0,
    resolution: Resolution | None = None,
) -> Result:
    """Solve the contact of a periodic layer and a rigid profile.

    Parameters
    ----------
    youngs_modulus, poisson_ratio, thickness, period, work_of_adhesion, slope_term
        See `fem_reference.problem.Problem`; SI units.
    harmonics : tuple of three array_like, each (n_harmonics,)
        Orders, amplitudes (m) and phases (rad): h = sum h_m cos(2 pi m x / period + phi_m).
    control : {"separation", "penetration", "total_displacement", "mean_pressure"}
        What is given: h_max - Delta, Delta = u_tot - mean face displacement, the plate's u_tot, or the mean pressure.
    value : float
        m, m, m or Pa.
    edges : array_like (n_patches, 2), "complete" or None
        Prescribed contact edges in m, ordered on the period; complete contact; or None for the JKR closure.
    patches : int
        Number of contact patches the closure looks for, at the highest crests.
    start : array_like (n_patches, 2), optional
        Where the closure starts instead, m: which of several equilibria is meant. It decides nothing else.
    start_scale : float
        Factor on the widths of the starting patches of the closure.
    resolution : Resolution, optional
        The finest of the three meshes; P4/P3 with 8 cells per period and 18 tip levels by default.

    Returns
    -------
    Result
        With a named `status`; numbers of a state that is not an equilibrium carry infinite uncertainty.

    Raises
    ------
    InvalidProblemError
        Naming the argument at fault.
    SingularSystemError
        When the linear solver misses its residual.

    Examples
    --------
    >>> from fem_reference.mesh import Resolution
    >>> wave = solve(youngs_modulus=1e6, poisson_ratio=0.5, thickness=0.02, period=0.01,
    ...              harmonics=([1], [50e-6], [0.0]), control="penetration", value=10e-6,
    ...              edges=[[-0.001, 0.001]], resolution=Resolution(2, 10, 8))
    >>> wave.status, round(wave.mean_pressure, -1), bool(wave.uncertainty["mean_pressure"] < 5.0)
    ('converged', 930.0, True)
    """
    problem = problem_of(youngs_modulus, poisson_ratio, thickness, period, harmonics, work_of_adhesion, slope_term)
    fine = Resolution() if resolution is None else resolution
    ladder = companions(fine)
    wanted = control_of(problem, control, value)
    if edges is None:
        closures = closed(problem, wanted, ladder, patches, start_scale, start)
        return judged_closure(problem, closures)
    evaluations = [evaluate(problem, mesh, r, wanted) for r, mesh in prescribed(problem, wanted, edges, ladder)]
    return judged(evaluations[-1], uncertainties(evaluations), None)


def companions(finest: Resolution) -> list[Resolution]:
    """Return the resolutions with half and three quarters of the cells, and the one given.

    Raises
    ------
    InvalidProblemError
        Naming `resolution`: fewer cells than `FEWEST_CELLS`, or too few tip levels for half of them.

    Examples
    --------
    >>> [r.cells for r in companions(Resolution(4, 8, 18))]
    [4, 6, 8]
    """
    fewest, levels = FEWEST_CELLS[finest.order], FEWEST_LEVELS + 2 * finest.order
    if finest.cells < fewest:
        reason = f"needs at least {fewest} cells with elements of order {finest.order}, got {finest.cells}"
        raise InvalidProblemError("resolution", f"{reason}: on coarser meshes the uncertainty is not reliable")
    if finest.tip_levels < levels:
        reason = f"needs at least {levels} tip levels with elements of order {finest.order}, got {finest.tip_levels}"
        raise InvalidProblemError(
            "resolution", f"{reason}: the coarsest of its three meshes has {2 * finest.order} fewer"
        )
    return [finest.coarser(0.5), finest.coarser(0.75), finest]


def problem_of(
    youngs_modulus: float,
    poisson_ratio: float,
    thickness: float,
    period: float,
    harmonics: Harmonics,
    work_of_adhesion: float,
    slope_term: bool,
) -> Problem:
    """Return the checked problem; raises `InvalidProblemError` naming the argument."""
    try:
        orders, amplitudes, phases = harmonics
    except (TypeError, ValueError):
        raise InvalidProblemError("harmonics", "must be a tuple (orders, amplitudes, phases)") from None
    return Problem(
        youngs_modulus, poisson_ratio, thickness, period, orders, amplitudes, phases, work_of_adhesion, slope_term
    )


def control_of(problem: Problem, control: ControlKind, value: float) -> Control:
    """Return the dimensionless control; raises `InvalidProblemError` naming `control` or `value`."""
    if control not in get_args(ControlKind):
        raise InvalidProblemError("control", f"must be one of {', '.join(get_args(ControlKind))}, got {control!r}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InvalidProblemError("value", f"must be a number, got {value!r}") from None
    if not np.isfinite(number):
        raise InvalidProblemError("value", f"must be finite, got {value!r}")
    if control == "mean_pressure":
        return Control(control, number / problem.unit_stress)
    height = number / problem.unit_height
    return Control("penetration", problem.highest - height) if control == "separation" else Control(control, height)


def prescribed(
    problem: Problem, control: Control, edges: ArrayLike | str, ladder: Sequence[Resolution]
) -> list[tuple[Resolution, LayerMesh]]:
    """Return meshes for prescribed edges (m) or complete contact, one for each resolution.

    Raises
    ------
    InvalidProblemError
        Naming `edges`, or `control` when complete contact cannot be driven that way.
    """
    if isinstance(edges, str):
        if edges != "complete":
            raise InvalidProblemError("edges", f"must be pairs, 'complete' or None, got {edges!r}")
        if control.kind == "penetration":
            raise InvalidProblemError(
                "control", "complete contact has penetration h_max; give mean_pressure or total_displacement"
            )
        if control.kind == "total_displacement" and problem.uniform_compliance < 1e-6 * problem.depth:
            raise InvalidProblemError("control", "an incompressible layer in complete contact needs mean_pressure")
        pairs = np.zeros((0, 2))
    else:
        pairs = pairs_of("edges", edges, problem)
    return [(r, layer_mesh(problem.depth, pairs, r, problem.highest_order)) for r in ladder]


def closed(
    problem: Problem,
    control: Control,
    ladder: Sequence[Resolution],
    patches: int,
    start_scale: float = 1.0,
    start: ArrayLike | None = None,
) -> list[Closure]:
    """Return closures on a coarse mesh and on each resolution, from edges given in m or from the crests.

    Raises
    ------
    InvalidProblemError
        Naming `start`, `patches`, `start_scale`, or `value` when nothing can be in contact.
    """
    if not (np.isfinite(start_scale) and start_scale > 0.0):
        raise InvalidProblemError("start_scale", f"must be positive, got {start_scale!r}")
    if problem.work_of_adhesion == 0.0 and control.value <= 0.0:
        raise InvalidProblemError("value", f"{control.kind} must be positive without adhesion: the faces part")
    if start is None:
        edges = start_edges(problem, chosen_crests(problem, patches), control, Resolution(2, 6, 4), start_scale)
    else:
        edges = scaled_patches(pairs_of("start", start, problem), start_scale)
    return close_on_ladder(problem, edges, list(ladder), control)


def pairs_of(argument: str, edges: ArrayLike, problem: Problem) -> FloatArray:
    """Return edges (n_patches, 2) given in m in periods; raise `InvalidProblemError` naming the argument."""
    try:
        pairs = np.asarray(edges, dtype=float) / problem.period
    except (TypeError, ValueError):
        raise InvalidProblemError(argument, "must be a sequence of pairs (a, b)") from None
    check_edges(pairs, argument)
    return pairs


def judged_closure(problem: Problem, closures: list[Closure]) -> Result:
    """Return the result of the last closure; one that failed has its outcome as status and infinite uncertainties."""
    last = closures[-1]
    if last.outcome != "converged":
        nowhere = np.full(face_nodes(last.evaluation.states.spaces).x.shape, np.inf)
        unknown: dict[str, Quantity] = dict.fromkeys(("displacement", "gap", "pressure"), nowhere)
        for name, quantity in quantities(last.evaluation).items():
            unknown[name] = np.full(np.shape(quantity), np.inf) if np.ndim(quantity) else np.inf
        return _result(last.outcome, last.message, last.evaluation, unknown, last.residual, None)
    smallest = None
    if problem.work_of_adhesion > 0.0:
        form = hessian(problem, closures[0])
        unit = problem.unit_release_rate / problem.period
        smallest = float(np.linalg.eigvalsh(0.5 * (form + form.T))[0]) * unit
    spread = uncertainties([closure.evaluation for closure in closures[1:]])
    return judged(last.evaluation, spread, last.residual, smallest)


def judged(
    evaluation: Evaluation,
    spread: dict[str, Quantity],
    residual: float | None,
    min_eigenvalue: float | None = None,
) -> Result:
    """Return the result with its status: an edge with K < 0 or a profile inside the layer is no contact state."""
    problem = evaluation.states.problem
    status: Status = "converged" if evaluation.edges.size else "complete_contact"
    message = ""
    intensity = evaluation.values.stress_intensity[patch_order(evaluation)] * problem.unit_stress_intensity
    closing = intensity < -2.0 * np.asarray(spread["stress_intensity"]) - 1e-7 * problem.unit_stress_intensity
    off_contact = ~contact_indicator(evaluation.states.mesh)(face_nodes(evaluation.states.spaces).x)
    smallest = float(np.min(interface_fields(evaluation).gap[off_contact], initial=0.0))
    allowed = 2.0 * float(np.max(spread["gap"])) + 1e-9 * problem.unit_height
    if np.any(closing):
        status, message = "negative_stress_intensity", "an edge closes (K < 0): the faces overlap beside it"
    elif smallest < -allowed:
        status, message = "interpenetration", f"the profile enters the layer by {-smallest:.3e} m off the contact"
    return _result(status, message, evaluation, spread, residual, min_eigenvalue)


def _result(
    status: Status,
    message: str,
    evaluation: Evaluation,
    spread: dict[str, Quantity],
    residual: float | None,
    min_eigenvalue: float | None,
) -> Result:
    known = quantities(evaluation)

    def number(name: str) -> float:
        return float(known[name])

    def table(name: str) -> FloatArray:
        return np.asarray(known[name])

    return Result(
        status=status,
        message=message,
        problem=evaluation.states.problem,
        edges=table("edges"),
        contact_fraction=number("contact_fraction"),
        load=number("load"),
        mean_pressure=number("mean_pressure"),
        penetration=number("penetration"),
        total_displacement=number("total_displacement"),
        strain_energy=number("strain_energy"),
        elastic_energy=number("elastic_energy"),
        adhesion_energy=number("adhesion_energy"),
        total_energy=number("total_energy"),
        middle_pressure=table("middle_pressure"),
        stress_intensity=table("stress_intensity"),
        energy_release_rate=table("energy_release_rate"),
        rank_one_defect=evaluation.values.defect[patch_order(evaluation)],
        interface=interface_fields(evaluation),
        closure_residual=residual,
        min_eigenvalue=min_eigenvalue,
        uncertainty=spread,
        resolution=evaluation.resolution,
        unknowns=evaluation.states.unknowns,
        evaluation=evaluation,
    )
