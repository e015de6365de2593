"""Windows of a contact of many patches: each feels the patches outside as in the solution of all patches.

Waves of the orders 60 to 250, amplitudes falling as order^-1.2; the patches are the parts of the profile above a level,
no equilibrium.  A window holds neighbouring patches and knows the others by their far field (bem/elastic/far_field.py).
Dimensionless, as in bem: period 2 pi.
"""

from dataclasses import replace

import numpy as np
import pytest

from bem.elastic.collocation import Elastic, evaluate
from bem.elastic.far_field import far_fields
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.windows.spread import charges_moved_in, charges_of
from bem.windows.windows import windows_of
from validation.plugin.rows import Code, Quantity

ORDERS, TOLERANCE = np.arange(60, 251), 1e-8


def cut(profile, level):
    """Return the parts of a profile above a level, those merged that lie near one another."""
    x, height = profile.grid
    above = height > level
    left = x[above & ~np.roll(above, 1)]
    right = x[above & ~np.roll(above, -1)] + 0.3 * x[1]
    right = right if right[0] > left[0] else np.append(right[1:], right[0] + 2 * np.pi)
    patches = Patches(left - 0.3 * x[1], right)
    return patches.merged_at(patches.gap_after < 0.3 * np.median(patches.gap_after))


@pytest.mark.quick
def test_edges(rows):
    """Are the stress intensities of every window, and their rates, those of the solution of all patches?"""
    phases = np.random.default_rng(0).uniform(-np.pi, np.pi, ORDERS.size)
    profile = Profile.from_harmonics(2 * np.pi, ORDERS, ORDERS**-1.2, phases).scaled()
    level = float(np.quantile(profile.grid[1], 0.7))
    elastic, patches, penetration = Elastic(profile), cut(profile, level), profile.max_height - level
    state = evaluate(elastic, patches, penetration, TOLERANCE)
    windows = windows_of(patches)
    fields = far_fields([window.arc for window in windows], charges_of(state), charges_moved_in(state))
    for deeper in (0.0, 0.01):
        errors, rates = [], []
        for window, far in zip(windows, fields, strict=True):
            alone = evaluate(replace(elastic, far=far), window.of(patches), penetration + deeper, TOLERANCE)
            whole = window.edges(state.shifted(deeper).stress_intensity)
            errors.append(float(np.max(np.abs(alone.stress_intensity - whole)) / np.max(np.abs(whole))))
            rate = window.edges(state.stress_intensity_rate)
            rates.append(float(np.max(np.abs(alone.stress_intensity_rate / rate - 1))))
        for name, error in (("stress intensities", errors), ("their rates by the penetration", rates)):
            rows.compare(f"{name}, {deeper:g} rms heights deeper", error, 0.0, of=Code.BEM, by=Code.IDENTITY,
                         quantity=Quantity.INTENSITY, required=30 * TOLERANCE, because="tolerance of the evaluations",
                         kind="construction")
