"""Write the fields of a result for ParaView, through meshio.

`write_fields` writes the whole layer as a VTU file: six-node triangles, all counter-clockwise, in SI coordinates with
the displacement (m) and the hydrostatic pressure (Pa) at vertices and mid-sides, the stress tensor (Pa), the von Mises
stress (Pa) and the strain energy density (J/m^3) as means over each triangle, so that density times area sums to the
strain energy. Floats are stored in binary: reading back returns the same bits.
"""

from pathlib import Path

import meshio
import numpy as np
from skfem import Basis, ElementTriP2

from fem_reference.contact import UnitStates
from fem_reference.elasticity import taylor_hood
from fem_reference.problem import FloatArray
from fem_reference.result import Result

COUNTER_CLOCKWISE = [0, 2, 1, 5, 4, 3]  # vertices and mid-sides of a six-node triangle, walked the other way


def field_mesh(result: Result) -> meshio.Mesh:
    """Return the whole layer of a result as a meshio mesh with its fields, SI units."""
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
    (ax, ay), (bx, by), (cx, cy) = points[cells[:, :3], :2].transpose(1, 2, 0)
    clockwise = (bx - ax) * (cy - ay) < (cx - ax) * (by - ay)
    cells[clockwise] = cells[clockwise][:, COUNTER_CLOCKWISE]
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
    """Return the hydrostatic pressure at vertices and mid-sides: linear or cubic along a side."""
    space, facets = states.spaces.pressure, states.mesh.triangles.facets
    at_vertices = nodal[space.nodal_dofs[0]]
    values = np.empty(nodes.N)
    values[nodes.nodal_dofs[0]] = at_vertices
    ends = at_vertices[facets].sum(axis=0)
    inner = nodal[space.facet_dofs].sum(axis=0) if states.spaces.order == 4 else None
    values[nodes.facet_dofs[0]] = ends / 2.0 if inner is None else (9.0 * inner - ends) / 16.0
    return values


def _stress_and_energy(states: UnitStates, field: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return means over each triangle: stress (n_triangles, 9), von Mises stress, energy density."""
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
        raise FileExistsError(f"{target} exists: name another file, or remove it")
    field_mesh(result).write(target, file_format="vtu")
