"""Rough states and scenes for the tests of the solver."""

import numpy as np
from scene_tables import rough, tables, waves

from bem.geometry.patches import Patches, ordered
from bem.geometry.profile import Profile
from bem.scene.scene import parse_scene


def bearing_cut(profile, share):
    """Patches where the profile is highest, covering about `share` of the period, and a matching penetration."""
    x, height = profile.grid
    level = np.quantile(height, 1 - share)
    above = height > level
    start, stop = np.flatnonzero(above & ~np.roll(above, 1)), np.flatnonzero(above & ~np.roll(above, -1))
    if stop[0] < start[0]:
        stop = np.roll(stop, -1)
    half = 0.25 * profile.period / x.size
    left, right = x[start] - half, x[stop] + half
    return ordered(left, np.where(right < left, right + profile.period, right)), profile.max_height - level


def short_waved(seed=0, first=60, last=250):
    """Only short waves, so that a cut has many patches."""
    m = np.arange(first, last + 1)
    phases = np.random.default_rng(seed).uniform(-np.pi, np.pi, m.size)
    return Profile.from_harmonics(2 * np.pi, m, m**-1.2, phases).scaled()


def cut_edges(profile, share):
    """Edges of the parts of the profile above a level (any patches test an evaluation), and the penetration there."""
    x, height = profile.grid
    level = float(np.quantile(height, 1 - share))
    above = height > level
    left = x[np.flatnonzero(above & ~np.roll(above, 1))] - x[1] / 2
    right = x[np.flatnonzero(above & ~np.roll(above, -1))] + x[1] / 2
    right = right if right[0] > left[0] else np.append(right[1:], right[0] + 2 * np.pi)
    return left, right, profile.max_height - level


def cut(profile, share):
    """The patches of `cut_edges`, and the penetration."""
    left, right, penetration = cut_edges(profile, share)
    return Patches(left, right), penetration


def rough_profile(harmonics=60, seed=4, hurst=0.7):
    return Profile.self_affine(0.01, hurst, 50e-6, harmonics, seed)


def rough_scene(targets, harmonics=40, seed=1, adhesion=0.03, control="separation", slope_term=True, **changes):
    """A scene with a self-affine profile; keyword arguments replace whole tables."""
    return parse_scene(tables(rough(harmonics, seed), control, targets, adhesion, slope_term=slope_term) | changes)


def banded_scene(targets, **changes):
    """A scene with short waves only, so that contact has many patches: 120 to 140 at separations about 2.4e-6 m."""
    orders = np.arange(100, 200)
    amplitudes = orders**-1.2
    phases = np.random.default_rng(0).uniform(-np.pi, np.pi, orders.size)
    amplitudes = amplitudes * 3e-6 / np.sqrt(np.sum(amplitudes**2) / 2)
    profile = waves(orders.tolist(), amplitudes.tolist(), phases.tolist())
    return parse_scene(tables(profile, "separation", targets, 3e-3, accuracy={"tolerance": 1e-2}) | changes)
