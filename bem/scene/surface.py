"""Profile that a resolved [profile] describes, SI units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from bem.geometry.profile import Profile

if TYPE_CHECKING:
    from bem.scans.periodic_samples import PeriodicSamples


def surface_of(values: Mapping[str, Any], scan: PeriodicSamples | None) -> Profile:
    """Return the profile in SI units of a resolved [profile], given as plain values."""
    kind = values["kind"]
    if kind == "self_affine":
        return Profile.self_affine(
            values["period"], values["hurst"], values["rms_height"], values["harmonics"], values["seed"]
        )
    if kind == "harmonics":
        return Profile.from_harmonics(values["period"], values["orders"], values["amplitudes"], values["phases"])
    if scan is None:
        raise ValueError(
            'profile.kind = "samples": a result has no samples of its file; allowed: the scan beside the values, as '
            "load_scene(path).surface() has it, or the stored harmonics of the result"
        )
    return Profile.from_samples(scan.x, scan.h, values["harmonics"], period=values["period"])
