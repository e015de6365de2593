"""Does the cost that `check` predicts hold: evaluations and seconds within a factor of 3 for nine of ten scenes?

Measured costs of many scenes are stored (cost_scenes.py); predictions are made anew.  A few of the quick scenes are
solved again: their evaluations must still be the stored ones, to the 20 % in which counts of work may change.
"""

from __future__ import annotations

import math

from validation.corpus.cost_scenes import KERNELS, PARTS, Judged, cost_scenes, judged, measure, outside
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, marks, trace
from validation.harness.rows import compared
from validation.harness.schema import Figure, Reference, Row, Table

FACTOR, ALLOWED = 3.0, 0.1
LISTED = 12
AGAIN = ("examples/one-wave", "cases/layer_two_crests", "two-crests", "two-waves", "micro-128", "bare-250")


def _row(found: list[Judged], which: int, quantity: str) -> Row:
    """The share of scenes that did not calibrate anything and are predicted worse than within the factor."""
    ratios = [one.ratios[which] for one in found if one.part != PARTS[0]]
    share = outside(ratios, FACTOR)
    source = Reference(kind="self", source=f"measured cost of {len(ratios)} scenes")
    return compared(
        f"share of scenes beyond a factor of {FACTOR:g}: {quantity}",
        *("", source, [0.0], [share], ALLOWED, MEASURED[quantity], "absolute"),
        basis="required",
    )


def _again(found: list[Judged]) -> Row:
    """Evaluations of quick scenes solved now against those stored."""
    stored = {one.name: one.evaluations for one in found}
    scenes = cost_scenes()
    now = [measure(scenes[name][1])["evaluations"] for name in AGAIN]
    known = [float(stored[name]) for name in AGAIN]
    ratios = [taken / before for taken, before in zip(now, known, strict=True)]
    source = Reference(kind="self", source="stored counts of the same scenes")
    return compared(
        "evaluations over those stored", "", source, [1.0] * len(AGAIN), ratios, 0.2, 0.02, basis="required"
    )


def _figure(found: list[Judged]) -> Figure:
    """Predicted against measured seconds."""
    compiled = [one for one in found if one.kernels == KERNELS[0]]
    ends = [f(one.seconds for one in compiled) for f in (min, max)]
    series = [
        marks(
            part,
            [one.seconds for one in compiled if one.part == part],
            [one.predicted_seconds for one in compiled if one.part == part],
        )
        for part in PARTS
    ]
    lines = [
        trace(label, ends, [factor * end for end in ends], style, hue=5)
        for label, factor, style in (
            ("equal", 1.0, "line"),
            ("three times", FACTOR, "dashed"),
            ("a third", 1 / FACTOR, "dashed"),
        )
    ]
    caption = "Predicted against measured seconds, compiled kernels: scenes that calibrated the prediction, and others."
    return drawn("predicted-cost", caption, loglog("measured / s", "predicted / s", *series, *lines))


def _table(found: list[Judged]) -> Table:
    """The scenes that are predicted worst."""
    worst = sorted(found, key=lambda one: -max(abs(math.log(ratio)) for ratio in one.ratios))[:LISTED]
    return Table(
        caption=f"The {LISTED} worst of {len(found)} predictions; all are in validation/corpus/cost_measured.json.",
        columns=["scene", "part", "kernels", "evaluations", "predicted", "seconds", "predicted seconds"],
        rows=[
            [
                *(one.name, one.part, one.kernels, one.evaluations, round(one.predicted_evaluations)),
                *(one.seconds, float(f"{one.predicted_seconds:.3g}")),
            ]
            for one in worst
        ],
    )


def _predicted_cost() -> Outcome:
    found = judged()
    compiled, numpy = ([one for one in found if one.kernels == kernels] for kernels in KERNELS)
    rows = (
        _row(compiled, 0, "evaluations"),
        _row(compiled, 1, "seconds, compiled kernels"),
        _row(numpy, 1, "seconds, NumPy"),
        _again(found),
    )
    return Outcome(rows=rows, figures=(_figure(found),), tables=(_table(found),))


MEASURED = {"evaluations": 0.0, "seconds, compiled kernels": 0.058, "seconds, NumPy": 0.039}  # of 52: none, 3, 2

CASES = (
    Case(id="predicted-cost", group="cost", level="quick", code="suite",
         question="Does the cost that is predicted for a scene hold within a factor of 3, for nine scenes of ten?",
         equations="evaluations = 6.2 increments (under load half, or fewer) + 18.2 crests + 6.3 targets; bare: 6.9",
         sources=("persson2001",), compute=_predicted_cost, effects=("half_space", "adhesion")),
)  # fmt: skip
