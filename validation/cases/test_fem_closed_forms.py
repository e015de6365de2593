"""Finite elements against closed forms, before they are a reference for anything.

- Complete contact of a wave with a bonded layer, any nu: energy per area h_1^2 / (4 c(q)), c(q) of Carbone and
  Mangialardi (J. Mech. Phys. Solids 56 (2008) 684); the energy converges with the order 2 m of elements of order m.
- One patch on a layer of two periods, which is a half-space to 1e-8: Johnson's state (Int. J. Solids Struct. 32 (1995)
  423), with its edges given: load and stress intensity are asked.  Edges that finite elements find are in
  test_three_ways.py and test_fem_calibration.py.
- The closure moves edges until K = K_c.  Both are made with E*, so that a wrong E* leaves edges, load and energy as
  they are: asked are K at the edges found, sqrt(2 E* gamma), and the smallest eigenvalue of the energy in motions of
  the edges.

h = D cos(q0 x), D = 50 or 100 um, period 10 mm, E = 1 MPa.  U is what the finite elements state from three meshes.
"""

import numpy as np
import pytest

import bem
import fem_reference
from fem_reference import Resolution
from fem_reference.export import field_mesh
from fem_reference.result import spread
from fem_reference.solve import companions
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid, layer_compliance
from validation.routes.fem_scenes import on_meshes, uncertain

PERIOD, AMPLITUDE, E = 0.01, 50e-6, 1e6
HALVED = 0.35 * float(np.expm1(0.5 / 0.35)) * PERIOD  # thickness at which meshes have half as many rows as columns
HALF_SPACE = 1e-8  # relative: a layer of two periods
GIVEN = {2: Resolution(2, 10, 12), 4: Resolution(4, 10, 22)}


def raw(wave, thickness):
    """Return a wave on a layer as `fem_reference.solve` takes it: raw numbers, without adhesion."""
    return {"youngs_modulus": wave.youngs_modulus, "poisson_ratio": wave.poisson_ratio, "thickness": thickness,
            "period": wave.wavelength, "harmonics": ([1], [wave.amplitude], [0.0])}


def even_order(sizes, errors):
    """Return the order p of errors C h^p (1 + b h^2) on three meshes, as smooth solutions leave on uniform ones."""
    h = np.asarray(sizes)
    terms = np.column_stack([np.log(h), h**2, np.ones(3)])
    return float(np.linalg.solve(terms, np.log(errors))[0])


@pytest.mark.quick
@pytest.mark.parametrize("poisson_ratio", [-0.5, 0.3, 0.499999, 0.5])
@pytest.mark.parametrize("order", [2, 4])
def test_complete_contact(rows, order, poisson_ratio):
    """Do finite elements converge at their order in complete contact, for any Poisson's ratio?"""
    exact = 0.25 * AMPLITUDE**2 / float(layer_compliance(2 * np.pi / PERIOD, HALVED, E, poisson_ratio))
    asymptotic = order == 2 or poisson_ratio < 0.4  # else P4 meets rounding, 1e-11, before its asymptotic range
    ladder = companions(Resolution(order, 24 if asymptotic else 16, 12))  # 12, 18 and 24 cells
    wave = Sinusoid(AMPLITUDE, PERIOD, E, poisson_ratio, 0.0)
    energies = np.array([values["strain_energy"] / PERIOD for values in on_meshes(
        ladder, **raw(wave, HALVED), control="mean_pressure", value=0.0, edges="complete")])
    rows.compare("elastic energy", energies[-1], exact, of=Code.FEM, by=Code.EXACT, quantity=Quantity.ENERGY,
                 unit="J/m^2", source="Carbone and Mangialardi 2008", uncertainty=float(spread(energies, ladder)))
    errors = np.abs(energies / exact - 1)
    cells = [resolution.cells for resolution in ladder]
    rows.curves("Relative error of the elastic energy in complete contact", "cells per period", "error",
                {f"P{order}, nu = {poisson_ratio:g}": (cells, errors)}, log="xy")
    if asymptotic:
        observed = even_order([1 / count for count in cells], errors)
        pairwise = np.log(errors[1] / errors[2]) / np.log(cells[2] / cells[1])
        rows.compare("order of the elastic energy", observed, 2.0 * order, of=Code.FEM, by=Code.RATE,
                     quantity=Quantity.RATE, uncertainty=abs(observed - pairwise), required=0.5,
                     because="half an order; the next elements differ by two",
                     source="energy norm of order m, squared")


@pytest.mark.parametrize("order", [pytest.param(2, marks=pytest.mark.quick),
                                   pytest.param(4, marks=pytest.mark.standard)])
@pytest.mark.parametrize(("fraction", "poisson_ratio", "alpha"), [(0.1, 0.3, 0.1), (0.4, 0.5, 0.3), (0.7, 0.45, 0.3)])
def test_given_edges(rows, order, fraction, poisson_ratio, alpha):
    """Do finite elements find load and stress intensity of Johnson's states at given edges?"""
    wave, half = Sinusoid(AMPLITUDE, PERIOD, E, poisson_ratio, alpha), 0.5 * fraction * PERIOD
    state = fem_reference.solve(**raw(wave, 2 * PERIOD), control="penetration", resolution=GIVEN[order],
                                value=float(wave.penetration(fraction * np.pi / 2)), edges=[[-half, half]],
                                work_of_adhesion=wave.work_of_adhesion)
    johnson = rows.between(Code.FEM, Code.EXACT, "Johnson 1995")
    star, critical = wave.full_contact_pressure, wave.alpha * wave.full_contact_pressure * np.sqrt(PERIOD)
    johnson.compare("mean pressure", state.mean_pressure, float(wave.mean_pressure(fraction * np.pi / 2)),
                    quantity=Quantity.PRESSURE, unit="Pa",
                    uncertainty=(uncertain(state, "mean_pressure"), HALF_SPACE * star))
    johnson.compare("stress intensity", state.stress_intensity, critical, quantity=Quantity.INTENSITY, unit="Pa m^1/2",
                    uncertainty=(np.ravel(state.uncertainty["stress_intensity"]), HALF_SPACE * critical))


WAVE = Sinusoid(amplitude=1e-4, wavelength=PERIOD, youngs_modulus=E, poisson_ratio=0.3, alpha=0.3)


def stiffness(psi):
    """Return d2U in J/m^3 as both edges of WAVE move outwards at fixed penetration, and as both move to one side.

    K / E* times dK: outwards K = sqrt(period / tan psi) pi E* (Delta - D S (1 - ln S)) / (period ln S), S = sin^2 psi.
    A shift adds the odd pressure E* D q0^2 / 2 s (1 + S - 2 s^2) / sqrt(S - s^2), s = sin(q0 x / 2), per length.
    """
    share, modulus = np.sin(psi) ** 2, WAVE.modulus
    intensity = np.sqrt(2 * modulus * WAVE.work_of_adhesion)
    per_lift = np.sqrt(PERIOD / np.tan(psi)) * np.pi * modulus / (PERIOD * np.log(share))  # dK/dDelta
    outwards = -intensity * (1 / np.sin(2 * psi) + 2 / (np.tan(psi) * np.log(share)))
    outwards += per_lift * WAVE.amplitude * np.log(share) * np.sin(2 * psi)
    curvature = WAVE.amplitude * (2 * np.pi / PERIOD) ** 2
    aside = modulus * curvature * np.sqrt(2 * PERIOD * np.sin(2 * psi)) * np.cos(psi) / 4
    return float(intensity / modulus * outwards * np.pi / PERIOD), float(intensity / modulus * aside)


@pytest.mark.quick
def test_modulus_of_the_closure(rows):
    """Has the contact whose edges the finite elements find the stress intensity and the stability it must?"""
    fractions = (0.3, 0.5, 0.7)
    states = [fem_reference.solve(**raw(WAVE, 2 * PERIOD), control="penetration", resolution=Resolution(2, 10, 10),
                                  value=float(WAVE.penetration(fraction * np.pi / 2)),
                                  work_of_adhesion=WAVE.work_of_adhesion) for fraction in fractions]
    critical = float(np.sqrt(2 * WAVE.modulus * WAVE.work_of_adhesion))
    rows.count("unknowns", sum(state.unknowns for state in states), within=0.0, of=Code.FEM)
    rows.compare("stress intensity at the edges found", np.concatenate([s.stress_intensity.ravel() for s in states]),
                 critical, of=Code.FEM, by=Code.EXACT, quantity=Quantity.INTENSITY, unit="Pa m^1/2",
                 uncertainty=max(uncertain(state, "stress_intensity") for state in states), required=1e-8 * critical,
                 because="the closure ends below 1e-8", source="sqrt(2 E* gamma)")
    exact = np.array([min(stiffness(fraction * np.pi / 2)) for fraction in fractions])
    rows.compare("smallest eigenvalue of the energy", [state.min_eigenvalue for state in states], exact, of=Code.FEM,
                 by=Code.EXACT, quantity=Quantity.STIFFNESS, unit="J/m^3", uncertainty=0.01 * exact,
                 required=0.01 * exact, because="differences on the scouting mesh decide the sign only",
                 source="Johnson's state, moved edges")
    profile = bem.Profile.from_harmonics(PERIOD, [1], [WAVE.amplitude])
    by_bem = []
    for fraction in fractions:
        half, adhesion = fraction * PERIOD / 2, bem.Adhesion(WAVE.work_of_adhesion)
        state = bem.ContactState(profile, bem.Solid(E, 0.3), [[-half, half]],
                                 float(WAVE.penetration(fraction * np.pi / 2)), adhesion=adhesion)
        by_bem.append([float(motion @ state.hessian @ motion) / 2 for motion in np.array([[-1, 1], [1, 1]])])
    closed = np.ravel([stiffness(fraction * np.pi / 2) for fraction in fractions])
    rows.compare("d2U outwards and to one side", np.ravel(by_bem), closed, of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.STIFFNESS, unit="J/m^3", uncertainty=1e-10 * closed, required=1e-9 * closed,
                 because="nine digits of a derivative", source="Johnson's state, moved edges")


@pytest.mark.quick
@pytest.mark.parametrize("order", [2, 4])
def test_written_fields(rows, order):
    """Are the fields that are written in equilibrium with the load, and do they hold the energy and the face?

    Mean stresses over the layer are those of its bottom, -p upright and none in shear, and those of a clamped layer,
    whose mean stretch along the period is zero, -p nu / (1 - nu) in the other directions.
    """
    nu, edges = 0.3, [[-0.1 * PERIOD, 0.12 * PERIOD]]
    result = fem_reference.solve(**raw(Sinusoid(AMPLITUDE, PERIOD, E, nu, 0.0), HALVED), control="mean_pressure",
                                 value=1e3, edges=edges, resolution=Resolution(order, 10, 12))
    mesh = field_mesh(result)
    nodes, at = mesh.cells[0].data, mesh.points[:, :2]
    rows.count("unknowns", result.unknowns, within=0.0, of=Code.FEM)
    for name in ("strain_energy", "penetration", "stress_intensity", "middle_pressure"):
        rows.count(f"stated U of {name}", uncertain(result, name), within=0.05, of=Code.FEM)
    a, b = at[nodes[:, 1]] - at[nodes[:, 0]], at[nodes[:, 2]] - at[nodes[:, 0]]
    area = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    stress, energy, mises = (mesh.cell_data[name][0] for name in ("stress", "strain_energy_density", "von_mises"))
    mean = area @ stress.reshape(-1, 9) / area.sum()
    face = np.flatnonzero((at[:, 1] == 0) & (at[:, 0] < at[:, 0].max()))
    middle = nodes[:, 3:]
    sides = [at[nodes[:, i]] + at[nodes[:, j]] for i, j in ((0, 1), (1, 2), (2, 0))]
    u, p, load = mesh.point_data["displacement"], mesh.point_data["pressure"], result.mean_pressure
    aside = load * nu / (1 - nu)
    rows.compare("mean stresses", mean, [-aside, 0, 0, 0, -load, 0, 0, 0, -aside], unit="Pa", of=Code.FEM,
                 by=Code.EXACT, quantity=Quantity.PRESSURE, uncertainty=1e-9 * load, required=1e-8 * load,
                 because="equilibrium of the whole holds to rounding on any mesh", source="equilibrium, Hooke")
    own = rows.between(Code.FEM, Code.IDENTITY, "the result that is written", "construction")
    parts = stress.reshape(-1, 3, 3)
    pressure = -np.trace(parts, axis1=1, axis2=2) / 3
    for name, unit, value, reference, required in (
        ("area of the layer", "m^2", area.sum(), PERIOD * HALVED, 1e-12),
        ("strain energy", "J/m", area @ energy, result.strain_energy, 1e-10),
        ("displacement of the face", "m", u[face, 1], result.displacement(at[face, 0]), 1e-10),
        ("middles of sides", "m", [at[middle[:, k]] for k in range(3)], np.array(sides) / 2, 1e-12),
        ("mean pressure at middles of sides and of the stresses", "Pa", area @ p[middle].mean(axis=1), area @ pressure,
         1e-8 if order == 2 else 1e-3),
        ("median von Mises stress over that of mean stresses", "", np.median(
            mises / np.sqrt(1.5 * np.sum((parts + pressure[:, None, None] * np.eye(3)) ** 2, axis=(1, 2)))), 1.0, 0.01),
    ):
        own.compare(name, value, reference, unit=unit, quantity=Quantity.POINTS,
                    required=required * np.max(np.abs(reference)),
                    because="rounding, or a rule of second order in a triangle")
