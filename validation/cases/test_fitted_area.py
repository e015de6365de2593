"""Fitted laws of the contact area: closed forms of one line, and the printed laws solved a second time for many.

One line h cos(q x), stresses over E*: without adhesion A = 2/pi asin sqrt(p / p*), p* = q h / 2 (Westergaard 1939);
with the work of adhesion w E*, p = p* sin^2(pi A / 2) - sqrt(w q / pi tan(pi A / 2)) (Johnson 1995).  Many lines have
the laws and coefficients of persson/contact_slope.py and persson/adhesive_edges.py, which are fits to boundary
elements: how well they fit is asked by tests/validation.  E* = 1 Pa.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import erf, erfinv

import persson
from validation.plugin.rows import Code, Quantity

MATERIAL = {"youngs_modulus": 0.75, "poisson_ratio": 0.5}
Q, H = 7.0, 0.02


@pytest.mark.quick
def test_one_line(rows):
    """Is the law of one line Westergaard's without adhesion, and Johnson's with it, at any load and at the pull-off?"""
    line, crest, areas, works = persson.DiscreteSpectrum([Q], [H]), Q * H / 2, np.array([0.05, 0.3, 0.7]), (1e-6, 1e-5)
    loads = crest * np.sin(np.pi * areas / 2) ** 2
    dry = [persson.contact_area(line, load, **MATERIAL).contact_fraction for load in loads]
    found, turns, pulled = [], [], []
    for work in works:
        down = loads - np.sqrt(work * Q / np.pi * np.tan(np.pi * areas / 2))
        laws = [persson.contact_area(line, load, work_of_adhesion=work, **MATERIAL) for load in down[1:]]
        found += [law.contact_fraction for law in laws]
        pulled.append(laws[0].pull_off)
        x = np.linspace(1e-4, 0.5, 100_001)
        turns.append(np.min(crest * np.sin(np.pi * x / 2) ** 2 - np.sqrt(work * Q / np.pi * np.tan(np.pi * x / 2))))
    exact = rows.between(Code.THEORY, Code.EXACT)
    exact.compare("area without adhesion", dry, areas, quantity=Quantity.AREA, uncertainty=1e-15, required=1e-13,
                  because="closed forms on both sides", source="Westergaard 1939")
    exact.compare("area with adhesion", found, np.tile(areas[1:], 2), quantity=Quantity.AREA, uncertainty=1e-9,
                  required=1e-8, because="the load is searched in steps of 1e-9", source="Johnson 1995")
    exact.compare("pull-off", pulled, turns, quantity=Quantity.PRESSURE, unit="Pa", uncertainty=1e-6 * np.abs(turns),
                  required=1e-5 * np.abs(turns), because="the least load on a grid", source="Johnson 1995")


def printed(orders, waves, load, work=None):
    """Return A of the printed laws at a load, for a period of 2 pi."""
    steps = (orders * waves) ** 2 / 2
    slope, w = np.sqrt(np.sum(steps)), steps / np.sum(steps)
    band = np.exp(np.log(orders) @ (w - w / orders**2 / np.sum(w / orders**2)))
    lacks, least = 0.894 * w @ np.cosh(np.log(orders[:, None] / orders)) ** -3.463 @ w, 0.093 * np.log(band) / band
    phase, alone = np.random.default_rng(0).uniform(-np.pi, np.pi, (64, orders.size)), 1 - w @ w
    x = np.linspace(0, 2 * np.pi, 1001)
    x = x[np.argmax([np.cos(np.outer(x, orders) + p) @ waves for p in phase], axis=1)]
    for _ in range(6):  # Newton's rule to the highest summit of each realisation
        at = orders * x[:, None] + phase
        x = x - np.sin(at) @ (orders * waves) / (np.cos(at) @ (orders**2 * waves))
    curvature = np.mean((np.cos(orders * x[:, None] + phase) @ (orders**2 * waves)) ** -0.5) ** -2

    def area(p):
        def missing(a):
            gradient = np.sqrt(1 - (1 - (1 - lacks) * a / (a + least)) * (1 - a))
            return erf(1.117 * np.sqrt(2) * p / (slope * gradient)) - a

        rough = brentq(missing, 1e-9, 1 - 1e-15, xtol=1e-16)
        single = 2 / np.pi * np.arcsin(np.sqrt(2 * p / curvature))
        return (1 - (1 - single**4) * (1 - (rough * alone ** (0.196 * (1 - rough**4))) ** 4)) ** 0.25

    def carried(p):
        a, resolved = area(p), np.cumsum(steps)
        lost = -np.diff(np.log(erf(erfinv(a) * np.sqrt(resolved[-1] / resolved))), prepend=0.0)
        rough = 1.907 * alone * 2 * a / np.pi * (orders @ lost)
        tension = np.sqrt(work * (rough + 1 / np.pi) * np.tan(np.pi * a / 2))
        return p - 1 / (1 / tension + 0.764 * rough / (rough + 1 / np.pi) / p)

    return area(load) if work is None else area(brentq(lambda p: carried(p) - load, load, 10 * load, xtol=1e-16))


@pytest.mark.quick
def test_many_lines(rows):
    """Does the program solve the laws that are printed, without adhesion and with it?"""
    lines, load = persson.DiscreteSpectrum.self_affine(1.0, 0.7, 0.05, 12), 0.01
    works = (None, 0.02 * lines.full_contact_energy)
    law = [persson.contact_area(lines, load, work_of_adhesion=work, **MATERIAL).contact_fraction for work in works]
    rows.compare("area of many lines, dry and with adhesion", law,
                 [printed(np.arange(1.0, 13), lines.amplitudes, load, work) for work in works], of=Code.THEORY,
                 by=Code.IDENTITY, quantity=Quantity.AREA, kind="construction", required=1e-7,
                 because="the load is searched in steps", source="the printed laws")
