"""Contact area without adhesion from the rms slope over the contact, for roughness in one direction.

What governs the area is the slope over the contact, g, and not that over the period, h'_rms: over all spectra tried

    A_rough = erf(c sqrt(2) p / (E* g)),    that is A = kappa p / (E* g), kappa = 1.78 at small loads, 1.7 at A = .3,

Persson's law with g in place of h'_rms.  Every line keeps its slope variance in contact; what lowers g is correlation
between lines, the contact sitting where their slopes cancel.  The closure adds it up over pairs of lines, with the
shares w_m = dS_m / S of the slope variance,

    (g / h'_rms)^2 = 1 - [1 - (1 - D) A_rough / (A_rough + A_0)] (1 - A_rough),
    D = D_0 sum_mn w_m w_n sech(ln q_m/q_n)^n,      A_0 = a_0 ln(B) / B,

lines near in wavenumber correlating most, and all the more where contact is too small to see the longest waves (B the
bandwidth of domain.py).  A periodic profile has besides at least one patch, on its highest summit, of the area

    A_one = (2 / pi) asin sqrt(2 q_0 p / (E* k)),     1 - A^4 = (1 - A_one^4) (1 - A_more^4),
    A_more = A_rough (1 - sum w_m^2)^(s (1 - A_rough^4))

with k the curvature there, <k^-1/2>^-2 over random phases, and q_0 the wavenumber of the period.  Limits: one line is
Westergaard exactly; A -> 1; A ~ p for broad continuous spectra as long as A exceeds A_0, then p^2/3; A ~ p^1/2 for a
finite sum of lines at vanishing load, the Hertzian contact of its highest summit.

c, n, D_0, s and a_0 are fitted on boundary-element ensembles (contact_slope.json, with the hold-out that they were
judged on).  Source: here; that the slope over the contact governs the area: J. S. van Dokkum, M. Khajeh Salehani,
N. Irani, L. Nicola, Tribol. Lett. 66 (2018) 115; H. M. Westergaard, J. Appl. Mech. 6 (1939) 49.  SI at the edge.
Limits: half-space, no adhesion, means over phases; `outside` of the answer (domain.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.fft import irfft
from scipy.special import erf

from persson.domain import data_file, groups_of, outside, refuse_extremes
from persson.mathematics.arrays import FloatArray, IntArray
from persson.nonadhesive import dimensionless_load, plane_strain_modulus
from persson.spectrum import DiscreteSpectrum, Spectrum, slope_shares

FILE = "contact_slope.json"
BISECTIONS = 60
PAIRED = 1000  # lines of which all pairs are taken; of more, bands this narrow in ln q:
BAND = 0.01
CARRIES = 1e-6  # share of slope or height from which a line counts for the period
COMMENSURATE = 1e-6  # of q_0
HIGHEST_ORDER = 20000  # beyond, the one patch is a 1e-3 of the area at most
PHASES, POINTS, NEWTON = 64, 16, 4  # realisations, points to the shortest wave, steps to the summit


@dataclass(frozen=True)
class ContactArea:
    """Contact area at one load.

    Attributes
    ----------
    contact_fraction : float
        A/A0.
    rough : float
        A_rough, what the profile would have without the patch on its highest summit.
    slope_over_contact : float
        g of the closure at A_rough.
    outside : tuple of str
        Where the case lies outside of the domain, in words; empty if nowhere.
    """

    contact_fraction: float
    rough: float
    slope_over_contact: float
    outside: tuple[str, ...]


def data() -> dict[str, Any]:
    """Coefficients, domain, and what they were fitted to and judged on."""
    return data_file(FILE)


def contact_area(
    spectrum: Spectrum, mean_pressure: float, *, youngs_modulus: float, poisson_ratio: float
) -> ContactArea:
    """Contact area without adhesion at one load.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
        Lines are those of a periodic profile if their wavenumbers are multiples of one; else of an infinite one.
    mean_pressure : float
        sigma_0 in Pa, > 0.
    youngs_modulus, poisson_ratio : float
        E > 0 in Pa; nu in (-1, 0.5].

    Raises
    ------
    ValueError
        An argument outside its range, with its value.

    Examples
    --------
    >>> lines = DiscreteSpectrum.self_affine(628.3, 0.7, 50e-6, 100)
    >>> found = contact_area(lines, 6667.0, youngs_modulus=1e6, poisson_ratio=0.5)
    >>> round(found.contact_fraction, 3), found.outside
    (0.085, ())
    """
    load = dimensionless_load(mean_pressure, plane_strain_modulus(youngs_modulus, poisson_ratio))
    refuse_extremes(spectrum, load)
    fraction, rough = (float(value[0]) for value in contact_fractions(spectrum, np.array([load])))
    found = groups_of(spectrum, load, fraction)
    smallest = _smallest(found["bandwidth"], data()["coefficients"])
    reduction = _reduction(np.array([rough]), pair_correlation(spectrum), smallest)[0]
    return ContactArea(
        fraction, rough, spectrum.slope_rms * float(np.sqrt(reduction)), outside(data()["domain"], found)
    )


def contact_fractions(
    spectrum: Spectrum, loads: FloatArray, coefficients: Mapping[str, float] | None = None
) -> tuple[FloatArray, FloatArray]:
    """A/A0 and A_rough at loads sigma_0 / E*, (n_loads,) each; by other coefficients if given."""
    value = coefficients or data()["coefficients"]
    pressed = np.asarray(loads, dtype=np.float64) / spectrum.slope_rms
    correlation = pair_correlation(spectrum, value)
    smallest = _smallest(groups_of(spectrum, 1.0, 0.0)["bandwidth"], value)
    low, high = np.zeros_like(pressed), np.ones_like(pressed)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        slope = np.sqrt(_reduction(middle, correlation, smallest))
        above = erf(value["c"] * np.sqrt(2) * pressed / slope) > middle
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    rough = high
    curvature = summit_curvature(spectrum)
    if curvature is None:
        return rough, rough
    one = 2 / np.pi * np.arcsin(np.sqrt(np.minimum(2 * pressed / curvature, 1.0)))
    shares = slope_shares(spectrum)[1]
    several = rough * max(1 - float(shares @ shares), 0.0) ** (value["s"] * (1 - rough**4))
    # 1 - (1 - a)(1 - b), without the difference of numbers near one
    fourth = one**4 + several**4 - (one * several) ** 4
    return np.asarray(fourth**0.25), rough


def pair_correlation(spectrum: Spectrum, coefficients: Mapping[str, float] | None = None) -> float:
    """D, in (0, D_0]: what neighbouring lines take from the slope over a small contact.

    Examples
    --------
    >>> wide = pair_correlation(DiscreteSpectrum([1.0, 1e6], [1e6, 1.0]))
    >>> round(wide / pair_correlation(DiscreteSpectrum([1.0], [1.0])), 12)
    0.5
    """
    value = coefficients or data()["coefficients"]
    return value["D_0"] * _pair_sum(spectrum, value["n"])


@lru_cache(maxsize=16)
def _pair_sum(spectrum: Spectrum, exponent: float) -> float:
    """sum_mn w_m w_n sech(ln q_m/q_n)^exponent."""
    wavenumbers, shares = slope_shares(spectrum)
    position = np.log(wavenumbers)
    if shares.size > PAIRED:
        bands = np.floor((position - position[0]) / BAND).astype(np.int64)
        weight = np.asarray(np.bincount(bands, shares), dtype=np.float64)
        full = weight > 0
        position = np.asarray(np.bincount(bands, shares * position), dtype=np.float64)[full] / weight[full]
        shares = weight[full]
    apart = np.abs(position[:, None] - position[None, :])
    kernel = (2 / (np.exp(-apart) * (1 + np.exp(2 * np.minimum(apart, 300.0))))) ** exponent
    return float(shares @ kernel @ shares)


@lru_cache(maxsize=16)
def summit_curvature(spectrum: Spectrum) -> float | None:
    """k / (q_0 h'_rms) at the highest summit, <k^-1/2>^-2 over random phases; None without a period.

    Examples
    --------
    >>> round(summit_curvature(DiscreteSpectrum([3.0], [0.1])) ** 2, 12)
    2.0
    """
    if not isinstance(spectrum, DiscreteSpectrum):
        return None
    lines = _orders(spectrum)
    if lines is None:
        return None
    orders, heights, _ = lines
    draw = np.random.default_rng(0)
    size = int(2 ** np.ceil(np.log2(POINTS * orders[-1])))
    roots = []
    for _ in range(PHASES):
        modes = heights * np.exp(1j * draw.uniform(-np.pi, np.pi, orders.size))
        padded = np.zeros(size // 2 + 1, dtype=np.complex128)
        padded[orders] = modes
        x = 2 * np.pi * int(np.argmax(irfft(padded, size))) / size
        for _ in range(NEWTON):
            turned = modes * np.exp(1j * orders * x)
            x -= float(np.sum(orders * turned).imag / np.sum(orders**2 * turned).real)
        roots.append(float(np.sum(orders**2 * modes * np.exp(1j * orders * x)).real) ** -0.5)
    return float(np.mean(roots)) ** -2 / float(np.sqrt(np.sum((orders * heights) ** 2) / 2))


def period_wavenumber(spectrum: Spectrum) -> float | None:
    """q_0 in rad/m, of the period of the lines that carry roughness; None without a period.

    Examples
    --------
    >>> period_wavenumber(DiscreteSpectrum([4.0, 6.0], [0.1, 0.1]))
    2.0
    """
    lines = _orders(spectrum) if isinstance(spectrum, DiscreteSpectrum) else None
    return None if lines is None else lines[2]


def _orders(spectrum: DiscreteSpectrum) -> tuple[IntArray, FloatArray, float] | None:
    """Orders and heights of the lines that carry roughness, and the wavenumber of their period, if they have one."""
    slope, height = spectrum.slope_variance_steps, spectrum.amplitudes**2
    carries = (slope > CARRIES * slope.sum()) | (height > CARRIES * height.sum())
    wavenumbers = spectrum.wavenumbers[carries]
    unit = float(wavenumbers[0])
    for wavenumber in wavenumbers[1:]:
        unit = _common(unit, float(wavenumber), COMMENSURATE * float(wavenumbers[0]))
        if wavenumbers[-1] > HIGHEST_ORDER * unit:
            return None
    amplitudes = spectrum.amplitudes[carries]
    return np.rint(wavenumbers / unit).astype(np.int64), amplitudes / amplitudes.max(), unit


def _common(one: float, other: float, least: float) -> float:
    """Greatest common divisor of two wavenumbers, remainders below `least` taken for rounding."""
    while other > least:
        remainder = one % other
        one, other = other, min(remainder, other - remainder)
    return one


def _smallest(bandwidth: float, coefficients: Mapping[str, float]) -> float:
    """A_0."""
    return coefficients["a_0"] * float(np.log(max(bandwidth, 1.0))) / bandwidth


def _reduction(area: FloatArray, correlation: float, smallest: float) -> FloatArray:
    """(g / h'_rms)^2 at A_rough > 0, of the shape of it."""
    kept = (1 - correlation) * area / (area + smallest)
    return np.asarray(kept + area - kept * area)  # 1 - (1 - kept)(1 - area), with all digits at small loads
