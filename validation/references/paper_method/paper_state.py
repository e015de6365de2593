"""State of adhesive contact by the paper's method: descents, with changes of the number of patches in between.

After each descent: a patch that vanished detaches, a gap that vanished closes, and where the profile enters the solid
between patches a new contact is made; then the descent starts anew.  A state is the minimum reached
from the edges given; `follow` goes up a path of penetrations in given steps.  The paper makes contacts of all
interpenetrations at the new penetration before it minimises, here they are made one at a time after a descent: the
order decides about the path alone.  Either way the 40 increments of the audited path had the same number of patches,
and contact fractions equal to 7e-8 (residual 1e-5).

Source: G. Carbone, M. Scaraggi, U. Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  SI at the edge.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray, IntArray
from validation.references.paper_method.conjugate_gradients import VANISHED, Descent, descend, edge_scale_of
from validation.references.paper_method.energy import Energy, SweepsError
from validation.references.paper_method.surface import Surface

CHANGES = 60  # of the number of patches, in all
POINTS = 24  # at which a gap is looked at, and this many more for every wavelength in it
BORN = 0.1  # of the shortest wavelength: width of a new contact


@dataclass(frozen=True, eq=False, kw_only=True)
class PaperState:
    """A state, SI units, or the name of the failure."""

    surface: Surface
    penetration: float
    status: str  # `converged`, `separated`, or `not_converged` with a message
    message: str = ""
    edges: FloatArray  # m, in order on the period, (L, 2)
    contact_fraction: float = math.nan
    mean_pressure: float = math.nan  # Pa
    elastic_energy: float = math.nan  # J/m per period
    tension: bool = False  # whether all edges are opening (K > 0), as they must
    smallest_gap: float = math.nan  # m, between the patches; not below -`allowed` rms heights when converged
    residual: float = math.nan  # max |G/w - 1|
    unknowns: int = 0
    evaluations: int
    sweeps: int
    found: Energy | None = None

    def gap(self, x: ArrayLike) -> FloatArray:
        """Return the gap in m at positions x in m (n,) off the contact; NaN if the state has no energy."""
        at = np.asarray(x, dtype=np.float64) / self.surface.unit_length
        if self.found is None:
            return np.full(at.shape, np.nan)
        rigid = self.surface.height(at) - self.surface.highest + self.penetration / self.surface.unit_height
        return np.asarray((displacement(self.surface, self.found, at) - rigid) * self.surface.unit_height)


def solve(
    surface: Surface,
    penetration: float,
    edges: ArrayLike,
    cells: int,
    allowed_residual: float = 1e-6,
    allowed: float = 1e-4,
) -> PaperState:
    """Minimise the energy at given penetration, from given edges.

    Parameters
    ----------
    surface : Surface
        With adhesion.
    penetration : float
        Delta, m.
    edges : array_like, (L, 2)
        Where to start, m, in order on the period.
    cells : int
        Per patch, and as many more for every half of the shortest wavelength in it.
    allowed_residual : float
        max |G/w - 1| at the end.
    allowed : float
        Interpenetration in rms heights that makes no new contact: the displacement near an edge is that inaccurate.

    Raises
    ------
    ValueError
        No adhesion, or edges that are not pairs in order.

    Examples
    --------
    >>> wave = Surface(1e6, 0.5, 0.01, [1], [1e-4], [0.0], work_of_adhesion=0.3)
    >>> state = solve(wave, 5e-5, [[-0.0025, 0.0025]], 12)
    >>> state.status, state.tension
    ('converged', True)
    """
    if surface.work == 0:
        raise ValueError("work_of_adhesion: the method needs adhesion, without it the energy is flat at its minimum")
    pairs = np.asarray(edges, dtype=np.float64) / surface.unit_length
    if pairs.ndim != 2 or pairs.shape[1] != 2 or np.any(edge_scale_of(pairs) <= 0):
        raise ValueError(f"edges: pairs in order, disjoint on the period are needed, not {pairs.tolist()}")
    depth, evaluations, sweeps = penetration / surface.unit_height, 0, 0

    def failed(message: str) -> PaperState:
        return PaperState(
            surface=surface,
            penetration=penetration,
            status="not_converged",
            message=message,
            edges=pairs * surface.unit_length,
            evaluations=evaluations,
            sweeps=sweeps,
        )

    for _ in range(CHANGES):
        counts = cells_for(surface, pairs, cells)
        try:
            descent = descend(surface, pairs, counts, depth, allowed_residual)
        except SweepsError as error:
            return failed(str(error))
        evaluations, sweeps = evaluations + descent.evaluations, sweeps + descent.sweeps
        pairs = descent.state.cells.edges
        if descent.end == "not_converged":
            return failed(f"|G/w - 1| is {descent.residual:.1e}")
        changed = _without_vanished(descent)
        if changed is None and np.any(cells_for(surface, pairs, cells) != counts):
            continue  # the cells are those of the edges found, whatever the start
        if changed is None:
            gaps, where = gap_between(surface, descent.state, depth)
            if gaps.min() >= -allowed:
                return _state(surface, penetration, descent, float(gaps.min()), evaluations, sweeps)
            changed = _with_contact(surface, pairs, float(where[np.argmin(gaps)]))
        if changed.size == 0:
            return PaperState(
                surface=surface,
                penetration=penetration,
                status="separated",
                edges=np.zeros((0, 2)),
                contact_fraction=0.0,
                mean_pressure=0.0,
                elastic_energy=0.0,
                tension=True,
                residual=0.0,
                smallest_gap=-penetration,
                evaluations=evaluations,
                sweeps=sweeps,
            )
        pairs = changed
    return failed(f"more than {CHANGES} changes of the patches")


def follow(
    surface: Surface, penetrations: ArrayLike, cells: int, allowed_residual: float = 1e-6, allowed: float = 1e-4
) -> list[PaperState]:
    """Solve for states at increasing penetrations (n,) in m.

    The first state starts from the highest crest, every other state from the edges of its predecessor.

    The list ends with the first state that is not an equilibrium.
    """
    half = BORN * np.pi / float(surface.order.max())
    place = surface.crest[0]
    edges = np.array([[place - half, place + half]]) * surface.unit_length
    states: list[PaperState] = []
    for penetration in np.asarray(penetrations, dtype=np.float64):
        states.append(solve(surface, float(penetration), edges, cells, allowed_residual, allowed))
        if states[-1].status != "converged":
            break
        edges = states[-1].edges
    return states


def cells_for(surface: Surface, edges: FloatArray, cells: int) -> IntArray:
    """Return numbers of cells, (L,): `cells`, and as many more for every half wavelength of the highest harmonic."""
    waves = np.diff(edges, axis=1)[:, 0] * surface.order.max() / np.pi
    return np.asarray(np.ceil(cells * (1 + waves)), dtype=np.int64)


def gap_between(surface: Surface, state: Energy, penetration: float) -> tuple[FloatArray, FloatArray]:
    """Return gaps in rms heights and their positions, at points between the patches that crowd at the edges."""
    edges = state.cells.edges
    ends = np.append(edges[1:, 0], edges[0, 0] + 2 * np.pi)
    points = []
    for start, stop in zip(edges[:, 1], ends, strict=True):
        count = POINTS + int(POINTS * (stop - start) * surface.order.max() / (2 * np.pi))
        points.append(start + (stop - start) * (1 - np.cos(np.pi * (np.arange(count) + 0.5) / count)) / 2)
    x = np.concatenate(points)
    return displacement(surface, state, x) - (surface.height(x) - surface.highest + penetration), x


def displacement(surface: Surface, state: Energy, x: FloatArray) -> FloatArray:
    """Return u - u_m in rms heights at points x (n,) off the contact."""
    cells, charges = state.cells, state.charges
    kernel = np.log(np.abs(2 * np.sin(np.subtract.outer(x, cells.centre) / 2)))
    field = -kernel @ charges / np.pi
    modes = surface.layer_modes
    if modes.size:
        order = np.arange(1, modes.size + 1)
        angle, phase = np.outer(cells.centre, order), np.outer(x, order)
        field += (np.cos(phase) * modes) @ (np.cos(angle).T @ charges) / np.pi
        field += (np.sin(phase) * modes) @ (np.sin(angle).T @ charges) / np.pi
    return np.asarray(field)


def _without_vanished(descent: Descent) -> FloatArray | None:
    """Return the edges without vanished patches, or with the first vanished gap closed; None if nothing vanished."""
    edges = descent.state.cells.edges
    width = np.diff(edges, axis=1)[:, 0]
    gone = width < VANISHED * descent.edge_scale.max(axis=1)
    if np.any(gone):
        return np.asarray(edges[~gone])
    behind = np.append(edges[1:, 0], edges[0, 0] + 2 * np.pi) - edges[:, 1]
    closing = np.flatnonzero(behind < VANISHED * descent.edge_scale[:, 1])
    if closing.size == 0:
        return None
    at = int(closing[0])
    following = (at + 1) % len(edges)
    merged = edges.copy()
    merged[at, 1] = edges[following, 1] + (2 * np.pi if following == 0 else 0.0)
    return np.asarray(np.delete(merged, following, axis=0))


def _with_contact(surface: Surface, edges: FloatArray, position: float) -> FloatArray:
    """Return the edges with a new small contact about a position."""
    behind = np.append(edges[1:, 0], edges[0, 0] + 2 * np.pi)
    after = int(np.flatnonzero((edges[:, 1] < position) & (position < behind))[0])
    free = min(position - edges[after, 1], behind[after] - position)
    half = min(BORN * np.pi / float(surface.order.max()), free / 3)
    return np.insert(edges, after + 1, [position - half, position + half], axis=0)


def _state(
    surface: Surface, penetration: float, descent: Descent, smallest: float, evaluations: int, sweeps: int
) -> PaperState:
    state, cells = descent.state, descent.state.cells
    tension = not np.any(state.closing)
    return PaperState(
        status="converged" if tension else "not_converged",
        message="" if tension else "an edge closes instead of opening: its neighbourhood interpenetrates",
        edges=cells.edges * surface.unit_length,
        contact_fraction=float(np.sum(np.diff(cells.edges))) / (2 * np.pi),
        mean_pressure=state.load * surface.unit_pressure / (2 * np.pi),
        elastic_energy=state.elastic * surface.unit_energy,
        tension=tension,
        smallest_gap=smallest * surface.unit_height,
        residual=descent.residual,
        unknowns=int(cells.counts.sum()),
        evaluations=evaluations,
        sweeps=sweeps,
        surface=surface,
        penetration=penetration,
        found=state,
    )
