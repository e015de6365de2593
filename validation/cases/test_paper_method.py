"""Boundary elements audited by the paper's own method: other cells, another iteration, another minimisation.

Graded cells of uniform pressure on the patches, Gauss-Seidel for the pressure, conjugate gradients of Polak and
Ribiere on the edges (references/paper_method).  Its second-order error is taken away by extrapolation, (4 fine -
coarse) / 3; U is the change of the extrapolation by one level, from three grids that are each half as fine as the
next.  On the rough path the method starts from first touch and makes its own contacts.  On the state with many patches
it starts from edges moved at random by up to a twentieth of the patch or gap beside them.  Finite elements cannot
reach either of these two.
"""

import numpy as np
import pytest

from validation.plugin.rows import Code, Quantity
from validation.references.paper_method import Surface, follow, solve
from validation.routes.scenes import edge_scale, posed, problem_of, solved

ACCURATE = {"tolerance": 1e-8}
RESIDUAL, PATH_RESIDUAL, GAP = 1e-7, 1e-5, 1e-3
STEPS = 30  # of penetration on the rough path
METHOD = "the paper's method: graded cells, Gauss-Seidel, Polak-Ribiere; extrapolated"
LAYER = {"solid": {"poisson_ratio": 0.45}, "layer": {"thickness": 0.002},
         "profile": {"orders": [1, 2], "amplitudes": [2e-5, 6e-5], "phases": [0.3, 0.0]},
         "adhesion": {"work_of_adhesion": 0.05, "slope_term": False}, "loading": {"targets": [5e-5]}}
ROUGH = {"profile": {"harmonics": 60}, "loading": {"control": "penetration", "targets": [5.8e-5]}}
MANY = {"profile": {"harmonics": 300}, "loading": {"targets": [25e-6]}}


def surface_of(name, tables):
    """Return the surface as the paper's method takes it: raw numbers."""
    problem = problem_of(posed(name, **tables), "the paper's method", "layer", "adhesion")
    return Surface(problem.youngs_modulus, problem.poisson_ratio, problem.period, problem.orders, problem.amplitudes,
                   problem.phases, problem.work_of_adhesion or 0.0, problem.slope_term, problem.thickness)


def limit(coarse, middle, fine):
    """Return the extrapolation of three grids and its uncertainty."""
    last, before = (4 * np.asarray(fine) - middle) / 3, (4 * np.asarray(middle) - coarse) / 3
    return last, np.abs(last - before)


def listed(edges, period):
    """Return edges (n, 2) with every left one in [0, period), in order."""
    edges = np.asarray(edges)
    shifted = edges - np.floor(edges[:, :1] / period) * period
    return shifted[np.argsort(shifted[:, 0])]


def audit(rows, state, surface, edges, cells):
    """Compare a state with grids of so many cells per patch, the first from given edges, each next from those found."""
    states = []
    for count in cells:
        states.append(solve(surface, state.penetration, edges, count, RESIDUAL, GAP))
        assert states[-1].status == "converged", states[-1].message
        edges = states[-1].edges
    own, period = state.error_estimate, surface.period
    both = rows.between(Code.BEM, Code.PAPER, METHOD)
    both.compare("patches on every grid", [state.n_patches] * len(states), [len(each.edges) for each in states],
                 quantity=Quantity.COUNT, uncertainty=(0.0, 0.0), required=0.5, because="a count")
    for name, quantity, unit, per in (("contact_fraction", Quantity.AREA, "", 1.0),
                                      ("mean_pressure", Quantity.PRESSURE, "Pa", 1.0),
                                      ("elastic_energy", Quantity.ENERGY, "J/m^2", period)):
        value, spread = limit(*(getattr(each, name) / per for each in states))
        both.compare(name.replace("_", " "), getattr(state, name), value, quantity=quantity, unit=unit,
                     uncertainty=(getattr(own, name), spread))
    value, spread = limit(*(listed(each.edges, period) for each in states))
    both.compare("edges", listed(state.edges, period), value, quantity=Quantity.EDGES, unit="m",
                 uncertainty=(own.contact_fraction * period, float(spread.max())))
    sizes = [each.unknowns for each in states]
    rows.curves("Contact fraction of the paper's method less that of boundary elements", "cells", "difference",
                {"paper's method": (sizes, [abs(each.contact_fraction - state.contact_fraction) for each in states]),
                 "second order": (sizes, [abs(states[-1].contact_fraction - state.contact_fraction)
                                          * (sizes[-1] / n) ** 2 for n in sizes])}, log="xy")


@pytest.mark.quick
def test_two_contacts_on_a_layer(rows):
    """Does the paper's method find the same two contacts on a layer?"""
    state = solved("layer_two_crests", **LAYER, accuracy=ACCURATE).targets[-1]
    audit(rows, state, surface_of("layer_two_crests", LAYER), [[0.004, 0.006], [0.009, 0.011]], (16, 32, 64))


@pytest.mark.standard
def test_path_on_a_rough_profile(rows):
    """Does the paper's method, from first touch through all events, end in the same state of 60 harmonics?"""
    state, surface = solved("rough_100", **ROUGH, accuracy=ACCURATE).targets[-1], surface_of("rough_100", ROUGH)
    path = follow(surface, np.linspace(0.0, state.penetration, STEPS + 1)[1:], 6, PATH_RESIDUAL, GAP)
    assert path[-1].status == "converged", path[-1].message
    audit(rows, state, surface, path[-1].edges, (6, 12, 24))


@pytest.mark.full
def test_many_contacts(rows):
    """Is a state of dozens of contacts, its edges moved at random, found again by the paper's method?"""
    state, surface = solved("rough_100", **MANY, accuracy=ACCURATE).targets[-1], surface_of("rough_100", MANY)
    edges = np.array(state.edges)
    moved = 0.05 * edge_scale(edges, surface.period) * np.random.default_rng(0).uniform(-1, 1, edges.shape)
    audit(rows, state, surface, edges + moved, (4, 8, 16))
