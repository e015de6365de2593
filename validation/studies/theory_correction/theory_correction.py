"""A better estimate of the contact area: the theory's correction calibrated, judged on a hold-out, and put on a page.

1. Boundary-element ensembles (correction_members.py), stored realisation by realisation on any executor; a
   second run continues where the first ended.
2. Calibration on the fit part (fit.py): calibration.json, which copied to persson/ becomes the
   calibrated correction of the package.
3. Judgement on the hold-out (hold_out.py) by that calibration: area, separation and distribution of the
   plain theory, of the calibrated correction and of those of the literature.
4. The report: the page for engineers (page.py).

Area, and with adhesion the change of all, are those of persson/contact_slope.py and persson/adhesive_edges.py, which
have fits of their own.  Source: persson/corrected_variance.py.  Limits: half-space, plane strain, loading; an hour of
one core.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from typing import Any

from persson.corrected_data import SCHEMA as CALIBRATION_SCHEMA
from validation.harness.case import Case, Outcome
from validation.harness.ensemble import results_of
from validation.harness.execution import Note
from validation.harness.schema import Table
from validation.harness.store import write_json
from validation.references.paper_problem import RMS_SLOPE
from validation.studies.bench import Bench, none_of
from validation.studies.theory_correction.correction_members import (
    FIT_ROOT,
    HOLD_OUT_ROOT,
    Group,
    Observed,
    groups,
    observed,
    relative_errors,
)
from validation.studies.theory_correction.fit import Calibration, calibrate, correction_from
from validation.studies.theory_correction.hold_out import CALIBRATED, PLAIN, HeldOut, judge, rms, rms_of, theories_of
from validation.studies.theory_correction.page import JUDGED, case_of, chosen, known, outcome

SCHEMA = "linecontact-theory-correction-study/1"
FILE, CALIBRATION = "theory-correction.json", "calibration.json"
DOMAIN = {  # the hold-out, and where on it the errors were large (persson/domain.py)
    "between": {
        "rms_slope": [None, 0.3],
        "load_over_slope": [0.005, 0.15],
        "bandwidth": [2.5, 102.0],
        "lines": [6.0, None],
        "contact_fraction": [0.02, 0.5],
    },
    "forbidden": [],
}


def cases(bench: Bench) -> list[Case]:
    """The case of the study: the page.

    The folder gets members/, calibration.json, theory-correction.json besides the report. Quick: a few small profiles
    that show that everything runs; calibrates and judges nothing of use.
    """
    return [case_of(partial(_outcome, bench), DOMAIN)]


def _outcome(bench: Bench) -> Outcome:
    chosen_groups = groups(bench.quick)
    cheap_first = sorted(chosen_groups, key=lambda group: group.harmonics * (4 if group.theta > 0 else 1))
    members = {group.name: group.members() for group in cheap_first}
    results = results_of(members, bench.folder / "members", bench.jobs, bench.say, bench.opener)
    return concluded(bench, [observed(group, results[group.name]) for group in chosen_groups])


def concluded(bench: Bench, ensembles: Sequence[Observed]) -> Outcome:
    """Calibrate, judge and write, from ensembles that are there."""
    fit = [one for one in ensembles if one.group.part == "fit"]
    held = [one for one in ensembles if one.group.part == "hold-out"]
    bench.say(Note("calibration"))
    found = calibrate(fit)
    correction = correction_from(list(found.values.values()))
    noise = relative_errors(held)
    judged = [one for group in held for one in judge(group, noise[group.group.name], correction, bench.say)]
    content = calibration_content(found, fit, judged, bench.facts)
    if not bench.quick:  # which calibrates nothing of use
        write_json(bench.folder / CALIBRATION, content)
    bench.write(FILE, SCHEMA, calibration=content, judged=[asdict(one) for one in judged])
    made = outcome(content, judged, sum(len(one.group.loads) for one in held), bench.quick)
    wrong = [f"{one.group.name}: {one.not_certified}" for one in ensembles if one.not_certified]
    tables = (*made.tables, summary(judged))
    return replace(made, rows=(*made.rows, none_of("ensembles with states not certified", wrong)), tables=tables)


def summary(judged: Sequence[HeldOut]) -> Table:
    """Rms errors over the hold-out by adhesion and theory."""
    return Table(
        caption="Rms errors over the hold-out.",
        columns=["adhesion", "theory", *JUDGED],
        rows=[
            ["with" if adhesive else "without", name, *(known(rms_of(some, quantity, name)) for quantity in JUDGED)]
            for adhesive in (False, True)
            for some in [chosen(judged, adhesive)]
            for name in theories_of(some)
        ],
    )


def calibration_content(
    found: Calibration, fit: Sequence[Observed], judged: Sequence[HeldOut], facts: Mapping[str, Any]
) -> dict[str, Any]:
    """What calibration.json holds."""
    held_out = {}
    for name, adhesive in (("without adhesion", False), ("with adhesion", True)):
        some = chosen(judged, adhesive)
        held_out[name] = {
            "loads": len(some),
            "area_rms": {theory: rms_of(some, "area", theory) for theory in (PLAIN, CALIBRATED)},
            "separation_rms": {theory: rms_of(some, "separation", theory) for theory in (PLAIN, CALIBRATED)},
            "noise_of_the_ensembles_rms": rms([one.area_noise for one in some]),
        }  # fmt: skip
    return {
        "schema": CALIBRATION_SCHEMA,
        "coefficients": found.values,
        "standard_errors": found.errors,
        "standard_errors_by": "jackknife over the Hurst exponents",
        "domain": DOMAIN,
        "fit": {"mean_square_over_error": found.chi_square, "area_rms": found.rms},
        "hold_out": held_out,
        "provenance": {
            "ensembles_made_by_commits": sorted({commit for one in fit for commit in one.commits}),
            "calibrated_by": {name: facts[name] for name in ("commit", "date", "sources_sha256", "python", "numpy")},
            "seed_roots": {"fit": FIT_ROOT, "hold-out": HOLD_OUT_ROOT},
            "rms_slope": RMS_SLOPE,
            "loads_over_E*": list(fit[0].group.loads),
            "groups": [_described(one.group) for one in fit],
        },
    }


def _described(group: Group) -> dict[str, Any]:
    names = ("hurst", "harmonics", "theta", "realisations")
    return {"spectrum": group.kind} | {name: getattr(group, name) for name in names}
