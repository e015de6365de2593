"""Layers: their kernel against independent solutions, and thin ones along whole paths against dense algebra.

c(q), the displacement of the face per pressure of a wave, is solved here by the exponential of plane-strain elasticity
through the thickness, and the kernel in space by quadrature of its Fourier integral:

    K(x) = 1/2 log(1 + 1/x^2) + int_0^oo (ratio(k d) - 1 + e^-k) / k cos kx dk,   sum over images K(x + 2 pi n)
         = sum_m ratio(m d) / m cos mx + 1/2 lim ratio(k d) / k.

Paths: a rough profile of 20 harmonics (h_rms = 50 um, period 10 mm, E = 1 MPa) on a layer of 0.02 periods, loaded and
unloaded; dense algebra has twice the nodes that it needs.  Source: Carbone and Mangialardi, J. Mech. Phys. Solids 56
(2008) 684.
"""

import numpy as np
import pytest
from scipy.linalg import expm

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import layer_compliance, layer_ratio, uniform_compliance
from validation.references.dense import LayerKernel
from validation.routes.dense_algebra import reference
from validation.routes.scenes import TEN_DIGITS, estimates, posed, solved, touching, values

MILD = {"solid": {"poisson_ratio": 0.3}}
PLATE = {"control": "total_displacement", "targets": [20e-6, 60e-6, 90e-6, 50e-6]}


def transferred(q, thickness, youngs_modulus, poisson_ratio):
    """Return c(q) in m/Pa by the exponential of plane-strain elasticity through the thickness.

    With u = U(y) sin qx, v = V(y) cos qx, sigma_xy = T sin qx, sigma_yy = S cos qx, lengths 1 / q and stresses mu,
    U' = V + T, V' = ((1 - 2 nu) S / 2 - nu U) / (1 - nu), T' = (2 U + nu S) / (1 - nu), S' = -T; U = V = 0 where the
    layer is bonded, T = 0 on its face.
    """
    nu = poisson_ratio
    system = np.array([[0, 1, 1, 0], [-nu / (1 - nu), 0, 0, (1 - 2 * nu) / (2 - 2 * nu)],
                       [2 / (1 - nu), 0, 0, nu / (1 - nu)], [0, 0, -1, 0]])
    through = expm(system * q * thickness)[:, 2:]  # of the tractions where the layer is bonded
    tractions = np.linalg.solve(through[2:], [0.0, -1.0])
    return -float(through[1] @ tractions) * 2 * (1 + nu) / (youngs_modulus * q)


@pytest.mark.quick
@pytest.mark.parametrize("poisson_ratio", [-0.5, 0.0, 0.3, 0.499, 0.5])
def test_compliance(rows, poisson_ratio):
    """Do boundary elements and dense algebra use the compliance c(q) of a bonded layer, thin and thick?"""
    thickness, q = 1e-3, np.array([0.1, 0.3, 1.0, 3.0]) / 1e-3
    exact = np.array([transferred(k, thickness, 1e6, poisson_ratio) for k in q])
    ours = bem.Layer(thickness).compliance(bem.Solid(1e6, poisson_ratio), q)
    for code, value in ((Code.BEM, ours), (Code.DENSE, layer_compliance(q, thickness, 1e6, poisson_ratio))):
        rows.compare("c(q), relative, q d = 0.1, 0.3, 1, 3", value / exact, 1.0, of=code, by=Code.EXACT,
                     quantity=Quantity.SPECTRUM, uncertainty=(1e-15, 1e-12),
                     source="matrix exponential of plane-strain elasticity")


@pytest.mark.quick
@pytest.mark.parametrize(("depth", "poisson_ratio"), [(0.15, 0.5), (0.6, 0.3), (2.0, 0.0)])
def test_kernel(rows, depth, poisson_ratio):
    """Is the kernel of dense algebra in space, with its mean compliance, that of its Fourier integral?"""
    x = np.array([0.3, 1.0, 2.0, 3.0])
    modes = LayerKernel.of(depth, poisson_ratio).value(x)
    uniform = uniform_compliance(depth, 1.0, poisson_ratio) / (4 * (1 - poisson_ratio**2))  # 1/2 lim ratio(k d) / k

    node, weight = np.polynomial.legendre.leggauss(16)
    ends = np.linspace(0, 40 / min(2 * depth, 1.0), 3001)
    half = (ends[1] - ends[0]) / 2
    k = (ends[:-1, None] + half * (node + 1)).ravel()
    smooth = np.tile(weight * half, ends.size - 1) * (layer_ratio(k * depth, poisson_ratio) - 1 + np.exp(-k)) / k
    places = np.abs(np.add.outer(x, 2 * np.pi * np.arange(-12, 13)))
    images = np.array([np.sum(0.5 * np.log1p(1 / near**2) + np.cos(np.outer(near, k)) @ smooth) for near in places])
    rows.compare("kernel", -np.log(2 * np.sin(x / 2)) - modes, images - uniform, of=Code.DENSE, by=Code.EXACT,
                 quantity=Quantity.POINTS, uncertainty=(1e-14, 1e-12),
                 source="Fourier integral by Gauss-Legendre, 25 images")


@pytest.mark.standard
@pytest.mark.parametrize(
    "tables",
    [pytest.param({}, id="incompressible, adhesion"), pytest.param({"adhesion": None}, id="incompressible"),
     pytest.param(MILD, id="compressible, adhesion"), pytest.param(MILD | {"loading": PLATE}, id="by its plate")],
)
def test_path_on_thin_layer(rows, tables):
    """Does a thin layer keep its accuracy along a whole path of loading and unloading?"""
    scene, result = posed("thin_layer", **tables), solved("thin_layer", **tables)
    assert all(state.certificate.ok for state in result.states)
    states = touching(result.targets)
    known = [reference(scene, state, refinement=2) for state in states]
    dense = rows.between(Code.BEM, Code.DENSE, "same edges to start from, twice the nodes")
    for name, quantity, unit in (("contact_fraction", Quantity.AREA, ""), ("mean_pressure", Quantity.PRESSURE, "Pa"),
                                 ("elastic_energy", Quantity.ENERGY, "J/m^2")):
        exact = np.array([answer[name] for answer in known])
        scale = np.max(np.abs(exact))
        dense.compare(name.replace("_", " "), values(states, name), exact, quantity=quantity, unit=unit,
                      uncertainty=(estimates(states, name), 1e-12 * scale), required=1e-10 * scale,
                      because=TEN_DIGITS)
    rows.count("evaluations", sum(state.evaluations for state in result.states), of=Code.BEM)
    shown = touching(result.states)
    rows.curves("Loading and unloading on a layer of 0.02 periods", "separation / um", "mean pressure / kPa",
                {"boundary elements": (values(shown, "separation") * 1e6, values(shown, "mean_pressure") / 1e3),
                 "dense algebra": ([answer["separation"] * 1e6 for answer in known],
                                   [answer["mean_pressure"] / 1e3 for answer in known])})
