"""Persson's theory at the loads of a run, with and without the correction, from what its result alone holds.

The theory is that of a half-space under compression.  The corrected one is drawn within its calibration alone.  With
adhesion separations take a ladder of loads, and are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import persson
from bem.geometry.profile import Profile
from bem.scene.result import Result
from persson import DiscreteSpectrum
from persson import corrected as corrected_theory

SELF_AFFINE = ("period", "hurst", "rms_height", "harmonics", "seed")
HARMONICS = ("period", "orders", "amplitudes", "phases")
MANY, FEW = 40, 8  # loads, where one takes no time and where it takes some
LEAST, MOST = 0.003, 0.6  # contact fractions of the theory among which the corrected one is tried
SPAN = 50.0  # largest load drawn over the smallest


Solved = persson.NonadhesiveContact | persson.AdhesiveContact | corrected_theory.CorrectedContact


@dataclass(frozen=True)
class Theory:
    """A curve: loads in Pa, contact fractions, and separations in m where they are known."""

    label: str
    loads: list[float]
    fractions: list[float]
    separations: list[float]


def spectrum_of(result: Result) -> DiscreteSpectrum | None:
    """The lines of the profile of a result; None of a scan whose result does not hold them."""
    profile = result.scene["profile"]
    if profile["kind"] != "samples":
        if profile["kind"] == "self_affine":
            surface = Profile.self_affine(**{name: profile[name] for name in SELF_AFFINE})
        else:
            surface = Profile.from_harmonics(**{name: profile[name] for name in HARMONICS})
        return DiscreteSpectrum.of_profile(surface)
    if "profile_q" not in result.fields:
        return None
    return DiscreteSpectrum(result.fields["profile_q"], result.fields["profile_amplitude"])


def theories_of(result: Result) -> list[Theory]:
    """The theory and the corrected one; none on a layer, without compression, or of two flat surfaces."""
    most = max((state.mean_pressure for state in result.states if state.mean_pressure > 0), default=0.0)
    if result.scene["layer"] is not None or most == 0 or not result.groups.get("rms_slope"):
        return []
    spectrum = spectrum_of(result)
    if spectrum is None:
        return []
    solid, adhesion = result.scene["solid"], result.scene["adhesion"]
    given = {name: solid[name] for name in ("youngs_modulus", "poisson_ratio")}
    if adhesion is not None:
        given["work_of_adhesion"] = adhesion["work_of_adhesion"]
    adhesive = adhesion is not None
    loads = np.geomspace(most / SPAN, most, FEW if adhesive else MANY).tolist()
    plain = [persson.solve(spectrum, load, with_separation=not adhesive, **given) for load in loads]
    found = [_curve("Persson's theory", loads, plain)]
    partial = [load for load, state in zip(loads, plain, strict=True) if LEAST < state.contact_fraction < MOST]
    chosen = partial[:: -(-len(partial) // FEW) or 1]
    corrected = [corrected_theory.solve(spectrum, load, **given, with_separation=not adhesive) for load in chosen]
    inside = [k for k, state in enumerate(corrected) if not state.outside_calibration]
    if len(inside) > 1:
        found.append(_curve("the corrected theory", [chosen[k] for k in inside], [corrected[k] for k in inside]))
    return found


def _curve(label: str, loads: list[float], states: Sequence[Solved]) -> Theory:
    """States as a curve."""
    separations = [state.separation for state in states]
    known = [value for value in separations if value is not None]
    return Theory(
        label, loads, [state.contact_fraction for state in states], known if len(known) == len(states) else []
    )
