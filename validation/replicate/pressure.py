"""Distribution of the pressure at 0.005 and 0.02 E*: its Gaussian and tensile ends, the double Gaussian, sigma_a.

P(sigma) is per nominal area, the contact's part only; the shares of every realisation are brought to common bins and
averaged.  Stresses in units of E*.

Compressive end: ln P = a - b sigma^k over 1 to 3 standard deviations of full-contact stress, h'_rms/2, k by least
squares; a Gaussian has k = 2.  Tensile end: P |sigma|^3 tends to (2 / pi lambda) sum_e w_e / E*, exactly (JKR edges).
Fit: the paper's double Gaussian with sigma_0 held and sigma_a and G free (persson/double_gaussian.py), times a free
amplitude, over -0.3 to 0.7 E*: the theory has half the area, and with the amplitude held at 1 the shape is missed by 15
to 20 % of the peak.  The formula vanishes at -sigma_a / 2, which is what is compared with the theory's sigma_a, where
its distribution ends.  Other windows, and the amplitude held, are in the table.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, minimize_scalar

from persson import double_gaussian, fit_double_gaussian
from validation.case import Outcome
from validation.replicate.evidence import Evidence, Realisation, jackknife, mean_and_error, theory_with_adhesion
from validation.replicate.members import MODULUS, SPECTRA_AT
from validation.replicate.statements import disagreement, statement
from validation.schema import Figure, Panel, Reference, Row, Series, Table, Tolerance

FloatArray = NDArray[np.float64]

BOUNDS = np.linspace(-0.3, 0.7, 51)  # of E*
TAIL_BOUNDS = -np.geomspace(30.0, 0.05, 41)  # of E*
TENSILE_END = (-6.0, -2.0)  # of E*
COMPRESSIVE_END = (1.0, 3.0)  # of h'_rms / 2
FITTED = (-0.3, -0.1, 0.0)  # lower ends of the window of the fit, of E*; the first is that of the rows
FACTOR = 1.4  # of the paper, on the theory's sigma_a
STARTS = (0.5, 1.5, 3.0)  # of sigma_a, in units of h'_rms / 2
CAUSE = (
    "both find tension beyond the theory's sigma_a; how much depends on the fit: the paper's formula ends at "
    "-sigma_a / 2 and is fitted here with its amplitude free, which describes the distribution to 3 % of its peak"
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


def fitted(sigma: FloatArray, values: FloatArray, load: float, spread: float) -> Fit:
    """Least squares over the points given, the best of several starts.

    Examples
    --------
    >>> sigma = np.linspace(-0.3, 0.7, 51)
    >>> found = fitted(sigma, Fit(0.02, 0.2, 0.018, 0.4, 0.0)(sigma), 0.02, 0.136)
    >>> [round(value, 6) for value in (found.end, found.variance, found.amplitude)]
    [0.1, 0.018, 0.4]
    """
    peak = float(values.max())

    def made(parameters: FloatArray, residual: float = 0.0) -> Fit:
        stress, variance, amplitude = np.exp(parameters) * (spread, spread**2, 1.0)
        return Fit(load, float(stress), float(variance), float(amplitude), residual)

    def misfit(parameters: FloatArray) -> FloatArray:
        return (made(parameters)(sigma) - values) / peak

    found = [least_squares(misfit, np.log([start, 1.0, 0.3]), xtol=1e-12, ftol=1e-12, gtol=1e-12) for start in STARTS]
    best = min(found, key=lambda one: float(one.cost))
    if not best.success:
        raise ArithmeticError(f"double Gaussian: {best.message}")
    return made(best.x, float(np.sqrt(np.mean(best.fun**2))))


def density(one: Realisation, load: float, bounds: FloatArray) -> FloatArray:
    """Mean of P E* over bins of sigma/E*, (n_bins,), from the exact shares of the solver's own bins."""
    own = one.field("sigma_bounds", load) / MODULUS
    shares = np.concatenate([[0.0], np.cumsum(one.field("P", load) * np.diff(own) * MODULUS)])
    return np.asarray(np.diff(np.interp(bounds, own, shares)) / np.diff(bounds))


def decay_power(sigma: FloatArray, values: FloatArray) -> float:
    """k of ln P = a - b sigma^k by least squares; bins without weight are left out.

    Examples
    --------
    >>> sigma = np.linspace(1.0, 3.0, 20)
    >>> round(decay_power(sigma, np.exp(1 - 0.5 * sigma**2)), 4)
    2.0
    """
    kept = values > 0
    x, y = sigma[kept] / sigma[kept][-1], np.log(values[kept])

    def misfit(power: float) -> float:
        basis = np.column_stack([np.ones_like(x), x**power])
        return float(np.sum((y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0]) ** 2))

    return float(minimize_scalar(misfit, bounds=(0.2, 8.0), method="bounded", options={"xatol": 1e-6}).x)


def compute(evidence: Evidence) -> Outcome:
    """Rows, figures and table."""
    rows: list[Row] = []
    lines: list[list[str | float | int | None]] = []
    figures: list[Figure] = []
    centres = (BOUNDS[1:] + BOUNDS[:-1]) / 2
    spread = evidence.lines.slope_rms / 2
    closer = 0
    for load in SPECTRA_AT:
        values = np.array([density(one, load, BOUNDS) for one in evidence.with_fields_at(load)])
        mean, _ = mean_and_error(values)
        theory = evidence.with_adhesion[load]
        raised = theory_with_adhesion(evidence.loading[0], load, 1 / FACTOR**2)
        said, said_raised = (found.pressure_distribution(centres * MODULUS) * MODULUS for found in (theory, raised))
        closer += int(np.sum(np.abs(mean - said_raised)) < np.sum(np.abs(mean - said)))
        fit = fitted(centres, mean, load, spread)
        rows.append(_gaussian_row(load, centres, values, spread, evidence.shortfall))
        rows.append(_tensile_row(evidence, load))
        rows.append(
            disagreement(
                f"tension where the fitted double Gaussian ends over the theory's sigma_a, {load:g} E*",
                fit.end / (theory.detachment_stress / MODULUS),
                jackknife(lambda m, p=load: fitted(centres, m, p, spread).end, values)[1]  # type: ignore[misc]
                / (theory.detachment_stress / MODULUS),
                FACTOR,
                (1.1, 1.7),
                CAUSE,
                where="section 5: they differ, a factor of about 1.4 on the theory's brings it closer",
                shortfall=evidence.shortfall,
            )
        )
        sigma_a = theory.detachment_stress / MODULUS
        for start in FITTED:
            inside = centres > start
            one = fitted(centres[inside], mean[inside], load, spread)
            lines.append(
                [load, start, one.amplitude, one.end, one.end / sigma_a, one.variance / spread**2, one.residual]
            )
        held = fit_double_gaussian(centres, mean, load)
        variance = 2 * held.diffusivity * load**2 / spread**2
        end = held.detachment_stress / 2
        lines.append([load, FITTED[0], "held at 1", end, end / sigma_a, variance, held.residual])
        figures += _figures(load, centres, values, fit, said, said_raised)
    rows.append(
        statement(
            f"loads of {len(SPECTRA_AT)} at which the theory's P(sigma) comes closer with {FACTOR:g} sigma_a",
            float(closer), 0.0, float(len(SPECTRA_AT)), 0.5, measured=0.0,
            where="section 5: a factor of about 1.4 brings the theory closer", shortfall=evidence.shortfall,
        )
    )  # fmt: skip
    figures.append(_tail_figure(evidence))
    table = Table(
        caption="Double Gaussian fitted to the mean P(sigma) from different lower ends to 0.7 E*; variance over that "
        "of full contact, rms residual over the largest P.",
        columns=["p/E*", "from sigma/E*", "amplitude", "ends at -sigma/E*", "over the theory's sigma_a",
                 "variance", "residual"],
        rows=lines,
    )  # fmt: skip
    return Outcome(rows=tuple(rows), figures=tuple(figures), tables=(table,))


def _gaussian_row(load: float, centres: FloatArray, values: FloatArray, spread: float, short: str) -> Row:
    end = (centres >= COMPRESSIVE_END[0] * spread) & (centres <= COMPRESSIVE_END[1] * spread)
    power, error = jackknife(lambda mean: decay_power(centres[end], mean[end]), values)
    return statement(
        f"power k of ln P = a - b sigma^k at high pressure, {load:g} E*", power, error, 2.0, 0.6, measured=0.34,
        where="section 5: Gaussian tail at high pressure", shortfall=short,
    )  # fmt: skip


def _tensile_row(evidence: Evidence, load: float) -> Row:
    """P |sigma|^3 over its limit, mean over the end and the realisations: exact, a check of ours."""
    centres = -np.sqrt(TAIL_BOUNDS[1:] * TAIL_BOUNDS[:-1])
    inside = (centres >= TENSILE_END[0]) & (centres <= TENSILE_END[1])
    ratios = []
    for one in evidence.with_fields_at(load):
        limit = float(one.field("tail_coefficient", load)) / MODULUS**2
        exact = limit * (TAIL_BOUNDS[1:] ** -2 - TAIL_BOUNDS[:-1] ** -2) / 2 / np.diff(TAIL_BOUNDS)
        ratios.append([float(np.mean((density(one, load, TAIL_BOUNDS) / exact)[inside]))])
    ratio, error = mean_and_error(ratios)
    return Row(
        quantity=f"tensile tail P |sigma|^3 over its limit, -6 to -2 E*, at {load:g} E*",
        unit="",
        reference=Reference(kind="exact", source="JKR edges: P -> (2 E*/(pi lambda)) sum w_e |sigma|^-3"),
        norm="absolute",
        expected=[1.0],
        computed=[float(ratio[0])],
        uncertainty=float(error[0]),
        tolerance=Tolerance(value=0.01, measured=0.0035),
    )


def _figures(
    load: float, centres: FloatArray, values: FloatArray, fit: Fit, said: FloatArray, raised: FloatArray
) -> list[Figure]:
    """The distribution, linear and logarithmic."""
    mean, error = mean_and_error(values)
    found = []
    for name, scale in (("linear", "linear"), ("logarithmic", "log")):
        least = 1e-4 * float(mean.max()) if scale == "log" else -np.inf

        def shown(y: FloatArray, least: float = least) -> list[float | None]:
            return [float(value) if value > least else None for value in y]

        x: list[float | None] = [float(value) for value in centres]
        lower: list[float | None] = [
            float(v) if v > least else (least if np.isfinite(least) else 0.0) for v in mean - error
        ]
        upper = [max(float(v), float(w)) for v, w in zip(mean + error, [one or 0.0 for one in lower], strict=True)]
        found.append(
            Figure(
                id=f"pressure-distribution-{load:g}-{name}",
                caption=f"Distribution of the pressure at {load:g} E*, {name}: mean over the realisations with its "
                "standard error, the double Gaussian fitted to it, and the theory.",
                solution=Panel(
                    xlabel="σ / E*",
                    ylabel="P E*",
                    yscale="log" if scale == "log" else "linear",
                    series=[
                        Series(label="mean and standard error", x=x, y=lower, upper=list(upper), style="band"),
                        Series(label="double Gaussian, fitted", x=x, y=shown(fit(centres))),
                        Series(label="Persson with adhesion", x=x, y=shown(said), style="dashed"),
                        Series(label=f"the same with {FACTOR:g} σ_a", x=x, y=shown(raised), style="dashed"),
                        Series(label="mean", x=x, y=shown(mean), style="points"),
                    ],
                ),
            )
        )
    return found


def _tail_figure(evidence: Evidence) -> Figure:
    centres = np.sqrt(TAIL_BOUNDS[1:] * TAIL_BOUNDS[:-1])
    series = []
    for load in SPECTRA_AT:
        there = evidence.with_fields_at(load)
        mean = np.mean([density(one, load, TAIL_BOUNDS) for one in there], axis=0)
        limit = float(np.mean([one.field("tail_coefficient", load) for one in there])) / MODULUS**2
        x = centres.tolist()
        series.append(Series(label=f"mean, {load:g} E*", x=x, y=mean.tolist(), style="points"))
        series.append(Series(label=f"limit from the edges, {load:g} E*", x=x, y=(limit * centres**-3.0).tolist()))
    return Figure(
        id="tensile-tail",
        caption="Tensile tail of the distribution: P falls as the third power, with the factor that the edges give.",
        solution=Panel(xlabel="-σ / E*", ylabel="P E*", xscale="log", yscale="log", series=series),
    )
