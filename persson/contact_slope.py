"""Fitted contact area without adhesion, from the rms slope over the contact; roughness in one direction.

The rms slope g over the contact governs the area, not the rms slope h'_rms over the period.  For all spectra tried

    A_rough = erf(c sqrt(2) p / (E* g)),    that is A = kappa p / (E* g), kappa = 1.78 at small loads, 1.7 at A = .3,

Persson's law with g in place of h'_rms.  Every line keeps its slope variance in contact; correlation between lines
lowers g, because contact sits where their slopes cancel.  The closure sums over pairs of lines, with the shares
w_m = dS_m / S of the slope variance:

    (g / h'_rms)^2 = 1 - [1 - (1 - D) A_rough / (A_rough + A_0)] (1 - A_rough),
    D = D_0 sum_mn w_m w_n sech(ln q_m/q_n)^n,      A_0 = a_0 ln(B) / B.

Lines of similar wavenumber correlate most, and more strongly where contact is too small to resolve the longest waves
(B is `bandwidth_of`, spectrum.py).  A periodic profile also has at least one patch, on its highest summit, of the area

    A_one = (2 / pi) asin sqrt(2 q_0 p / (E* k)),     1 - A^4 = (1 - A_one^4) (1 - A_more^4),
    A_more = A_rough (1 - sum w_m^2)^(s (1 - A_rough^4))

with k the curvature there, <k^-1/2>^-2 over random phases, and q_0 the wavenumber of the period.  Limits: one line is
Westergaard exactly; A -> 1; A ~ p for broad continuous spectra as long as A exceeds A_0, then p^2/3; A ~ p^1/2 for a
finite sum of lines at vanishing load, the Hertzian contact of its highest summit.

c, n, D_0, s and a_0 are fitted on boundary-element ensembles by validation/fits/areas.py (41 spectra, 2274
realisations, seed roots 1 and 2; domain and hold-out errors: fitted_area.py).  Source: here; that the slope over the
contact governs the area: J. S. van Dokkum, M. Khajeh Salehani, N. Irani, L. Nicola, Tribol. Lett. 66 (2018) 115;
H. M. Westergaard, J. Appl. Mech. 6 (1939) A49.  Stresses in units of E*.  Limits: half-space, no adhesion, means over
phases.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from scipy.fft import irfft
from scipy.special import erf

from persson.mathematics.arrays import FloatArray, IntArray
from persson.spectrum import DiscreteSpectrum, Spectrum, bandwidth_of, slope_shares

COEFFICIENTS = {"c": 1.117, "n": 3.463, "D_0": 0.894, "s": 0.196, "a_0": 0.093}
BISECTIONS = 60
PAIRED = 1000  # lines of which all pairs are taken; of more, bands this narrow in ln q:
BAND = 0.01
CARRIES = 1e-6  # share of slope or height from which a line counts for the period
COMMENSURATE = 1e-6  # of q_0
HIGHEST_ORDER = 20000  # beyond, the one patch is a 1e-3 of the area at most
PHASES, POINTS, NEWTON = 64, 16, 4  # realisations, points to the shortest wave, steps to the summit


def contact_fractions(
    spectrum: Spectrum, loads: FloatArray, coefficients: Mapping[str, float] = COEFFICIENTS
) -> FloatArray:
    """Return A/A0 without adhesion at loads sigma_0 / E*, (n_loads,) each.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
        Lines form a periodic profile if their wavenumbers are multiples of one wavenumber, else an infinite profile.
    loads : (n_loads,) array
        sigma_0 / E* > 0.
    coefficients : mapping, optional
        Other values of c, n, D_0, s and a_0, for the fit.

    Examples
    --------
    >>> lines = DiscreteSpectrum.self_affine(628.3, 0.7, 50e-6, 100)
    >>> contact_fractions(lines, np.array([0.005])).round(3)
    array([0.085])
    """
    value = coefficients
    pressed = np.asarray(loads, dtype=np.float64) / spectrum.slope_rms
    correlation = pair_correlation(spectrum, value)
    bandwidth = bandwidth_of(spectrum)
    smallest = value["a_0"] * float(np.log(max(bandwidth, 1.0))) / bandwidth
    low, high = np.zeros_like(pressed), np.ones_like(pressed)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        slope = np.sqrt(_reduction(middle, correlation, smallest))
        above = erf(value["c"] * np.sqrt(2) * pressed / slope) > middle
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    rough = high
    curvature = summit_curvature(spectrum)
    if curvature is None:
        return rough
    single = 2 / np.pi * np.arcsin(np.sqrt(np.minimum(2 * pressed / curvature, 1.0)))
    shares = slope_shares(spectrum)[1]
    several = rough * max(1 - float(shares @ shares), 0.0) ** (value["s"] * (1 - rough**4))
    # 1 - (1 - a)(1 - b), without the difference of numbers near one
    fourth = single**4 + several**4 - (single * several) ** 4
    return np.asarray(fourth**0.25)


def pair_correlation(spectrum: Spectrum, coefficients: Mapping[str, float] = COEFFICIENTS) -> float:
    """Return D, in (0, D_0]: the share of the slope variance that a small contact lacks, by correlated lines.

    Examples
    --------
    >>> wide = pair_correlation(DiscreteSpectrum([1.0, 1e6], [1e6, 1.0]))
    >>> round(wide / pair_correlation(DiscreteSpectrum([1.0], [1.0])), 12)
    0.5
    """
    return coefficients["D_0"] * _pair_sum(spectrum, coefficients["n"])


@lru_cache(maxsize=16)
def _pair_sum(spectrum: Spectrum, exponent: float) -> float:
    """Return sum_mn w_m w_n sech(ln q_m/q_n)^exponent."""
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
    """Return k / (q_0 h'_rms) at the highest summit, <k^-1/2>^-2 over random phases; None without a period.

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
    """Return q_0 in rad/m, of the period of the lines that carry roughness; None without a period.

    Examples
    --------
    >>> period_wavenumber(DiscreteSpectrum([4.0, 6.0], [0.1, 0.1]))
    2.0
    """
    lines = _orders(spectrum) if isinstance(spectrum, DiscreteSpectrum) else None
    return None if lines is None else lines[2]


def _orders(spectrum: DiscreteSpectrum) -> tuple[IntArray, FloatArray, float] | None:
    """Return orders, heights and period wavenumber of the lines that carry roughness; None without a common period."""
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


def _common(first: float, second: float, least: float) -> float:
    """Return the greatest common divisor of two wavenumbers, taking remainders below `least` for rounding."""
    while second > least:
        remainder = first % second
        first, second = second, min(remainder, second - remainder)
    return first


def _reduction(area: FloatArray, correlation: float, smallest: float) -> FloatArray:
    """Return (g / h'_rms)^2 at contact fractions A_rough > 0, same shape."""
    factor = (1 - correlation) * area / (area + smallest)
    return np.asarray(factor + area - factor * area)  # 1 - (1 - factor)(1 - area), with all digits at small loads
