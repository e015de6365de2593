"""A better estimate of the contact area: the theory's correction calibrated, judged on a hold-out, and put on a page.

1. Boundary-element ensembles (correction_members.py), stored realisation by realisation on any executor; a
   second run continues where the first ended.
2. Calibration on the fit part (fit.py): calibration.json, which copied to persson/ becomes the
   calibrated correction of the package.
3. Judgement on the hold-out (hold_out.py) by that calibration: area, separation and distribution of the
   plain theory, of the calibrated correction and of those of the literature.
4. report.json and report.html: the page for engineers (page.py).

Area, and with adhesion the change of all, are those of persson/contact_slope.py and persson/adhesive_edges.py, which
have fits of their own.  Source: persson/corrected_variance.py.  Limits: half-space, plane strain, loading; an hour of
one core.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from bem.scene.atomic_file import write_atomically
from persson.corrected_data import SCHEMA as CALIBRATION_SCHEMA
from persson.corrected_data import calibration
from validation.harness.ensemble import results_of
from validation.harness.execution import Listener, Note
from validation.harness.executors import Opener, local_processes
from validation.harness.provenance import provenance
from validation.harness.runner import record_of
from validation.harness.schema import SCHEMA as REPORT_SCHEMA
from validation.harness.schema import Report, with_checksum
from validation.harness.store import write_json
from validation.references.paper_problem import RMS_SLOPE
from validation.report.render import failures, write_html
from validation.studies.shown import text_table
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
from validation.studies.theory_correction.page import JUDGED, case_of, chosen, outcome

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


def run(folder: Path, quick: bool, report: Listener, jobs: int = 1, opener: Opener = local_processes) -> int:
    """Run the study; 1 when a realisation failed or is not certified, or a row of the report fails.

    The folder gets members/, calibration.json, theory-correction.json, report.json and report.html. Quick: a few small
    profiles that show that everything runs; calibrates and judges nothing of use.
    """
    facts = provenance()
    chosen_groups = groups(quick)
    cheap_first = sorted(chosen_groups, key=lambda group: group.harmonics * (4 if group.theta > 0 else 1))
    members = {group.name: group.members() for group in cheap_first}
    results = results_of(members, folder / "members", report, jobs, opener)
    if results is None:
        return 1
    ensembles = [observed(group, results[group.name]) for group in chosen_groups]
    return conclude(folder, ensembles, facts, report, short=quick)


def conclude(
    folder: Path, ensembles: Sequence[Observed], facts: Mapping[str, Any], report: Listener, short: bool
) -> int:
    """Calibrate, judge and write, from ensembles that are there."""
    fit = [one for one in ensembles if one.group.part == "fit"]
    held = [one for one in ensembles if one.group.part == "hold-out"]
    report(Note("calibration"))
    found = calibrate(fit)
    correction = correction_from(list(found.values.values()))
    noise = relative_errors(held)
    judged = [one for group in held for one in judge(group, noise[group.group.name], correction, report)]
    content = calibration_content(found, fit, judged, facts)
    write_json(folder / CALIBRATION, content)
    planned = sum(len(one.group.loads) for one in held)
    made = report_of(content, judged, planned, facts, short)
    write_json(folder / FILE, {"schema": SCHEMA, "calibration": content, "judged": [asdict(one) for one in judged]})
    write_atomically(folder / "report.json", made.model_dump_json(by_alias=True, indent=1) + "\n")
    write_html(made, folder)
    wrong = [f"{one.group.name}: {one.not_certified} states not certified" for one in ensembles if one.not_certified]
    wrong += [f"{case}: {why}" for case, why in failures(made)]
    for line in wrong:
        report(Note(f"FAILED {line}"))
    print(text_table(["adhesion", "theory", "area", "separation", "distribution"], summary(judged)))
    packaged = calibration()["coefficients"]
    coefficients = [[name, value, found.errors[name], packaged[name]] for name, value in found.values.items()]
    print(text_table(["coefficient", "found", "error", "in the package"], coefficients))
    print(f"{len(judged)} of {planned} loads judged, {len(wrong)} failures; {folder / 'report.html'}")
    return 1 if wrong else 0


def summary(judged: Sequence[HeldOut]) -> list[list[Any]]:
    """Rms errors over the hold-out by adhesion and theory."""
    return [
        ["with" if adhesive else "without", name, *(rms_of(some, quantity, name) for quantity in JUDGED)]
        for adhesive in (False, True)
        for some in [chosen(judged, adhesive)]
        for name in theories_of(some)
    ]


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


def report_of(
    content: Mapping[str, Any], judged: Sequence[HeldOut], planned: int, facts: Mapping[str, Any], short: bool
) -> Report:
    """The report of one case: the page."""
    made = outcome(content, judged, planned, short)
    form = " --quick" if short else ""
    return with_checksum(
        Report(
            schema_=REPORT_SCHEMA,
            level="theory correction, short form" if short else "theory correction",
            command=f"python -m validation study theory-correction{form}",
            planned=1,
            provenance=dict(facts),
            cases=[record_of(case_of(made, content["domain"]), made, 0.0)],
            changes=[],
        )
    )


def _described(group: Group) -> dict[str, Any]:
    names = ("hurst", "harmonics", "theta", "realisations")
    return {"spectrum": group.kind} | {name: getattr(group, name) for name in names}
