"""Hard cases of Persson's theory: one line and ten thousand, steep and flat spectra, vanishing loads, much adhesion.

The expectation stands here beforehand: the status of the result, or `refused: ARGUMENT` where an error that names the
argument is the right answer.  The full form doubles the resolution and takes the finest spectra.  Correct means: both
routes of the diffusion, each with its own fixed point, agree; without adhesion the closed form erf is met; adhesion
adds area and takes away separation, which is not negative.  SI units.
"""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from scipy.special import erf

import persson
from persson.spectrum import Spectrum
from validation.corpus.hard.hard_case_run import Answered, Asked, Check
from validation.corpus.hard.hard_case_scenes import MODULUS, WORK
from validation.references.paper_problem import PERIOD, RMS_HEIGHT, Table

ROUTES = 4e-5  # of the contact fraction, between the routes; measured 1.6e-5 for one line, 2.4e-7 for the paper's
CLOSED_FORM = 1e-12  # of the contact fraction without adhesion; measured 2e-16
SEPARATION = 3e-4  # of h_rms; 1e-4 is what the default resolution states
FIRST = 2 * np.pi / PERIOD  # rad/m
PLANE_STRAIN = MODULUS / 0.75
SOLID: Table = {"youngs_modulus": MODULUS, "poisson_ratio": 0.5}


def spectrum_of(question: Table) -> Spectrum:
    """The spectrum of a question: so many lines, or continuous over so many decades."""
    if "decades" in question:
        highest = FIRST * 10 ** question["decades"]
        return persson.ContinuousSpectrum.self_affine(FIRST, highest, question["hurst"], question["h_rms"])
    return persson.DiscreteSpectrum.self_affine(FIRST, question["hurst"], question["h_rms"], question["lines"])


def solved(question: Table, **given: Any) -> Any:
    """The theory of a question, with other arguments beside it."""
    material = SOLID | {"work_of_adhesion": question["work"], "resolution": question["resolution"]}
    return persson.solve(spectrum_of(question), question["pressure"] * PLANE_STRAIN, **material, **given)


def without_adhesion(found: Answered) -> Iterator[str]:
    """The contact fraction of the closed form: erf(sqrt 2 sigma_0 / (E* h'_rms)); adhesion adds area to it."""
    spectrum, pressure, result = spectrum_of(found.tables), found.tables["pressure"] * PLANE_STRAIN, found.result
    dry = persson.solve_nonadhesive(spectrum, pressure, **SOLID)
    exact = float(erf(np.sqrt(2) * pressure / (PLANE_STRAIN * spectrum.slope_rms)))
    error = abs(dry.contact_fraction - exact)
    if not error <= CLOSED_FORM * exact:
        yield f"contact fraction off by {error:.1e} from the closed form"
    if isinstance(result, persson.AdhesiveContact):
        if not result.contact_fraction >= dry.contact_fraction * (1 - ROUTES):
            yield f"adhesion takes away area: {result.contact_fraction:.6g} of {dry.contact_fraction:.6g}"
        error = SEPARATION * spectrum.h_rms
        least = -np.inf if result.status in ("branches", "below_zero") else -error  # then the status says so
        if result.separation is None or not least <= result.separation <= dry.separation + error:
            yield f"separation {result.separation} above {dry.separation} without adhesion, or negative"


def other_route(found: Answered) -> Iterator[str]:
    """The contact fraction of the other route, which only adhesion has."""
    if isinstance(found.result, persson.AdhesiveContact):
        other = solved(found.tables, route="volterra", with_separation=False)
        fraction = found.result.contact_fraction
        apart = abs(fraction - other.contact_fraction)
        if not apart <= ROUTES * fraction:
            yield f"routes differ by {apart:.1e} in a contact fraction of {fraction:.4g}"


CHECKS: dict[str, Check] = {check.__name__: check for check in (without_adhesion, other_route)}


class PerssonCase(Asked):
    """A hard case of the theory: a spectrum, the pressure over E*, and the work of adhesion."""

    refusals: ClassVar[tuple[type[Exception], ...]] = (ValueError,)
    known: ClassVar[Mapping[str, Check]] = CHECKS
    forms: ClassVar[tuple[Table, Table]] = ({"resolution": 1.0}, {"resolution": 2.0})

    @staticmethod
    def ask(question: Table) -> Any:
        """The theory by its first route."""
        return solved(question)


def _case(
    name: str, reason: str, pressure: float, *expected: str, work: float | None = WORK, full: int = 0, **spectrum: float
) -> PerssonCase:
    """A case; by default it converges, with 125 lines in both forms, H = 0.7, and the rms height of the paper."""
    usual = {"hurst": 0.7, "h_rms": RMS_HEIGHT} | ({} if "decades" in spectrum else {"lines": 125})
    question = usual | spectrum | {"pressure": pressure, "work": work}
    more: Table = {"lines": full} if full else {}
    return PerssonCase(name, reason, question, tuple(CHECKS), expected or ("converged",), more)


def _persson_cases() -> Iterator[PerssonCase]:
    complete, no_load = "complete_contact", "refused: mean_pressure"
    yield _case("one_line", "the theory needs roughness on many scales", 0.02, "single_line", lines=1)
    yield _case("one_line_without_adhesion", "the same without adhesion", 0.02, "single_line", work=None, lines=1)
    yield _case("two_lines", "hardly a diffusion", 0.02, lines=2)
    yield _case("ten_thousand_lines", "10^4 lines", 0.02, lines=1000, full=10_000)
    yield _case("five_decades", "a continuous spectrum", 0.02, decades=3, hurst=0.8)
    yield _case("tiny_load", "area proportional to the load down to 1e-7", 1e-8, full=1000)
    yield _case("tiny_load_without_adhesion", "the same", 1e-12, work=None, full=1000)
    yield _case("nearly_complete_contact", "1e-5 of the area is missing", 0.3)
    yield _case("complete_contact", "1e-12 is missing", 0.5, complete)
    yield _case("complete_contact_without_adhesion", "the same", 2.0, complete, work=None)
    yield _case("no_load", "the separation diverges", 0.0, no_load)
    yield _case("tension", "no answer in tension", -0.01, no_load)
    yield _case("nan_load", "not a number", np.nan, no_load)
    yield _case("much_adhesion", "contact persists at zero load", 1e-3, "branches", work=10.0)
    for hurst in (0.01, 0.3, 0.99):
        yield _case(f"hurst_{hurst:g}", "flat and steep spectra", 0.02, hurst=hurst, full=1000)
    for work, status in {1e-8: "converged", 1e-4: "converged", 1.0: "below_zero", 1e2: complete}.items():
        yield _case(f"work_{work:g}", "hardly any adhesion to far too much", 0.02, status, work=work)
    for height, status in {1e-9: complete, 1e-7: complete, 1e-5: "below_zero", 1e-3: "converged"}.items():
        yield _case(f"rms_height_{height:g}", "nm to mm", 0.02 * height / RMS_HEIGHT, status, h_rms=height)


PERSSON_CASES: tuple[PerssonCase, ...] = tuple(_persson_cases())
