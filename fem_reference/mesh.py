"""Triangle meshes of one period of the layer, graded towards the contact edges and moving with them.

The base is a crisscross mesh (each rectangle cut in four by its diagonals: no locking direction, no triangle with two
boundary sides), its rows growing slowly with depth. It is refined (red-green-blue) until a triangle at distance r from
the nearest contact edge is no larger than

    max( tip size, min( H, 4 r / cells ) ),      H = base size,  tip size = (shortest adjacent interval) 2^-tip_levels,

so that halving 4/cells resolves the r^(1/2) field of every ring alike and the observed order is that of the elements.
Contact edges sit on vertices. When the edges move, the vertices follow by a map piecewise linear in x; the topology is
kept, so every computed quantity is a smooth function of the edges.

The period is cut at a seam, in the middle of the longest interval between edges (a gap or a patch). Vertices are kept
in the local coordinate X = (x - seam) mod 1; both sides of the seam carry the same vertices. Unit of length: the
period.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from skfem import MeshTri1

from fem_reference.problem import FloatArray, IntArray, InvalidProblemError

FEWEST_LEVELS = 4  # halvings at the tips
GROWTH = 0.35  # row height H (1 + y/GROWTH): the fields decay at least as exp(-2 pi y)
UNKNOWNS_PER_TRIANGLE = {2: 4.5, 4: 20.5}  # by order, far from boundaries: 2 m^2 / 2 of displacement, (m-1)^2 / 2
NARROWEST = 1e-6  # of the period; below it the coordinates of the smallest triangles lose their digits


@dataclass(frozen=True)
class Resolution:
    """Fineness of a mesh.

    Parameters
    ----------
    order : int
        Order of the displacement elements: 2 (P2/P1) or 4 (P4/P3).
    cells : int
        Base cells per period (more are taken for thin layers and high harmonics), >= 3.
    tip_levels : int
        Halvings from the shortest interval beside an edge to the smallest triangle there, 4 to 24.

    Examples
    --------
    >>> Resolution(4, 8, 20).coarser(0.5)
    Resolution(order=4, cells=4, tip_levels=12)
    """

    order: int = 4
    cells: int = 8
    tip_levels: int = 18

    def __post_init__(self) -> None:
        if self.order not in (2, 4):
            raise InvalidProblemError("resolution", f"order must be 2 or 4, got {self.order!r}")
        if self.cells < 3:
            raise InvalidProblemError("resolution", f"cells must be at least 3, got {self.cells!r}")
        if not FEWEST_LEVELS <= self.tip_levels <= 24:
            raise InvalidProblemError("resolution", f"tip_levels must lie in 4..24, got {self.tip_levels!r}")

    def coarser(self, share: float) -> "Resolution":
        """Return the resolution with a share of the cells, rounded up.

        Each halving takes away 2 m tip levels, so that errors of the tips grow with the order 2 m of a load.
        """
        cells = int(np.ceil(share * self.cells))
        fewer = round(2 * self.order * float(np.log2(self.cells / cells)))
        return replace(self, cells=cells, tip_levels=self.tip_levels - fewer)


@dataclass(frozen=True)
class LayerMesh:
    """Mesh of a period of the layer, 0 <= X <= 1, 0 <= y <= depth.

    Parameters
    ----------
    triangles : skfem.MeshTri1
        The mesh at the present positions of the edges.
    reference : FloatArray, shape (2, n_vertices)
        Vertices before the map that follows the edges.
    reference_edges : FloatArray, shape (n_patches, 2)
        Local positions of the edges in the reference.
    edges : FloatArray, shape (n_patches, 2)
        Present positions x of the edges, periods; a patch may run past 1. Empty: the whole face is in contact.
    seam : float
        Position x of the cut.
    depth : float
        Layer thickness, periods.
    """

    triangles: Any
    reference: FloatArray
    reference_edges: FloatArray
    edges: FloatArray
    seam: float
    depth: float

    @property
    def local_edges(self) -> FloatArray:
        """Present local positions of the edges, shape (n_patches, 2)."""
        return np.asarray((self.edges - self.seam) % 1.0)

    def reach(self) -> FloatArray:
        """Return the distance (n_patches, 2) from each edge to the nearest of the next edge, the seam and the plate."""
        tips = self.local_edges.ravel()
        knots = np.concatenate([[0.0], np.sort(tips), [1.0]])
        where = np.searchsorted(knots[1:-1], tips) + 1
        nearest = np.minimum(tips - knots[where - 1], knots[where + 1] - tips)
        return np.asarray(np.minimum(nearest, self.depth).reshape(self.edges.shape))


def check_edges(edges: FloatArray, argument: str = "edges") -> None:
    """Raise `InvalidProblemError` unless the patches (n_patches, 2) are ordered, disjoint and wide enough."""
    if edges.ndim != 2 or edges.shape[1] != 2 or edges.shape[0] == 0:
        raise InvalidProblemError(argument, "must be a sequence of pairs (a, b)")
    if not np.all(np.isfinite(edges)):
        raise InvalidProblemError(argument, "must be finite")
    if np.any(edges[:, 1] <= edges[:, 0]):
        raise InvalidProblemError(argument, "every patch needs a < b")
    flat = np.append(edges.ravel(), edges[0, 0] + 1.0)
    lengths = np.diff(flat)
    if np.any(lengths <= 0.0):
        raise InvalidProblemError(argument, "patches overlap or are out of order on the period")
    if np.any(lengths < NARROWEST):
        raise InvalidProblemError(
            argument, f"a patch or a gap is narrower than the mesh can carry ({NARROWEST:g} periods)"
        )


def crisscross(x: FloatArray, y: FloatArray) -> Any:
    """Return a triangle mesh of the tensor grid x (n,), y (m,), every rectangle cut in four by its diagonals.

    Examples
    --------
    >>> crisscross(np.linspace(0, 1, 3), np.linspace(0, 1, 2)).t.shape
    (3, 8)
    """
    nx, ny = len(x), len(y)
    corners = np.array(np.meshgrid(x, y, indexing="ij")).reshape(2, -1)
    centres = np.array(np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2, indexing="ij")).reshape(2, -1)
    index = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    m = nx * ny + np.arange(len(a))
    t = np.hstack([np.array([a, b, m]), np.array([b, c, m]), np.array([c, d, m]), np.array([d, a, m])])
    return MeshTri1(np.hstack([corners, centres]), t)


def _grid(depth: float, resolution: Resolution, highest_order: int) -> tuple[int, int]:
    """Return the numbers of columns and rows of the base mesh."""
    n = resolution.cells
    size = min(1.0 / n, 4.0 * depth / n, 4.0 / (n * highest_order))
    rows = max(2, int(np.ceil(GROWTH / size * np.log1p(depth / GROWTH) - 1e-9)))
    return int(np.ceil(1.0 / size - 1e-9)), rows


def base_unknowns(depth: float, resolution: Resolution, highest_order: int) -> float:
    """Return about how many unknowns a mesh has before it is graded to any edge, without making it.

    Examples
    --------
    >>> base_unknowns(2.0, Resolution(4, 8, 18), 20)
    88560.0
    """
    columns, rows = _grid(depth, resolution, highest_order)
    return 4 * columns * rows * UNKNOWNS_PER_TRIANGLE[resolution.order]


def _base(depth: float, resolution: Resolution, highest_order: int) -> Any:
    """Return a crisscross mesh without edges."""
    columns, rows = _grid(depth, resolution, highest_order)
    y = GROWTH * np.expm1(np.linspace(0.0, np.log1p(depth / GROWTH), rows + 1))
    y[-1] = depth
    return crisscross(np.linspace(0.0, 1.0, columns + 1), y)


def _refined_where_large(mesh: Any, tips: FloatArray, floor: FloatArray, slope: float) -> tuple[Any, bool]:
    """Refine once the triangles that are too large for their distance from the tips (n_tips,)."""
    corners = mesh.p[:, mesh.t]
    sides = np.stack([corners[:, i] - corners[:, (i + 1) % 3] for i in range(3)])
    size = np.sqrt(np.max(np.sum(sides**2, axis=1), axis=0))
    centre = corners.mean(axis=1)
    distance = np.hypot(centre[0][:, None] - tips, centre[1][:, None])
    allowed = np.min(np.maximum(floor, slope * distance), axis=1)
    marked = np.flatnonzero(size > np.sqrt(2.0) * allowed)
    return (mesh.refined(marked), True) if marked.size else (mesh, False)


def _seam_matched(mesh: Any) -> Any:
    """Refine until both sides of the seam carry the same vertices."""
    while True:
        sides = [np.flatnonzero(np.abs(mesh.p[0] - end) < 1e-14) for end in (0.0, 1.0)]
        marked: list[int] = []
        for end, other in ((0.0, sides[1]), (1.0, sides[0])):
            facets = mesh.facets_satisfying(lambda x, end=end: np.abs(x[0] - end) < 1e-14, boundaries_only=True)
            middle = mesh.p[1, mesh.facets[:, facets]].mean(axis=0)
            missing = np.min(np.abs(middle[:, None] - mesh.p[1, other]), axis=1) < 1e-14
            marked.extend(mesh.f2t[0, facets[missing]].tolist())
        if not marked:
            return mesh
        mesh = mesh.refined(np.unique(marked))


def _seam_of(edges: FloatArray) -> float:
    """Return the middle of the longest interval between successive edges."""
    knots = np.append(edges.ravel(), edges[0, 0] + 1.0)
    longest = int(np.argmax(np.diff(knots)))
    return float((0.5 * (knots[longest] + knots[longest + 1])) % 1.0)


def layer_mesh(depth: float, edges: FloatArray, resolution: Resolution, highest_order: int = 1) -> LayerMesh:
    """Return the mesh of the layer graded towards the given edges.

    Parameters
    ----------
    depth : float
        Layer thickness, periods.
    edges : FloatArray, shape (n_patches, 2)
        Contact edges, periods, ordered on the circle; shape (0, 2): the whole face is in contact.
    resolution : Resolution
    highest_order : int
        Highest harmonic the base mesh must carry.

    Raises
    ------
    InvalidProblemError
        Edges out of order, overlapping, or closer than `NARROWEST`.

    Examples
    --------
    >>> mesh = layer_mesh(2.0, np.array([[0.4, 0.6]]), Resolution(2, 8, 6))
    >>> mesh.seam, bool(np.any(mesh.triangles.p[0] == (0.4 - mesh.seam) % 1.0))
    (0.0, True)
    """
    base = _base(depth, resolution, highest_order)
    if edges.size == 0:
        return LayerMesh(base, base.p, edges, edges, 0.0, depth)
    check_edges(edges)
    seam = _seam_of(edges)
    tips = ((edges - seam) % 1.0).ravel()
    knots = np.append(edges.ravel(), edges[0, 0] + 1.0)
    lengths = np.diff(knots)
    beside = np.minimum(np.minimum(lengths, np.roll(lengths, 1)), depth)
    slope = 4.0 / resolution.cells
    mesh, changed = base, True
    while changed:  # down to vertices dense enough for every edge to find one of its own
        mesh, changed = _refined_where_large(mesh, tips, beside / 8.0, slope)
    face = np.flatnonzero(mesh.p[1] == 0.0)
    vertex = face[np.argmin(np.abs(mesh.p[0, face][:, None] - tips), axis=0)]
    if len(np.unique(vertex)) < len(tips):
        raise InvalidProblemError("edges", "two edges share one vertex of the mesh: a patch or a gap is too narrow")
    snapped = mesh.p[0, vertex]
    changed = True
    while changed:
        mesh, changed = _refined_where_large(mesh, snapped, beside * 2.0**-resolution.tip_levels, slope)
    mesh = _seam_matched(mesh)
    blank = LayerMesh(mesh, mesh.p, snapped.reshape(edges.shape), edges, seam, depth)
    return moved(blank, edges)


def moved(mesh: LayerMesh, edges: FloatArray) -> LayerMesh:
    """Return the same topology with the contact edges at new positions.

    Parameters
    ----------
    mesh : LayerMesh
    edges : FloatArray, shape (n_patches, 2)
        New positions in the same order; each stays between its neighbours and the seam.

    Raises
    ------
    InvalidProblemError
        The order of the edges, or their side of the seam, would change.
    """
    check_edges(edges)
    start, now = mesh.reference_edges.ravel(), ((edges - mesh.seam) % 1.0).ravel()
    order: IntArray = np.argsort(start)
    if np.any(np.diff(now[order]) <= 0.0):
        raise InvalidProblemError("edges", "an edge crossed another edge or the seam of the mesh")
    x = np.interp(mesh.reference[0], np.r_[0.0, start[order], 1.0], np.r_[0.0, now[order], 1.0])
    p = np.ascontiguousarray(np.vstack([x, mesh.reference[1]]))
    return replace(mesh, triangles=MeshTri1(p, mesh.triangles.t), edges=edges)
