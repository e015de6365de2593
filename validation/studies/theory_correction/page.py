"""The page for engineers: how much area, how certain, where not; and what was compared on the hold-out, as a case.

The numbers of the page are those of the calibration and of the hold-out alone; its figures show area and separation
before and after, with error bars of the ensembles.  Uncertainty of a contact fraction: the rms error over the hold-out
in its range of loads, without or with adhesion, which contains the scatter of the ensembles it was judged by.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from persson import adhesive_edges
from persson.contact_slope import contact_fractions, data
from persson.domain import in_words
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, marks, semilogx, shaded, trace
from validation.harness.schema import Cells, Figure, Reference, Row, Series, Table, Tolerance
from validation.references.paper_problem import RMS_SLOPE
from validation.studies.adhesive_edges import areas_of
from validation.studies.theory_correction.correction_members import Group
from validation.studies.theory_correction.hold_out import CALIBRATED, PLAIN, HeldOut, rms, rms_of, theories_of

CASE = "theory-correction"
BELOW, ABOVE = 0.002, 0.006  # E*, at the common rms slope: bounds of the ranges of loads
RANGES = (("low", 0.0, BELOW), ("middle", BELOW, ABOVE), ("high", ABOVE, 1.0))
AIM = 0.05  # of the area
SHOWN_LOADS = (0.01, 0.02, 0.05, 0.1, 0.18)  # p / (E* h'_rms)
SHOWN_HURSTS, SHOWN_BANDWIDTHS, SHOWN_THETAS = (0.3, 0.5, 0.7, 0.9), (30, 100, 300, 1000), (0.01, 0.03, 0.1)
QUESTION = (
    "Given the Hurst exponent, the bandwidth, the rms slope, the load and the adhesion of a profile rough in one "
    "direction: how large is the contact area, how certain is that, and where must it not be used?"
)
EQUATIONS = (
    "Use: persson.corrected.solve(spectrum, mean_pressure, youngs_modulus=E, poisson_ratio=nu, "
    "work_of_adhesion=gamma, correction=persson.corrected_data.calibrated()), with spectrum = "
    "persson.DiscreteSpectrum.self_affine(2 pi / longest wavelength, H, h_rms, bandwidth) or the measured lines. "
    r"Or read $A / A_0$ in the tables from $p / (E^\ast h'_{\text{rms}})$, $H$, bandwidth and "
    r"$\theta = \gamma / (E^\ast \sum_m q_m h_m^2 / 8)$, and its uncertainty in those of the hold-out. "
    "Area without adhesion by the slope over the contact (persson.contact_slope.contact_area, the same number). "
    r"With adhesion: $p = p_d(A) - T$, $1 / T = 1 / T_1 + c m / p_d$, "
    r"$T_1 = \sqrt{E^\ast \gamma \, n \tan(\pi A / 2)}$, with $p_d(A)$ the load of the same area without adhesion, "
    r"$n = \frac{q_0}{\pi} + n_{\text{rough}}$ edges per length, "
    r"$n_{\text{rough}} = k (1 - \sum_m w_m^2) \frac{2 A}{\pi} \int q \, d(-\ln A_q)$, $m = n_{\text{rough}} / n$. "
    r"Energy and separation without adhesion: $\tau = \int S \, dV$, "
    r"$S = [g + (1 - g) A^2] [1 - e^{-k n A / (1 - A)}]$, $g = c_0 b / (b + b_0)$, "
    r"$b = \ln q - \langle \ln q \rangle$, $n = q / q_1$; their changes by adhesion from the enthalpy. "
    "At zero and negative loads, down to the pull-off, persson.adhesive_edges.contact_area. "
    "Must not be used for: roughness in two directions or isotropic roughness; finite layers; unloading, which keeps "
    "more contact. Below the smallest contact fraction single realisations scatter by tens of per cent about any mean. "
)

GUARD = (
    " `outside_calibration` of the answer names what of this a case does not keep to; it is empty where all is kept."
)


def outcome(calibration: Mapping[str, Any], judged: Sequence[HeldOut], planned: int, short: bool) -> Outcome:
    """Rows, figures and tables of the page, from the content of the data file and the hold-out with its planned loads.

    `short` is the quick form, which shows that everything runs and judges nothing.
    """
    made = (_areas_without_adhesion(), _uncertainties_without_adhesion(), _areas(), _uncertainties_with_adhesion())
    of_judged = (_uncertainties(judged), _aims(judged), _coefficients(calibration), _by_kind(judged), _all(judged))
    counts = {"loads judged": len(judged), "loads planned": planned, "without a state": planned - len(judged)}
    return Outcome(tuple(_rows(judged, short)), tuple(figures_of(judged)), (*made, *of_judged), counts)


def case_of(compute: Callable[[], Outcome], domain: Mapping[str, Any]) -> Case:
    """The page as a case of a report; `domain` as in the calibration."""
    return Case(id=CASE, group="correction of the theory", level="full",
                question=QUESTION,
                equations=EQUATIONS + in_words(domain) + GUARD,
                sources=("carbone2009", "persson2001", "yang2008", "almqvist2011", "wang2017", "dapp2014",
                "yastrebov2017"), compute=compute,
                effects=("half_space", "adhesion", "pressure_distribution"))  # fmt: skip


# what is judged: its error in words, and by adhesion what was measured on the full hold-out and what is accepted again
JUDGED: dict[str, tuple[str, dict[bool, tuple[float, float]]]] = {
    "area": ("rms relative error over the hold-out", {False: (0.047, 0.09), True: (0.117, 0.2)}),
    "separation": ("rms relative error over the hold-out", {False: (0.111, 0.2), True: (0.125, 0.2)}),
    "pressure distribution": (
        "rms over the hold-out of the largest distance of the shares above a pressure, over the area",
        {False: (0.072, 0.13), True: (0.125, 0.25)},
    ),
}
ADHESION = {False: "without adhesion", True: "with adhesion"}
SHORT = {False: "without", True: "with adhesion"}


def _rows(judged: Sequence[HeldOut], short: bool) -> Iterator[Row]:
    for (adhesive, words), (quantity, (error, limits)) in product(ADHESION.items(), JUDGED.items()):
        some = chosen(judged, adhesive)
        plain, found = (rms_of(some, quantity, theory) if some else np.nan for theory in (PLAIN, CALIBRATED))
        measured, accepted = limits[adhesive]
        yield Row(
            quantity=f"{quantity} {words}, calibrated: {error} (plain theory {plain:.3f})",
            unit="1",
            reference=Reference(kind="independent code", source="boundary-element ensembles of the hold-out"),
            norm="absolute",
            expected=[0.0],
            computed=[known(found)],
            tolerance=Tolerance(value=accepted, measured=measured),
            pinned="unconverged",
            status="not run" if short else "run",
            message="short form: it judges nothing" if short else "",
        )


def _areas_without_adhesion() -> Table:
    loads = np.array(SHOWN_LOADS) * RMS_SLOPE
    rows: list[Cells] = []
    for hurst, bandwidth in product(SHOWN_HURSTS, SHOWN_BANDWIDTHS):
        area, _ = contact_fractions(Group("fit", "self-affine", hurst, bandwidth, 0.0, 1).lines, loads)
        rows.append([hurst, bandwidth, *(round(float(value), 4) for value in area)])
    return Table(
        caption="Without adhesion, what to expect: contact fraction A/A0 by the slope over the contact "
        "(persson.contact_slope.contact_area, which takes any lines), for p/(E* h'_rms) as in the heads of the "
        "columns; self-affine, no roll-off.",
        columns=["H", "bandwidth", *(f"{load:g}" for load in SHOWN_LOADS)],
        rows=rows,
    )


def _uncertainties_without_adhesion() -> Table:
    stored = data()
    return Table(
        caption="Without adhesion, how certain: rms relative error of that area on its own hold-out, with the noise of "
        f"the ensembles. {in_words(stored['domain'])} `outside` of the answer names what a case does not keep to.",
        columns=["spectra", "loads", "area, rms", "noise of the ensembles, rms"],
        rows=[[name, one["loads"], one["error"], one["noise"]] for name, one in stored["hold_out"]["rms"].items()],
    )


def _uncertainties_with_adhesion() -> Table:
    stored = adhesive_edges.data()
    return Table(
        caption="With adhesion, how certain: rms relative error on two hold-outs of pairs, of the area and of the area "
        "where that without adhesion is given; the noise of the ensembles in both. "
        f"{in_words(stored['domain'])} `outside` of the answer names what a case does not keep to.",
        columns=["spectra", "loads", "area, rms", "noise of it", "area for given area without adhesion, rms",
                 "noise of it"],
        rows=[[f"{which}: {name}", one["loads"], one["area"], one["area_noise"], one["ratio"], one["ratio_noise"]]
              for which, part in (("first", "hold_out"), ("second", "second_hold_out"))
              for name, one in stored[part]["rms"].items()],
    )  # fmt: skip


def _areas() -> Table:
    loads = np.array(SHOWN_LOADS)
    rows: list[Cells] = []
    for hurst, bandwidth in product(SHOWN_HURSTS, SHOWN_BANDWIDTHS):
        for theta in SHOWN_THETAS:
            lines = Group("fit", "self-affine", hurst, bandwidth, theta, 1).lines
            rows.append([theta, hurst, bandwidth, *(round(float(a), 4) for a in areas_of(lines, loads, theta))])
    rows.sort(key=lambda row: [float(value or 0) for value in row[:3]])
    return Table(
        caption="With adhesion, what to expect: A/A0 by the edges of the contact, for p/(E* h'_rms) as in the "
        "heads of the columns; self-affine, no roll-off, bandwidth = longest over shortest wavelength, "
        "theta = gamma / (E* sum q_m h_m^2 / 8).",
        columns=["theta", "H", "bandwidth", *(f"{load:g}" for load in SHOWN_LOADS)],
        rows=rows,
    )


def _uncertainties(judged: Sequence[HeldOut]) -> Table:
    rows: list[Cells] = []
    for adhesive, (name, low, high) in product(ADHESION, RANGES):
        if some := chosen(judged, adhesive, low, high):
            found = [one.area[CALIBRATED] for one in some]
            over = f"{name}: {low / RMS_SLOPE:.3f} to {min(high, 0.05) / RMS_SLOPE:.3f}"
            rows.append([SHORT[adhesive], over, len(some), rms_of(some, "area", PLAIN), rms(found),
                         float(np.mean(found)), float(np.max(np.abs(found))), float(np.mean(np.abs(found) < AIM)),
                         rms([one.area_noise for one in some])])  # fmt: skip
    return Table(
        caption="How certain: relative error of the contact fraction on the hold-out; the rms column is the standard "
        "uncertainty to be used. Part of it is the noise of the ensembles it was judged by, in the last column.",
        columns=["adhesion", "p/(E* h'_rms)", "loads", "plain theory, rms", "calibrated, rms", "mean", "largest",
                 f"share within {AIM:g}", "noise of the ensembles, rms"],
        rows=rows
    )  # fmt: skip


def _aims(judged: Sequence[HeldOut]) -> Table:
    rows: list[Cells] = []
    for adhesive, words in ADHESION.items():
        if not (some := chosen(judged, adhesive)):
            continue
        rows.append(_aim(f"area {words}: rms error at most {AIM:g}", rms_of(some, "area", CALIBRATED), AIM))
        within = float(np.mean([abs(one.area[CALIBRATED]) < max(AIM, 2 * one.area_noise) for one in some]))
        rows.append([f"area {words}: share within {AIM:g} or two standard errors of the ensemble", within, ""])
        parts = ((name, chosen(judged, adhesive, low, high)) for name, low, high in RANGES)
        rows += [
            _aim(f"area {words}, {name} loads: rms error", rms_of(part, "area", CALIBRATED), AIM)
            for name, part in parts
            if part
        ]
        before, after = (rms_of(some, "separation", theory) for theory in (PLAIN, CALIBRATED))
        rows.append(_aim(f"separation {words}: rms error no worse than {before:.3f}", after, before))
    return Table(
        caption="What was aimed at, and what came of it on the hold-out.", columns=["aim", "found", ""], rows=rows
    )


def _aim(words: str, found: float, most: float) -> Cells:
    return [words, found, "met" if found <= most else "not met"]


def _coefficients(calibration: Mapping[str, Any]) -> Table:
    values, errors = calibration["coefficients"], calibration["standard_errors"]
    return Table(
        caption="Coefficients and standard errors (jackknife over the Hurst exponents).",
        columns=["coefficient", "value", "standard error"],
        rows=[[name, values[name], errors[name]] for name in values],
    )


def _by_kind(judged: Sequence[HeldOut]) -> Table:
    rows: list[Cells] = []
    for adhesive, kind in sorted({(one.adhesive, one.kind) for one in judged}):
        some = [one for one in judged if (one.adhesive, one.kind) == (adhesive, kind)]
        rows += [
            [SHORT[adhesive], kind, name, len(some), rms_of(some, "area", name),
             known(rms_of(some, "separation", name)), known(rms_of(some, "pressure distribution", name)),
             rms([one.area_noise for one in some])]
            for name in theories_of(some)
        ]  # fmt: skip
    return Table(
        caption="Before and after on the hold-out, rms: relative error of the area, relative error of the separation, "
        "largest distance of the distributions over the area; the noise of the ensembles beside them.",
        columns=["adhesion", "spectrum", "theory", "loads", "area", "separation", "distribution", "noise of the area"],
        rows=rows,
    )


def _all(judged: Sequence[HeldOut]) -> Table:
    return Table(
        caption="Every load of the hold-out: means of the ensembles with standard errors, relative errors of the area, "
        "separations in rms heights, largest distances of the distributions over the area.",
        columns=["group", "p/E*", "realisations", "A/A0", "standard error", "plain", "calibrated", "s/h_rms",
                 "standard error of s", "s plain", "s calibrated", "distance plain", "distance calibrated",
                 "noise of the distance", "remark"],
        rows=[[one.group, one.load, one.realisations, one.contact_fraction, one.contact_fraction * one.area_noise,
               one.area[PLAIN], one.area[CALIBRATED], one.separation, known(one.separation_noise),
               known(one.separations.get(PLAIN, np.nan)), known(one.separations.get(CALIBRATED, np.nan)),
               one.distribution[PLAIN], one.distribution[CALIBRATED], known(one.distribution_noise), one.remark]
              for one in judged]
    )  # fmt: skip


def chosen(judged: Sequence[HeldOut], adhesive: bool, low: float = 0.0, high: float = 1.0) -> list[HeldOut]:
    """Those without or with adhesion at loads in [low, high)."""
    return [one for one in judged if one.adhesive == adhesive and low <= one.load < high]


def figures_of(judged: Sequence[HeldOut]) -> list[Figure]:
    """Two figures without adhesion, and two with it where it was judged."""
    figures = []
    for adhesive in (False, True):
        some = chosen(judged, adhesive)
        if not some:
            continue
        words = "with" if adhesive else "without"
        at = [one.contact_fraction for one in some]
        figures.append(
            drawn(f"landing-correction-{words}-adhesion",
                  f"Hold-out {words} adhesion: contact fraction by the plain and the corrected theory against "
                  "that of the ensembles; below the relative errors with two standard errors of the ensembles.",
                  loglog("contact fraction of the ensembles", "of the theory",
                         marks("calibrated", at, _times(some, CALIBRATED)),
                         marks("plain theory", at, _times(some, PLAIN)),
                         trace("equal", [min(at), max(at)], [min(at), max(at)])),
                  semilogx("contact fraction of the ensembles", "relative error",
                           marks("calibrated", at, [one.area[CALIBRATED] for one in some]),
                           marks("plain theory", at, [one.area[PLAIN] for one in some]), _noise(some))),
        )  # fmt: skip
        figures.append(_separation_figure(some, words))
    return figures


def _separation_figure(some: Sequence[HeldOut], words: str) -> Figure:
    ordered = sorted(some, key=lambda one: one.separation)
    at = [one.separation for one in ordered]
    noise = [known(2 * one.separation_noise / one.separation) for one in ordered]
    return drawn(f"correction-separation-{words}-adhesion",
                 f"Hold-out {words} adhesion: relative error of the separation, before and after, with two standard "
                 "errors of the ensembles.",
                 semilogx("separation of the ensembles / h_rms", "relative error",
                          *(
                              marks(name, at,
                                    [known(one.separations.get(name, np.nan) / one.separation - 1) for one in ordered])
                              for name in (CALIBRATED, PLAIN)
                          ),
                          _two_errors(at, noise)))  # fmt: skip


def _times(some: Sequence[HeldOut], name: str) -> list[float | None]:
    return [one.contact_fraction * (1 + one.area[name]) for one in some]


def _noise(some: Sequence[HeldOut]) -> Series:
    ordered = sorted(some, key=lambda one: one.contact_fraction)
    return _two_errors([one.contact_fraction for one in ordered], [2 * one.area_noise for one in ordered])


def _two_errors(at: Sequence[float], noise: Sequence[float | None]) -> Series:
    """On either side of zero."""
    return shaded("two standard errors", at, [None if value is None else -value for value in noise], noise)


def known(value: float) -> float | None:
    """A finite number as it is, any other as None."""
    return float(value) if np.isfinite(value) else None
