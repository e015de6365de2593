"""Distribution of the pressure at 0.005 and 0.02 E*: its Gaussian and tensile ends, the double Gaussian, sigma_a.

P(sigma) is per nominal area, the contact's part only; the shares of every realisation are brought to common bins and
averaged.  Stresses in units of E*.

Compressive end: ln P = a - b sigma^k over 1 to 3 standard deviations of full-contact stress, h'_rms/2, k by least
squares; a Gaussian has k = 2.  Tensile end: P |sigma|^3 tends to (2 / pi lambda) sum_e w_e / E*, exactly (JKR edges).
Fit: the paper's double Gaussian with sigma_0 held, sigma_a and G free, over sigma >= 0 (persson/double_gaussian.py);
its sensitivity to the lower end of the window is in the table.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from persson import DoubleGaussian, fit_double_gaussian
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
FIT_FROM = 0.0  # of E*
OTHER_FITS_FROM = (-0.3, -0.05, 0.05)  # of E*
FACTOR = 1.4  # of the paper, on the theory's sigma_a
CAUSE = (
    "the double Gaussian with sigma_0 held does not describe this distribution (residual 15 to 20 % of its peak): "
    "edges resolved to their singularity carry tension far below any barrier, and the number of the fit moves by an "
    "order of magnitude with the lower end of its window"
)


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
        fit = _fitted(centres, mean, load, FIT_FROM)
        rows.append(_gaussian_row(load, centres, values, spread, evidence.shortfall))
        rows.append(_tensile_row(evidence, load))
        rows.append(
            disagreement(
                f"sigma_a of the double Gaussian over the theory's, {load:g} E*",
                fit.detachment_stress / (theory.detachment_stress / MODULUS),
                jackknife(lambda m, p=load: _fitted(centres, m, p, FIT_FROM).detachment_stress, values)[1]  # type: ignore[misc]
                / (theory.detachment_stress / MODULUS),
                FACTOR,
                (0.0, 0.5),
                CAUSE,
                where="section 5: they differ, a factor of about 1.4 on the theory's brings it closer",
                shortfall=evidence.shortfall,
            )
        )
        for start in (FIT_FROM, *OTHER_FITS_FROM):
            other = _fitted(centres, mean, load, start)
            variance = 2 * other.diffusivity * load**2
            lines.append([load, start, other.detachment_stress, variance / spread**2, other.residual,
                          theory.detachment_stress / MODULUS])  # fmt: skip
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
        "of full contact, residual over the largest P.",
        columns=["p/E*", "from sigma/E*", "sigma_a/E*", "variance", "residual", "theory's sigma_a/E*"],
        rows=lines,
    )
    return Outcome(rows=tuple(rows), figures=tuple(figures), tables=(table,))


def _fitted(centres: FloatArray, mean: FloatArray, load: float, start: float) -> DoubleGaussian:
    inside = centres > start
    return fit_double_gaussian(centres[inside], mean[inside], load)


def _gaussian_row(load: float, centres: FloatArray, values: FloatArray, spread: float, short: str) -> Row:
    end = (centres >= COMPRESSIVE_END[0] * spread) & (centres <= COMPRESSIVE_END[1] * spread)
    power, error = jackknife(lambda mean: decay_power(centres[end], mean[end]), values)
    return statement(
        f"power k of ln P = a - b sigma^k at high pressure, {load:g} E*", power, error, 2.0, 0.5, measured=0.25,
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
    load: float, centres: FloatArray, values: FloatArray, fit: DoubleGaussian, said: FloatArray, raised: FloatArray
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
                "standard error, the double Gaussian fitted over sigma >= 0, and the theory.",
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
