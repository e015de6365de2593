"""Slope of the profile over the contact, and how much of it the harmonics take from one another there.

With h = sum_m h_m cos(m x + phi_m), h'_m one term of h', and means <.> over the contact of the share A of the period,

    own_m = <h'_m^2>,   kept_m = <h'_m h'>,   <h'^2> = sum_m kept_m,

kept_m / own_m - 1 being the correlation of harmonic m with all others: zero over the whole period, below zero where the
contact sits where slopes cancel.  The indicator of the contact has the modes
chi_k = sum_e s_e i exp(-i k x_e) / (2 pi k), s_e = 1 at right edges and -1 at left ones, chi_0 = A; with
c_m = (i m h_m / 2) exp(i phi_m), c_-m its conjugate,

    <h'_m h'> = 2 Re[c_m^* (chi * c)_m] / A,   <h'_m^2> = 2 (|c_m|^2 A + Re[c_m^*2 chi_2m]) / A.

Exact for given edges; the convolution runs over 4 M modes (FFT).  Dimensionless (scaling.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, rfft

from bem.geometry.arrays import ComplexArray, FloatArray
from bem.geometry.profile import Profile

BLOCK = 256  # speed: edges at a time


@dataclass(frozen=True, eq=False)
class ContactSlopes:
    """Slope variances over the contact, dimensionless; zeros without contact."""

    orders: FloatArray  # m, ascending, (n_harmonics,)
    own: FloatArray  # <h'_m^2>, (n_harmonics,)
    kept: FloatArray  # <h'_m h'>, (n_harmonics,)

    @property
    def rms(self) -> float:
        """Rms slope over the contact."""
        return float(np.sqrt(max(np.sum(self.kept), 0.0)))


def contact_slopes(profile: Profile, left: FloatArray, right: FloatArray) -> ContactSlopes:
    """Slopes of a dimensionless profile over patches from left to right, (n_patches,) each; none: no contact.

    Examples
    --------
    The crest of one wave, half of the period: <sin^2> = 1/2 - sin(pi) / (2 pi)

    >>> wave = Profile.from_harmonics(2 * np.pi, [1], [1.0])
    >>> round(contact_slopes(wave, np.array([-np.pi / 2]), np.array([np.pi / 2])).rms ** 2, 12)
    0.5
    """
    ascending = np.argsort(profile.orders)
    orders = profile.orders[ascending]
    amplitude = 0.5j * orders * profile.amplitudes[ascending] * np.exp(1j * profile.phases[ascending])
    zero = np.zeros(orders.size)
    if left.size == 0:
        return ContactSlopes(orders.astype(np.float64), zero, zero)
    chi = indicator_modes(left, right, 2 * int(orders[-1]))
    area = float(chi[0].real)
    size = 4 * (int(orders[-1]) + 1)
    slope = np.zeros(size // 2 + 1, dtype=np.complex128)
    slope[orders] = amplitude
    padded = np.zeros(size // 2 + 1, dtype=np.complex128)
    padded[: chi.size] = chi
    product = rfft(irfft(slope, size) * irfft(padded, size)) * size
    kept = 2 * np.real(np.conj(amplitude) * product[orders]) / area
    own = 2 * (np.abs(amplitude) ** 2 + np.real(np.conj(amplitude) ** 2 * chi[2 * orders]) / area)
    return ContactSlopes(orders.astype(np.float64), own, kept)


def complete_contact_slopes(profile: Profile) -> ContactSlopes:
    """The same over the whole period, where harmonics do not correlate."""
    ascending = np.argsort(profile.orders)
    own = (profile.orders * profile.amplitudes)[ascending] ** 2 / 2
    return ContactSlopes(profile.orders[ascending].astype(np.float64), own, own.copy())


def indicator_modes(left: FloatArray, right: FloatArray, highest: int) -> ComplexArray:
    """chi_k = (1/2 pi) int exp(-i k x) dx over the contact, k = 0..highest, (highest + 1,)."""
    edges, signs = np.concatenate([left, right]), np.repeat([-1.0, 1.0], left.size)
    step = int(np.ceil(np.sqrt(highest + 1)))
    total = np.zeros((step, step), dtype=np.complex128)
    for start in range(0, edges.size, BLOCK):
        x, sign = edges[start : start + BLOCK], signs[start : start + BLOCK]
        total += (
            np.exp(-1j * np.multiply.outer(step * np.arange(step), x))
            * sign
            @ np.exp(-1j * np.multiply.outer(x, np.arange(step)))
        )
    modes = total.ravel()[: highest + 1]
    modes[1:] *= 1j / (2 * np.pi * np.arange(1, highest + 1))
    modes[0] = np.sum(right - left) / (2 * np.pi)
    return np.asarray(modes)
