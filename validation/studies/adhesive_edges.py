"""Area with adhesion from the edges of the contact: pairs of ensembles, the two coefficients, and the hold-outs.

The plan is the data file of the theory (persson/adhesive_edges.json): spectra, loads, works of adhesion (theta, over
the elastic energy of full contact), realisations and seed root, of the fit and of two hold-outs.  Every realisation is
solved without and with adhesion on the same phases, which are independent between groups (contact_slope.py).  What is
compared is the mean area with adhesion; the theory takes that without adhesion from the same realisations (its law
p_d(A) is moved onto it, at every load), so that what both share cancels, and for the area alone from contact_slope.py.
Errors are those of a jackknife over the realisations (`left_out`: those that the solver did not finish).  The fit
minimises ln(A_theory / A_ensemble) over the error and `FLOOR`; the hold-outs enter no fit.  Writes adhesive-edges.json.
Limits: half-space, loading; three hours of one core.
"""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from bem.scene.result import Result
from persson.adhesive_edges import EdgeLaw, data
from persson.contact_slope import contact_fractions
from persson.domain import groups_of, outside
from persson.spectrum import DiscreteSpectrum
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Found
from validation.harness.ensemble import Member, results_of
from validation.harness.figure_data import table
from validation.references.paper_problem import MODULUS, RMS_SLOPE, up_to
from validation.studies import contact_slope
from validation.studies.bench import Bench, study_case
from validation.studies.contact_slope import coefficient_table, fitted_from, hold_out_row, lines_of, name_of, rms

SCHEMA = "linecontact-adhesive-edges-study/1"
PARTS = ("fit", "hold_out", "second_hold_out")
FILE = "adhesive-edges.json"
FLOOR, QUICK = 0.02, 2
SAME_LOAD, DEEPEST = 1e-7, 1e-4  # of E*; separation in rms heights, before which the load stops the path

Group = Mapping[str, Any]


def member(group: Group, loads: FloatArray, root: int, k: int, theta: float) -> Member:
    """Realisation k of a seed root, at loads over E* h'_rms, with adhesion theta or (0) without."""
    dry = contact_slope.member(group, loads[loads <= group.get("loads_up_to", np.inf)], root, k)
    if theta == 0:
        return Member(f"{dry.name}-t0", dry.scene)
    lines = lines_of(group)
    loading = up_to(dry.scene["loading"]["targets"], DEEPEST * lines.h_rms)
    adhesion = {"work_of_adhesion": theta * MODULUS * lines.full_contact_energy}
    return Member(f"{dry.name}-t{theta:g}", {**dry.scene, "loading": loading, "adhesion": adhesion})


def summary_of(dry: FloatArray, wet: FloatArray) -> dict[str, list[float | None]]:
    """Mean areas without and with adhesion, and errors by a jackknife, from arrays (n_realisations, n_loads).

    The errors are relative: of the ratio of the means, and of the mean with adhesion.  A load at which a realisation
    has no state, being in complete contact, has None.
    """
    means = [(np.delete(wet, i, 0).mean(0), np.delete(dry, i, 0).mean(0)) for i in range(len(wet))]
    left_out = [np.stack([np.log(with_it / without), np.log(with_it)]) for with_it, without in means]
    spread = np.sqrt((len(wet) - 1) * np.var(left_out, axis=0))
    rows = {"dry": dry.mean(0), "wet": wet.mean(0), "ratio_error": spread[0], "wet_error": spread[1]}
    return {name: [round(float(v), 5) if np.isfinite(v) else None for v in row] for name, row in rows.items()}


def areas_of(
    lines: DiscreteSpectrum, loads: FloatArray, theta: float, coefficients: Mapping[str, float] | None = None
) -> FloatArray:
    """A/A0 with adhesion at loads over E* h'_rms, (n_loads,)."""
    law = EdgeLaw(lines, theta * lines.full_contact_energy, coefficients)
    return np.array([law.at(float(load))[1] for load in loads * lines.slope_rms])


def paired_areas(
    lines: DiscreteSpectrum,
    loads: FloatArray,
    dry: FloatArray,
    theta: float,
    coefficients: Mapping[str, float] | None = None,
) -> FloatArray:
    """The same with p_d(A) moved, in ln p, onto the areas `dry` (n_loads,) of the ensemble without adhesion."""
    law = EdgeLaw(lines, theta * lines.full_contact_energy, coefficients)
    pressed = loads * lines.slope_rms
    grid = np.geomspace(0.2 * pressed[0], 5 * pressed[-1], 2000)
    area = contact_fractions(lines, grid)[0]
    at_dry = np.exp(np.interp(np.log(dry), np.log(area), np.log(grid)))
    moved = grid * np.exp(np.interp(np.log(area), np.log(dry), np.log(pressed / at_dry)))
    inside = area < 1 - 1e-9
    moved, area = moved[inside], area[inside]
    load = moved - law.tension(moved, area)
    top = int(np.argmax(load)) + 1
    return np.interp(pressed, np.maximum.accumulate(load[:top]), area[:top])


def misses(
    part: Mapping[str, Any], coefficients: Mapping[str, float] | None, paired: bool, inside: bool = True
) -> FloatArray:
    """ln(A_theory / A_ensemble) and its error, (2, n), of a part of the data file; of its domain alone if `inside`."""
    found = []
    domain, which = data()["domain"], "ratio_error" if paired else "wet_error"
    every = np.array(part["loads_over_E*h'"])
    for group in part["groups"]:
        lines = lines_of(group)
        for theta, one in zip(part["thetas"], group["areas"], strict=True):
            rows = np.array([one[name] for name in ("dry", "wet", which)], dtype=np.float64)
            there = np.isfinite(rows[0])
            loads, (dry, wet, error) = every[there], rows[:, there]
            theory = (
                paired_areas(lines, loads, dry, theta, coefficients)
                if paired
                else areas_of(lines, loads, theta, coefficients)
            )
            kept = wet > domain["between"]["contact_fraction"][0]
            if inside:
                work = theta * lines.full_contact_energy
                cases = (groups_of(lines, load * RMS_SLOPE, area, work) for load, area in zip(loads, wet, strict=True))
                kept &= np.array([not outside(domain, case) for case in cases])
            found.append(np.stack([np.log(theory / wet), error])[:, kept])
    return np.concatenate(found, axis=1)


def fitted(part: Mapping[str, Any]) -> dict[str, float]:
    """The two coefficients by least squares on the pairs, from those of the package; ArithmeticError without any."""

    def residual(coefficients: dict[str, float]) -> FloatArray:
        miss, error = misses(part, coefficients, paired=True)
        return np.asarray(miss / np.hypot(error, FLOOR))

    return fitted_from(data()["coefficients"], residual, diff_step=1e-2, xtol=1e-4, ftol=1e-6)


def cases(bench: Bench) -> list[Case]:
    """The case of the study; quick: two realisations of one group in each part, which shows that everything runs."""
    return [
        study_case("area-from-the-edges", partial(_judged, bench),
                   "Which coefficients give the area with adhesion, and how far off is it on two hold-outs?",
                   r"$\ln (A_{\text{theory}} / A_{\text{ensemble}})$, the area without adhesion from the same "
                   "realisations (ratio) or from the theory (area)", "carbone2009", "half_space adhesion")
    ]  # fmt: skip


def _judged(bench: Bench) -> Found:
    parts = {name: ensembles_of(data()[name], bench, name) for name in PARTS}
    coefficients, packaged = fitted(parts["fit"]), data()["coefficients"]
    errors = {
        f"{part}, {name}": misses(parts[part], packaged, paired)
        for part in PARTS[1:]
        for name, paired in (("ratio", True), ("area", False))
    }
    found = {name: {"error": rms(miss), "noise": rms(noise)} for name, (miss, noise) in errors.items()}
    bench.write(FILE, SCHEMA, coefficients=coefficients, **parts, hold_out_rms=found)
    stored = [data()[part]["rms"]["inside the domain"][name] for part in PARTS[1:] for name in ("ratio", "area")]
    yield hold_out_row({name: one["error"] for name, one in found.items()}, stored, bench.quick)
    yield coefficient_table(coefficients, packaged)
    numbers = {of: [one[of] for one in found.values()] for of in ("error", "noise")}
    loads = [miss.size for miss, _ in errors.values()]
    yield table("Rms over the hold-outs by the coefficients of the package.",
                {"hold-out": errors, "rms": numbers["error"], "noise": numbers["noise"], "loads": loads})  # fmt: skip


def ensembles_of(plan: Mapping[str, Any], bench: Bench, part: str) -> dict[str, Any]:
    """A part of the data file with areas of its own."""
    loads, root = np.array(plan["loads_over_E*h'"]), plan["seed_root"]
    groups = plan["groups"][:1] if bench.quick else plan["groups"]
    thetas = (0.0, *plan["thetas"])
    members = {
        (name_of(group), theta): [
            member(group, loads, root, k, theta)
            for k in range(min(group["realisations"], QUICK) if bench.quick else group["realisations"])
            if k not in group.get("left_out", ())
        ]
        for group in groups
        for theta in thetas
    }
    results = results_of(members, bench.folder / part, bench.jobs, bench.say, bench.opener)
    areas = {key: np.array([_areas(result, loads) for result in found]) for key, found in results.items()}
    found = [
        {**group, "areas": [summary_of(areas[name, 0.0], areas[name, theta]) for theta in plan["thetas"]]}
        for group in groups
        for name in [name_of(group)]
    ]
    return {**plan, "groups": found}


def _areas(result: Result, loads: FloatArray) -> FloatArray:
    """A/A0 at each load; nan where there is no state."""
    found = np.full(loads.size, np.nan)
    for state in result.targets:
        apart = np.abs(loads * RMS_SLOPE - state.mean_pressure / MODULUS)
        if apart.min() < SAME_LOAD:
            found[np.argmin(apart)] = state.contact_fraction
    return found
