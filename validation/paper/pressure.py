"""Distribution of the pressure at 0.005 and 0.02 E*: its Gaussian and tensile ends, the double Gaussian, sigma_a.

P(sigma) is per nominal area, the contact's part only; the shares of every realisation are brought to common bins and
averaged.  Stresses in units of E*.

Compressive end: ln P = a - b sigma^k over 1 to 3 standard deviations of full-contact stress, h'_rms/2, k by least
squares; a Gaussian has k = 2.  Tensile end: P |sigma|^3 tends to (2 / pi lambda) sum_e w_e / E*, exactly (JKR edges).
The fit of the double Gaussian, and why its sigma_a is what it is: double_gaussian_fit.py.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, semilogy, shaded, trace
from validation.harness.schema import Figure
from validation.paper.double_gaussian_fit import FACTOR, Sample
from validation.paper.evidence import (
    Evidence,
    Realisation,
    jackknife,
    mean_and_error,
    theory_with_adhesion,
)
from validation.paper.members import SPECTRA_AT
from validation.paper.statements import Check, Statement, Topic
from validation.references.paper_problem import MODULUS

BOUNDS = np.linspace(-0.3, 0.7, 51)  # of E*
CENTRES = (BOUNDS[1:] + BOUNDS[:-1]) / 2
TAIL_BOUNDS = -np.geomspace(30.0, 0.05, 41)  # of E*
TENSILE_END = (-6.0, -2.0)  # of E*
COMPRESSIVE_END = (1.0, 3.0)  # of h'_rms / 2


def density(realisation: Realisation, load: float, bounds: FloatArray) -> FloatArray:
    """Return the mean of P E* over bins of sigma/E*, (n_bins,), from the exact shares of the solver's own bins."""
    own = realisation.field("sigma_bounds", load) / MODULUS
    shares = np.concatenate([[0.0], np.cumsum(realisation.field("P", load) * np.diff(own) * MODULUS)])
    return np.asarray(np.diff(np.interp(bounds, own, shares)) / np.diff(bounds))


def decay_power(sigma: FloatArray, values: FloatArray) -> float:
    """Fit k of ln P = a - b sigma^k by least squares; bins with P = 0 are left out.

    Examples
    --------
    >>> sigma = np.linspace(1.0, 3.0, 20)
    >>> round(decay_power(sigma, np.exp(1 - 0.5 * sigma**2)), 4)
    2.0
    """
    weighted = values > 0
    x, y = sigma[weighted] / sigma[weighted][-1], np.log(values[weighted])

    def misfit(power: float) -> float:
        basis = np.column_stack([np.ones_like(x), x**power])
        return float(np.sum((y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0]) ** 2))

    return float(minimize_scalar(misfit, bounds=(0.2, 8.0), method="bounded", options={"xatol": 1e-6}).x)


def compute(evidence: Evidence) -> Topic:
    """Return statements, checks and figures."""
    statements: list[Statement] = []
    figures: list[Figure] = []
    samples: list[Sample] = []
    spread = evidence.lines.slope_rms / 2
    for load in SPECTRA_AT:
        values = np.array([density(realisation, load, BOUNDS) for realisation in evidence.with_fields_at(load)])
        theories = {factor: _distribution(evidence, load, factor) for factor in (1.0, FACTOR)}
        sample = Sample(load, CENTRES, values, evidence.with_adhesion[load].detachment_stress / MODULUS, spread)
        samples.append(sample)
        statements += [_gaussian(evidence, sample), *sample.statements(evidence)]
        figures += _figures(sample, theories[1.0], theories[FACTOR])
    statements.append(_factor(evidence, samples))
    checks = [] if evidence.shortfall else [_tensile(evidence, load) for load in SPECTRA_AT]
    return Topic("What is the distribution of the pressure?", statements, checks, figures)


def _distribution(evidence: Evidence, load: float, factor: float) -> Callable[[FloatArray], FloatArray]:
    """Return the theory's P E* as a function of sigma/E*, with sigma_a multiplied by a factor."""
    contact = evidence.with_adhesion[load]
    if factor != 1:
        contact = theory_with_adhesion(evidence.loading[0], load, 1 / factor**2)
    return lambda sigma: np.asarray(contact.pressure_distribution(sigma * MODULUS) * MODULUS)


def _distance(evidence: Evidence, sample: Sample, factor: float) -> float:
    """Return int |P - P of the theory| over the bins, divided by the contact fraction."""
    predicted = _distribution(evidence, sample.load, factor)(CENTRES)
    return float(np.sum(np.abs(sample.mean - predicted)) / np.sum(sample.mean))


def _factor(evidence: Evidence, samples: Sequence[Sample]) -> Statement:
    closer = sum(_distance(evidence, sample, FACTOR) < _distance(evidence, sample, 1.0) for sample in samples)
    return evidence.statement(
        "section 5: a factor of about 1.4 brings the theory closer",
        f"loads of {len(samples)} at which the theory's P(sigma) comes closer with {FACTOR:g} sigma_a",
        (float(closer), 0.0),
        float(len(samples)),
        0.5,
        float(len(samples) - 1),
    )


def _gaussian(evidence: Evidence, sample: Sample) -> Statement:
    low, high = (bound * sample.spread for bound in COMPRESSIVE_END)
    end = (low <= CENTRES) & (high >= CENTRES)
    power = jackknife(lambda mean: decay_power(CENTRES[end], mean[end]), sample.values)
    return evidence.statement(
        "section 5: Gaussian tail at high pressure",
        f"power k of ln P = a - b sigma^k at high pressure, {sample.load:g} E*",
        power,
        2.0,
        0.5,
        1.0,
        "excluded: an exponential tail",
    )


def _tensile(evidence: Evidence, load: float) -> Check:
    """Compare P |sigma|^3 with its limit of JKR edges, mean over the end and the realisations."""
    centres = -np.sqrt(TAIL_BOUNDS[1:] * TAIL_BOUNDS[:-1])
    inside = (centres >= TENSILE_END[0]) & (centres <= TENSILE_END[1])
    ratios = []
    for realisation in evidence.with_fields_at(load):
        limit = float(realisation.field("tail_coefficient", load)) / MODULUS**2
        exact = limit * (TAIL_BOUNDS[1:] ** -2 - TAIL_BOUNDS[:-1] ** -2) / 2 / np.diff(TAIL_BOUNDS)
        ratios.append(float(np.mean((density(realisation, load, TAIL_BOUNDS) / exact)[inside])))
    name = f"tensile tail P |sigma|^3 over (2 E*/(pi lambda)) sum w_e, -6 to -2 E*, at {load:g} E*"
    return Check(name, float(np.mean(ratios)), 1.0, 0.01)


def _figures(
    sample: Sample, said: Callable[[FloatArray], FloatArray], raised: Callable[[FloatArray], FloatArray]
) -> Iterator[Figure]:
    """Yield the distribution, linear and logarithmic."""
    smooth = np.linspace(BOUNDS[0], BOUNDS[-1], 401)
    curves = (
        ("double Gaussian, fitted as printed", sample.fit(smooth), "line", 3),
        ("ours: with a free amplitude", sample.over(float(BOUNDS[0]), None, True, False)(smooth), "dashed", 3),
        ("Persson with adhesion", said(smooth), "line", 1),
        (rf"the same with {FACTOR:g} $\sigma_a$", raised(smooth), "dashed", 1),
    )
    mean, error = mean_and_error(sample.values)
    for name, panel, least in (("linear", axes, -np.inf), ("logarithmic", semilogy, 1e-4 * float(mean.max()))):
        carried = mean > least
        lower = np.maximum(mean - error, max(least, 0.0))[carried]
        yield drawn(
            f"pressure-distribution-{sample.load:g}-{name}",
            f"Distribution of the pressure at {sample.load:g} E*, {name}: mean of the realisations with its standard "
            "error, the double Gaussian fitted to the mean, and the theory.",
            panel(
                r"$\sigma/E^*$",
                "$P\\,E^*$",
                shaded("mean and standard error", CENTRES[carried], lower, (mean + error)[carried], 0),
                marks("mean", CENTRES[carried], mean[carried], hue=0),
                *(
                    trace(label, smooth[values > least], values[values > least], style, hue)
                    for label, values, style, hue in curves
                ),
            ),
        )
