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
    """Pressure, least load and energies of complete contact, dimensionless.

    Attributes
    ----------
    pressure : Profile
        Zero-mean part of the pressure, as harmonics.
    least_load : float
        Load per period below which the pressure is tensile somewhere.
    elastic_energy, adhesion_energy : float
        Per period, without the mean compression.
    left_out : float
        Largest change of the elastic energy by elastic effects that are left out.
    """

    pressure: Profile
    least_load: float
    elastic_energy: float
    adhesion_energy: float
    left_out: float = 0.0


def complete_contact(
    profile: Profile, law: InterfaceLaw | None = None, compliance: Compliance | None = None
) -> CompleteContact:
    """Return complete contact of a profile in closed form.

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
    """Return the position near `near` at which a gap closes, as the last one under adhesion.

    The tension of the gap grows without bound as the gap narrows, so that the gap moves to where least work of adhesion
    closes it.  If the work of adhesion is equal everywhere, the gap moves to the lowest pressure of complete contact.
    """
    wave = profile if np.any(law.work_and_gradient(profile.grid[0])[1]) else complete.pressure
    places = wave.valleys[0]
    return float(places[np.argmin(np.abs((places - near + np.pi) % (2 * np.pi) - np.pi))])


def _stiffening(profile: Profile, kernel: KernelSeries) -> float:
    """Return the change of the elastic energy of complete contact by an effect, modes added by absolute value."""
    stiffer = np.abs(1 / kernel.ratio(profile.orders.astype(np.float64)) - 1)
    return float(np.pi / 2 * np.sum(profile.orders * profile.amplitudes**2 * stiffer))
