"""Mesh of one period of the layer that Gmsh made, read through meshio.

`read_layer_mesh` reads a .msh file: straight-sided triangles with four named boundaries, `face` (y = 0), `plate` (y =
thickness), `left` and `right` (the seam, with equal vertices on both). `by_forms` solves on its mesh, with contact
edges at vertices of the face.

Limits: Gmsh formats 2.2 and 4.1, nodes without parametric coordinates, every element in a physical group.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from skfem import MeshTri1

from fem_reference.problem import FloatArray, IntArray, InvalidProblemError

BOUNDARIES = ("face", "plate", "left", "right")
STRAIGHT = 1e-9  # of the period: how far a boundary vertex may be off its line
PARAMETRIC = "{} has nodes with parametric coordinates; save it with Mesh.SaveParametric = 0"
ALL_ENTITIES = "{} has elements of no physical group; save it with Mesh.SaveAll = 0"


@dataclass(frozen=True)
class ImportedLayer:
    """A layer mesh read from a file.

    Parameters
    ----------
    points : FloatArray, shape (2, n_vertices)
        Coordinates in m as in the file, x from 0 to the period, y from 0 to the thickness.
    triangles : IntArray, shape (3, n_triangles)
    boundaries : dict
        From the four names to vertex numbers.
    """

    points: FloatArray
    triangles: IntArray
    boundaries: dict[str, IntArray]

    @property
    def mesh(self) -> Any:
        """Mesh of scikit-fem (MeshTri1), coordinates in m."""
        return MeshTri1(self.points, self.triangles)

    @property
    def period(self) -> float:
        """Period in m."""
        return float(np.ptp(self.points[0]))

    @property
    def thickness(self) -> float:
        """Layer thickness in m."""
        return float(np.ptp(self.points[1]))


def read_layer_mesh(path: str | Path) -> ImportedLayer:
    """Read one period of the layer from a .msh file with named boundaries.

    Raises
    ------
    InvalidProblemError
        Naming `mesh`: a file that cannot be read, no triangles, a missing or crooked boundary, an unmatched seam.
    """
    source = _gmsh_file(Path(path))
    triangles = [block.data for block in source.cells if block.type == "triangle"]
    if not triangles:
        raise InvalidProblemError("mesh", f"{path} holds no straight-sided triangles")
    cells = np.vstack(triangles)
    used, inverse = np.unique(cells, return_inverse=True)
    renumbered = np.full(len(source.points), -1)
    renumbered[used] = np.arange(len(used))
    boundaries = {}
    for name in BOUNDARIES:
        boundaries[name] = renumbered[_named_vertices(source, name)]
        if np.any(boundaries[name] < 0):
            raise InvalidProblemError("mesh", f"boundary {name!r} has vertices of no triangle")
    layer = ImportedLayer(source.points[used, :2].T.copy(), inverse.reshape(cells.shape).T.copy(), boundaries)
    _check_shape(layer)
    return layer


def _gmsh_file(path: Path) -> meshio.Mesh:
    """Read a Gmsh file in which every element belongs to a physical group."""
    try:
        if b"$ParametricNodes" in path.read_bytes():  # format 2.2
            raise InvalidProblemError("mesh", PARAMETRIC.format(path))
        source = meshio.gmsh.read(path)
    except (OSError, meshio.ReadError, ValueError, TypeError, KeyError, IndexError) as reason:
        if "parametric" in str(reason):  # format 4.1
            raise InvalidProblemError("mesh", PARAMETRIC.format(path)) from None
        if "gmsh:physical" in str(reason):
            raise InvalidProblemError("mesh", ALL_ENTITIES.format(path)) from None
        raise InvalidProblemError("mesh", f"cannot read {path} as a Gmsh mesh (2.2 or 4.1): {reason}") from None
    if any(np.any(tags == 0) for tags in source.cell_data.get("gmsh:physical", [])):
        raise InvalidProblemError("mesh", ALL_ENTITIES.format(path))
    return source


def _named_vertices(source: meshio.Mesh, name: str) -> IntArray:
    """Return the vertex numbers of a named boundary of lines."""
    tag, dimension = source.field_data.get(name, (None, None))
    if tag is None or dimension != 1:
        known = sorted(source.field_data) or "none"
        raise InvalidProblemError("mesh", f"has no boundary named {name!r} (named groups: {known})")
    found = [
        block.data[physical == tag].ravel()
        for block, physical in zip(source.cells, source.cell_data["gmsh:physical"], strict=True)
        if block.type == "line"
    ]
    vertices = np.unique(np.concatenate(found)) if found else np.zeros(0, dtype=np.int64)
    if not vertices.size:
        raise InvalidProblemError("mesh", f"boundary {name!r} has no lines")
    return vertices


def _check_shape(layer: ImportedLayer) -> None:
    period, thickness = layer.period, layer.thickness
    lines = {"face": (1, 0.0), "plate": (1, thickness), "left": (0, 0.0), "right": (0, period)}
    for name, (axis, expected) in lines.items():
        on_it = layer.boundaries[name]
        if np.max(np.abs(layer.points[axis, on_it] - expected)) > STRAIGHT * period:
            raise InvalidProblemError("mesh", f"boundary {name!r} is not the line {'xy'[axis]} = {expected:g}")
        others = np.flatnonzero(np.abs(layer.points[axis] - expected) <= STRAIGHT * period)
        if len(others) != len(on_it):
            raise InvalidProblemError("mesh", f"boundary {name!r} does not hold all the vertices on its line")
    heights = [np.sort(layer.points[1, layer.boundaries[side]]) for side in ("left", "right")]
    if len(heights[0]) != len(heights[1]) or np.max(np.abs(heights[0] - heights[1])) > STRAIGHT * period:
        raise InvalidProblemError("mesh", "left and right do not carry the same vertices")
