"""Unstructured mesh of Gmsh, read by meshio and solved by scikit-fem's forms, against boundary elements at given edges.

`fem_reference/meshes/layer.msh` is one period of a layer half as thick (nu = 0.3), graded to 1/250 of the period at the
edges 0.3 and 0.7; h = -cos(2 pi x / period) / 100 periods, E = 1 MPa, period 1 m. Elements P2/P1 on the mesh and on
the same one halved. Edges are singular and the halved triangles alike there, so that load and energy converge as h:
U is three times the difference of the two meshes (Roache 1998, sec. 5.9, of two meshes of first order).
"""

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import bem
from fem_reference.by_forms import layer_state
from fem_reference.imported_mesh import read_layer_mesh
from validation.plugin.rows import Code, Quantity

MODULUS, RATIO, HEIGHT, EDGES, PENETRATION = 1e6, 0.3, 0.01, np.array([[0.3, 0.7]]), 0.004
WAVE = 2 * np.pi
PROFILE = (lambda x: -HEIGHT * np.cos(WAVE * x), lambda x: HEIGHT * WAVE * np.sin(WAVE * x))


@pytest.mark.quick
def test_gmsh_mesh(rows):
    """Do scikit-fem's forms on an unstructured mesh find the load, energy and G of boundary elements at given edges?"""
    mesh = read_layer_mesh(Path(str(files("fem_reference"))) / "meshes" / "layer.msh").mesh
    profile = bem.Profile.from_harmonics(1.0, [1], [HEIGHT], [np.pi])
    state = bem.ContactState(profile, bem.Solid(MODULUS, RATIO), EDGES, PENETRATION, bem.Layer(0.5))
    softness = 0.5 * (1 - 2 * RATIO) * (1 + RATIO) / (MODULUS * (1 - RATIO))  # c(0), m/Pa
    load = state.mean_pressure
    moved = PENETRATION + softness * load  # of the plate
    coarse, fine = (layer_state(each, MODULUS, RATIO, PROFILE, EDGES, moved - HEIGHT, 2)
                    for each in (mesh, mesh.refined()))
    energy = state.elastic_energy + 0.5 * softness * load**2
    pair = rows.between(Code.FEM, Code.BEM, f"{fine.basis.N} values of displacement, Gmsh 4.1")
    for name, value, before, ours, quantity, unit in (
        ("load", fine.load, coarse.load, load, Quantity.PRESSURE, "N/m"),
        ("strain energy", fine.strain_energy, coarse.strain_energy, energy, Quantity.ENERGY, "J/m"),
        ("G", fine.release_rate, coarse.release_rate, state.energy_release_rate, Quantity.INTENSITY, "J/m^2"),
    ):
        pair.compare(name, np.ravel(value), np.ravel(ours), quantity=quantity, unit=unit,
                     uncertainty=(3 * np.ravel(np.abs(np.subtract(value, before))), 1e-9 * np.ravel(np.abs(ours))))
