"""Scenes of extreme values: each key of the contract at the ends of its range, in the middle, and beyond."""

import numpy as np

from bem.scene.scene import SceneError, parse_scene

MAGNITUDES = [1e-300, 1e-61, 1e-60, 1e-20, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e13, 1e60, 1e61, 1e300]
USUAL = {"youngs_modulus": 1e6, "period": 0.01, "height": 1e-4, "work": 0.03, "thickness": 0.002}
CONTROLS = ["separation", "penetration", "mean_pressure", "total_displacement"]
SHARES = [-1e9, -3.0, -0.1, 0.0, 1e-9, 1e-3, 0.3, 0.7, 1.0, 1.5, 4.0, 1e9]  # of what the control is measured in


def extreme_scene(random):
    """A scene as a dict: two magnitudes at most are extreme, so that not every scene is refused."""
    value = dict(USUAL)
    for name in random.choice(list(USUAL), size=random.integers(0, 3), replace=False):
        value[name] = float(random.choice(MAGNITUDES)) * (USUAL[name] if random.random() < 0.5 else 1.0)
    control = str(random.choice(CONTROLS))
    pressed = control == "mean_pressure"
    unit = value["youngs_modulus"] * value["height"] / value["period"] if pressed else value["height"]
    targets = [float(share * unit) for share in random.choice(SHARES, size=random.integers(1, 4))]
    if control == "separation":
        targets = [abs(target) for target in targets]
    orders = [[1], [3], [1, 2], [1, 4, 9]][random.integers(4)]
    loading = {"control": control, "targets": targets}
    if random.random() < 0.2:
        share = float(random.choice([1e-13, 1e-12, 1e-7, 1e-3, 0.3, 0.95, 0.99]))
        loading |= {"initial": "complete_contact", "flaw": share * value["period"]}
    data = {
        "solid": {
            "youngs_modulus": value["youngs_modulus"],
            "poisson_ratio": float(random.choice([-1, -0.999, 0, 0.3, 0.4999999, 0.5])),
        },
        "profile": {
            "kind": "harmonics",
            "period": value["period"],
            "orders": orders,
            "amplitudes": [value["height"] / order for order in orders],
            "phases": random.choice([0.0, 1.0, 3.0], size=len(orders)).tolist(),
        },
        "loading": loading,
        "accuracy": {
            "tolerance": float(random.choice([1e-13, 1e-12, 1e-6, 1e-2])) if random.random() < 0.3 else 1e-6,
            "max_increment": float(random.choice([1e-9, 1.0, 100.0, 1e3])) if random.random() < 0.3 else 5.0,
        },
    }
    if random.random() < 0.6:
        data["adhesion"] = {"work_of_adhesion": value["work"], "slope_term": bool(random.random() < 0.5)}
    if control == "total_displacement" or random.random() < 0.2:
        data["layer"] = {"thickness": value["thickness"]}
    return data


def parsed(data):
    """The scene, or None where it is refused."""
    try:
        return parse_scene(data)
    except SceneError:
        return None


def extreme_scenes(count, seed):
    random = np.random.default_rng(seed)
    return [extreme_scene(random) for _ in range(count)]
