"""Spectra of displacement and pressure at 0.005 and 0.02 E*: exponents, full contact at short waves and at high load.

C_u and C_sigma are two-sided per line (bem/spectra.py); every line of one realisation scatters like a periodogram, so
the exponents are those of the mean over the realisations, by least squares of ln C against ln q over the orders of a
window, every line with the same weight.  The windows were fixed beforehand: orders 10 to 100 for the middle, 250 to
1000 for the high end.  The error is the jackknife's; the sensitivity is the largest change when either end, or both,
moves by half an octave either way.  For the half-space C_sigma = E*^2 q^2 C_u / 4 line by line, so that its exponent
is that of C_u plus 2, and the two are one statement.

Theory: C_u = C A(q)/A0, exponent -(2 + H) where adhesion is negligible; 1 - 2 H of C_sigma is that of full contact at
every q, C_sigma ~ q^2 C.  Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from validation.case import Outcome
from validation.replicate.evidence import Evidence, Realisation, jackknife, mean_and_error
from validation.replicate.members import HURST, LOADS, MODULUS, SPECTRA_AT
from validation.replicate.statements import statement
from validation.schema import Figure, Panel, Row, Series, Table

FloatArray = NDArray[np.float64]

MIDDLE, HIGH = (10.0, 100.0), (250.0, 1000.0)  # orders, fixed beforehand
HALF_OCTAVE = 2**0.5
BANDS = 24  # of orders, equal in ln q, in figures


def exponent(power: FloatArray, window: tuple[float, float]) -> float:
    """Slope of ln C against ln q over the orders of a window; power belongs to the orders 1, 2, ..

    Examples
    --------
    >>> round(exponent(np.arange(1.0, 200.0) ** -2.7, (10, 100)), 12)
    -2.7
    """
    order = np.arange(1, power.size + 1)
    inside = (order >= window[0]) & (order <= window[1])
    return float(np.polyfit(np.log(order[inside]), np.log(power[inside]), 1)[0])


def sensitivity(power: FloatArray, window: tuple[float, float]) -> float:
    """Largest change of the exponent when the ends of the window move by half an octave either way.

    Examples
    --------
    >>> sensitivity(np.arange(1.0, 200.0) ** -2.0, (10, 100)) < 1e-12
    True
    """
    middle = exponent(power, window)
    moved = [
        exponent(power, (window[0] * HALF_OCTAVE**low, window[1] * HALF_OCTAVE**high))
        for low, high in product((-1, 0, 1), repeat=2)
    ]
    return max(abs(value - middle) for value in moved)


def displacement_spectra(realisations: tuple[Realisation, ...], load: float) -> FloatArray:
    """C_u at a load in m^3, (n_realisations, n_orders)."""
    return np.array([one.field("C_u", load) for one in realisations])


def compute(evidence: Evidence) -> Outcome:
    """Rows, figures and table of the loading ensemble and of the profile at high load."""
    rows: list[Row] = []
    lines: list[list[str | float | int | None]] = []
    highest = evidence.size.harmonics
    for load in SPECTRA_AT:
        power = displacement_spectra(evidence.with_fields_at(load), load)[:, :highest]
        theory = evidence.with_adhesion[load].displacement_power(evidence.loading[0].surface.q0)
        for name, window in (("10 to 100", MIDDLE), ("250 to 1000", HIGH)):
            if highest < window[1]:
                rows += _rows(load, name, np.nan, 0.0, np.nan, evidence.shortfall)
                continue
            value, error = jackknife(lambda mean, w=window: exponent(mean, w), power)  # type: ignore[misc]
            swing = sensitivity(power.mean(axis=0), window)
            said = exponent(theory, window)
            lines.append([load, len(power), name, value, error, swing, said, value + 2, said + 2])
            rows += _rows(load, name, value, error, said, evidence.shortfall)
    table = Table(
        caption="Exponents of the mean spectra; sensitivity: largest change when the ends move by half an octave.",
        columns=["p/E*", "realisations", "orders", "C_u", "standard error", "sensitivity", "Persson's C_u", "C_sigma",
                 "Persson's C_sigma"],
        rows=lines,
    )  # fmt: skip
    figures = [_displacement_figure(evidence), _pressure_figure(evidence), _ratio_figure(evidence)]
    if evidence.high_load is not None:
        rows.append(_high_load_row(evidence.high_load, evidence.shortfall))
        figures.append(_high_load_figure(evidence.high_load))
    return Outcome(rows=tuple(rows), figures=tuple(figures), tables=(table,))


def _rows(load: float, name: str, value: float, error: float, theory: float, short: str) -> list[Row]:
    """The paper's exponents of this window: of C_u, its theory and C_sigma in the middle; of C_sigma at the end."""
    if name == "250 to 1000":
        return [
            statement(
                f"exponent of C_sigma at {load:g} E*, orders 250 to 1000", value + 2, error, 1 - 2 * HURST, 0.15,
                measured=0.1, where="section 5: 1 - 2 H of full contact at high q", shortfall=short,
            )
        ]  # fmt: skip
    return [
        statement(
            f"exponent of C_u at {load:g} E*, orders 10 to 100", value, error, -2.73, 0.15,
            measured=0.12, last_digit=0.005, where="section 5: -2.73, theory -2.7", shortfall=short,
        ),
        statement(
            f"exponent of C_u in the theory with adhesion at {load:g} E*, orders 10 to 100", theory, 0.0, -2.7, 0.05,
            measured=0.021, last_digit=0.05, where="section 5: theory -2.7", shortfall=short,
        ),
        statement(
            f"exponent of C_sigma at {load:g} E*, orders 10 to 100 (that of C_u plus 2)", value + 2, error, -HURST,
            0.15, measured=0.1, where="section 5: -H in the middle range", shortfall=short,
        ),
    ]  # fmt: skip


def _high_load_row(one: Realisation, short: str) -> Row:
    state = one.result.targets[-1]
    power, profile = one.result.fields[f"C_u_{len(one.result.targets) - 1}"], one.result.fields["C_h"]
    carried = profile > 0
    return statement(
        f"C_u over C at contact fraction {state.contact_fraction:.3f}, mean over orders",
        float(np.mean(power[carried] / profile[carried])),
        0.0,
        1.0,
        0.1,
        measured=0.055,
        where="section 5: C_u tends to C at very high load",
        shortfall=short,
    )


def banded(values: FloatArray, bands: int = BANDS) -> tuple[list[float], list[float]]:
    """Means over bands of orders equal in ln q: central orders and values.

    Examples
    --------
    >>> order, value = banded(np.ones(100), 4)
    >>> len(order), set(value)
    (4, {1.0})
    """
    edges = np.geomspace(1, values.size + 1, bands + 1)
    order = np.arange(1, values.size + 1)
    inside = [(order >= low) & (order < high) for low, high in pairwise(edges)]
    kept = [mask for mask in inside if mask.any()]
    return (
        [float(np.exp(np.mean(np.log(order[mask])))) for mask in kept],
        [float(np.mean(values[mask])) for mask in kept],
    )


def _displacement_figure(evidence: Evidence) -> Figure:
    order = list(map(float, range(1, evidence.size.harmonics + 1)))
    q0 = evidence.loading[0].surface.q0
    series = [Series(label="profile", x=order, y=evidence.lines.power(q0).tolist())]
    for load in SPECTRA_AT:
        power = displacement_spectra(evidence.with_fields_at(load), load)[:, : len(order)]
        series.append(Series(label=f"mean, {load:g} E*", x=order, y=power.mean(axis=0).tolist(), style="points"))
        theory = evidence.with_adhesion[load].displacement_power(q0)
        series.append(Series(label=f"Persson, {load:g} E*", x=order, y=theory.tolist()))
    return Figure(
        id="displacement-spectrum",
        caption="Spectrum C_u of the displacement against the order q/q0, mean over the realisations, and the theory.",
        solution=Panel(xlabel="q / q0", ylabel="C_u / m³", xscale="log", yscale="log", series=series),
    )


def _pressure_figure(evidence: Evidence) -> Figure:
    order = list(map(float, range(1, evidence.size.harmonics + 1)))
    q0 = evidence.loading[0].surface.q0
    series = []
    for load in SPECTRA_AT:
        power = np.array([one.field("C_sigma", load) for one in evidence.with_fields_at(load)])[:, : len(order)]
        series.append(Series(label=f"mean, {load:g} E*", x=order, y=power.mean(axis=0).tolist(), style="points"))
        theory = evidence.with_adhesion[load].pressure_power(q0)
        series.append(Series(label=f"Persson, {load:g} E*", x=order, y=theory.tolist()))
    stiffness = evidence.with_adhesion[LOADS[-1]].plane_strain_modulus * q0 * np.array(order) / 2
    full = stiffness**2 * evidence.lines.power(q0)
    series.append(Series(label="full contact", x=order, y=full.tolist(), style="dashed"))
    return Figure(
        id="pressure-spectrum",
        caption="Spectrum C_sigma of the pressure against the order q/q0; full contact has the slope 1 - 2 H.",
        solution=Panel(xlabel="q / q0", ylabel="C_σ / (Pa² m)", xscale="log", yscale="log", series=series),
    )


def _ratio_figure(evidence: Evidence) -> Figure:
    """C_u / C in bands of orders: level where short waves are in full contact within the contact."""
    q0 = evidence.loading[0].surface.q0
    profile = evidence.lines.power(q0)
    series = []
    for load in SPECTRA_AT:
        power = displacement_spectra(evidence.with_fields_at(load), load)[:, : profile.size]
        bands = [banded(one / profile) for one in power]
        mean, error = mean_and_error([value for _, value in bands])
        x = bands[0][0]
        series.append(Series(label=f"mean and standard error, {load:g} E*", x=x, y=(mean - error).tolist(),
                             upper=(mean + error).tolist(), style="band"))  # fmt: skip
        theory = evidence.with_adhesion[load]
        series.append(Series(label=f"Persson's A(q)/A0, {load:g} E*", x=list(map(float, range(1, profile.size + 1))),
                             y=theory.contact_fractions.tolist()))  # fmt: skip
    return Figure(
        id="displacement-over-profile",
        caption="C_u / C of the profile, in bands of orders, beside the theory's A(q)/A0.",
        solution=Panel(xlabel="q / q0", ylabel="C_u / C", xscale="log", yscale="log", series=series),
    )


def _high_load_figure(one: Realisation) -> Figure:
    profile = one.result.fields["C_h"]
    carried = np.flatnonzero(profile > 0)
    order = (carried + 1).astype(float).tolist()
    return Figure(
        id="high-load",
        caption=f"C_u / C of a profile with {len(order)} harmonics as contact becomes complete.",
        solution=Panel(
            xlabel="q / q0",
            ylabel="C_u / C",
            xscale="log",
            yscale="log",
            series=[
                Series(
                    label=f"p = {state.mean_pressure / MODULUS:.3g} E*, A/A0 = {state.contact_fraction:.3f}",
                    x=order,
                    y=(one.result.fields[f"C_u_{k}"][carried] / profile[carried]).tolist(),
                )
                for k, state in enumerate(one.result.targets)
            ],
        ),
    )
