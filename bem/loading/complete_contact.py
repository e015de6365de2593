"""Complete contact: the closed form, for any profile, thickness and Poisson ratio.

The displacement is the profile, so every mode carries sigma_m = m h_m / ratio_m (dimensionless; ratio: compliance
relative to the half-space) on top of any mean pressure, and the separation is zero.  Without adhesion it
needs p >= 0 everywhere; under the JKR model it is metastable at any load, because a crack of zero length needs
infinite tension to open.  Source: Johnson, Int. J. Solids Struct. 32 (1995) 423.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.interface_law import InterfaceLaw

if TYPE_CHECKING:
    from bem.elastic.compliance import Compliance
    from bem.elastic.kernel_series import KernelSeries


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
        What elastic effects that are left out would change of the elastic energy, at most.
    """

    pressure: Profile
    least_load: float
    elastic_energy: float
    adhesion_energy: float
    left_out: float = 0.0


def complete_contact(
    profile: Profile, law: InterfaceLaw | None = None, compliance: Compliance | None = None
) -> CompleteContact:
    """The closed form for a profile.

    Parameters
    ----------
    profile : Profile
        Dimensionless.
    law : InterfaceLaw, optional
        None without adhesion.
    compliance : Compliance, optional
        None for a half-space.
    """
    kernel, left_out = (None, None) if compliance is None else (compliance.kernel, compliance.left_out)
    ratio = np.ones(profile.orders.size) if kernel is None else kernel.ratio(profile.orders.astype(np.float64))
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
    wave = profile if np.any(law.work_and_gradient(profile.grid[0])[1]) else complete.pressure
    places = wave.valleys[0]
    return float(places[np.argmin(np.abs((places - near + np.pi) % (2 * np.pi) - np.pi))])


def _stiffening(profile: Profile, kernel: KernelSeries) -> float:
    """What an effect changes of the elastic energy of complete contact, no mode against another."""
    stiffer = np.abs(1 / kernel.ratio(profile.orders.astype(np.float64)) - 1)
    return float(np.pi / 2 * np.sum(profile.orders * profile.amplitudes**2 * stiffer))
