"""Spectra of displacement and pressure at 0.005 and 0.02 E*, at high load, and for two Hurst exponents.

C_u and C_sigma are two-sided per line; every line of one realisation scatters like a periodogram.  An exponent is the
least squares slope of ln C against ln q over the orders of a window, every line with the same weight, fitted to each
realisation on its own: mean and standard error over them.  The paper does not print its window, and the spectrum is
slightly curved; so the number of the middle range is the mean over the windows of `MIDDLE`, and the lowest and highest
of them, which is the ambiguity that the window leaves, stand beside the verdict.  For the half-space C_sigma = E*^2 q^2
C_u / 4 line by line, so that its exponent is that of C_u plus 2.  Theory: C_u = C A(q)/A0, exponent -(2 + H) where
adhesion is negligible; 1 - 2 H of C_sigma is that of full contact at every q, C_sigma ~ q^2 C.

C_u / C at a wavenumber q is the part of the roughness of that wavelength that the solid follows.  The theory's A(q)/A0
is level at high q for H > 0.5, where within the contact the short waves are in full contact, and falls about as
q^-(1 - H) for H < 0.5.  The exponents of C_u / C near the last decade of orders (`SHORT`) are compared with the
theory's over the same orders, for H = 0.8 and H = 0.3 at the same load over the rms slope.  The theory gives the mean
over realisations, so that the mean spectrum is fitted: the logarithm of a single spectrum scatters more at short waves,
where its fit falls steeper.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from persson import AdhesiveContact, DiscreteSpectrum
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import Figure, Series, drawn, trace
from validation.paper.curves import banded, scattered
from validation.paper.ensemble import Ensemble, Realisation, estimate, jackknife, theory_with_adhesion
from validation.paper.members import HURSTS, LOADS, SPECTRA_AT
from validation.paper.statements import Measured
from validation.references.paper_problem import MODULUS

Window = tuple[float, float]

MIDDLE: tuple[Window, ...] = ((3.0, 30.0), (5.0, 50.0), (10.0, 100.0), (3.0, 100.0))  # orders
HIGH: Window = (250.0, 1000.0)
SHIFTED = slice(2, 100)  # orders 3 to 100
SHORT: tuple[Window, ...] = ((0.1, 1.0), (0.07, 0.7), (0.15, 1.0))  # of the highest order
PAPERS = -2.73  # exponent of C_u
HOW_DRAWN = (
    "Thin lines and shaded bands: single realisations and their mean with its standard error, averaged over bands of "
    "orders; lines: the theory. Loads and windows are ours."
)


def exponents(power: FloatArray, windows: Sequence[Window]) -> FloatArray:
    """Return the slope of ln C against ln q over the orders of each window; power belongs to the orders 1, 2, .."""
    order = np.arange(1, power.size + 1)
    inside = [(order >= low) & (order <= high) for low, high in windows]
    return np.array([np.polyfit(np.log(order[mask]), np.log(power[mask]), 1)[0] for mask in inside])


def mean_exponent(windows: Sequence[Window], power: FloatArray) -> float:
    """Return the mean of the exponents over windows."""
    return float(exponents(power, windows).mean())


def of_realisations(power: FloatArray, windows: Sequence[Window]) -> Measured:
    """Return the exponent fitted to each realisation, (n_realisations, n_orders), with its range over the windows."""
    each = np.array([exponents(row, windows) for row in power])
    return Measured(*estimate(each.mean(axis=1)), note=_range(each.mean(axis=0)))


def of_mean(power: FloatArray, windows: Sequence[Window]) -> Measured:
    """Return the exponent of the mean of realisations, (n_realisations, n_orders), with the jackknife's error."""
    fitted = jackknife(partial(mean_exponent, windows), power)
    return Measured(*fitted, note=_range(exponents(power.mean(axis=0), windows)))


def _range(by_window: FloatArray) -> str:
    return f"windows: {by_window.min():.3f} to {by_window.max():.3f}"


def measured(ensemble: Ensemble) -> dict[str, Measured]:
    """Return our numbers of the spectra."""
    numbers = of_theory(ensemble.wet, ensemble.loading[0].profile.q0)
    for load in SPECTRA_AT:
        theory = ensemble.wet[load].displacement_power(ensemble.loading[0].profile.q0)
        at_load = of_spectrum(_spectra(ensemble, "C_u", load), theory)
        numbers |= {f"{name} {load:g}": number for name, number in at_load.items()}
    for hurst in HURSTS:
        group = ensemble.whole(f"hurst {hurst:g}")
        if group is not None:
            numbers[f"exponent of C_u over C, H = {hurst:g}"] = of_short_waves(group)
    high_load = ensemble.whole("high load")
    return numbers if high_load is None else numbers | {"C_u over C when nearly flat": _nearly_flat(*high_load)}


def of_theory(wet: Mapping[float, AdhesiveContact], q0: float) -> dict[str, Measured]:
    """Return the exponents of C_u in the theory at `SPECTRA_AT`, as far as its orders reach; U: half their range."""
    power = {load: wet[load].displacement_power(q0) for load in SPECTRA_AT}
    return {
        f"exponent of C_u in theory {load:g}": Measured(each.mean(), np.ptp(each) / 4)
        for load, of in power.items()
        if (windows := _middle(of.size)) and (each := exponents(of, windows)).size
    }


def _middle(orders: int) -> list[Window]:
    """Return the windows of the middle range within some orders."""
    return [window for window in MIDDLE if window[1] <= orders]


def _spectra(ensemble: Ensemble, name: str, load: float) -> FloatArray:
    """Return C_u at a load in m^3, or C_sigma, (n_realisations, n_orders)."""
    return ensemble.fields(name, load)[:, : ensemble.size.harmonics]


def of_spectrum(power: FloatArray, theory: FloatArray) -> dict[str, Measured]:
    """Return the numbers of C_u, (n_realisations, n_orders), at one load, as far as its orders reach."""
    numbers: dict[str, Measured] = {}
    if windows := _middle(theory.size):
        numbers["exponent of C_u"] = of_realisations(power, windows)
    if theory.size >= SHIFTED.stop:
        shift = (power[:, SHIFTED] / theory[SHIFTED]).mean(axis=1)
        numbers["shift of C_u"] = Measured(*estimate(shift))
    if theory.size >= HIGH[1]:
        high = np.array([mean_exponent([HIGH], row) for row in power])
        rise = high - [mean_exponent(MIDDLE, row) for row in power]
        numbers["exponent of C_sigma at high q"] = Measured(*estimate(high + 2))
        numbers["rise of the exponent of C_sigma"] = Measured(*estimate(rise))
    return numbers


def of_short_waves(group: Sequence[Realisation]) -> Measured:
    """Return the exponent of C_u / C at short waves of one Hurst exponent, and the theory's as the printed number."""
    power = np.array([followed(member) for member in group])
    windows = [(low * power.shape[1], high * power.shape[1]) for low, high in SHORT]
    ours, theory = of_mean(power, windows), mean_exponent(windows, _area_by_order(group))
    return Measured(ours.value, ours.error, theory, note=ours.note)


def followed(member: Realisation, k: int = -1) -> FloatArray:
    """Return C_u / C at target k, (n_orders,)."""
    fields, last = member.result.fields, len(member.result.targets) - 1
    power = DiscreteSpectrum.of_profile(member.profile).power(member.profile.q0)
    return np.asarray(fields[f"C_u_{last if k < 0 else k}"][: power.size] / power)


def _area_by_order(group: Sequence[Realisation]) -> FloatArray:
    """Return A(q)/A0 of the theory at the load of the first realisation."""
    lines = DiscreteSpectrum.of_profile(group[0].profile)
    return theory_with_adhesion(lines, group[0].final_load).contact_fractions


def _nearly_flat(member: Realisation) -> Measured:
    """Return C_u / C at the highest load; its value at the lowest is excluded."""
    first, last = (member.result.targets[k].contact_fraction for k in (0, -1))
    note = f"at contact fraction {last:.4f}; excluded: its value at {first:.3f}"
    return Measured(*estimate(followed(member)), excluded=float(followed(member, 0).mean()), note=note)


def figures(ensemble: Ensemble) -> Iterator[Figure]:
    """Yield both spectra, and C_u over C for two Hurst exponents."""
    q0 = ensemble.loading[0].profile.q0
    profile, order = ensemble.lines.power(q0), range(1, ensemble.size.harmonics + 1)
    stiffness = ensemble.wet[LOADS[-1]].plane_strain_modulus * q0 * np.array(order) / 2
    displaced = [trace("profile", order, profile, hue=5)]
    pressed = [trace("full contact, slope 1 - 2H", order, stiffness**2 * profile / MODULUS**2, "dashed", hue=5)]
    for hue, load in enumerate(SPECTRA_AT):
        name, theory = f"{load:g} E*", ensemble.wet[load]
        displaced += _curves(_spectra(ensemble, "C_u", load), theory.displacement_power(q0), name, hue)
        stress = _spectra(ensemble, "C_sigma", load) / MODULUS**2
        pressed += _curves(stress, theory.pressure_power(q0) / MODULUS**2, name, hue)
    steep, ends = float(displaced[1].y[0] or 1.0), (3.0, 100.0)
    displaced.append(trace(f"the paper's slope {PAPERS}", ends, [steep * end**PAPERS for end in ends], "dashed", 5))
    yield drawn(
        "displacement-spectrum",
        f"Spectrum C_u of the displacement against the order. {HOW_DRAWN}",
        "$q/q_0$",
        "$C_u$ / m³",
        *displaced,
        log="xy",
    )
    yield drawn(
        "pressure-spectrum",
        f"Spectrum C_sigma over E*^2 of the pressure against the order. {HOW_DRAWN}",
        "$q/q_0$",
        r"$C_\sigma/E^{*2}$ / m",
        *pressed,
        log="xy",
    )
    groups = {hurst: group for hurst in HURSTS if (group := ensemble.whole(f"hurst {hurst:g}"))}
    if groups:
        series: list[Series] = []
        for hue, (hurst, group) in enumerate(groups.items()):
            series += _curves(
                np.array([followed(member) for member in group]), _area_by_order(group), f"H = {hurst:g}", hue
            )
        yield drawn(
            "short-wavelengths",
            "Part of the roughness that the solid follows, C_u / C, against the order, beside the theory's A(q)/A0: "
            f"level at short waves for H = 0.8, falling for H = 0.3. {HOW_DRAWN}",
            "$q/q_0$",
            "$C_u/C$",
            *series,
            log="xy",
        )


def _curves(power: FloatArray, theory: FloatArray, name: str, hue: int) -> list[Series]:
    """Return single realisations and mean with its error in bands of orders, and the theory."""
    bands, order = [banded(row) for row in power], range(1, power.shape[1] + 1)
    return [
        *scattered(bands, bands[0][0], [value for _, value in bands], f"{name}, ", hue)[:2],
        trace(f"{name}, Persson with adhesion", order, theory, hue=hue),
    ]
