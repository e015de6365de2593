"""Rough states and scenes for the tests of the solver."""

import numpy as np

from bem.geometry.patches import ordered
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


def rough_profile(harmonics=60, seed=4, hurst=0.7):
    return Profile.self_affine(0.01, hurst, 50e-6, harmonics, seed)


def rough_scene(targets, harmonics=40, seed=1, adhesion=0.03, control="separation", **changes):
    """A scene with a self-affine profile; keyword arguments replace whole tables."""
    data = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
        "profile": {
            "kind": "self_affine",
            "period": 0.01,
            "hurst": 0.7,
            "rms_height": 50e-6,
            "harmonics": harmonics,
            "seed": seed,
        },
        "loading": {"control": control, "targets": targets},
    }
    if adhesion:
        data["adhesion"] = {"work_of_adhesion": adhesion, "slope_term": True}
    return parse_scene(data | changes)
