"""Complete contact: the closed form, for any profile, thickness and Poisson ratio.

The displacement is the profile, so every mode carries sigma_m = m h_m / ratio_m (dimensionless; ratio: compliance of
the layer relative to the half-space) on top of any mean pressure, and the separation is zero.  Without adhesion it
needs p >= 0 everywhere; under the JKR model it is metastable at any load, because a crack of zero length needs
infinite tension to open.  Source: Johnson, Int. J. Solids Struct. 32 (1995) 423.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.interface_law import InterfaceLaw

FloatArray = NDArray[np.float64]
ComplianceRatio = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class CompleteContact:
    """What complete contact costs and needs, dimensionless.

    Attributes
    ----------
    pressure : Profile
        Zero-mean part of the pressure, as harmonics.
    least_load : float
        Load per period below which the pressure is tensile somewhere.
    elastic_energy, adhesion_energy : float
        Per period, without the mean compression.
    left_out : float
        What a layer that is left out would add to the elastic energy.
    """

    pressure: Profile
    least_load: float
    elastic_energy: float
    adhesion_energy: float
    left_out: float = 0.0


def complete_contact(
    profile: Profile,
    law: InterfaceLaw | None = None,
    compliance_ratio: ComplianceRatio | None = None,
    left_out: ComplianceRatio | None = None,
) -> CompleteContact:
    """The closed form for a profile.

    Parameters
    ----------
    profile : Profile
        Dimensionless.
    law : InterfaceLaw, optional
        None without adhesion.
    compliance_ratio : callable, optional
        Compliance of the modes m >= 1 relative to the half-space, (n,) to (n,); None for a half-space.
    left_out : callable, optional
        The same of a layer that is left out of the equations.
    """
    ratio = np.ones(profile.orders.size)
    if compliance_ratio is not None:
        ratio = compliance_ratio(profile.orders.astype(np.float64))
    amplitude = profile.orders * profile.amplitudes / ratio
    pressure = Profile(profile.period, profile.orders, amplitude, profile.phases)
    lowest = Profile(profile.period, profile.orders, amplitude, profile.phases + np.pi).max_height
    whole = Patches(np.zeros(1), np.full(1, 2 * np.pi))
    return CompleteContact(
        pressure,
        2 * np.pi * lowest,
        float(np.pi / 2 * np.sum(amplitude * profile.amplitudes)),
        0.0 if law is None else law.energy(whole),
        left_out=0.0 if left_out is None else _stiffening(profile, left_out),
    )


def closing_place(complete: CompleteContact, profile: Profile, law: InterfaceLaw, near: float) -> float:
    """Where a gap near this position closes, as the last one under adhesion.

    Its tension grows without bound as it narrows, so that it moves to where least work of adhesion closes it; where
    that is the same everywhere, to where the pressure of complete contact is lowest.
    """
    wave = profile if np.any(law.work_gradient(profile.grid[0])) else complete.pressure
    places = Profile(wave.period, wave.orders, wave.amplitudes, wave.phases + np.pi).crests[0]
    return float(places[np.argmin(np.abs((places - near + np.pi) % (2 * np.pi) - np.pi))])


def _stiffening(profile: Profile, compliance_ratio: ComplianceRatio) -> float:
    """Elastic energy of complete contact on a layer of this compliance, less that on a half-space."""
    stiffer = 1 / compliance_ratio(profile.orders.astype(np.float64)) - 1
    return float(np.pi / 2 * np.sum(profile.orders * profile.amplitudes**2 * stiffer))
