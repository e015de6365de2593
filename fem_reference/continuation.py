"""Branch of equilibria by pseudo-arclength continuation: points (edges, control), their tangents and stability.

The unknowns are the 2 n edges x and the value c of the control. A point of the branch has F(x, c) = 0, F the residual
of `closure` on one moving mesh. The next one is predicted along the tangent t and corrected by Newton's method on

    F(x, c) = 0,    t . W (z - z_predicted) = 0,    z = (x, c),

W the inverse squares of the scales: of an edge the shorter of the patch and the gap beside it, of the control a unit
given. The system stays regular where the control turns (a fold), so that folds are passed and located, not run into
(Keller 1977, in Applications of Bifurcation Theory, 359; Allgower and Georg, Numerical Continuation Methods, 1990). The
derivatives by edges come by differences at every accepted point and by Broyden's update between; F is linear in c.

Units: as in `problem` (dimensionless).
"""

from dataclasses import dataclass, replace

import numpy as np

from fem_reference.closure import (
    Closure,
    Control,
    ControlKind,
    Evaluation,
    difference_jacobian,
    evaluate,
    followed_mesh,
    hessian,
    intervals,
    residual,
)
from fem_reference.contact import KeptFactors
from fem_reference.factors import SingularSystemError
from fem_reference.mesh import LayerMesh, Resolution, moved
from fem_reference.problem import FloatArray, InvalidProblemError, Problem
from fem_reference.result import face_displacement

CLOSED = 1e-5  # residual that ends Newton's method: 1e-5 of K_c
ITERATIONS = 10
FAR = 0.35  # of the scales: a corrected point so far from its prediction belongs to another branch
LARGEST_CHANGE = 0.3  # of the scales in one iteration
GRID = 64  # points per shortest wavelength at which the gap is looked at
CLOSER = 5  # times the grid about a minimum of the gap is made four times finer
MARGIN = 0.1  # of a gap beside each of its edges, where it is not looked at: at most 4e-3 periods
CHORD = 0.1  # of a step: how far the chord may be from the mean of the tangents at its ends
NEW_MESH = 1e-2  # of the scales: how far a new mesh moves the edges


@dataclass(frozen=True)
class Point:
    """An equilibrium: mesh solution, value of the control, derivatives of the residual, tangent.

    Parameters
    ----------
    evaluation : Evaluation
    value : float
    by_edges : FloatArray, shape (2 n, 2 n)
    by_value : FloatArray, shape (2 n,)
    tangent : FloatArray, shape (2 n + 1,)
        Its largest component is one in units of the scales.
    lowest : float
        Least eigenvalue of the Hessian of the potential energy at fixed control; infinite without adhesion, where
        every equilibrium is the minimum of a convex problem.
    softest : FloatArray, shape (2 n,)
        Its eigenvector, as motions of the edges in x along the tangent.
    """

    evaluation: Evaluation
    value: float
    by_edges: FloatArray
    by_value: FloatArray
    tangent: FloatArray
    lowest: float
    softest: FloatArray

    @property
    def edges(self) -> FloatArray:
        """Contact edges (n_patches, 2), periods."""
        return self.evaluation.edges

    @property
    def place(self) -> FloatArray:
        """Edges and the value of the control, (2 n + 1,)."""
        return np.append(self.edges.ravel(), self.value)

    @property
    def stable(self) -> bool:
        """True if the point is a minimum of the energy."""
        return self.lowest > 0.0


@dataclass(frozen=True)
class Solution:
    """Zero of the residual on one mesh: mesh solution, value of the control, derivatives updated on the way."""

    evaluation: Evaluation
    value: float
    by_edges: FloatArray
    by_value: FloatArray
    kept: KeptFactors

    @property
    def place(self) -> FloatArray:
        """Edges and the value of the control, (2 n + 1,)."""
        return np.append(self.evaluation.edges.ravel(), self.value)


@dataclass(frozen=True)
class Branch:
    """Problem, kind of control, mesh resolution, and the unit of the control in steps along a branch."""

    problem: Problem
    kind: ControlKind
    resolution: Resolution
    unit: float

    def control(self, value: float) -> Control:
        """Return the control at a value."""
        return Control(self.kind, value)

    def evaluated(self, mesh: LayerMesh, value: float, kept: KeptFactors | None = None) -> Evaluation:
        """Solve on a mesh at a value of the control."""
        return evaluate(self.problem, mesh, self.resolution, self.control(value), kept)

    def residual(self, evaluation: Evaluation, value: float) -> FloatArray:
        """Return F (2 n,) of the states of an evaluation at a value of the control."""
        load = self.control(value).load(evaluation.states)
        return residual(self.problem, replace(evaluation, load=load))

    def scales(self, edges: FloatArray) -> FloatArray:
        """Return the scales (2 n + 1,) of edges (n_patches, 2) and control."""
        lengths = intervals(edges)
        return np.append(np.minimum(lengths, np.roll(lengths, 1)), self.unit)

    def at(self, evaluation: Evaluation, value: float, direction: float) -> Point | None:
        """Return the equilibrium near the edges of an evaluation at a fixed value, by Newton's method; None if none.

        Its tangent points to where the control has the sign of `direction`.
        """
        border = np.append(np.zeros(evaluation.edges.size), direction)
        place = np.append(evaluation.edges.ravel(), value)
        kept = KeptFactors()
        slope = self.by_edges_of(self.evaluated(evaluation.states.mesh, value, kept), value, kept)
        return self._point(self.solved(evaluation.states.mesh, slope, place, border), border)

    def step(self, start: Point, length: float, value: float | None = None) -> Point | None:
        """Return the point a length along the tangent of a start or, with `value`, the nearby point at that control.

        None where Newton's method fails, or ends on another branch, or the branch bends too much for the length.
        """
        scales = self.scales(start.edges)
        place = start.place + length * start.tangent
        if value is None:
            border = start.tangent / scales**2
        else:
            border = np.append(np.zeros(start.edges.size), np.sign(start.tangent[-1]))
            place[-1] = value
        end = self._point(self.solved(start.evaluation.states.mesh, start.by_edges, place, border), border)
        if end is None:
            return None
        chord = (end.place - start.place) / scales
        tangents = 0.5 * (start.tangent + end.tangent) / scales
        bent = chord - tangents * float(chord @ tangents) / float(tangents @ tangents)
        return end if np.max(np.abs(bent)) < CHORD * np.max(np.abs(chord)) + NEW_MESH else None

    def solved(
        self, mesh: LayerMesh, slope: FloatArray, place: FloatArray, border: FloatArray, closed: float = CLOSED
    ) -> Solution | None:
        """Solve F(z) = 0 and border . (z - place) = 0, starting at z = place; None where Newton's method fails.

        Parameters
        ----------
        mesh : LayerMesh
            Followed to the place, then moved with the edges.
        slope : FloatArray, shape (2 n, 2 n)
            Derivatives of F by the edges, to begin with.
        place, border : FloatArray, shape (2 n + 1,)
        closed : float
            Residual that ends the iteration.
        """
        scales = self.scales(place[:-1].reshape(-1, 2))
        if np.any(scales[:-1] <= 0.0):
            return None
        here, step, before, by_value = place.copy(), np.zeros(0), np.zeros(0), np.zeros(0)
        kept = KeptFactors()
        for _ in range(ITERATIONS):
            try:
                edges = here[:-1].reshape(-1, 2)
                mesh = moved(mesh, edges) if step.size else followed_mesh(mesh, edges, self.resolution, self.problem)
                evaluation = self.evaluated(mesh, float(here[-1]), kept)
            except (InvalidProblemError, SingularSystemError):
                return None
            lack = self.residual(evaluation, float(here[-1]))
            if step.size:
                inner, weight = step[:-1], step[:-1] / scales[:-1] ** 2
                missed = lack - before - slope @ inner - by_value * step[-1]
                slope = slope + np.outer(missed, weight) / max(float(inner @ weight), 1e-300)
                if np.max(np.abs(lack)) > 2.0 * np.max(np.abs(before)):
                    return None
            by_value = (self.residual(evaluation, float(here[-1]) + self.unit) - lack) / self.unit
            if np.max(np.abs(lack)) < closed:
                return Solution(evaluation, float(here[-1]), slope, by_value, kept)
            system = np.vstack([np.column_stack([slope, by_value]), border])
            try:
                step = np.linalg.solve(system, np.append(-lack, 0.0))
            except np.linalg.LinAlgError:
                return None
            step *= min(1.0, LARGEST_CHANGE / float(np.max(np.abs(step) / scales)))
            here, before = here + step, lack
            if np.max(np.abs(here - place) / scales) > FAR:
                return None
        return None

    def by_edges_of(self, evaluation: Evaluation, value: float, kept: KeptFactors) -> FloatArray:
        """Return the derivatives (2 n, 2 n) of F by the edges, by differences."""
        base = self.residual(evaluation, value)
        mesh = evaluation.states.mesh
        return difference_jacobian(self.problem, mesh, self.resolution, self.control(value), base, kept)

    def _point(self, solution: Solution | None, border: FloatArray) -> Point | None:
        """Return a solution with derivatives by differences, tangent and stability; None without one."""
        if solution is None:
            return None
        evaluation, value, by_value = solution.evaluation, solution.value, solution.by_value
        slope = self.by_edges_of(evaluation, value, solution.kept)
        system = np.vstack([np.column_stack([slope, by_value]), border])
        try:
            tangent = np.linalg.solve(system, np.append(np.zeros(len(by_value)), 1.0))
        except np.linalg.LinAlgError:
            return None
        tangent /= float(np.max(np.abs(tangent) / self.scales(evaluation.edges)))
        lowest, softest = np.inf, np.zeros(len(by_value))
        if self.problem.work_of_adhesion > 0.0:
            form = hessian(self.problem, Closure("converged", "", evaluation, 0.0, slope))
            eigenvalues, vectors = np.linalg.eigh(0.5 * (form + form.T))
            lowest, softest = float(eigenvalues[0]), vectors[:, 0] * np.tile([-1.0, 1.0], len(evaluation.edges))
            along = softest @ (tangent / self.scales(evaluation.edges) ** 2)[:-1]
            softest = softest if along >= 0.0 else -softest
        return Point(evaluation, value, slope, by_value, tangent, lowest, softest)


def gap_minima(evaluation: Evaluation) -> list[tuple[float, float]]:
    """Return the local minima of the gap between the faces off the contact: positions, periods, and values.

    A negative gap that reaches an edge belongs to an edge that closes, and is left out.
    """
    states, problem = evaluation.states, evaluation.states.problem
    plate = float(states.displacement_of_plate[0] + evaluation.load * states.displacement_of_plate[1])

    def gap_at(x: FloatArray) -> FloatArray:
        displacement = face_displacement(evaluation, (x - states.mesh.seam) % 1.0)
        return np.asarray(displacement - (problem.height(x) - problem.highest + plate))

    minima = []
    ends = np.roll(evaluation.edges[:, 0], -1)
    ends[-1] += 1.0
    for a, b in zip(evaluation.edges[:, 1], ends, strict=True):
        margin = min(MARGIN * (b - a), 4e-3)
        x = np.linspace(a + margin, b - margin, max(8, int(GRID * problem.highest_order * (b - a))))
        gap = gap_at(x)
        for k in np.flatnonzero((gap[1:-1] < gap[:-2]) & (gap[1:-1] <= gap[2:])) + 1:
            if min(gap[:k].max(), gap[k + 1 :].max()) <= 0.0:
                continue
            near = x[k - 1 : k + 2]
            for _ in range(CLOSER):  # a parabola on the grid alone is 1e-5 rms heights off, the same on every mesh
                near = np.linspace(near[0], near[-1], 9)
                lowest = int(np.clip(np.argmin(gap_at(near)), 1, 7))
                near = near[lowest - 1 : lowest + 2]
            minima.append((float(near[1]), float(gap_at(near)[1])))
    return minima


def gap_near(evaluation: Evaluation, position: float) -> float:
    """Return the least gap, rms heights, at the minimum nearest to a position (periods)."""
    return min((abs((x - position + 0.5) % 1.0 - 0.5), gap) for x, gap in gap_minima(evaluation))[1]
