"""Meshes: bad edges are named, edges are vertices, the seam matches, moving keeps the topology."""

import numpy as np
import pytest

from fem_reference.elasticity import taylor_hood
from fem_reference.mesh import Resolution, base_unknowns, layer_mesh, moved
from fem_reference.problem import InvalidProblemError

FINE = Resolution(2, 8, 10)


@pytest.mark.parametrize(
    "edges",
    [
        [[0.4, 0.3]],
        [[0.1, 0.4], [0.3, 0.6]],
        [[0.6, 0.8], [0.1, 0.3]],
        [[0.1, 0.5], [0.8, 1.2]],
        [[0.2, 0.2 + 1e-7]],
        [[0.0, 1.0 - 1e-7]],
        [[0.1, np.nan]],
        [0.1, 0.2],
    ],
    ids=["reversed", "overlapping", "unordered", "overlapping round the period", "narrow", "narrow gap", "nan", "flat"],
)
def test_bad_edges_are_named(edges):
    with pytest.raises(InvalidProblemError, match=r"^edges: "):
        layer_mesh(1.0, np.array(edges), FINE)


@pytest.mark.parametrize("depth", [0.05, 0.5, 2.0])
@pytest.mark.parametrize(
    "edges",
    [[[0.4, 0.6]], [[0.01, 0.98]], [[0.1, 0.12], [0.5, 0.8]], [[0.0, 0.2], [0.3, 0.5], [0.6, 0.7], [0.75, 0.95]]],
    ids=["one", "nearly complete", "unequal", "four"],
)
def test_edges_are_vertices_seam_is_matched_and_area_kept(edges, depth):
    mesh = layer_mesh(depth, np.array(edges), FINE)
    p, t = mesh.triangles.p, mesh.triangles.t
    face = p[0, p[1] == 0.0]
    assert np.max(np.min(np.abs(face[:, None] - mesh.local_edges.ravel()), axis=0)) == 0.0
    left, right = (np.sort(p[1, p[0] == end]) for end in (0.0, 1.0))
    np.testing.assert_array_equal(left, right)
    a, b = p[:, t[1]] - p[:, t[0]], p[:, t[2]] - p[:, t[0]]
    area = 0.5 * np.abs(a[0] * b[1] - a[1] * b[0])
    assert area.min() > 0
    assert area.sum() == pytest.approx(depth, rel=1e-12)


def test_smallest_triangle_follows_the_tip_levels():
    def smallest(levels):
        mesh = layer_mesh(1.0, np.array([[0.4, 0.6]]), Resolution(2, 8, levels))
        face = np.sort(mesh.triangles.p[0, mesh.triangles.p[1] == 0.0])
        return np.diff(face).min()

    assert smallest(12) / smallest(10) == pytest.approx(0.25, rel=1e-6)


def test_moving_keeps_the_topology_and_puts_vertices_on_the_edges():
    mesh = layer_mesh(1.0, np.array([[0.1, 0.3], [0.5, 0.9]]), FINE)
    target = np.array([[0.11, 0.28], [0.52, 0.93]])
    after = moved(mesh, target)
    np.testing.assert_array_equal(after.triangles.t, mesh.triangles.t)
    face = after.triangles.p[0, after.triangles.p[1] == 0.0]
    assert np.max(np.min(np.abs(face[:, None] - after.local_edges.ravel()), axis=0)) == 0.0


def test_an_edge_cannot_cross_the_seam():
    mesh = layer_mesh(1.0, np.array([[0.4, 0.6]]), FINE)
    with pytest.raises(InvalidProblemError, match="seam"):
        moved(mesh, np.array([[-0.1, 0.6]]))


@pytest.mark.parametrize("arguments", [(3, 8, 10), (2, 2, 10), (2, 8, 40)], ids=["order", "cells", "tip levels"])
def test_bad_resolution_is_named(arguments):
    with pytest.raises(InvalidProblemError, match=r"^resolution: "):
        Resolution(*arguments)


@pytest.mark.parametrize("order", [2, 4])
def test_unknowns_are_estimated_before_a_mesh_is_made(order):
    resolution = Resolution(order, 20, 10)
    nodes, pressures = taylor_hood(layer_mesh(2.0, np.zeros((0, 2)), resolution).triangles, order).sizes
    assert base_unknowns(2.0, resolution, 1) == pytest.approx(2 * nodes + pressures, rel=0.05)
