"""The double Gaussian fitted to P(sigma), and why its sigma_a is not the theory's: window, weights, amplitude.

The paper's double Gaussian with sigma_0 held and sigma_a and G free (persson/double_gaussian.py), times a free
amplitude, over -0.3 to 0.7 E*: the theory has half the area, and with the amplitude held at 1 the shape is missed by
20 % of the peak.  The formula vanishes at -sigma_a / 2; this end is what is compared with the theory's sigma_a, where
its distribution ends.

No distribution of a JKR contact ends at a finite tension: it falls as |sigma|^-3.  The end of the fit is therefore no
property of the contact alone.  It is shown against the lower end of the window, for equal weights of P and of ln P,
with the amplitude held, and for the theory's own distribution fitted alike, which ends at 0.7 of its own sigma_a.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5.  Stresses over E*.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import least_squares

from persson import double_gaussian, fit_double_gaussian
from validation.harness.arrays import FloatArray
from validation.harness.drawings import axes, drawn, shaded, trace
from validation.harness.schema import Figure, Row, Series, Table
from validation.replicate.evidence import jackknife
from validation.replicate.members import SPECTRA_AT
from validation.replicate.statements import disagreement, statement

FACTOR = 1.4  # of the paper, on the theory's sigma_a
STARTS = (0.5, 1.5, 3.0)  # of sigma_a, in units of h'_rms / 2
WINDOWS = (-0.3, -0.1, -0.08, -0.06, -0.04, -0.02, 0.0, 0.02)  # lower ends; the first is that of the rows
SHOWN = (-0.3, -0.1, 0.0)  # in the table
LEAST = 1e-3  # of the peak: what is fitted with equal weights of ln P
NARROW = -0.1  # lower end from which ln P is fitted: beyond, the formula is zero
CAUSE = (
    "a contact with JKR edges has no largest tension, so that the end of the fit depends on its window and weights: at "
    "0.02 E* from 1.5 with compression alone, which is the paper's 1.4, to 1.9 with the tail, and at 0.005 E* from 1.8 "
    "to 2.2 (figure and table); the paper does not state its window"
)


@dataclass(frozen=True)
class Fit:
    """A double Gaussian times an amplitude; stresses in units of E*, residual rms over the largest P."""

    load: float
    detachment_stress: float
    variance: float
    amplitude: float
    residual: float

    @property
    def end(self) -> float:
        """Tension at which the formula vanishes."""
        return self.detachment_stress / 2

    def __call__(self, sigma: FloatArray) -> FloatArray:
        """P E* at sigma/E*."""
        diffusivity = self.variance / (2 * self.load**2)
        return self.amplitude * double_gaussian(sigma, self.load, self.detachment_stress, diffusivity)


def fitted(sigma: FloatArray, values: FloatArray, load: float, spread: float, logarithmic: bool = False) -> Fit:
    """Least squares of P, or of ln P, over the points given, the best of several starts.

    Examples
    --------
    >>> sigma = np.linspace(-0.3, 0.7, 51)
    >>> found = fitted(sigma, Fit(0.02, 0.2, 0.018, 0.4, 0.0)(sigma), 0.02, 0.136)
    >>> [round(value, 6) for value in (found.end, found.variance, found.amplitude)]
    [0.1, 0.018, 0.4]
    """
    peak = float(values.max())
    kept = values > LEAST * peak if logarithmic else np.ones(values.size, dtype=bool)

    def made(parameters: FloatArray, residual: float = 0.0) -> Fit:
        stress, variance, amplitude = np.exp(parameters) * (spread, spread**2, 1.0)
        return Fit(load, float(stress), float(variance), float(amplitude), residual)

    def misfit(parameters: FloatArray) -> FloatArray:
        found = made(parameters)(sigma[kept])
        if logarithmic:
            return np.asarray(np.log(np.maximum(found, 1e-8 * peak)) - np.log(values[kept]))
        return np.asarray((found - values[kept]) / peak)

    found = [least_squares(misfit, np.log([start, 1.0, 0.3]), xtol=1e-12, ftol=1e-12, gtol=1e-12) for start in STARTS]
    best = min(found, key=lambda one: float(one.cost))
    if not best.success:
        raise ArithmeticError(f"double Gaussian: {best.message}")
    return made(best.x, float(np.sqrt(np.mean(((made(best.x)(sigma) - values) / peak) ** 2))))


@dataclass(frozen=True, eq=False)
class Sample:
    """P E* of every realisation in bins, with what the theory says of its end; stresses in units of E*.

    Parameters
    ----------
    load : float
    centres : (n_bins,) array
    values : (n_realisations, n_bins) array
    detachment_stress : float
        The theory's sigma_a.
    spread : float
        Standard deviation of the stress in full contact.
    """

    load: float
    centres: FloatArray
    values: FloatArray
    detachment_stress: float
    spread: float

    @cached_property
    def mean(self) -> FloatArray:
        """Over the realisations."""
        return np.asarray(self.values.mean(axis=0))

    @cached_property
    def fit(self) -> Fit:
        """Of the mean, over the whole window."""
        return self.over(WINDOWS[0])

    def over(self, start: float, values: FloatArray | None = None, logarithmic: bool = False) -> Fit:
        """Of these values, or of the mean, from `start` on."""
        inside = self.centres > start
        chosen = self.mean if values is None else values
        return fitted(self.centres[inside], chosen[inside], self.load, self.spread, logarithmic)

    def end(self, start: float, logarithmic: bool = False) -> tuple[float, float]:
        """End of the fit over the theory's sigma_a, and its standard error."""
        return jackknife(lambda mean: self.over(start, mean, logarithmic).end / self.detachment_stress, self.values)

    def rows(self, short: str) -> list[Row]:
        """Of the whole window, and at the higher load, where it is known to 10 %, of compression alone."""
        said = f"tension where the fitted double Gaussian ends over the theory's sigma_a, {self.load:g} E*"
        where = "section 5: they differ, a factor of about 1.4 on the theory's brings it closer"
        whole, error = self.end(WINDOWS[0])
        rows = [
            disagreement(f"{said}, fitted over -0.3 to 0.7 E*", whole, error, FACTOR, (1.1, 1.7), CAUSE, where=where,
                         shortfall=short),
        ]  # fmt: skip
        if self.load == SPECTRA_AT[-1]:
            pressed, error = self.end(0.0)
            rows.append(
                statement(f"{said}, fitted over compression alone", pressed, error, FACTOR, 0.3, measured=0.07,
                          where=where, same_ensemble=True, shortfall=short),
            )  # fmt: skip
        return rows


def window_figure(samples: Sequence[Sample]) -> Figure:
    """End of the fit against the lower end of its window."""
    series: list[Series] = []
    for hue, sample in enumerate(samples):
        ends = [sample.end(start) for start in WINDOWS]
        x = list(WINDOWS)
        inner = [start for start in WINDOWS if start >= NARROW]
        series += [
            shaded(f"{sample.load:g} E*, standard error", x, [v - e for v, e in ends], [v + e for v, e in ends], hue),
            trace(f"{sample.load:g} E*, equal weights of P", x, [v for v, _ in ends], hue=hue),
            trace(f"{sample.load:g} E*, equal weights of ln P", inner,
                  [sample.over(start, logarithmic=True).end / sample.detachment_stress for start in inner], "dashed",
                  hue=hue),
        ]  # fmt: skip
    across: list[float | None] = [WINDOWS[0], WINDOWS[-1]]
    series.append(trace("the paper's factor", across, [FACTOR, FACTOR], "dashed", hue=5))
    return drawn(
        "double-gaussian-window",
        "Why sigma_a is a number of the fit: the tension at which the double Gaussian ends, over the theory's "
        "sigma_a, against the stress from which it is fitted, to 0.7 E*.",
        axes(r"fitted from $\sigma/E^*$", r"end of the fit / $\sigma_a$", *series),
    )


def window_table(samples: Sequence[Sample], theories: Sequence[FloatArray]) -> Table:
    """Fits of the mean, and of the theory's own distribution."""
    lines: list[list[str | float | int | None]] = []
    for sample, said in zip(samples, theories, strict=True):

        def line(what: str, start: float, fit: Fit, one: Sample = sample) -> list[str | float | int | None]:
            variance = fit.variance / one.spread**2
            ratio = fit.end / one.detachment_stress
            return [one.load, what, start, fit.amplitude, fit.end, ratio, variance, fit.residual]

        lines += [line("mean, weights of P", start, sample.over(start)) for start in SHOWN]
        lines += [
            line("mean, weights of ln P", start, sample.over(start, logarithmic=True))
            for start in SHOWN
            if start >= NARROW
        ]
        held = fit_double_gaussian(sample.centres, sample.mean, sample.load)
        variance = 2 * held.diffusivity * sample.load**2
        lines.append(
            line(
                "mean, amplitude held at 1",
                WINDOWS[0],
                Fit(sample.load, held.detachment_stress, variance, 1.0, held.residual),
            )
        )
        lines.append(line("Persson's own P, weights of P", WINDOWS[0], sample.over(WINDOWS[0], said)))
    return Table(
        caption="Double Gaussian fitted from different lower ends to 0.7 E*; variance over that of full contact, rms "
        "residual of P over the largest P.",
        columns=["p/E*", "what is fitted", "from sigma/E*", "amplitude", "ends at -sigma/E*",
                 "over the theory's sigma_a", "variance", "residual"],
        rows=lines
    )  # fmt: skip
