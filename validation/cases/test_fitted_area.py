"""Fitted laws of the contact area for a single line, beside its closed forms.

One line h cos(q x), stresses over E*: without adhesion A = 2/pi asin sqrt(p / p*), p* = q h / 2 (Westergaard 1939);
with the work of adhesion w E*, p = p* sin^2(pi A / 2) - sqrt(w q / pi tan(pi A / 2)) (Johnson 1995).  Many lines have
the laws and coefficients of persson/contact_slope.py and persson/adhesive_edges.py, which are fits to boundary
elements: how well they fit is asked by tests/validation.  E* = 1 Pa.
"""

import numpy as np
import pytest

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
                  kind="construction", because="closed forms on both sides", source="Westergaard 1939")
    exact.compare("area with adhesion", found, np.tile(areas[1:], 2), quantity=Quantity.AREA, uncertainty=1e-9,
                  source="Johnson 1995; the load is searched in steps of 1e-9")
    exact.compare("pull-off", pulled, turns, quantity=Quantity.PRESSURE, unit="Pa", uncertainty=1e-5 * np.abs(turns),
                  source="Johnson 1995; the law takes its least load from a grid of 0.8 %: the square of half a step")
