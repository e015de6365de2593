"""Hard cases of Persson's theory: one line and ten thousand, steep and flat spectra, vanishing loads, much adhesion.

Expected is the status of the result, or the argument that an error names.  With adhesion both routes of the diffusion,
finite volumes and an integral equation, each with its own fixed point, agree; adhesion adds area and takes away
separation.  E = 1 MPa, nu = 0.5, period 10 mm, rms height 50 um, H = 0.7.  SI units.
"""

import numpy as np
import pytest

import persson
from validation.plugin.rows import Code, Quantity

MODULUS, WORK, RMS, FIRST = 1e6, 0.03, 50e-6, 2 * np.pi / 0.01
STAR = MODULUS / (1 - 0.5**2)
SOLID = {"youngs_modulus": MODULUS, "poisson_ratio": 0.5}
COMPLETE, NO_LOAD = "complete_contact", "mean_pressure"
HARD = {  # mean pressure over E*; what differs from 125 lines, H = 0.7 and adhesion; status, or argument refused
    "one line": (0.02, {"lines": 1}, "single_line"),
    "one line, dry": (0.02, {"lines": 1, "work": None}, "single_line"),
    "two lines": (0.02, {"lines": 2}, "converged"),
    "ten thousand lines": (0.02, {"lines": 10_000}, "converged"),
    "three decades": (0.02, {"decades": 3, "hurst": 0.8}, "converged"),
    "tiny load": (1e-8, {}, "converged"),
    "tiny load, dry": (1e-12, {"work": None}, "converged"),
    "nearly complete contact": (0.3, {}, "converged"),
    "complete contact": (0.5, {}, COMPLETE),
    "complete contact, dry": (2.0, {"work": None}, COMPLETE),
    "no load": (0.0, {}, NO_LOAD),
    "tension": (-0.01, {}, NO_LOAD),
    "load that is no number": (np.nan, {}, NO_LOAD),
    "much adhesion at a small load": (1e-3, {"work": 10.0}, "branches"),
    "H = 0.01": (0.02, {"hurst": 0.01}, "converged"),
    "H = 0.3": (0.02, {"hurst": 0.3}, "converged"),
    "H = 0.99": (0.02, {"hurst": 0.99}, "converged"),
    "work of adhesion 1e-08": (0.02, {"work": 1e-8}, "converged"),
    "work of adhesion 0.0001": (0.02, {"work": 1e-4}, "converged"),
    "work of adhesion 1": (0.02, {"work": 1.0}, "below_zero"),
    "work of adhesion 100": (0.02, {"work": 1e2}, COMPLETE),
    "rms height 1e-09": (0.02 * 1e-9 / RMS, {"rms": 1e-9}, COMPLETE),
    "rms height 1e-07": (0.02 * 1e-7 / RMS, {"rms": 1e-7}, COMPLETE),
    "rms height 1e-05": (0.02 * 1e-5 / RMS, {"rms": 1e-5}, "below_zero"),
    "rms height 0.001": (0.02 * 1e-3 / RMS, {"rms": 1e-3}, "converged"),
}
STANDARD = (
    "much adhesion at a small load",
    "ten thousand lines",
    "three decades",
    "work of adhesion 1",
    "rms height 1e-05",
    "rms height 1e-07",
    "H = 0.99",
    "H = 0.3",
)


def spectrum_of(hurst=0.7, rms=RMS, lines=125, decades=0, **_):
    """Return the spectrum: so many lines, or continuous over so many decades."""
    if decades:
        return persson.ContinuousSpectrum.self_affine(FIRST, FIRST * 10**decades, hurst, rms)
    return persson.DiscreteSpectrum.self_affine(FIRST, hurst, rms, lines)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.standard if name in STANDARD else pytest.mark.quick) for name in HARD]
)
def test_hard_theory(rows, name):
    """Does the theory end as expected in a hard case, do two routes agree, and does adhesion add area?"""
    load, changes, expected = HARD[name]
    spectrum, pressure, material = spectrum_of(**changes), load * STAR, SOLID | {"work_of_adhesion": WORK}
    if "work" in changes:
        material["work_of_adhesion"] = changes["work"]
    if expected == NO_LOAD:
        with pytest.raises(ValueError, match="mean_pressure") as refusal:
            persson.solve(spectrum, pressure, **material)
        rows.table("Refused", ["message"], [[str(refusal.value)]])
        return unexpected(rows, 0)
    contact = persson.solve(spectrum, pressure, **material)
    unexpected(rows, contact.status != expected)
    dry = persson.solve_nonadhesive(spectrum, pressure, **SOLID)
    if material["work_of_adhesion"] is None:
        return None
    rows.count("nodes", contact.areas.size, within=0.001, of=Code.THEORY)
    other = persson.solve(spectrum, pressure, route="volterra", with_separation=False, **material).contact_fraction
    rows.compare("contact fraction by two routes", contact.contact_fraction, other, of=Code.THEORY, by=Code.IDENTITY,
                 quantity=Quantity.AREA, kind="construction", required=4e-5 * other,
                 because="what the default resolution states of one line", source="the integral equation")
    rows.compare("area that adhesion takes away", min(contact.contact_fraction / dry.contact_fraction, 1.0), 1.0,
                 of=Code.THEORY, by=Code.IDENTITY, quantity=Quantity.AREA, kind="construction", required=4e-5,
                 because="error of the routes")
    if contact.status not in ("branches", "below_zero"):  # statuses that say so
        excess = max(contact.separation - dry.separation, -contact.separation, 0.0) / spectrum.h_rms
        rows.compare("separation above that without adhesion, or negative, over the rms height", excess, 0.0,
                     of=Code.THEORY, by=Code.IDENTITY, quantity=Quantity.LENGTH, kind="construction", required=3e-4,
                     because="error of the separation at the default resolution")
    return None


def unexpected(rows, count):
    """Add the row of a status that is not the expected one."""
    rows.compare("status other than expected", float(count), 0.0, of=Code.THEORY, by=Code.IDENTITY,
                 quantity=Quantity.COUNT, kind="construction", required=0.5,
                 because="stated before the run")
