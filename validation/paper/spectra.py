"""Spectra of displacement and pressure at 0.005 and 0.02 E*: exponents, full contact at short waves and at high load.

C_u and C_sigma are two-sided per line; every line of one realisation scatters like a periodogram.  An exponent is the
least squares slope of ln C against ln q over the orders of a window, every line with the same weight, fitted to each
realisation on its own: mean and standard error over them; what the mean spectrum gives stands beside it.  The paper
does not print its window, and the spectrum is slightly curved; so the number of the middle range is the mean over the
windows of `MIDDLE`, and the lowest and highest of them, which is the ambiguity that the window leaves, stand beside
the verdict.  For the half-space C_sigma = E*^2 q^2 C_u / 4 line by line, so that its exponent is that of C_u plus 2.

Theory: C_u = C A(q)/A0, exponent -(2 + H) where adhesion is negligible; 1 - 2 H of C_sigma is that of full contact at
every q, C_sigma ~ q^2 C.  Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from validation.harness.arrays import FloatArray
from validation.harness.figure_data import drawn, loglog, semilogx, trace
from validation.harness.schema import Figure, Series
from validation.paper.evidence import Evidence, Realisation, estimate, jackknife, scattered
from validation.paper.members import LOADS, SPECTRA_AT
from validation.paper.statements import Statement, Topic
from validation.references.paper_problem import HURST, MODULUS

Window = tuple[float, float]

MIDDLE: tuple[Window, ...] = ((3.0, 30.0), (5.0, 50.0), (10.0, 100.0), (3.0, 100.0))  # orders
DRAWN = (3.0, 100.0)  # of the middle, whose straight line is drawn
HIGH: Window = (250.0, 1000.0)
SHIFTED, NEGLIGIBLE = (3.0, 100.0), 0.2  # orders; of the theory's C_u
PAPERS = -2.73  # exponent of C_u
FULL_CONTACT = -(1 + 2 * HURST)  # of C_u: the profile's own
BANDS = 24  # of orders, equal in ln q, in figures
HOW_DRAWN = (
    "Thin lines and shaded bands: single realisations and their mean with its standard error, averaged over bands of "
    "orders; lines: the theory. Loads and windows are ours."
)


@dataclass(frozen=True)
class Exponent:
    """Mean over windows and realisations, its standard error, and the lowest and highest window."""

    value: float
    error: float
    low: float
    high: float

    def reported(self, added: float = 0.0) -> str:
        """Return the range of the exponent over the windows as text, with a number added to both ends."""
        return f"windows: {self.low + added:.3f} to {self.high + added:.3f}"


def exponent(power: FloatArray, window: Window) -> float:
    """Return the slope of ln C against ln q over the orders of a window; power belongs to the orders 1, 2, ..

    Examples
    --------
    >>> round(exponent(np.arange(1.0, 200.0) ** -2.7, (10, 100)), 12)
    -2.7
    """
    order = np.arange(1, power.size + 1)
    inside = (order >= window[0]) & (order <= window[1])
    return float(np.polyfit(np.log(order[inside]), np.log(power[inside]), 1)[0])


def exponent_of(power: FloatArray, windows: Sequence[Window]) -> Exponent:
    """Fit the exponent of realisations, (n_realisations, n_orders), over several windows; NaN without a window.

    Examples
    --------
    >>> lines = np.arange(1.0, 200.0) ** -2.0
    >>> fitted = exponent_of(np.array([lines, 2 * lines]), [(3, 30), (10, 100)])
    >>> round(fitted.value, 12), round(fitted.error, 12), round(fitted.high - fitted.low, 12)
    (-2.0, 0.0, 0.0)
    """
    if not windows:
        return Exponent(np.nan, 0.0, np.nan, np.nan)
    each = np.array([[exponent(row, window) for window in windows] for row in power])
    by_window = each.mean(axis=0)
    return Exponent(*estimate(each.mean(axis=1)), float(by_window.min()), float(by_window.max()))


def exponent_of_mean(power: FloatArray, windows: Sequence[Window]) -> Exponent:
    """Fit the exponent of the mean of realisations, (n_realisations, n_orders), over windows; jackknife error.

    Examples
    --------
    >>> lines = np.arange(1.0, 201.0) ** -2.0
    >>> fitted = exponent_of_mean(np.array([lines, 2 * lines]), [(3, 30), (10, 100)])
    >>> round(fitted.value, 12), round(fitted.error, 12)
    (-2.0, 0.0)
    """
    value, error = jackknife(lambda mean: float(np.mean([exponent(mean, window) for window in windows])), power)
    by_window = [exponent(power.mean(axis=0), window) for window in windows]
    return Exponent(value, error, min(by_window), max(by_window))


def spectra(evidence: Evidence, load: float, name: str = "C_u") -> FloatArray:
    """Return C_u at a load in m^3, or C_sigma, (n_realisations, n_orders)."""
    every = [realisation.field(name, load) for realisation in evidence.with_fields_at(load)]
    return np.array(every)[:, : evidence.size.harmonics]


def compute(evidence: Evidence) -> Topic:
    """Return statements and figures of the loading ensemble and of the profile at high load."""
    statements: list[Statement] = []
    for load in SPECTRA_AT:
        power = spectra(evidence, load)
        theory = evidence.with_adhesion[load].displacement_power(evidence.loading[0].surface.q0)
        for judge in (_middle, _shift, _high):
            statements += judge(load, power, theory, evidence)
    figures = list(_figures(evidence))
    if evidence.high_load is not None:
        statement, figure = _high_load(evidence.high_load, evidence)
        statements, figures = [*statements, statement], [*figures, figure]
    question = "What are the exponents of the spectra, and is contact full at short wavelengths?"
    return Topic(question, statements, (), figures)


def _middle(load: float, power: FloatArray, theory: FloatArray, evidence: Evidence) -> list[Statement]:
    """Judge the paper's exponents of the middle range: of C_u, of its theory, of C_sigma."""
    windows = [window for window in MIDDLE if window[1] <= power.shape[1]]
    fitted = exponent_of(power, windows)
    predicted = float(np.mean([exponent(theory, window) for window in windows])) if windows else np.nan
    of_mean = exponent_of_mean(power, windows).value if windows else np.nan
    statement = evidence.statement
    return [
        statement(
            "section 5: -2.73, theory -2.7",
            f"exponent of C_u at {load:g} E*, middle range",
            (fitted.value, fitted.error),
            PAPERS,
            0.15,
            FULL_CONTACT,
            f"{fitted.reported()}; fitted to the mean spectrum {of_mean:.3f}",
        ),
        statement(
            "section 5: theory -2.7",
            f"exponent of C_u in the theory with adhesion at {load:g} E*, middle range",
            (predicted, 0.0),
            -2.7,
            0.1,
            FULL_CONTACT,
        ),
        statement(
            "section 5: -H in the middle range",
            f"exponent of C_sigma at {load:g} E*, middle range (that of C_u plus 2)",
            (fitted.value + 2, fitted.error),
            -HURST,
            0.15,
            FULL_CONTACT + 2,
            fitted.reported(2),
        ),
    ]


def _shift(load: float, power: FloatArray, theory: FloatArray, evidence: Evidence) -> list[Statement]:
    """Judge how far C_u lies above the theory's C_u: mean over the orders of `SHIFTED`."""
    if power.shape[1] < SHIFTED[1]:
        return []
    inside = slice(int(SHIFTED[0]) - 1, int(SHIFTED[1]))
    ratio = estimate((power[:, inside] / theory[inside]).mean(axis=1))
    return [
        evidence.statement(
            "section 5: a non-negligible shift, the exponents the same",
            f"C_u at {load:g} E* over that of the theory with adhesion, orders 3 to 100, off by more "
            f"than {NEGLIGIBLE:.0%}",
            ratio,
            1.0,
            NEGLIGIBLE,
            differs=True,
        )
    ]


def _high(load: float, power: FloatArray, theory: FloatArray, evidence: Evidence) -> list[Statement]:
    """Judge the exponent of C_sigma at the high end, and by how much it has risen from the middle."""
    if power.shape[1] < HIGH[1]:
        return []
    fitted = exponent_of(power, [HIGH])
    rise = [exponent(row, HIGH) - np.mean([exponent(row, window) for window in MIDDLE]) for row in power]
    where = "section 5: from -H in the middle range to 1 - 2 H of full contact at high q"
    return [
        evidence.statement(
            where,
            f"exponent of C_sigma at {load:g} E*, orders 250 to 1000",
            (fitted.value + 2, fitted.error),
            1 - 2 * HURST,
            0.15,
            -HURST,
        ),
        evidence.statement(
            where,
            f"rise of the exponent of C_sigma to orders 250 to 1000, {load:g} E*",
            estimate(rise),
            1 - HURST,
            0.15,
            0.0,
        ),
    ]


def _high_load(realisation: Realisation, evidence: Evidence) -> tuple[Statement, Figure]:
    """Judge and draw C_u / C as contact becomes complete: in bands of orders, and its mean at every load."""
    profile = realisation.result.fields["C_h"]
    carried = np.flatnonzero(profile > 0)
    series, lines = list[Series](), list[tuple[float, ...]]()
    for k, state in enumerate(realisation.result.targets):
        ratio = realisation.result.fields[f"C_u_{k}"][carried] / profile[carried]
        order, followed = banded(ratio)
        load, fraction = state.mean_pressure / MODULUS, state.contact_fraction
        series.append(trace(f"p = {load:.3g} E*, A/A0 = {fraction:.4f}", order, followed, hue=k))
        lines.append((state.separation * 1e6, load, fraction, *estimate(ratio), max(abs(v - 1) for v in followed)))
    (_, _, first, least, *_), (_, _, last, mean, error, _) = lines[0], lines[-1]
    statement = evidence.statement(
        "section 5: C_u tends to C at very high load",
        f"C_u over C at contact fraction {last:.4f}, mean over orders",
        (mean, error),
        1.0,
        min(0.02, abs(least - 1) / 2),
        least,
        f"excluded: its value at {first:.3f}",
    )
    figure = drawn(
        "high-load",
        f"C_u / C of a profile with {carried.size} harmonics as contact becomes complete, in bands of orders.",
        semilogx("$q/q_0$", "$C_u/C$", *series),
    )
    return statement, figure


def banded(values: FloatArray, bands: int = BANDS) -> tuple[list[float], list[float]]:
    """Return means over bands of orders equal in ln q: central orders and values.

    Examples
    --------
    >>> order, value = banded(np.ones(100), 4)
    >>> len(order), set(value)
    (4, {1.0})
    """
    edges = np.geomspace(1, values.size + 1, bands + 1)
    order = np.arange(1, values.size + 1)
    inside = [(order >= low) & (order < high) for low, high in pairwise(edges)]
    filled = [mask for mask in inside if mask.any()]
    return (
        [float(np.exp(np.mean(np.log(order[mask])))) for mask in filled],
        [float(np.mean(values[mask])) for mask in filled],
    )


def _figures(evidence: Evidence) -> Iterator[Figure]:
    """Yield both spectra, and C_u over C, level where short waves are in full contact."""
    q0 = evidence.loading[0].surface.q0
    profile, order = evidence.lines.power(q0), range(1, evidence.size.harmonics + 1)
    stiffness = evidence.with_adhesion[LOADS[-1]].plane_strain_modulus * q0 * np.array(order) / 2
    displaced = [trace("profile", order, profile, hue=5)]
    pressed = [trace("full contact, slope 1 - 2H", order, stiffness**2 * profile / MODULUS**2, "dashed", hue=5)]
    followed: list[Series] = []
    for hue, load in enumerate(SPECTRA_AT):
        name, theory = f"{load:g} E*", evidence.with_adhesion[load]
        power, stress = spectra(evidence, load), spectra(evidence, load, "C_sigma") / MODULUS**2
        displaced += _curves(power, theory.displacement_power(q0), name, hue)
        pressed += _curves(stress, theory.pressure_power(q0) / MODULUS**2, name, hue)
        followed += _curves(power / profile, theory.contact_fractions, name, hue)
    steep = float(displaced[1].y[0] or 1.0)
    displaced.append(trace(f"the paper's slope {PAPERS}", DRAWN, [steep * end**PAPERS for end in DRAWN], "dashed", 5))
    yield drawn(
        "displacement-spectrum",
        f"Spectrum C_u of the displacement against the order. {HOW_DRAWN}",
        loglog("$q/q_0$", "$C_u$ / m³", *displaced),
    )
    yield drawn(
        "pressure-spectrum",
        f"Spectrum C_sigma over E*^2 of the pressure against the order. {HOW_DRAWN}",
        loglog("$q/q_0$", r"$C_\sigma/E^{*2}$ / m", *pressed),
    )
    yield drawn(
        "displacement-over-profile",
        "C_u / C of the profile, in bands of orders, beside the theory's A(q)/A0.",
        loglog("$q/q_0$", "$C_u/C$", *followed),
    )


def _curves(power: FloatArray, theory: FloatArray, name: str, hue: int) -> list[Series]:
    """Return single realisations and mean with its error in bands of orders, and the theory."""
    bands, order = [banded(row) for row in power], range(1, power.shape[1] + 1)
    return [
        *scattered(bands, bands[0][0], [value for _, value in bands], name=f"{name}, ", hue=hue)[:2],
        trace(f"{name}, Persson with adhesion", order, theory, hue=hue),
    ]
