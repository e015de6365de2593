"""Contact at short wavelengths for H = 0.8 and H = 0.3, at the same load over the rms slope.

C_u / C at a wavenumber q is the part of the roughness of that wavelength that the solid follows.  The theory has C_u
/ C = A(q)/A0: level at high q for H > 0.5, where within the contact the short waves are in full contact, and falling
about as q^-(1 - H) for H < 0.5.  Compared are the exponents of C_u / C near the last decade of orders (several
windows), each against the theory's own over the same orders.  What the theory gives is the mean over realisations, so
that the mean spectrum is fitted; the logarithm of a single one scatters more at short waves, where its fit falls
steeper.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, section 5.
"""

import numpy as np

from validation.harness.arrays import FloatArray
from validation.harness.figure_data import drawn, loglog, trace
from validation.harness.schema import Series
from validation.paper.evidence import Evidence, Realisation, scattered, theory_with_adhesion
from validation.paper.spectra import Exponent, banded, exponent, exponent_of, exponent_of_mean
from validation.paper.statements import Statement, Topic

WINDOWS = ((0.1, 1.0), (0.07, 0.7), (0.15, 1.0))  # of the highest order
LEVEL = 0.8  # the Hurst exponent at which short waves are in full contact


def compute(evidence: Evidence) -> Topic:
    """Return statements and figure."""
    question = "Are short waves in full contact for H = 0.8, and not for H = 0.3?"
    statements: list[Statement] = []
    series: list[Series] = []
    for hue, (value, group) in enumerate(evidence.hurst.items()):
        if len(group) < 2:
            return Topic(question, message=f"H = {value:g}: {len(group)} realisations, 2 at least are needed")
        orders = group[0].surface.max_order
        windows = [(low * orders, high * orders) for low, high in WINDOWS]
        power = np.array([_followed(realisation, orders) for realisation in group])
        of_mean, of_each = exponent_of_mean(power, windows), exponent_of(power, windows)
        theory = theory_with_adhesion(group[0], group[0].final_load)
        predicted = float(np.mean([exponent(theory.contact_fractions, window) for window in windows]))
        statements.append(_statement(value, of_mean, of_each, predicted, evidence))
        bands = [banded(ratio, 16) for ratio in power]
        series += scattered(bands, bands[0][0], [y for _, y in bands], name=f"H = {value:g}, ", hue=hue)
        series.append(
            trace(f"H = {value:g}, Persson's A(q)/A0", range(1, orders + 1), theory.contact_fractions, hue=hue)
        )
    figure = drawn(
        "short-wavelengths",
        "Part of the roughness that the solid follows, C_u / C, against the order in bands, for H = 0.8, level "
        "at short waves, and H = 0.3, falling.",
        loglog("$q/q_0$", "$C_u/C$", *series),
    )
    return Topic(question, statements, (), (figure,))


def _statement(value: float, of_mean: Exponent, of_each: Exponent, theory: float, evidence: Evidence) -> Statement:
    """Judge the exponent: level at short waves for H > 0.5, falling for H < 0.5, each as the theory has it."""
    where = "section 5: full contact at short wavelengths as the theory, computed here, expects for H > 0.5"
    note = f"over the theory's: {of_mean.value / theory:.2f}; {of_mean.reported()}; fitted to each realisation "
    note += f"{of_each.value:.3f} +- {of_each.error:.3f}"
    excluded = -(1 - 0.3) if value >= LEVEL else 0.0  # the fall of H = 0.3; level
    return evidence.statement(
        where,
        f"exponent of C_u / C at short waves, H = {value:g}",
        (of_mean.value, of_mean.error),
        theory,
        min(0.25, abs(excluded - theory) / 2),
        excluded,
        note,
    )


def _followed(realisation: Realisation, orders: int) -> FloatArray:
    """Return C_u / C at the last target, (n_orders,)."""
    last = len(realisation.result.targets) - 1
    return np.asarray(
        realisation.result.fields[f"C_u_{last}"][:orders] / realisation.lines.power(realisation.surface.q0)
    )
