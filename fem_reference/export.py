"""Fields for ParaView and layer meshes from Gmsh, both through meshio.

`write_fields` writes the whole layer as a VTU file: six-node triangles in SI coordinates with the displacement (m)
and the hydrostatic pressure (Pa) at vertices and mid-sides, the von Mises stress (Pa) and the strain energy density
(J/m^3) as means over each triangle, so that density times area sums to the strain energy. Floats are stored in
binary: reading back returns the same bits.

`read_layer_mesh` reads a .msh file of one period of the layer, straight-sided triangles, with four named boundaries:
`face` (y = 0), `plate` (y = thickness), `left` and `right` (the seam, the same vertices on both). Contact edges
prescribed on such a mesh must be vertices of its face. `solve_on_mesh` then solves with P4/P3 and, for the
uncertainty, P2/P1 elements on the same triangles: far too careful for P4/P3, but no finer mesh is at hand.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import ArrayLike
from skfem import Basis, ElementTriP2, MeshTri1

from fem_reference.closure import ControlKind, evaluate
from fem_reference.contact import UnitStates
from fem_reference.elasticity import taylor_hood
from fem_reference.mesh import LayerMesh, Resolution, check_edges
from fem_reference.problem import FloatArray, IntArray, InvalidProblemError, Problem
from fem_reference.result import Result, uncertainties
from fem_reference.solve import control_of, judged

BOUNDARIES = ("face", "plate", "left", "right")
STRAIGHT = 1e-9  # of the period: how far a boundary vertex may be off its line


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
    try:
        source = meshio.read(path, file_format="gmsh")
    except (OSError, meshio.ReadError, ValueError, KeyError, IndexError) as reason:
        raise InvalidProblemError("mesh", f"cannot read {path}: {reason}") from None
    except SystemExit:  # what meshio does with a file of another format
        raise InvalidProblemError("mesh", f"cannot read {path} as a Gmsh mesh") from None
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


def _named_vertices(source: meshio.Mesh, name: str) -> IntArray:
    """Vertex numbers of a named boundary of lines."""
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


def layer_mesh_of(layer: ImportedLayer, edges: FloatArray) -> LayerMesh:
    """Mesh in periods with contact edges (n_patches, 2), periods, at vertices of the face.

    Raises
    ------
    InvalidProblemError
        Naming `edges` when one is not a vertex of the face.
    """
    points = layer.points / layer.period
    on_face, plate = layer.boundaries["face"], layer.boundaries["plate"]
    points[1, on_face] = 0.0
    points[1, plate] = layer.thickness / layer.period
    points[0, layer.boundaries["left"]], points[0, layer.boundaries["right"]] = 0.0, 1.0
    snapped = edges
    if edges.size:
        check_edges(edges)
        wanted = (edges % 1.0).ravel()
        nearest = on_face[np.argmin(np.abs(points[0, on_face][:, None] - wanted), axis=0)]
        if np.max(np.abs(points[0, nearest] - wanted)) > STRAIGHT or np.any(np.isin(wanted, [0.0, 1.0])):
            raise InvalidProblemError("edges", "each must be a vertex of the mesh's face, off its seam")
        points[0, nearest] = wanted
        snapped = edges
    triangles = MeshTri1(np.ascontiguousarray(points), np.ascontiguousarray(layer.triangles))
    return LayerMesh(triangles, points, snapped % 1.0, snapped, 0.0, layer.thickness / layer.period)


def solve_on_mesh(
    problem: Problem, layer: ImportedLayer, control: ControlKind, value: float, edges: ArrayLike | None = None
) -> Result:
    """Solve prescribed edges (m), or complete contact without them, on an imported mesh.

    Parameters
    ----------
    problem : Problem
        With the mesh's period and thickness.
    layer : ImportedLayer
    control, value
        As in `fem_reference.solve`.
    edges : array_like, shape (n_patches, 2), optional

    Raises
    ------
    InvalidProblemError
        Naming `mesh` when its sizes are not the problem's, else as in `fem_reference.solve`.
    """
    sizes = np.array([problem.period, problem.thickness])
    if np.max(np.abs(np.array([layer.period, layer.thickness]) / sizes - 1.0)) > 1e-6:
        raise InvalidProblemError("mesh", f"measures {layer.period:g} by {layer.thickness:g} m, not the layer's sizes")
    pairs = np.zeros((0, 2)) if edges is None else np.asarray(edges, dtype=float) / problem.period
    mesh = layer_mesh_of(layer, pairs)
    wanted = control_of(problem, control, value)
    if edges is None and control != "mean_pressure":
        raise InvalidProblemError("control", "complete contact on an imported mesh takes mean_pressure")
    fine = Resolution(4)
    evaluations = [evaluate(problem, mesh, replace(fine, order=order), wanted) for order in (2, 4)]
    return judged(evaluations[1], uncertainties(evaluations), None)


def field_mesh(result: Result) -> meshio.Mesh:
    """Whole layer of a result as a meshio mesh with its fields, SI units."""
    states, load, problem = result.evaluation.states, result.evaluation.load, result.problem
    triangles = states.mesh.triangles
    nodes = Basis(triangles, ElementTriP2(), intorder=0)
    field = states.fields[0] + load * states.fields[1]
    points = np.zeros((nodes.N, 3))
    points[:, 0] = (states.mesh.seam + nodes.doflocs[0]) * problem.period
    points[:, 1] = nodes.doflocs[1] * problem.period
    displacement = np.zeros((nodes.N, 3))
    n, _ = states.spaces.sizes
    space = states.spaces.displacement
    middle = (states.spaces.order - 1) // 2
    for component in range(2):
        nodal = field[component * n : (component + 1) * n]
        displacement[nodes.nodal_dofs[0], component] = nodal[space.nodal_dofs[0]]
        displacement[nodes.facet_dofs[0], component] = nodal[space.facet_dofs[middle]]
    pressure = _pressure_at_nodes(states, field[2 * n :], nodes)
    stress, von_mises, density = _stress_and_energy(states, field)
    cells = np.vstack([nodes.nodal_dofs[0][triangles.t], nodes.facet_dofs[0][triangles.t2f]]).T
    return meshio.Mesh(
        points,
        [("triangle6", cells)],
        point_data={
            "displacement": displacement * problem.unit_height,
            "pressure": pressure * problem.unit_stress,
        },
        cell_data={
            "stress": [stress * problem.unit_stress],
            "von_mises": [von_mises * problem.unit_stress],
            "strain_energy_density": [density * problem.unit_energy / problem.period**2],
        },
    )


def _pressure_at_nodes(states: UnitStates, nodal: FloatArray, nodes: Basis) -> FloatArray:
    """Hydrostatic pressure at vertices and mid-sides: linear or cubic along a side."""
    space, facets = states.spaces.pressure, states.mesh.triangles.facets
    at_vertices = nodal[space.nodal_dofs[0]]
    values = np.empty(nodes.N)
    values[nodes.nodal_dofs[0]] = at_vertices
    ends = at_vertices[facets].sum(axis=0)
    inner = nodal[space.facet_dofs].sum(axis=0) if states.spaces.order == 4 else None
    values[nodes.facet_dofs[0]] = ends / 2.0 if inner is None else (9.0 * inner - ends) / 16.0
    return values


def _stress_and_energy(states: UnitStates, field: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Means over each triangle of the stress tensor, (n_triangles, 9), the von Mises stress and the energy density."""
    spaces, n = taylor_hood(states.mesh.triangles, states.spaces.order), states.spaces.sizes[0]
    space = spaces.displacement
    mu, softness = states.problem.shear_modulus, states.problem.inverse_bulk_modulus
    ux, uy = (space.interpolate(field[c * n : (c + 1) * n]) for c in range(2))
    pressure = np.asarray(spaces.pressure.interpolate(field[2 * n :]))
    xx, yy, xy = ux.grad[0], uy.grad[1], 0.5 * (ux.grad[1] + uy.grad[0])
    third = (xx + yy) / 3.0
    deviator = xx**2 + yy**2 + 2.0 * xy**2 - 3.0 * third**2  # eps' : eps' with the zz part
    area = space.dx.sum(axis=1)

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.sum(values * space.dx, axis=1) / area)

    stress = np.zeros((len(area), 9))
    for places, part in (((0,), xx - third), ((4,), yy - third), ((8,), -third), ((1, 3), xy)):
        stress[:, places] = mean(2.0 * mu * part - (0.0 if len(places) > 1 else pressure))[:, None]
    von_mises = mean(np.sqrt(6.0 * deviator) * mu)
    return stress, von_mises, mean(mu * deviator + 0.5 * softness * pressure**2)


def write_fields(result: Result, path: str | Path) -> None:
    """Write the layer of a result as a VTU file for ParaView.

    Raises
    ------
    FileExistsError
        The file is there already.
    """
    target = Path(path)
    if target.exists():
        raise FileExistsError(f"{target} exists")
    field_mesh(result).write(target, file_format="vtu")
