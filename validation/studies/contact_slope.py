"""Area without adhesion from the slope over the contact: ensembles, the five coefficients, and the hold-out.

The plan is the data file of the theory (persson/contact_slope.json): spectra, loads, realisations by seed root, of the
fit and of the hold-out.  Phases are independent between groups: the seed is (root, name of the group, realisation).
The fit minimises ln(A_theory / A_ensemble) over the standard error of the mean and `FLOOR`, at contact fractions from
`LEAST`; the hold-out enters no fit.  Writes contact-slope.json: what was found beside what the package has.
Limits: half-space, no adhesion; some minutes of one core.
"""

import zlib
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from persson.contact_slope import contact_fractions, data
from persson.spectrum import DiscreteSpectrum
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Found
from validation.harness.ensemble import Member, results_of
from validation.harness.figure_data import drawn, marks, semilogx, table
from validation.harness.rows import Against
from validation.harness.schema import Row, Table
from validation.references import paper_problem
from validation.references.paper_problem import MODULUS, PERIOD, RMS_SLOPE
from validation.studies.bench import Bench, study_case

SCHEMA = "linecontact-contact-slope-study/1"
FILE = "contact-slope.json"
SHORT = {"self-affine": "sa", "roll-off": "ro", "band": "nb", "gaussian": "ga", "lines": "li"}
LEAST, FLOOR, QUICK = 0.02, 0.015, 2
SAME = 0.1  # of a rms miss: within it ensembles of the same seeds give again what is stored
QUICK_HARMONICS = 10

Group = Mapping[str, Any]
Areas = dict[str, tuple[Group, FloatArray, FloatArray]]


def shape_of(group: Group) -> tuple[FloatArray, FloatArray]:
    """Orders and heights, without scale, of the lines of a group, (n_lines,) each.

    Examples
    --------
    >>> shape_of({"spectrum": "band", "parameters": [2, 4]})[0].tolist()
    [2.0, 3.0, 4.0]
    """
    kind, given = group["spectrum"], group["parameters"]
    if kind == "lines":
        order = np.array(given[0], dtype=np.float64)
        return order, order ** -given[1]
    order = np.arange(given[0] if kind == "band" else 1, given[-1] + 1.0)
    if kind == "self-affine":
        return order, order ** -(given[0] + 0.5)
    if kind == "roll-off":
        return order, np.maximum(order, given[0]) ** -(given[1] + 0.5)
    if kind == "gaussian":
        return order, np.exp(-((order / given[0]) ** 2) / 2)
    if kind == "band":
        return order, 1 / order
    raise ValueError(f"spectrum: {kind!r} is not one of {', '.join(SHORT)}")


def name_of(group: Group) -> str:
    """Of its members, without root and number."""
    return "-".join([SHORT[group["spectrum"]], *map(str, group["parameters"])]).replace(" ", "")


def lines_of(group: Group) -> DiscreteSpectrum:
    """The lines of a group, with the rms slope that all share."""
    order, height = shape_of(group)
    wavenumber = 2 * np.pi / PERIOD * order
    return DiscreteSpectrum(wavenumber, height * RMS_SLOPE / np.sqrt(np.sum((wavenumber * height) ** 2) / 2))


def member(group: Group, loads: FloatArray, root: int, k: int) -> Member:
    """Realisation k of a seed root, at loads over E* h'_rms."""
    order, _ = shape_of(group)
    seed = [root, zlib.crc32(name_of(group).encode()), k]
    phases = np.random.default_rng(seed).uniform(-np.pi, np.pi, order.size)
    scene = paper_problem.scene(
        f"slope over the contact: {name_of(group)}, realisation {k} of root {root}",
        paper_problem.lines(order, lines_of(group).amplitudes, phases),
        {"control": "mean_pressure", "targets": (loads * RMS_SLOPE * MODULUS).tolist()},
        accuracy={"tolerance": 1e-3},
    )
    return Member(f"{name_of(group)}-{root}-{k:03d}", scene)


def cases(bench: Bench) -> list[Case]:
    """The case of the study; quick: two realisations of the small groups, which shows that everything runs."""
    return [
        study_case("area-from-the-slope", partial(_judged, bench),
                   "Which coefficients give the area without adhesion, and how far off is it on a hold-out?",
                   r"$\ln (A_{\text{theory}} / A_{\text{ensemble}})$ at contact fractions from 0.02", "persson2001",
                   "half_space")
    ]  # fmt: skip


def _judged(bench: Bench) -> Found:
    found = {part: _areas(bench, part) for part in ("fit", "hold_out")}
    packaged, loads = data()["coefficients"], np.array(data()["hold_out"]["loads_over_E*h'"])
    coefficients = fitted(found["fit"], np.array(data()["fit"]["loads_over_E*h'"]))
    judged = {name: misses({name: one}, loads, packaged) for name, one in found["hold_out"].items()}
    by_package = rms(np.concatenate(list(judged.values())))
    held = {
        name: {"areas": area.tolist(), "relative_errors": error.tolist(), "misses": judged[name].tolist()}
        for name, (_, area, error) in found["hold_out"].items()
    }
    bench.write(FILE, SCHEMA, coefficients=coefficients, hold_out_rms_of_the_package=by_package,
                hold_out_rms_of_these=rms(misses(found["hold_out"], loads, coefficients)), hold_out=held)  # fmt: skip
    yield hold_out_row({"area": by_package}, [data()["hold_out"]["rms"]["all"]["error"]], bench.quick)
    curves = [marks(name, area[area > LEAST], judged[name]) for name, (_, area, _) in found["hold_out"].items()]
    yield drawn("landing-hold-out", "Hold-out: the theory with the coefficients of the package over the ensembles.",
                semilogx("contact fraction of the ensemble", "ln (theory / ensemble)", *curves))  # fmt: skip
    yield coefficient_table(coefficients, packaged)


def hold_out_row(found: Mapping[str, float], stored: Sequence[float], quick: bool) -> Row:
    """Rms misses of the package on its hold-outs, the same seeds again, beside those that its data file states."""
    row = Against("self", "what the data file of the theory states").row(
        f"rms miss on the hold-out: {', '.join(found)}", "", stored, found.values(), None, required=SAME,
        pinned="unconverged")  # fmt: skip
    judges_nothing = {"status": "not run", "message": "short form: it judges nothing"}
    return row.model_copy(update=judges_nothing if quick else {})


def coefficient_table(found: Mapping[str, float], packaged: Mapping[str, float]) -> Table:
    """Coefficients beside those of the package."""
    stored = [packaged[name] for name in found]
    return table("Coefficients.", {"coefficient": found, "found": found.values(), "in the package": stored})


def _areas(bench: Bench, part: str) -> Areas:
    """Mean areas and their errors of the groups of a part of the plan."""
    plan = data()[part]
    loads, roots = np.array(plan["loads_over_E*h'"]), plan["seed_roots"]
    groups = [group for group in plan["groups"] if not bench.quick or shape_of(group)[0][-1] <= QUICK_HARMONICS]
    members = {
        name_of(group): [
            member(group, loads, root, k)
            for root, count in zip(roots, group["realisations"], strict=True)
            for k in range(min(count, QUICK) if bench.quick else count)
        ]
        for group in groups
    }
    results = results_of(members, bench.folder / part, bench.jobs, bench.say, bench.opener)
    found: Areas = {}
    for group in groups:
        areas = np.array([[s.contact_fraction for s in result.targets] for result in results[name_of(group)]])
        error = areas.std(axis=0, ddof=1) / np.sqrt(len(areas)) / areas.mean(axis=0)
        found[name_of(group)] = group, areas.mean(axis=0), error
    return found


def fitted(ensembles: Areas, loads: FloatArray) -> dict[str, float]:
    """The five coefficients by least squares from those of the package; ArithmeticError where they do not converge."""
    weighted = partial(misses, ensembles, loads, weighted=True)
    return fitted_from(data()["coefficients"], weighted, diff_step=1e-3, xtol=1e-6, ftol=1e-8)


def fitted_from(
    start: Mapping[str, float], residual: Callable[[dict[str, float]], FloatArray], **accuracy: float
) -> dict[str, float]:
    """Coefficients by least squares; ArithmeticError where they do not converge."""

    def at(values: FloatArray) -> FloatArray:
        return residual(dict(zip(start, values.tolist(), strict=True)))

    answer = least_squares(at, list(start.values()), **accuracy)
    if not answer.success:
        raise ArithmeticError(f"coefficients {', '.join(start)}: {answer.message}")
    return dict(zip(start, map(float, answer.x), strict=True))


def misses(
    ensembles: Areas, loads: FloatArray, coefficients: Mapping[str, float], weighted: bool = False
) -> FloatArray:
    """ln(A_theory / A_ensemble) at contact fractions from `LEAST`, over its error if weighted."""
    found = []
    for group, area, error in ensembles.values():
        theory = contact_fractions(lines_of(group), loads * RMS_SLOPE, coefficients)[0]
        miss = np.log(theory / area) / (np.hypot(error, FLOOR) if weighted else 1.0)
        found.append(miss[area > LEAST])
    return np.concatenate(found)


def rms(values: FloatArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
