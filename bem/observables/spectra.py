"""Spectra of profile, displacement and pressure, from the Chebyshev series of the pressure.

A mode is sigma_m = (1/2 pi) int sigma exp(-i m x) dx (dimensionless, scaling.py), its spectrum C(m) = |sigma_m|^2,
two-sided: the mean square is the sum over m of both signs.  On a patch x = c + r t the integral is a Bessel series,

    sigma_m = 1/2 exp(-i m c) sum_n Q_n (-i)^n J_n(m r),

which is evaluated as the Gauss-Chebyshev sum 1/(2 n) sum_k q(t_k) exp(-i m x_k): n nodes are wrong by terms
Q_j J_{2n-j}(m r) only, which vanish for 2 n > N + m r + O((m r)^(1/3)), so that the square-root edges cost nothing
(Mason and Handscomb, Chebyshev Polynomials, 2003, section 5.4).  With m = a + B b all modes are one matrix product.
The displacement follows from u_m = ratio_m sigma_m / m, ratio: compliance of a layer relative to the half-space.
In SI, C(m q0) = |.|^2 / q0: multiply by height^2 length for profile and displacement, stress^2 length for pressure.

Source of the definitions: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
Limits: modes lose m times the rounding of x, 1e-12 of the largest at m = 4000.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import dct

from bem.audit.displacement import ComplianceRatio
from bem.geometry.arrays import ComplexArray, FloatArray
from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile

LEAST_ORDERS = 128  # format: of stored spectra


@dataclass(frozen=True, eq=False)
class Spectra:
    """Two-sided spectra per line, dimensionless."""

    orders: FloatArray  # m = 1..n_orders; the wavenumber is m q0; (n_orders,)
    profile: FloatArray  # C_h, (n_orders,)
    displacement: FloatArray  # C_u, (n_orders,)
    pressure: FloatArray  # C_sigma, (n_orders,)


def spectral_orders(profile: Profile) -> int:
    """Return the highest order worth storing: twice the order of the profile, and at least 128.

    Beyond twice the order of the profile only the edges of patches show.
    """
    return max(2 * profile.max_order, LEAST_ORDERS)


def spectra(
    profile: Profile,
    pressure: PatchPressure,
    highest: int | None = None,
    compliance_ratio: ComplianceRatio | None = None,
) -> Spectra:
    """Return C_h, C_u and C_sigma of a dimensionless state with patches (none: separated).

    `highest` is the highest order, by default `spectral_orders`; `compliance_ratio` is the compliance of a layer over
    the compliance of the half-space for orders m >= 1, (n,) to (n,).

    Examples
    --------
    Westergaard, half of the period in contact: sigma = 2 cos(x/2) sqrt(1/2 - sin^2(x/2)), modes 1 and 2 are 3/8 and 1/8

    >>> wave = Profile.from_harmonics(2 * np.pi, [1], [1.0])
    >>> theta = (np.arange(24) + 0.5) * np.pi / 24
    >>> x = np.pi / 2 * np.cos(theta)
    >>> q = np.pi * np.cos(x / 2) * np.sqrt(0.5 - np.sin(x / 2) ** 2) * np.sin(theta)
    >>> charge = dct(q, type=2) / 24 * np.where(np.arange(24) == 0, 0.5, 1.0)
    >>> state = PatchPressure(np.array([-np.pi / 2]), np.array([np.pi / 2]), (charge,))
    >>> np.sqrt(spectra(wave, state, 2).pressure).round(12).tolist()
    [0.375, 0.125]
    """
    highest = spectral_orders(profile) if highest is None else highest
    modes = np.abs(pressure_modes(pressure, highest)[1:]) ** 2
    orders = np.arange(1.0, highest + 1)
    return Spectra(
        orders, profile_spectrum(profile, highest), modes * _compliance(orders, compliance_ratio) ** 2, modes
    )


def complete_contact_spectra(
    profile: Profile, highest: int | None = None, compliance_ratio: ComplianceRatio | None = None
) -> Spectra:
    """Return the spectra of complete contact, where u = h: C_u = C_h, C_sigma = (m / ratio_m)^2 C_h."""
    highest = spectral_orders(profile) if highest is None else highest
    orders = np.arange(1.0, highest + 1)
    of_profile = profile_spectrum(profile, highest)
    return Spectra(orders, of_profile, of_profile.copy(), of_profile / _compliance(orders, compliance_ratio) ** 2)


def profile_spectrum(profile: Profile, highest: int) -> FloatArray:
    """Return C_h(m) = h_m^2 / 4 for m = 1..highest, (highest,); orders beyond are left out."""
    spectrum = np.zeros(highest)
    included = profile.orders <= highest
    spectrum[profile.orders[included] - 1] = profile.amplitudes[included] ** 2 / 4
    return spectrum


def pressure_modes(pressure: PatchPressure, highest: int) -> ComplexArray:
    """Return sigma_m = (1/2 pi) int sigma exp(-i m x) dx of a dimensionless pressure, m = 0..highest.

    The shape is (highest + 1,).
    """
    step = int(np.ceil(np.sqrt(highest + 1)))
    total = np.zeros((step, step), dtype=np.complex128)
    for x, charge in _blocks(pressure, highest):
        baby = np.exp(-1j * np.multiply.outer(x, np.arange(step)))
        giant = np.exp(-1j * np.multiply.outer(step * np.arange(step), x)) * charge
        total += giant @ baby
    return np.asarray(total.ravel()[: highest + 1] / (2 * np.pi))


def _blocks(pressure: PatchPressure, highest: int) -> list[tuple[FloatArray, FloatArray]]:
    """Return positions and charges (pi/n) q of nodes that resolve exp(-i m x) on every patch, about 4000 at a time."""
    blocks: list[tuple[FloatArray, FloatArray]] = []
    positions: list[FloatArray] = []
    charges: list[FloatArray] = []
    for left, right, series in zip(pressure.left, pressure.right, pressure.charges, strict=True):
        center, radius = (left + right) / 2, (right - left) / 2
        argument = highest * radius
        n = int(np.ceil((series.size + argument + 12 * np.cbrt(argument) + 20) / 2))
        n = max(n, series.size)
        padded = np.zeros(n)
        padded[: series.size] = series / 2
        padded[0] = series[0]
        positions.append(center + radius * np.cos((np.arange(n) + 0.5) * np.pi / n))
        charges.append(dct(padded, type=3) * (np.pi / n))
        if sum(part.size for part in positions) > 4000:
            blocks.append((np.concatenate(positions), np.concatenate(charges)))
            positions, charges = [], []
    if positions:
        blocks.append((np.concatenate(positions), np.concatenate(charges)))
    return blocks


def _compliance(orders: FloatArray, compliance_ratio: ComplianceRatio | None) -> FloatArray:
    """Return u_m / sigma_m, (n,)."""
    return 1 / orders if compliance_ratio is None else np.asarray(compliance_ratio(orders) / orders)
