"""The JKR closure: contact edges at which the stress intensity is the critical one.

    K_e = sqrt(2 E* gamma sqrt(1 + h'(e)^2))      at every edge (K_e = 0 without adhesion),

at given penetration, total displacement or load.

Far from the closure every edge moves the way that lowers the energy (out where K < K_c); near it Newton's method takes
over: the Jacobian by differences on a coarse P2/P1 mesh that moves with the edges, updated by Broyden's formula (Math.
Comp. 19 (1965) 577, doi:10.1090/S0025-5718-1965-0198670-6), then the same Jacobian as a chord on finer meshes, where
two or three evaluations suffice. A step never changes a patch or a gap by more than a fraction of itself, so the edges
keep their order; a patch that shrinks away, a gap that closes, and a stalled iteration are outcomes with names.

Stability under the same control: the Hessian of the potential energy in the outward motions of the edges,

    H_ef = (K_e / E*) dK_e/d(out_f) - delta_ef dw_e/d(out_e),

positive definite at a minimum; symmetric for the exact solution.

Units: as in `problem` (dimensionless).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from fem_reference.contact import KeptFactors, UnitStates, solve_unit_states
from fem_reference.crests import crest_patches, scaled_patches
from fem_reference.energy_release import EdgeStates, EdgeValues, edge_states
from fem_reference.mesh import NARROWEST, LayerMesh, Resolution, layer_mesh, moved
from fem_reference.problem import FloatArray, InvalidProblemError, Problem

ControlKind = Literal["separation", "penetration", "total_displacement", "mean_pressure"]
Outcome = Literal["converged", "no_equilibrium", "not_converged"]

LARGEST_CHANGE = 0.3  # of a patch or gap in one step
REMESH = 0.35  # relative change of a patch or gap after which the mesh is made anew
ITERATIONS = 40
FAR = 0.5  # relative residual above which a Newton step must lower the energy, or a plain downhill step is taken
NEAR = 3.0  # relative residual below which a Jacobian by differences is worth its cost
VANISHED = 1e-3  # of its start: a patch or gap that shrank so far is gone
CLOSED = 1e-8  # relative residual of K that ends the iteration
SCAN = np.geomspace(0.01, 0.97, 10)  # depths of the starting family, of the total height of the profile
SHALLOW = np.geomspace(1e-8, 0.01, 7)  # the same where all of these open: contacts of 1e-4 periods and less


@dataclass(frozen=True)
class Control:
    """Prescribed quantity: its kind (a separation is kept as a penetration) and its dimensionless value."""

    kind: ControlKind
    value: float

    def load(self, states: UnitStates) -> float:
        """Return the load per period at which the states meet the control."""
        if self.kind == "mean_pressure":
            return self.value
        response = states.penetration if self.kind == "penetration" else states.displacement_of_plate
        return float((self.value - response[0]) / response[1])


@dataclass(frozen=True)
class Evaluation:
    """Solution on a mesh at its controlled load."""

    states: UnitStates
    edge_states: EdgeStates | None
    load: float
    resolution: Resolution

    @property
    def values(self) -> EdgeValues:
        """Stress intensity, release rate and defect at the edges; empty in complete contact."""
        if self.edge_states is None:
            none = np.zeros((0, 2))
            return EdgeValues(none, none, none)
        return self.edge_states.at_load(self.load)

    @property
    def edges(self) -> FloatArray:
        """Contact edges (n_patches, 2), periods."""
        return self.states.mesh.edges


def evaluate(
    problem: Problem, mesh: LayerMesh, resolution: Resolution, control: Control, kept: KeptFactors | None = None
) -> Evaluation:
    """Return the state on a mesh at the load that meets the control; `kept` factors of a similar mesh save work."""
    states = solve_unit_states(problem, mesh, resolution.order, kept)
    edges = edge_states(states) if mesh.edges.size else None
    return Evaluation(states, edges, control.load(states), resolution)


def residual(problem: Problem, evaluation: Evaluation) -> FloatArray:
    """Return (K - K_c) over a fixed scale at every edge, shape (2 n_patches,).

    The scale is the larger of K_c and E* sqrt(width) / 10, the stress intensity of a fair share of the rms height.
    """
    critical, scale = _critical_and_scale(problem, evaluation.edges)
    return np.asarray(((evaluation.values.stress_intensity - critical) / scale).ravel())


def _critical_and_scale(problem: Problem, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K_c at edges (n_patches, 2), and the scale of the residual there."""
    critical = problem.critical_stress_intensity(edges)
    geometric = 0.1 * problem.plane_strain_modulus * np.sqrt(np.diff(edges, axis=1))
    return critical, np.maximum(critical, geometric)


@dataclass(frozen=True)
class Closure:
    """A closed (or failed) set of edges on one mesh.

    Parameters
    ----------
    outcome : str
        `converged`, `no_equilibrium` or `not_converged`.
    message : str
    evaluation : Evaluation
        At the last edges.
    residual : float
        Largest relative residual of K.
    jacobian : FloatArray, shape (2 n_patches, 2 n_patches)
        d residual / d edge.
    """

    outcome: Outcome
    message: str
    evaluation: Evaluation
    residual: float
    jacobian: FloatArray


def intervals(edges: FloatArray) -> FloatArray:
    """Return the lengths (2 n_patches,) of patch, gap, patch, gap, ... round the period."""
    return np.asarray(np.diff(np.append(edges.ravel(), edges[0, 0] + 1.0)))


def start_edges(
    problem: Problem, crests: FloatArray, control: Control, resolution: Resolution, factor: float
) -> FloatArray:
    """Return edges (n_patches, 2) from which the closure starts: patches cut off the crests at one depth.

    The depth is the greatest at which the mean residual of K rises through zero, a stable contact. Near pull-off the
    residual may be positive at every depth of the scan: then its minimum between the depths is searched.

    Raises
    ------
    InvalidProblemError
        Naming `value` when there are none: nothing stays in contact.
    """
    grid = np.linspace(0.0, 1.0, 256 * problem.highest_order)
    total = problem.highest - float(problem.height(grid).min())

    def at(share: float) -> FloatArray:
        return crest_patches(problem, crests, share * total)

    def opening(edges: FloatArray) -> FloatArray:
        mesh = layer_mesh(problem.depth, edges, resolution, problem.highest_order)
        return residual(problem, evaluate(problem, mesh, resolution, control))

    tried: list[tuple[float, float]] = []  # share of the depth, mean residual
    for shares in (SCAN, SHALLOW):
        family = [(share, at(float(share))) for share in shares]
        kept = [(float(share), edges) for share, edges in family if np.diff(edges).min() > 2.0 * NARROWEST]
        residuals = [opening(edges) for _, edges in kept]
        mean = np.array([opened.mean() for opened in residuals])
        tried += [(share, float(value)) for (share, _), value in zip(kept, mean, strict=True)]
        if not all(np.all(opened > 0.0) for opened in residuals):
            break
    else:
        share = _stable(sorted(tried), lambda share: float(opening(at(share)).mean()))
        if share is None:
            reason = "leaves no contact: all edges open at every depth tried; allowed: a greater penetration or load"
            raise InvalidProblemError("value", reason)
        return scaled_patches(at(share), factor)
    members = [edges for _, edges in kept]
    stable = np.flatnonzero((mean[:-1] < 0.0) & (mean[1:] >= 0.0))
    if stable.size:
        k = int(stable[-1])
        share = mean[k] / (mean[k] - mean[k + 1])
        return scaled_patches((1.0 - share) * members[k] + share * members[k + 1], factor)
    return scaled_patches(members[int(np.argmin(np.abs(mean)))], factor)


def _stable(tried: list[tuple[float, float]], mean: Callable[[float], float]) -> float | None:
    """Return the depth at which the mean residual rises through zero behind its minimum; None if it has no zero.

    `tried` holds (depth, mean residual); the minimum is searched between the neighbours of the least of them.
    """
    k = int(np.argmin([value for _, value in tried]))
    below, above = tried[max(k - 1, 0)][0], tried[min(k + 1, len(tried) - 1)][0]
    found = minimize_scalar(
        lambda power: mean(float(np.exp(power))),
        bounds=(np.log(below), np.log(above)),
        method="bounded",
        options={"xatol": 1e-2},
    )
    least = float(np.exp(found.x))
    if mean(least) >= 0.0:
        return None
    return float(brentq(mean, least, above, rtol=1e-2))


def difference_jacobian(
    problem: Problem,
    mesh: LayerMesh,
    resolution: Resolution,
    control: Control,
    base: FloatArray,
    kept: KeptFactors | None = None,
) -> FloatArray:
    """Return d residual / d edge by forward differences on the moving mesh, shape (2 n_patches, 2 n_patches)."""
    edges = mesh.edges
    lengths = intervals(edges)
    columns = []
    for e in range(edges.size):
        step = 1e-5 * min(lengths[e], lengths[e - 1])
        shifted = edges.ravel().copy()
        shifted[e] += step
        there = evaluate(problem, moved(mesh, shifted.reshape(edges.shape)), resolution, control, kept)
        columns.append((residual(problem, there) - base) / step)
    return np.array(columns).T


def _limited(edges: FloatArray, step: FloatArray) -> FloatArray:
    """Return the step, shortened so that no patch or gap changes by more than `LARGEST_CHANGE` of itself."""
    lengths = intervals(edges)
    change = np.diff(np.append(step, step[0]))
    largest = float(np.max(np.abs(change) / lengths))
    return step * min(1.0, LARGEST_CHANGE / largest) if largest > 0.0 else step


def close(
    problem: Problem,
    edges: FloatArray,
    resolution: Resolution,
    control: Control,
    jacobian: FloatArray | None = None,
    kept: KeptFactors | None = None,
) -> Closure:
    """Find the edges at which the residual vanishes on meshes of one resolution.

    Parameters
    ----------
    problem : Problem
    edges : FloatArray, shape (n_patches, 2)
        Start.
    resolution : Resolution
    control : Control
    jacobian : FloatArray, optional
        From a coarser closure; without it one is made by differences and renewed when convergence is slow.
    kept : KeptFactors, optional
        Factors to begin with; on return it holds those of the last mesh that was factorised.
    """
    own = jacobian is None
    mesh = layer_mesh(problem.depth, edges, resolution, problem.highest_order)
    kept = KeptFactors() if kept is None else kept
    here = evaluate(problem, mesh, resolution, control, kept)
    now = residual(problem, here)
    size = float(np.max(np.abs(now)))
    slope = difference_jacobian(problem, mesh, resolution, control, now, kept) if jacobian is None else jacobian
    diverging = False

    def ended(outcome: Outcome, message: str) -> Closure:
        return Closure(outcome, message, here, size, slope)

    for _ in range(ITERATIONS):
        if size < CLOSED:
            return ended("converged", "")
        try:
            full = np.asarray(np.linalg.solve(slope, -now), dtype=np.float64)
        except np.linalg.LinAlgError:
            return ended("no_equilibrium", "the closure is singular: a limit point of the equilibrium branch")
        step = _limited(here.edges, full)
        if own and size > FAR and (diverging or not _agrees(now, full)):
            step = _downhill(here.edges, now)
        trial = here.edges + step.reshape(here.edges.shape)
        vanished = _vanished(trial, intervals(edges))
        if vanished:
            return ended("no_equilibrium", vanished)
        try:
            there = evaluate(problem, followed_mesh(mesh, trial, resolution, problem), resolution, control, kept)
        except InvalidProblemError as reason:
            return ended("no_equilibrium", f"a step of Newton's method moved an edge past another ({reason})")
        then = residual(problem, there)
        reached = float(np.max(np.abs(then)))
        slope = slope + np.outer(then - now - slope @ step, step) / (step @ step)
        remeshed = there.states.mesh.reference is not mesh.reference
        slow = reached > 0.3 * size and reached > 100.0 * CLOSED
        diverging = reached > size
        here, now, size, mesh = there, then, reached, there.states.mesh
        if own and (slow or remeshed) and size < NEAR:
            slope = difference_jacobian(problem, mesh, resolution, control, now, kept)
    return ended("not_converged", f"the closure residual is {size:.1e} after {ITERATIONS} steps")


def _agrees(now: FloatArray, step: FloatArray) -> bool:
    """Return True if every edge far from closure moves so as to lower the energy.

    An edge that closes moves out, an edge that opens moves in.
    """
    outward_step = step * np.tile([-1.0, 1.0], len(step) // 2)
    far = np.abs(now) > 0.3 * np.max(np.abs(now))
    return bool(np.all(outward_step[far] * now[far] < 0.0))


def _downhill(edges: FloatArray, now: FloatArray) -> FloatArray:
    """Return a step that lowers the energy at every edge.

    It is a share of the patch or gap beside the edge, smaller near closure.
    """
    lengths = intervals(edges)
    beside = np.minimum(lengths, np.roll(lengths, 1))
    return np.asarray(-0.3 * now / (np.abs(now) + 0.5) * beside * np.tile([-1.0, 1.0], len(edges)))


def _vanished(edges: FloatArray, start: FloatArray) -> str:
    """Name the event where a patch or gap has shrunk to a trace of its start, else return an empty string."""
    lengths = intervals(edges)
    small = lengths < np.maximum(VANISHED * start, 10.0 * NARROWEST)
    if np.any(small[::2]):
        return "a patch detaches"
    return "a gap closes" if np.any(small[1::2]) else ""


def followed_mesh(mesh: LayerMesh, edges: FloatArray, resolution: Resolution, problem: Problem) -> LayerMesh:
    """Return the mesh moved to the edges, or a new mesh where the edges went far."""
    start = mesh.reference_edges
    change = intervals(edges) / intervals(_unrolled(start))
    if np.max(np.abs(change - 1.0)) > REMESH:
        return layer_mesh(problem.depth, edges, resolution, problem.highest_order)
    return moved(mesh, edges)


def _unrolled(local: FloatArray) -> FloatArray:
    """Return the edges (n_patches, 2) from local positions that may have passed the seam."""
    flat = local.ravel()
    return np.asarray((flat[0] + (flat - flat[0]) % 1.0).reshape(local.shape))


def close_on_ladder(
    problem: Problem,
    start: FloatArray,
    resolutions: list[Resolution],
    control: Control,
) -> list[Closure]:
    """Find the edges at which K = K_c on a coarse mesh, then on each finer mesh from the edges of the one before.

    The Jacobian of the coarse mesh serves on all meshes (chord method).  The first failure ends the list.

    Returns
    -------
    list of Closure
        The coarse one first, then one for each resolution reached.
    """
    kept = KeptFactors()
    first = close(problem, start, scouting(resolutions[0]), control, kept=kept)
    closures = [first]
    if first.outcome == "converged":
        coarse = first.evaluation
        base = residual(problem, coarse)
        slope = difference_jacobian(problem, coarse.states.mesh, coarse.resolution, control, base, kept)
        closures[0] = Closure(first.outcome, first.message, coarse, first.residual, slope)
        for resolution in resolutions:
            last = close(problem, closures[-1].evaluation.edges, resolution, control, closures[-1].jacobian)
            closures.append(last)
            if last.outcome != "converged":
                break
    return closures


def scouting(resolution: Resolution) -> Resolution:
    """Return the coarse P2/P1 resolution on which edges are found and the Jacobian is made."""
    return Resolution(2, 8, 7) if resolution.order == 4 else Resolution(2, 6, 6)


def hessian(problem: Problem, closure: Closure) -> FloatArray:
    """Return the second derivatives (2 n_patches, 2 n_patches) of the energy by outward motions of the edges.

    They are not symmetrised.

    From the Jacobian of the coarse closure; E a^2 / lambda^2.
    """
    edges = closure.evaluation.edges
    outwards = np.tile([-1.0, 1.0], len(edges))
    scale = _critical_and_scale(problem, edges)[1].ravel()
    step = 1e-6
    critical_slope = (
        problem.critical_stress_intensity(edges + step) - problem.critical_stress_intensity(edges - step)
    ).ravel() / (2.0 * step)
    work_slope = (problem.work_of_opening(edges + step) - problem.work_of_opening(edges - step)).ravel() / (2.0 * step)
    intensity = closure.evaluation.values.stress_intensity.ravel()
    slopes = closure.jacobian * scale[:, None] + np.diag(critical_slope)  # dK/dx at the closure, where K = K_c
    form = intensity[:, None] / problem.plane_strain_modulus * slopes * outwards
    return np.asarray(form - np.diag(outwards * work_slope))
