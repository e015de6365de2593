"""Fields written as VTU are read back bit for bit and integrate to the numbers of the result."""

import meshio
import numpy as np
import pytest

from fem_reference import Resolution, solve
from fem_reference.export import field_mesh, write_fields

COMMON = {
    "youngs_modulus": 1.0,
    "poisson_ratio": 0.3,
    "thickness": 0.5,
    "period": 1.0,
    "harmonics": ([1], [0.01], [np.pi]),
    "control": "mean_pressure",
    "value": 0.01,
    "edges": [[0.3, 0.7]],
}


@pytest.fixture(scope="module", params=[2, 4], ids=["P2/P1", "P4/P3"])
def result(request):
    return solve(**COMMON, resolution=Resolution(request.param, 10, 12))


def test_fields_read_back_bit_for_bit(result, tmp_path):
    written = field_mesh(result)
    write_fields(result, tmp_path / "layer.vtu")
    read = meshio.read(tmp_path / "layer.vtu")
    np.testing.assert_array_equal(read.points, written.points)
    np.testing.assert_array_equal(read.cells[0].data, written.cells[0].data)
    for name in ("displacement", "pressure"):
        np.testing.assert_array_equal(read.point_data[name], written.point_data[name])
    for name in ("von_mises", "strain_energy_density"):
        np.testing.assert_array_equal(read.cell_data[name][0], written.cell_data[name][0])


def test_an_existing_file_is_not_overwritten(result, tmp_path):
    (tmp_path / "layer.vtu").write_text("mine")
    with pytest.raises(FileExistsError):
        write_fields(result, tmp_path / "layer.vtu")


def test_energy_density_sums_to_the_strain_energy(result):
    mesh = field_mesh(result)
    corner = mesh.points[mesh.cells[0].data[:, :3], :2]
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])  # below 0 for a clockwise triangle
    assert np.all(area > 0)
    total = np.sum(area * mesh.cell_data["strain_energy_density"][0])
    assert total == pytest.approx(result.strain_energy, rel=1e-10)  # measured 1e-13


def test_mid_side_nodes_are_in_the_middle_of_their_sides(result):
    mesh = field_mesh(result)
    nodes = mesh.points[mesh.cells[0].data]
    for middle, (i, j) in zip((3, 4, 5), ((0, 1), (1, 2), (0, 2)), strict=True):
        expected = 0.5 * (nodes[:, i] + nodes[:, j])
        order = SIDES.index((i, j))
        np.testing.assert_allclose(nodes[:, 3 + order], expected, atol=1e-14)
        assert middle == 3 + order


SIDES = [(0, 1), (1, 2), (0, 2)]


def test_exported_displacement_is_that_of_the_face(result):
    mesh = field_mesh(result)
    face = np.flatnonzero(mesh.points[:, 1] == 0)
    np.testing.assert_allclose(
        mesh.point_data["displacement"][face, 1], result.displacement(mesh.points[face, 0]), atol=1e-15
    )


def test_exported_pressure_is_that_of_the_elements(result):
    mesh, states = field_mesh(result), result.evaluation.states
    nodal = (states.fields[0] + result.evaluation.load * states.fields[1])[2 * states.spaces.sizes[0] :]
    some = mesh.points[-200:, :2]  # mid-sides
    local = np.column_stack([some[:, 0] - states.mesh.seam, some[:, 1]])
    expected = states.spaces.pressure.probes(local.T) @ nodal * result.problem.unit_stress
    np.testing.assert_allclose(mesh.point_data["pressure"][-200:], expected, rtol=1e-6, atol=1e-12)


def test_a_uniformly_compressed_layer_has_uniform_fields():
    flat = COMMON | {"harmonics": ([], [], []), "edges": "complete"}
    mesh = field_mesh(solve(**flat, resolution=Resolution(4, 8, 12)))
    nu = 0.3
    # uniaxial strain: sigma_yy = -p, sigma_xx = sigma_zz = -p nu / (1 - nu)
    lateral = 0.01 * nu / (1 - nu)
    np.testing.assert_allclose(mesh.point_data["pressure"], (0.01 + 2 * lateral) / 3, rtol=1e-10)
    np.testing.assert_allclose(mesh.cell_data["von_mises"][0], 0.01 - lateral, rtol=1e-10)
    stress = np.diag([-lateral, -0.01, -lateral]).ravel()
    np.testing.assert_allclose(mesh.cell_data["stress"][0], np.tile(stress, (len(mesh.cells[0].data), 1)), atol=1e-13)
