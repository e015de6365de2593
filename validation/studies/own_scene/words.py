"""The findings of a study of a scene as plain values for study.json, with its figure, its table and its sentence."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

from bem.command_line.answer_table import quantity
from validation.harness.figure_data import bars, drawn, loglog, marks
from validation.harness.schema import Figure
from validation.report.run_words import CONTROLS
from validation.report.study_page import share
from validation.studies.own_scene.findings import Compared, Findings, combined, largest, node_rate
from validation.studies.own_scene.settings import Setting
from validation.studies.own_scene.solved_setting import Key, NodeCurve, Solved
from validation.studies.shown import text_table

SOURCES = {
    "numerical": "the numerical error",
    "cut": "the cut of the roughness",
    "detrending": "the detrending of the scan",
    "window": "how the scan is made periodic",
    "period": "which part of the scan is the period",
    "seed": "the realisation of the random phases",
    "slope term": "the length on which adhesion counts",
}
CHANGES = {  # what a user can do about each
    "numerical": "a smaller accuracy.tolerance lowers it",
    "cut": "the key profile.harmonics decides it: which is the shortest wave that is roughness and not noise?",
    "detrending": "the key profile.detrend decides it: what of the scan is form and not roughness?",
    "window": "the key profile.periodic decides it; a longer scan lowers it",
    "period": "a longer scan, or the mean of several, lowers it",
    "seed": "the mean of more realisations (profile.seed) lowers it",
    "slope term": "the key adhesion.slope_term decides it",
}
SIDE_BY_SIDE = 1.3  # factor of the seconds by which bars of the figure are set apart


def sentence(found: Findings) -> str:
    """The largest uncertainty, and the numerical error beside it; that there is no contact, where there is none."""
    touched = any(reading.contact_fraction > 0 for one in found.numerical for reading in one.solved.readings)
    return _largest_in_words(found) if touched else f"There is no contact at any target. {_largest_in_words(found)}"


def _largest_in_words(found: Findings) -> str:
    most = largest(found.uncertainties)
    own = largest([one for one in found.uncertainties if one.kind == "numerical"])
    if most is None or own is None:
        return "No number of this scene varies: there is no target with one."
    if most.relative == 0:
        return "Nothing that was varied changes a number of this scene."
    what = f"{most.quantity} {_at(most.key)}"
    if most is own:
        said = f"The largest uncertainty is the numerical error: {share(own.relative)} of the {what}"
        return f"{said}; {CHANGES['numerical']}."
    if most.source == "seed":
        how = f"varies by {share(most.relative)} (standard deviation of {most.count} realisations; "
        how += f"standard error of their mean {share(most.of_mean)})"
    else:
        alternatives = "alternative" if most.count == 1 else "alternatives"
        how = f"changes by up to {share(most.relative)} with it ({most.count} {alternatives})"
    return (
        f"The largest uncertainty is {SOURCES[most.source]} ({most.kind}): the {what} {how}. "
        f"{_sentence(CHANGES[most.source])} The numerical error is at most {share(own.relative)}."
    )


def _sentence(words: str) -> str:
    """Words with a capital and an end."""
    return words[0].upper() + words[1:] + ("" if words.endswith("?") else ".")


def table_text(found: Findings) -> str:
    """What to use for so many digits, for a terminal."""
    rows = [
        [one.digits, one.setting or "not reached", one.evaluations, one.seconds, one.error, one.open_source or "-"]
        for one in found.advice
    ]
    return text_table(["digits", "use", "evaluations", "seconds", "error", "left open by"], rows)


def content_of(found: Findings, answered: Sequence[tuple[Setting, Solved]]) -> dict[str, Any]:
    """What study.json holds besides scene and provenance."""
    base = answered[0][1]
    compared = {one.setting: one for one in (*found.numerical, *found.others)}
    return {
        "sentence": sentence(found),
        "reference": found.reference,
        "floor": found.floor,
        "rms_slope": base.rms_slope,
        "digits": [vars(one) for one in found.advice],
        "targets": list(_targets(found, base)),
        "sources": list(_sources(found)),
        "settings": [_setting(*one, compared.get(one[0])) for one in answered],
        "nodes": [_node(curve) for curve in base.nodes],
        "seconds": sum(solved.seconds for _, solved in answered),
        "figure": _figure(found, base).model_dump(mode="json"),
    }


def _at(key: Key) -> str:
    held, value, visit = key
    unit = CONTROLS[held][1]
    again = "" if visit == 1 else f" (visit {visit})"
    return f"at a {held.replace('_', ' ')} of {quantity(value, unit)}{again}"


def _targets(found: Findings, base: Solved) -> Iterator[dict[str, Any]]:
    """The budget of each number at each target."""
    for reading in base.readings:
        unit = CONTROLS[reading.free][1]
        numbers = (
            ("contact fraction", reading.contact_fraction, reading.fraction_error, ""),
            (reading.free.replace("_", " "), reading.free_value, reading.free_error, unit),
        )
        for name, value, estimate, of_unit in numbers:
            of = [one for one in found.uncertainties if one.key == reading.key and one.quantity == name]
            if math.isnan(value) or not of:
                continue
            yield {
                "target": _at(reading.key).removeprefix("at a "),
                "branch": reading.branch,
                "quantity": name,
                "unit": of_unit,
                "value": value,
                "estimate": estimate,
                "certified": reading.certified,
                "numerical": combined(of, "numerical"),
                "input": combined(of, "input"),
                "model": combined(of, "model"),
                "by_source": {one.source: one.relative for one in of},
            }


def _sources(found: Findings) -> Iterator[dict[str, Any]]:
    """The largest uncertainty of each source, largest first."""
    names = dict.fromkeys(one.source for one in found.uncertainties)
    worst = [largest([one for one in found.uncertainties if one.source == name]) for name in names]
    for one in sorted((one for one in worst if one is not None), key=lambda one: -one.relative):
        yield {
            "kind": one.kind,
            "source": one.source,
            "words": SOURCES[one.source],
            "relative": one.relative,
            "of_mean": one.of_mean,
            "count": one.count,
            "where": f"{one.quantity} {_at(one.key)}",
        }


def _setting(setting: Setting, solved: Solved, off: Compared | None) -> dict[str, Any]:
    """One setting, what it took and what it changed."""
    return {
        "kind": setting.kind,
        "source": setting.source,
        "name": setting.name,
        "status": solved.status,
        "why": solved.failure,
        "seconds": solved.seconds,
        "evaluations": solved.evaluations,
        "unknowns": solved.unknowns,
        "contact_fraction": None if off is None else off.fraction,
        **{name: getattr(off, name, None) for name in ("free", "covered", "judged")},
    }


def _node(curve: NodeCurve) -> dict[str, Any]:
    """Errors of one state against nodes per patch, and their rates; nan: none."""
    return {
        "target": _at(curve.key).removeprefix("at a "),
        "per_patch": curve.per_patch,
        "load_errors": curve.load_errors,
        "intensity_errors": curve.intensity_errors,
        "load_rate": node_rate(curve.per_patch, curve.load_errors),
        "intensity_rate": node_rate(curve.per_patch, curve.intensity_errors),
    }


def _figure(found: Findings, base: Solved) -> Figure:
    """Error against seconds, and what the question leaves open as bars beside it."""
    series = []
    for hue, source in enumerate(("tolerance", "max_increment", "as it is")):
        points = [one for one in found.numerical if one.setting.source == source and math.isfinite(one.error)]
        if points:
            seconds = [one.solved.seconds for one in points]
            series.append(marks(source, seconds, [_drawn(one.error, found.floor) for one in points], hue=hue))
    if base.nodes:
        spent = map(sum, zip(*(curve.seconds for curve in base.nodes), strict=True))
        every = (one for curve in base.nodes for one in (curve.load_errors, curve.intensity_errors))
        errors = map(max, zip(*every, strict=True))
        series.append(marks("nodes, of its states alone", spent, [_drawn(error, 0.0) for error in errors], hue=3))
    for k, (source, shares) in enumerate(_bars(found)):
        place = [base.seconds * SIDE_BY_SIDE ** (k + 1)]
        series.append(bars(source, place, [min(shares)], [max(shares)], hue=4 + k))
    caption = (
        "Largest relative error of a number of this scene against CPU seconds; errors below "
        f"{found.floor:.1g}, the estimated error of the finest setting, are drawn there. Bars, set side by side: what "
        "the question leaves open, from the target that it changes least to the one that it changes most."
    )
    return drawn("error-against-seconds", caption, loglog("CPU seconds", "relative error or change", *series))


def _drawn(error: float, floor: float) -> float | None:
    return max(error, floor) or None


def _bars(found: Findings) -> Iterator[tuple[str, list[float]]]:
    """Relative changes of all numbers by each source of input and of the model."""
    for source in dict.fromkeys(one.source for one in found.uncertainties if one.kind != "numerical"):
        of = [one for one in found.uncertainties if one.source == source and one.relative > 0]
        if of:
            yield f"{source} ({of[0].kind})", [one.relative for one in of]
