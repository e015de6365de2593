"""Hard cases of Persson's theory: one line and ten thousand, steep and flat spectra, vanishing loads, much adhesion.

The expectation stands here beforehand: the status of the result, or `refused: ARGUMENT` where an error that names the
argument is the right answer.  The full form doubles the resolution and takes the finest spectra.  Correct means: both
routes of the diffusion, each with its own fixed point, agree; without adhesion the closed form erf is met; adhesion
adds area and takes away separation, which is not negative.  SI units.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.special import erf

import persson
from persson.spectrum import Spectrum
from validation.corpus.hard.hard_case_run import Asked, TrialOutcome, ended
from validation.corpus.hard.hard_case_scenes import MODULUS, WORK
from validation.references.paper_problem import PERIOD, RMS_HEIGHT, Table

ROUTES = 4e-5  # of the contact fraction, between the routes; measured 1.6e-5 for one line, 2.4e-7 for the paper's
CLOSED_FORM = 1e-12  # of the contact fraction without adhesion; measured 2e-16
SEPARATION = 3e-4  # of h_rms; 1e-4 is what the default resolution states
FIRST = 2 * np.pi / PERIOD  # rad/m
PLANE_STRAIN = MODULUS / 0.75


@dataclass(frozen=True)
class PerssonCase(Asked):
    """A hard case of the theory."""

    id: str
    reason: str
    spectrum: Table  # hurst, h_rms and either `lines` or `decades` (a continuous spectrum)
    pressure: float  # over E*
    work: float | None = WORK  # J/m^2


def lines(number: int, hurst: float = 0.7, h_rms: float = RMS_HEIGHT) -> Table:
    """A discrete spectrum."""
    return {"lines": number, "hurst": hurst, "h_rms": h_rms}


def _persson_cases() -> list[PerssonCase]:
    more: Table = {"lines": 1000}
    cases = [
        PerssonCase("one_line", "the theory needs roughness on many scales", lines(1), 0.02, expected="single_line"),
        PerssonCase(
            "one_line_without_adhesion", "the same without adhesion", lines(1), 0.02, None, expected="single_line"
        ),
        PerssonCase("two_lines", "hardly a diffusion", lines(2), 0.02),
        PerssonCase("ten_thousand_lines", "10^4 lines", lines(1000), 0.02, full={"lines": 10_000}),
        PerssonCase("five_decades", "a continuous spectrum", {"decades": 3, "hurst": 0.8, "h_rms": RMS_HEIGHT}, 0.02),
        PerssonCase("tiny_load", "area proportional to the load down to 1e-7", lines(125), 1e-8, full=more),
        PerssonCase("tiny_load_without_adhesion", "the same", lines(125), 1e-12, None, full=more),
        PerssonCase("nearly_complete_contact", "1e-5 of the area is missing", lines(125), 0.3),
        PerssonCase("complete_contact", "1e-12 is missing", lines(125), 0.5, expected="complete_contact"),
        PerssonCase(
            "complete_contact_without_adhesion", "the same", lines(125), 2.0, None, expected="complete_contact"
        ),
        PerssonCase("no_load", "the separation diverges", lines(125), 0.0, expected="refused: mean_pressure"),
        PerssonCase("tension", "no answer in tension", lines(125), -0.01, expected="refused: mean_pressure"),
        PerssonCase("nan_load", "not a number", lines(125), np.nan, expected="refused: mean_pressure"),
        PerssonCase("much_adhesion", "contact persists at zero load", lines(125), 1e-3, 10.0, expected="branches"),
    ]
    cases += [
        PerssonCase(f"hurst_{hurst:g}", "flat and steep spectra", lines(125, hurst), 0.02, full=more)
        for hurst in (0.01, 0.3, 0.99)
    ]
    cases += [
        PerssonCase(f"work_{work:g}", "hardly any adhesion to far too much", lines(125), 0.02, work, expected=expected)
        for work, expected in ((1e-8, "converged"), (1e-4, "converged"), (1.0, "below_zero"), (1e2, "complete_contact"))
    ]
    heights = {1e-9: "complete_contact", 1e-7: "complete_contact", 1e-5: "below_zero", 1e-3: "converged"}
    return cases + [
        PerssonCase(f"rms_height_{height:g}", "nm to mm", lines(125, h_rms=height), 0.02 * height / RMS_HEIGHT,
                    expected=expected)
        for height, expected in heights.items()
    ]  # fmt: skip


PERSSON_CASES: tuple[PerssonCase, ...] = tuple(_persson_cases())


def run_case(case: PerssonCase, full: bool = False) -> TrialOutcome:
    """Solve a hard case of the theory by its first route and judge it."""
    spectrum, pressure = spectrum_of(case.changed(case.spectrum, full)), case.pressure * PLANE_STRAIN
    solid: Table = {"youngs_modulus": MODULUS, "poisson_ratio": 0.5}
    given: Table = solid | {"work_of_adhesion": case.work, "resolution": 2.0 if full else 1.0}

    def judge(found: persson.AdhesiveContact | persson.NonadhesiveContact) -> list[str]:
        dry = persson.solve_nonadhesive(spectrum, pressure, **solid)
        findings = without_adhesion(spectrum, pressure, dry)
        if isinstance(found, persson.AdhesiveContact):
            other = persson.solve(spectrum, pressure, route="volterra", with_separation=False, **given)
            assert isinstance(other, persson.AdhesiveContact)
            findings += judged(found, other, dry)
        return findings

    solve = partial(persson.solve, spectrum, pressure, **given)
    return ended(case.id, (case.expected,), solve, (ValueError,), judge)


def spectrum_of(table: Table) -> Spectrum:
    """The spectrum of a case."""
    if "decades" in table:
        highest = FIRST * 10 ** table["decades"]
        return persson.ContinuousSpectrum.self_affine(FIRST, highest, table["hurst"], table["h_rms"])
    return persson.DiscreteSpectrum.self_affine(FIRST, table["hurst"], table["h_rms"], table["lines"])


def without_adhesion(spectrum: Spectrum, pressure: float, found: persson.NonadhesiveContact) -> list[str]:
    """The contact fraction of the closed form: erf(sqrt 2 sigma_0 / (E* h'_rms))."""
    exact = float(erf(np.sqrt(2) * pressure / (PLANE_STRAIN * spectrum.slope_rms)))
    error = abs(found.contact_fraction - exact)
    return [] if error <= CLOSED_FORM * exact else [f"contact fraction off by {error:.1e} from the closed form"]


def judged(
    found: persson.AdhesiveContact, other: persson.AdhesiveContact, dry: persson.NonadhesiveContact
) -> list[str]:
    """What the other route and the theory without adhesion say against a state."""
    findings = []
    apart = abs(found.contact_fraction - other.contact_fraction)
    if not apart <= ROUTES * found.contact_fraction:
        findings.append(f"routes differ by {apart:.1e} in a contact fraction of {found.contact_fraction:.4g}")
    if not found.contact_fraction >= dry.contact_fraction * (1 - ROUTES):
        findings.append(f"adhesion takes away area: {found.contact_fraction:.6g} of {dry.contact_fraction:.6g}")
    error = SEPARATION * found.spectrum.h_rms
    least = -np.inf if found.status in ("branches", "below_zero") else -error  # then the status says so
    if found.separation is None or not least <= found.separation <= dry.separation + error:
        findings.append(f"separation {found.separation} above {dry.separation} without adhesion, or negative")
    return findings
