"""Layer meshes of Gmsh with named boundaries are read, and other files are refused by name."""

import signal
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path

import meshio
import numpy as np
import pytest

from fem_reference import InvalidProblemError
from fem_reference.by_forms import layer_state
from fem_reference.imported_mesh import read_layer_mesh

MESHES = Path(str(files("fem_reference"))) / "meshes"
WAVE = (lambda x: -0.01 * np.cos(2 * np.pi * x), lambda x: 0.02 * np.pi * np.sin(2 * np.pi * x))  # and its slope


@pytest.fixture(scope="module")
def imported():
    return read_layer_mesh(MESHES / "layer.msh")


def test_the_committed_gmsh_mesh_has_its_boundaries_and_sizes(imported):
    assert imported.period == 1.0
    assert imported.thickness == 0.5
    assert set(imported.boundaries) == {"face", "plate", "left", "right"}


@pytest.mark.parametrize(
    ("old", "new"), [('"face"', '"bottom"'), ('"left"', '"seam"'), ('"plate"', '"top"')], ids=["face", "left", "plate"]
)
def test_a_mesh_without_a_named_boundary_is_refused(tmp_path, old, new):
    text = (MESHES / "layer.msh").read_text()
    assert old in text
    (tmp_path / "bad.msh").write_text(text.replace(old, new))
    with pytest.raises(InvalidProblemError, match=rf"^mesh: .*{old[1:-1]}"):
        read_layer_mesh(tmp_path / "bad.msh")


def test_a_file_that_is_no_mesh_is_refused(tmp_path):
    (tmp_path / "bad.msh").write_text("no mesh at all")
    with pytest.raises(InvalidProblemError, match=r"^mesh: cannot read"):
        read_layer_mesh(tmp_path / "bad.msh")


def lines_of(mesh, name):
    """Vertices of a named boundary, one by one."""
    tag, _ = mesh.field_data[name]
    blocks = zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True)
    return np.unique(
        np.concatenate([block.data[tags == tag].ravel() for block, tags in blocks if block.type == "line"])
    )


def inner(mesh, name):
    """A vertex of a named boundary that is not at its ends, and of no other."""
    others = [lines_of(mesh, other) for other in ("face", "plate", "left", "right") if other != name]
    return np.setdiff1d(lines_of(mesh, name), np.concatenate(others))[0]


def without_triangles(mesh):
    for block in mesh.cells:
        block.type = "line" if block.type == "line" else "triangle6"


def without_lines(mesh):
    tag, _ = mesh.field_data["face"]
    for tags in mesh.cell_data["gmsh:physical"]:
        tags[tags == tag] = -1


def with_a_hole(mesh):
    vertex = inner(mesh, "plate")
    for block in mesh.cells:
        if block.type == "triangle":
            block.data = block.data[~np.any(block.data == vertex, axis=1)]


def crooked(mesh):
    mesh.points[inner(mesh, "face"), 1] += 0.01


def with_a_vertex_on_the_plate(mesh):
    edge = np.concatenate([lines_of(mesh, name) for name in ("face", "plate", "left", "right")])
    mesh.points[np.setdiff1d(np.arange(len(mesh.points)), edge)[0], 1] = 0.5


def sheared(mesh):
    mesh.points[inner(mesh, "left"), 1] += 1e-3


def unnamed(mesh):
    for tags in mesh.cell_data["gmsh:physical"]:
        tags[:1] = 0


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (without_triangles, "holds no straight-sided triangles"),
        (without_lines, "boundary 'face' has no lines"),
        (with_a_hole, "boundary 'plate' has vertices of no triangle"),
        (crooked, "boundary 'face' is not the line y = 0"),
        (with_a_vertex_on_the_plate, "boundary 'plate' does not hold all the vertices on its line"),
        (sheared, "left and right do not carry the same vertices"),
        (unnamed, "elements of no physical group"),
    ],
)
def test_a_mesh_that_is_no_period_of_a_layer_is_refused(tmp_path, spoil, said):
    mesh = meshio.gmsh.read(MESHES / "layer.msh")
    mesh.cell_sets, mesh.point_data = {}, {}
    spoil(mesh)
    meshio.gmsh.write(tmp_path / "bad.msh", mesh, "2.2", binary=False)
    with pytest.raises(InvalidProblemError, match=f"^mesh: .*{said}"):
        read_layer_mesh(tmp_path / "bad.msh")


@contextmanager
def meshed():
    """Open the shipped geometry in Gmsh, meshed and ready to be written."""
    gmsh = pytest.importorskip("gmsh", exc_type=ImportError)
    gmsh.initialize(interruptible=False)
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # Gmsh restores the default, which ends the process
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(MESHES / "layer.geo"))
        gmsh.model.mesh.generate(2)
        yield gmsh
    finally:
        gmsh.finalize()


def test_gmsh_makes_a_mesh_of_the_same_layer(tmp_path, imported):
    with meshed() as gmsh:
        gmsh.write(str(tmp_path / "layer.msh"))
    again = read_layer_mesh(tmp_path / "layer.msh")
    assert (again.period, again.thickness) == (imported.period, imported.thickness)
    edges = np.array([[0.3, 0.7]])
    loads = [layer_state(layer.mesh, 1.0, 0.3, WAVE, edges, 0.005, 2).load for layer in (again, imported)]
    assert loads[0] == pytest.approx(loads[1], rel=1e-3)


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize(("option", "said"), [("SaveParametric", "parametric coordinates"), ("SaveAll", "no physical")])
def test_what_gmsh_saves_besides_the_named_boundaries_is_refused_by_name(tmp_path, version, option, said):
    with meshed() as gmsh:
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber(f"Mesh.{option}", 1)
        gmsh.write(str(tmp_path / "layer.msh"))
    with pytest.raises(InvalidProblemError, match=rf"^mesh: .*{said}.*Mesh\.{option} = 0"):
        read_layer_mesh(tmp_path / "layer.msh")
