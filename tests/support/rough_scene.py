"""A small rough scene that loads, unloads and lets go, for tests of what a result is shown as."""

ROUGH = {
    "title": "rubber on <glass>",
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": 8, "seed": 1},
    "adhesion": {"work_of_adhesion": 0.03},
    "loading": {"control": "separation", "targets": [6e-5, 4e-5, 6e-5, 9e-4]},
    "output": {"shapes": [6e-5, 4e-5], "spectra": True},
}
