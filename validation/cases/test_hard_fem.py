"""Hard cases of the finite elements: thin and nearly incompressible layers, contacts that vanish or nearly close.

Expected is the status of the result, or the argument that an error names.  Numbers are compared with closed forms at
the contact fraction found (waves on a layer of two periods, a half-space to exp(-8 pi) = 1e-11: Westergaard, Johnson),
with the elastic energy of complete contact, sum h_m^2 / (4 c(q_m)) per area, and with boundary elements at the same
edges and penetration.  What U of the contact fraction or of the edges moves the reference by belongs to U.  SI units.
"""

import numpy as np
import pytest

import bem
import fem_reference
from validation.cases.hard_scenes import ADHESIVE, DRY, MODULUS, WAVE, WAVE_WORK, dry_loads
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import layer_compliance
from validation.references.paper_problem import PERIOD

COARSE = fem_reference.Resolution(2, 10, 10)
HALF_SPACE = 1e-10  # relative: a layer of two periods against a half-space
LAYER = {"youngs_modulus": MODULUS, "poisson_ratio": 0.5, "thickness": 2 * PERIOD, "period": PERIOD,
         "harmonics": ([1], [WAVE], [0.0]), "control": "penetration", "work_of_adhesion": 0.0}
EDGES = {"edges": [[-0.05 * PERIOD, 0.08 * PERIOD]]}
LOADED, STICKY = {"control": "mean_pressure"}, {"work_of_adhesion": WAVE_WORK}
ORDERS = np.arange(1, 21)
HEIGHTS = ORDERS**-1.2 * WAVE / np.sqrt(np.sum(ORDERS**-2.4) / 2)
ROUGH = (ORDERS.tolist(), HEIGHTS.tolist(), np.random.default_rng(0).uniform(-3, 3, ORDERS.size).tolist())
UNITS = {"youngs_modulus": MODULUS * 1e6, "thickness": 2e6 * PERIOD, "period": 1e6 * PERIOD,
         "harmonics": ([1], [WAVE * 1e6], [0.0]), "work_of_adhesion": 1e12 * WAVE_WORK}


def depth(fraction):
    """Return the penetration of the adhesive wave at a contact fraction."""
    return float(ADHESIVE.penetration(np.pi / 2 * fraction))


HARD = {  # what differs from LAYER, the reference ("", "wave", "complete", "bem"), status or argument refused
    **{f"nu = {nu:g}": ({"poisson_ratio": nu, "thickness": 0.1 * PERIOD, "value": 1e-6} | EDGES, "bem", "converged")
       for nu in (-0.9, 0.0, 0.499999, 0.5)},
    "thin incompressible layer": ({"thickness": 0.02 * PERIOD, "value": 2e-7} | EDGES, "bem", "converged"),
    "thin incompressible layer in complete contact": (
        {"thickness": 0.02 * PERIOD, "edges": "complete", "value": 1e4} | LOADED, "complete", "complete_contact"),
    "rough thin layer": ({"thickness": 0.05 * PERIOD, "poisson_ratio": 0.45, "value": 4e-6, "harmonics": ROUGH} | EDGES,
                         "bem", "converged"),
    "nearly complete contact": ({"value": dry_loads(0.95)[0]} | LOADED, "wave", "converged"),
    "nearly complete contact with adhesion": ({"value": depth(0.9)} | STICKY, "wave", "converged"),
    "tiny load": ({"value": dry_loads(1e-3)[0]} | LOADED, "wave", "converged"),
    "tension before pull-off": ({"value": depth(0.1)} | STICKY, "wave", "converged"),
    "weak adhesion": ({"value": 2e-5, "work_of_adhesion": 1e-8}, "bem", "converged"),
    "strong adhesion": ({"value": 2e-5, "work_of_adhesion": 100.0}, "bem", "converged"),
    "units a million times smaller": (UNITS | {"value": 1e6 * depth(0.5)}, "wave", "converged"),
    "uncovered crest": ({"harmonics": ([2], [WAVE], [0.0]), "value": 2e-5}, "", "interpenetration"),
    "beyond pull-off": ({"value": -5e-5} | STICKY, "", "value"),
    "apart": ({"value": -1e-6}, "", "value"),
    "narrower than the mesh": ({"edges": [[0.0, 1e-7 * PERIOD]], "value": 1e-6}, "", "edges"),
    "incompressible by displacement": (
        {"edges": "complete", "control": "total_displacement", "value": 1e-6}, "", "control"),
}
QUICK = ("apart", "incompressible by displacement", "narrower than the mesh", "nu = -0.9", "nu = 0.5",
         "thin incompressible layer in complete contact", "thin incompressible layer")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.quick if name in QUICK else pytest.mark.standard) for name in HARD]
)
def test_hard_fem(rows, name):
    """Do finite elements end as expected in a hard case, and are their numbers within the uncertainty they state?"""
    changes, reference, expected = HARD[name]
    arguments = LAYER | changes | {"resolution": COARSE}
    if expected in ("value", "edges", "control"):
        with pytest.raises((fem_reference.InvalidProblemError, fem_reference.SingularSystemError)) as refusal:
            fem_reference.solve(**arguments)
        return unexpected(rows, getattr(refusal.value, "argument", str(refusal.value).split(":")[0]), expected)
    result = fem_reference.solve(**arguments)
    unexpected(rows, result.status, expected)
    if reference:
        {"wave": by_closed_form, "complete": by_complete_contact, "bem": by_boundary_elements}[reference](
            rows, arguments, result
        )
    return None


def unexpected(rows, status, expected):
    """Add the row of a status that is not the expected one."""
    rows.compare(f"status other than {expected}", float(status != expected), 0.0, of=Code.FEM, by=Code.IDENTITY,
                 quantity=Quantity.COUNT, kind="construction", required=0.5, because=f"it is {status}")


def by_closed_form(rows, arguments, result):
    """Add rows of mean pressure and penetration of one wave at the contact fraction found."""
    exact = ADHESIVE if arguments["work_of_adhesion"] else DRY
    length = arguments["period"] / PERIOD  # and of stresses, in the scene of other units
    psi, spread = np.pi / 2 * result.contact_fraction, np.pi / 2 * float(result.uncertainty["contact_fraction"])
    near = np.array([psi - spread, psi, min(psi + spread, np.pi / 2)])
    for name, quantity, unit, scale in (
        ("mean_pressure", Quantity.PRESSURE, "Pa", exact.full_contact_pressure),
        ("penetration", Quantity.LENGTH, "m", WAVE),
    ):
        known = np.array([float(getattr(exact, name)(at)) for at in near]) * length
        theirs = np.ptp(known) + HALF_SPACE * max(scale * length, abs(known[1]))
        rows.compare(name.replace("_", " "), getattr(result, name), known[1], of=Code.FEM, by=Code.EXACT, unit=unit,
                     quantity=quantity, uncertainty=(float(result.uncertainty[name]), theirs),
                     source="Westergaard 1939, Johnson 1995")


def by_complete_contact(rows, arguments, result):
    """Add the row of the elastic energy of complete contact, per period."""
    orders, amplitudes, _ = (np.asarray(series, dtype=float) for series in arguments["harmonics"])
    layer = (arguments[key] for key in ("thickness", "youngs_modulus", "poisson_ratio"))
    energy = np.sum(amplitudes**2 / (4 * layer_compliance(2 * np.pi * orders / PERIOD, *layer))) * PERIOD
    rows.compare("elastic energy", result.elastic_energy, energy, of=Code.FEM, by=Code.EXACT, quantity=Quantity.ENERGY,
                 unit="J/m", uncertainty=(float(result.uncertainty["elastic_energy"]), 1e-12 * energy),
                 source="sum h^2 / (4 c)")


def by_boundary_elements(rows, arguments, result):
    """Add the row of the mean pressure at the edges and penetration found, by boundary elements."""
    profile = bem.Profile.from_harmonics(PERIOD, *arguments["harmonics"])
    solid, layer = bem.Solid(MODULUS, arguments["poisson_ratio"]), bem.Layer(arguments["thickness"])

    def pressure(shift):
        edges = [(float(a) - shift, float(b) + shift) for a, b in result.edges]
        return bem.ContactState(profile, solid, edges, result.penetration, layer, tolerance=1e-12).mean_pressure

    spread = 0.0 if "edges" in arguments else float(np.max(result.uncertainty["edges"]))
    moved = abs(pressure(spread) - pressure(0.0)) if spread else 0.0
    rows.compare("mean pressure at the edges found", result.mean_pressure, pressure(0.0), of=Code.FEM, by=Code.BEM,
                 quantity=Quantity.PRESSURE, unit="Pa", source="elastic state at the same edges",
                 uncertainty=(float(result.uncertainty["mean_pressure"]),
                              moved + 1e-11 * abs(pressure(0.0))))
