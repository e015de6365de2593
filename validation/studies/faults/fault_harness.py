"""Faults of the harness itself: comparison, norms, combined tolerance, fits of rates, verdicts, baselines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from validation.studies.faults.fault_injection import Fault, Function


def _mean_norm(original: Function, size: float) -> Function:
    """The mean of the errors in place of the largest."""

    def wrong(row: Any) -> float:
        if row.band is not None:
            return float(original(row))
        difference = np.abs(np.array(row.computed, float) - np.array(row.expected, float))
        return float(((1 - size) * difference.max() + size * difference.mean()) / row.scale)

    return wrong


def _signed_norm(original: Function, size: float) -> Function:
    """computed - expected without its modulus: what is too small passes."""

    def wrong(row: Any) -> float:
        if row.band is not None:
            return float(original(row))
        return float(np.max(np.array(row.computed, float) - np.array(row.expected, float)) / row.scale)

    return wrong


def _nan_dropped(original: Function, size: float) -> Function:
    """Values that are no numbers are left out, as nanmax does."""

    def wrong(row: Any) -> float:
        if row.band is not None:
            return float(original(row))
        pairs = [(a, b) for a, b in zip(row.computed, row.expected, strict=True) if a is not None and b is not None]
        errors = [abs(a - b) / row.scale for a, b in pairs if math.isfinite(a - b)]
        return float(max(errors, default=0.0))

    return wrong


def _generous_tolerance(original: Function, size: float) -> Function:
    """Uncertainties are added to the tolerance instead of bounding it from below, ten times over."""

    def wrong(row: Any) -> float:
        return float(original(row) + size * 20 * (row.uncertainty + row.reference.uncertainty) / row.scale)

    return wrong


def _lower_order(original: Function, size: float) -> Function:
    """A quarter of the fitted order is lost."""
    return lambda x, error: (1 - 0.25 * size) * original(x, error)


def _late_sizes(original: Function, size: float) -> Function:
    """Sizes are recorded after they were refined, one place late: errors are set against the wrong ones."""

    def wrong(x: Any, error: Any) -> Any:
        sizes = np.asarray(x, dtype=np.float64)
        return original(np.append(sizes[1:], sizes[-1] * sizes[-1] / sizes[-2]), error)

    return wrong


def _accepts(original: Function, size: float) -> Function:
    """Everything that ran agrees."""
    return lambda row: "agrees" if row.status == "run" else original(row)


def _too_good_passes(original: Function, size: float) -> Function:
    """Only the far side of a band counts: agreeing too well passes."""

    def wrong(row: Any) -> Any:
        verdict = original(row)
        if verdict == "changed" and abs(row.computed[0] / row.expected[0] - 1) < abs(row.band.low - 1):
            return "expected deviation"
        return verdict

    return wrong


def _count_band_wider(original: Function, size: float) -> Function:
    """Differences from a baseline are told without those of counts."""
    return lambda *given, **named: [line for line in original(*given, **named) if "evaluations" not in line]


HARNESS_FAULTS: tuple[Fault, ...] = (
    Fault(
        "harness-mean-norm",
        "mean for maximum in the norm",
        "validation.harness.compare:error_of",
        _mean_norm,
        "mean instead",
    ),
    Fault("harness-signed-norm", "errors without modulus", "validation.harness.compare:error_of", _signed_norm),
    Fault(
        "harness-nan-dropped",
        "missing values left out of the norm",
        "validation.harness.compare:error_of",
        _nan_dropped,
    ),
    Fault(
        "harness-generous-tolerance",
        "uncertainties counted ten times, on top of the tolerance",
        "validation.harness.compare:combined_tolerance",
        _generous_tolerance,
        "ten times",
    ),
    Fault(
        "harness-rate-fit",
        "fitted orders too small by a quarter",
        "validation.harness.compare:fitted_order",
        _lower_order,
        "a quarter",
    ),
    Fault(
        "harness-late-steps",
        "errors set against sizes one refinement late",
        "validation.harness.compare:pairwise_orders",
        _late_sizes,
    ),
    Fault("harness-verdict-accepts", "everything that ran agrees", "validation.harness.verdict:verdict_of", _accepts),
    Fault("harness-too-good-passes", "a band with one side", "validation.harness.verdict:verdict_of", _too_good_passes),
    Fault(
        "harness-counts-not-told",
        "baselines pass over counts of evaluations",
        "validation.harness.baseline:differences",
        _count_band_wider,
    ),
)
