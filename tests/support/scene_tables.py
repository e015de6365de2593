"""Tables of scenes: cosines or a self-affine profile, on a half-space or a layer, with or without adhesion."""

PERIOD = 0.01


def waves(orders, amplitudes, phases=None):
    """[profile] of cosines."""
    phases = [0.0] * len(orders) if phases is None else phases
    return {"kind": "harmonics", "period": PERIOD, "orders": orders, "amplitudes": amplitudes, "phases": phases}


def rough(harmonics, seed=0, hurst=0.7, rms_height=5e-5):
    """[profile] of a self-affine one."""
    kind = {"kind": "self_affine", "period": PERIOD, "hurst": hurst, "rms_height": rms_height}
    return kind | {"harmonics": harmonics, "seed": seed}


def tables(profile, control, targets, work=None, *, slope_term=False, thickness=None, nu=0.5, accuracy=None, **loading):
    """A scene of rubber; what is None or empty is left out, further keywords are of [loading]."""
    made = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": nu},
        "profile": profile,
        "loading": {"control": control, "targets": list(targets)}
        | {key: value for key, value in loading.items() if value is not None},
        "adhesion": {"work_of_adhesion": work, "slope_term": slope_term} if work else None,
        "layer": {"thickness": thickness} if thickness else None,
        "accuracy": accuracy,
    }
    return {name: table for name, table in made.items() if table is not None}
