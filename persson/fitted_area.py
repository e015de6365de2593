"""Contact area by fitted laws, `contact_area`: an entry beside the plain theory (solve.py), with a domain.

Without adhesion the law is contact_slope.py, with adhesion adhesive_edges.py.  Both give the mean contact fraction over
random phases, of boundary-element ensembles on a half-space; a single profile scatters about the mean, by 10 to 40 %
where less than a tenth of it touches.

Relative errors of the area, rms, on hold-out ensembles that entered no fit (tests/validation/hold_out_dry.csv and
hold_out_wet.csv; the noise is the standard error of the ensemble mean):

    law             loads   contact fraction   error   noise
    dry             162     0.02 to 0.55       3.9 %   2.2 %
    dry, in domain  144     0.02 to 0.55       2.9 %   2.1 %
    wet, in domain   98     0.05 to 0.6        4.9 %   2.9 %

A case is described by numbers without units, weighted by the roughness that they stand for, so that a line without
power changes nothing: rms_slope h'_rms; load_over_slope p / (E* h'_rms); bandwidth (spectrum.py); lines
1 / sum (dS_m / S)^2, the number of lines that carry the slope; theta, the work of adhesion over the elastic energy of
full contact; contact_fraction.  A case outside of its intervals is answered with the status `out_of_domain` and the
reasons.  So is a case in the forbidden box of the dry law, where lines, bandwidth and contact fraction all lie within
`DRY_FORBIDDEN`: the area comes out up to 19 % too small.  The box was drawn after the hold-out had been seen.

SI units.  Limits: a layer, roughness in two directions and unloading are not described.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from persson.adhesive_edges import EdgeLaw
from persson.contact_slope import contact_fractions
from persson.nonadhesive import dimensionless_load, plane_strain_modulus
from persson.spectrum import Spectrum, bandwidth_of, slope_shares

Interval = tuple[float, float]

DRY_DOMAIN: dict[str, Interval] = {
    "rms_slope": (0.0, 0.3),
    "load_over_slope": (0.008, 0.2),
    "bandwidth": (0.0, 210.0),
    "contact_fraction": (0.02, 0.55),
}
WET_DOMAIN: dict[str, Interval] = {
    "rms_slope": (0.0, 0.3),
    "load_over_slope": (0.008, 0.2),
    "bandwidth": (1.2, 60.0),
    "lines": (10.0, np.inf),
    "theta": (0.0, 0.1),
    "contact_fraction": (0.05, 0.6),
}
DRY_FORBIDDEN: dict[str, Interval] = {
    "lines": (4.0, 10.0),
    "bandwidth": (1.9, np.inf),
    "contact_fraction": (0.0, 0.15),
}
ROUNDING = 1e-9  # relative: a case on the bound of an interval lies inside
REPRESENTED = (1e-60, 1e60)  # cubes and squares of these are floating-point numbers


@dataclass(frozen=True)
class FittedArea:
    """Contact area at one load.

    Attributes
    ----------
    contact_fraction : float
        A/A0.
    status : "in_domain" or "out_of_domain"
        The errors of the module hold in the domain; outside of it the area is an extrapolation.
    reasons : tuple of str
        A sentence for each number outside of the domain, with its value and the allowed interval.
    pull_off : float or None
        Least mean pressure in Pa at which there is contact, < 0 where adhesion holds contact in tension; None without
        adhesion.
    """

    contact_fraction: float
    status: Literal["in_domain", "out_of_domain"]
    reasons: tuple[str, ...]
    pull_off: float | None = None


def contact_area(
    spectrum: Spectrum,
    mean_pressure: float,
    *,
    youngs_modulus: float,
    poisson_ratio: float,
    work_of_adhesion: float | None = None,
) -> FittedArea:
    """Return the contact area at one load, by the fitted law without or with adhesion.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
        Lines form a periodic profile if their wavenumbers are multiples of one wavenumber, else an infinite profile.
    mean_pressure : float
        sigma_0 in Pa; > 0 without adhesion, not below the pull-off with adhesion.
    youngs_modulus, poisson_ratio : float
        E > 0 in Pa; nu in (-1, 0.5].
    work_of_adhesion : float, optional
        gamma in J/m^2, > 0; None for no adhesion.

    Raises
    ------
    ValueError
        An argument outside its range, with its value; a tension beyond the pull-off, with both.

    Examples
    --------
    >>> from persson.spectrum import DiscreteSpectrum
    >>> lines = DiscreteSpectrum.self_affine(628.3, 0.7, 50e-6, 100)
    >>> solid = dict(youngs_modulus=1e6, poisson_ratio=0.5)
    >>> dry = contact_area(lines, 6667.0, **solid)
    >>> wet = contact_area(lines, 6667.0, work_of_adhesion=0.03, **solid)
    >>> round(dry.contact_fraction, 3), round(wet.contact_fraction, 3), wet.status
    (0.085, 0.128, 'in_domain')
    """
    modulus = plane_strain_modulus(youngs_modulus, poisson_ratio)
    if work_of_adhesion is None:
        load = dimensionless_load(mean_pressure, modulus)
        _refuse_extremes(spectrum, load, None)
        fraction = float(contact_fractions(spectrum, np.array([load]))[0])
        numbers = numbers_of(spectrum, load, fraction)
        return _answer(fraction, reasons_outside(DRY_DOMAIN, numbers, DRY_FORBIDDEN), None)
    if not np.isfinite(mean_pressure):
        raise ValueError(f"mean_pressure: {mean_pressure} must be finite (Pa)")
    if not (np.isfinite(work_of_adhesion) and work_of_adhesion > 0):
        raise ValueError(
            f"work_of_adhesion: {work_of_adhesion} must be finite and > 0 (J/m^2); leave it out for no adhesion"
        )
    load, work = mean_pressure / modulus, work_of_adhesion / modulus
    _refuse_extremes(spectrum, abs(load) or spectrum.slope_rms, work)
    law = EdgeLaw(spectrum, work)
    fraction = law.at(load)[1]
    reasons = reasons_outside(WET_DOMAIN, numbers_of(spectrum, load, fraction, work))
    return _answer(fraction, reasons, law.pull_off * modulus)


def numbers_of(spectrum: Spectrum, load: float, contact_fraction: float, work_length: float = 0.0) -> dict[str, float]:
    """Return the numbers without units that describe a case, by the names above.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    load : float
        sigma_0 / E*.
    contact_fraction : float
        A/A0.
    work_length : float
        gamma / E* in m; 0 without adhesion.

    Examples
    --------
    >>> from persson.spectrum import DiscreteSpectrum
    >>> round(numbers_of(DiscreteSpectrum([1.0, 4.0], [0.4, 0.1]), 0.01, 0.1)["lines"], 12)
    2.0
    """
    shares = slope_shares(spectrum)[1]
    return {
        "rms_slope": spectrum.slope_rms,
        "load_over_slope": load / spectrum.slope_rms,
        "bandwidth": bandwidth_of(spectrum),
        "lines": float(1 / (shares @ shares)),
        "theta": work_length / spectrum.full_contact_energy,
        "contact_fraction": contact_fraction,
    }


def reasons_outside(
    domain: Mapping[str, Interval], numbers: Mapping[str, float], forbidden: Mapping[str, Interval] | None = None
) -> tuple[str, ...]:
    """Return one reason for each number outside of its interval, and one for a case inside the forbidden box.

    Examples
    --------
    >>> reasons_outside({"theta": (0.0, 0.1)}, {"theta": 0.2})
    ('theta 0.2 is outside 0 to 0.1',)
    """
    reasons = [
        f"{name} {numbers[name]:.3g} is outside {low:g} to {high:g}"
        for name, (low, high) in domain.items()
        if not _within(numbers[name], (low, high))
    ]
    if forbidden and all(_within(numbers[name], interval) for name, interval in forbidden.items()):
        values = ", ".join(f"{name} {numbers[name]:.3g}" for name in forbidden)
        reasons.append(f"{values}: the area comes out up to 19 % too small for few lines far apart at small contact")
    return tuple(reasons)


def _within(value: float, interval: Interval) -> bool:
    return interval[0] * (1 - ROUNDING) <= value <= interval[1] * (1 + ROUNDING)


def _answer(fraction: float, reasons: tuple[str, ...], pull_off: float | None) -> FittedArea:
    return FittedArea(fraction, "out_of_domain" if reasons else "in_domain", reasons, pull_off)


def _refuse_extremes(spectrum: Spectrum, load: float, work_length: float | None) -> None:
    """Raise ValueError, with name and value, for numbers whose squares and cubes overflow or vanish."""
    lowest, highest = REPRESENTED
    numbers = {
        "rms slope of the spectrum": spectrum.slope_rms,
        "rms height of the spectrum (m)": spectrum.h_rms,
        "mean_pressure: sigma_0 / E*": load,
        "mean_pressure: sigma_0 / (E* h'_rms)": load / max(spectrum.slope_rms, lowest),
    }
    if work_length is not None:
        energy = max(spectrum.full_contact_energy, lowest)
        numbers |= {
            "work_of_adhesion: gamma / E* (m)": work_length,
            "work_of_adhesion: gamma / energy of full contact": work_length / energy,
        }
    for name, value in numbers.items():
        if not lowest <= value <= highest:
            raise ValueError(f"{name}: {value:g} must lie in {lowest:g} to {highest:g}")
