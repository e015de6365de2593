"""Statements that hold for any profile: energy release rate, mean gap, invariance where the period begins.

G = K^2 / (2 E*), w = gamma sqrt(1 + h'^2): dU/d(edge) = G - w outwards, dU/dDelta = load, and the mean gap is the
highest crest less the penetration.  Rough profiles of 40 to 100 harmonics, Hurst exponent 0.7, h_rms = 50 um, period
10 mm; E = 1 MPa, nu = 0.5, gamma = 0.03 J/m^2.  All rows hold by construction: both sides come from the boundary
elements.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import bem
from validation.plugin.rows import Code, Quantity
from validation.routes.scenes import NOT_SELF_AFFINE, posed, solved, touching, values

SOLID = bem.Solid(1e6, 0.5)
STEP = 2e-4  # of the narrowest patch, in differences of fourth order
EVENTS = ("new_contact", "coalescence", "detachment", "pull_off")


def mean_gap(edges, penetration, profile):
    """Return the mean gap over a period, m, by Gauss-Legendre in the angle that clusters points at the edges."""
    state = bem.ContactState(profile, SOLID, edges, penetration)
    node, weight = np.polynomial.legendre.leggauss(600)
    theta = np.pi / 2 * (node + 1)
    total = 0.0
    for (_, left), (right, _) in pairwise([*edges, edges[0] + profile.period]):
        x = left + (right - left) * (1 - np.cos(theta)) / 2
        gap = state.displacement(x) - (profile.height(x) - profile.max_height + penetration)
        total += float(np.sum(weight * gap * np.sin(theta))) * np.pi / 4 * (right - left)
    return total / profile.period


@pytest.mark.quick
def test_energy_release_rate(rows):
    """Are G - w, its sensitivities and the load the derivatives of the energy by edges and penetration?"""
    profile = bem.Profile.self_affine(period=0.01, hurst=0.7, rms_height=50e-6, harmonics=60, seed=4)
    x = np.linspace(0, profile.period, 4001)
    above = profile.height(x) > np.quantile(profile.height(x), 0.75)  # contact on the highest quarter
    starts, ends = np.flatnonzero(above & ~np.roll(above, 1)), np.flatnonzero(above & ~np.roll(above, -1))
    edges, depth = (
        np.stack([x[starts], x[ends]], axis=1),
        profile.max_height - float(np.quantile(profile.height(x), 0.75)),
    )
    assert starts[0] < ends[0] and starts.size == ends.size == 2

    def state(moved, penetration):
        return bem.ContactState(profile, SOLID, moved, penetration, adhesion=bem.Adhesion(0.03, slope_term=True))

    def derivative(function, step):
        """Return the derivative at zero by differences of fourth order."""
        near, far = (function(k * step) - function(-k * step) for k in (1, 2))
        return (8 * near - far) / (12 * step)

    center, step = state(edges, depth), STEP * float(np.min(np.diff(edges)))
    by_edge = np.array([derivative(lambda by, k=k: energy_and_gradient(
        state(edges + by * (np.arange(4) == k).reshape(2, 2), depth)), step) for k in range(4)])
    by_depth = derivative(lambda by: state(edges, depth + by).energy, 1e-4 * profile.rms_height)
    rounding = "rounding of the energy over the step of the differences"
    identity = rows.between(Code.BEM, Code.IDENTITY, "differences of fourth order", "construction")
    largest = float(np.max(np.abs(center.gradient)))
    identity.compare("dU/d(edge)", center.gradient, by_edge[:, 0], quantity=Quantity.INTENSITY, unit="J/m^2",
                     required=1e-9 * largest, because=rounding)
    identity.compare("d2U/d(edge)d(edge)", center.hessian, by_edge[:, 1:], quantity=Quantity.STIFFNESS, unit="J/m^3",
                     required=1e-8 * float(np.max(np.abs(center.hessian))), because=rounding)
    identity.compare("dU/d(penetration) = load", center.load, by_depth, quantity=Quantity.PRESSURE, unit="N/m",
                     required=1e-9 * center.load, because=rounding)
    identity.compare("mean gap of given patches", mean_gap(edges, depth, profile), profile.max_height - depth,
                     quantity=Quantity.LENGTH, unit="m", required=1e-12 * profile.rms_height,
                     because="Gauss-Legendre converges to rounding")


def energy_and_gradient(state):
    """Return the energy and its derivatives by the edges."""
    return np.array([state.energy, *state.gradient.ravel()])


@pytest.mark.quick
def test_mean_gap_and_dissipation_along_a_path(rows):
    """Is the mean gap the separation at every target, and does no event release negative energy?"""
    result, profile = solved("rough_100"), posed("rough_100").surface()
    assert min(event.energy_released or 0.0 for event in result.events) >= 0
    states = touching(result.targets)
    gaps = [mean_gap(np.array(state.edges), state.penetration, profile) for state in states]
    rows.compare("mean gap", gaps, values(states, "separation"), of=Code.BEM, by=Code.IDENTITY,
                 quantity=Quantity.LENGTH, unit="m", kind="construction", source="separation",
                 required=1e-11 * profile.rms_height, because="Gauss-Legendre converges to rounding")
    rows.count("evaluations", sum(state.evaluations for state in result.states), of=Code.BEM)
    ways = {way: touching(state for state in result.states if state.branch == way) for way in ("loading", "unloading")}
    rows.curves("Adhesion makes loading and unloading of a rough profile differ", "separation / um",
                "mean pressure / kPa", {way: (values(states, "separation") * 1e6, values(states, "mean_pressure") / 1e3)
                                        for way, states in ways.items()})


@pytest.mark.quick
def test_where_the_period_begins(rows):
    """Has a profile the same contacts, loads and events wherever its period begins?

    At a shift of 0.1672 periods two patches merge across the end of the period.
    """
    surface = posed("rough_100", profile={"harmonics": 40}).surface()
    results = []
    for shift in (0.0, 0.1672, 0.86):
        moved = replace(surface, phases=surface.phases - 2 * np.pi * shift * surface.orders)
        waves = {name: getattr(moved, name).tolist() for name in ("orders", "amplitudes", "phases")}
        results.append(solved("rough_100", profile=NOT_SELF_AFFINE | {"kind": "harmonics"} | waves,
                              adhesion={"work_of_adhesion": 0.01},
                              loading={"targets": [60e-6, 45e-6, 60e-6]}))
        assert all(state.certificate.ok for state in results[-1].states)
    first, *others = results
    shifted = rows.between(Code.BEM, Code.IDENTITY, "the profile that begins elsewhere", "construction")
    for name, quantity, unit, required, because in (
        ("contact_fraction", Quantity.AREA, "", 1e-12, "rounding"),
        ("mean_pressure", Quantity.PRESSURE, "Pa", 1e-12 * max(values(first.targets, "mean_pressure")), "rounding"),
        ("n_patches", Quantity.COUNT, "", 0.5, "a count"),
    ):
        shifted.compare(name.replace("_", " ").replace("n patches", "patches"),
                        [values(result.targets, name) for result in others],
                        np.tile(values(first.targets, name), len(others)), quantity=quantity, unit=unit,
                        required=required, because=because)
    met = [[sum(event.kind == kind for event in result.events) for kind in EVENTS] for result in results]
    shifted.compare("events of each kind", met[1:], met[0] * len(others), quantity=Quantity.COUNT, required=0.5,
                    because="a count")
