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
from validation.harness.case import Outcome
from validation.harness.figure_data import drawn, loglog, trace
from validation.harness.schema import Cells, Row, Series, Table
from validation.replicate.evidence import Evidence, Realisation, scattered, theory_with_adhesion
from validation.replicate.paper_spectra import Exponent, banded, exponent, exponent_of, exponent_of_mean
from validation.replicate.statements import Alternative

WINDOWS = ((0.1, 1.0), (0.07, 0.7), (0.15, 1.0))  # of the highest order
LEVEL = 0.8  # the Hurst exponent at which short waves are in full contact
CAUSE = (
    "the theory loses contact with the wavenumber faster than the solid does, as in its area; both fall, as the paper "
    "says of H < 0.5"
)


def compute(evidence: Evidence) -> Outcome:
    """Rows, figure and table."""
    rows: list[Row] = []
    series: list[Series] = []
    lines: list[Cells] = []
    for hue, (value, group) in enumerate(evidence.hurst.items()):
        if len(group) < 2:
            return Outcome(skipped=f"H = {value:g}: {len(group)} realisations, 2 at least are needed")
        orders = group[0].surface.max_order
        windows = [(low * orders, high * orders) for low, high in WINDOWS]
        power = np.array([_followed(one, orders) for one in group])
        found, alone = exponent_of_mean(power, windows), exponent_of(power, windows)
        theory = theory_with_adhesion(group[0], group[0].final_load)
        said = float(np.mean([exponent(theory.contact_fractions, window) for window in windows]))
        area = float(np.mean([one.result.targets[-1].contact_fraction for one in group]))
        lines.append([value, len(group), orders, group[0].final_load, area, theory.contact_fraction, found.value,
                      found.error, found.low, found.high, alone.value, alone.error, said])  # fmt: skip
        rows.append(_row(value, found, alone, said, evidence))
        bands = [banded(one, 16) for one in power]
        series += scattered(bands, bands[0][0], [y for _, y in bands], name=f"H = {value:g}, ", hue=hue)
        series.append(trace(f"H = {value:g}, Persson's A(q)/A0", range(1, orders + 1), theory.contact_fractions,
                            hue=hue))  # fmt: skip
    table = Table(
        caption="Exponents of C_u / C near the last decade of orders, fitted to the mean of the realisations: mean "
        "over the windows, and the lowest and highest of them; and fitted to each realisation.",
        columns=["H", "realisations", "harmonics", "p/E*", "A/A0", "Persson's A/A0", "exponent", "standard error",
                 "lowest", "highest", "of each", "standard error of these", "Persson's exponent"],
        rows=lines
    )  # fmt: skip
    figure = drawn(
        "short-wavelengths",
        "Part of the roughness that the solid follows, C_u / C, against the order in bands, for H = 0.8, level "
        "at short waves, and H = 0.3, falling.",
        loglog("$q/q_0$", "$C_u/C$", *series),
    )
    return Outcome(rows=tuple(rows), figures=(figure,), tables=(table,))


def _row(value: float, found: Exponent, alone: Exponent, theory: float, evidence: Evidence) -> Row:
    """Level at short waves for H > 0.5; falling, otherwise than in the theory, for H < 0.5."""
    name = f"exponent of C_u / C at short waves, H = {value:g}"
    passage = evidence.paper(
        "section 5: full contact at short wavelengths as the theory, computed here, expects for H > 0.5"
    )
    reported = f"{found.reported()}; fitted to each realisation {alone.value:.3f} +- {alone.error:.3f}"
    if value < LEVEL:
        name += ", over that of the theory"
        return passage.is_otherwise(name, found.value, found.error, theory, (0.7, 0.97), CAUSE, reported=reported)
    falls = Alternative(-(1 - 0.3), "the fall of H = 0.3, about -(1 - H)")
    return passage.states(name, found.value, found.error, theory, 0.25, falls, measured=0.137, reported=reported)


def _followed(one: Realisation, orders: int) -> FloatArray:
    """C_u / C at the last target, (n_orders,)."""
    last = len(one.result.targets) - 1
    return np.asarray(one.result.fields[f"C_u_{last}"][:orders] / one.lines.power(one.surface.q0))
