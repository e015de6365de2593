"""The rows of the steps from a scan to a surface, each seen to fail where its step does something else."""

import numpy as np
import pytest

from bem.geometry.profile import Profile
from bem.scans import scan_preparation
from bem.scans.gaussian_filter import GaussianFilter
from validation.cases.states import scans
from validation.harness.verdict import verdict_of


def failing():
    return {row.quantity.rpartition(": ")[2] for row in scans.CASES[1].compute().rows if verdict_of(row) != "agrees"}


def test_every_step_gives_what_it_is_to_give():
    assert failing() == set()


def _not_reversed(line, method):
    x, h = line
    if method != "mirror":
        return scan_preparation._as_before(line, method)
    step = (x[-1] - x[0]) / (x.size - 1)
    return (x[0] + step * np.arange(2 * x.size), np.concatenate([h, h])), {}


def _only_upwards(raw, line, method):
    x, h = line
    if method != "replace":
        return line, {"count": 0}
    middle = np.array([np.median(h[max(k - 2, 0) : k + 3]) for k in range(h.size)])
    threshold = scan_preparation.OUTLIER * np.median(np.abs(np.diff(h)))
    return (x, np.where(h - middle > threshold, middle, h)), {"count": 1}


def _as_if_equal(raw, line, missing, method):
    x, h = line
    return (np.linspace(x[0], x[-1], x.size), h), {"deviation": 0.0}


FAULTS = {
    "trend": lambda patch: patch.setitem(scan_preparation.DEGREES, "quadratic", 1),
    "window": lambda patch: patch.setattr(scan_preparation, "TAPER", 0.12),
    "spikes": lambda patch: patch.setattr(scan_preparation, "_outliers", _only_upwards),
    "unequal steps": lambda patch: patch.setattr(scan_preparation, "_even", _as_if_equal),
    "mirror": lambda patch: patch.setattr(scan_preparation, "_periodic", _not_reversed),
    "cut": None,
    "cut-offs": lambda patch: patch.setattr(GaussianFilter, "applied", lambda filtered, h, spacing: h),
}


@pytest.mark.parametrize("step", FAULTS)
def test_a_step_that_does_something_else_fails(step, monkeypatch):
    monkeypatch.setattr(scan_preparation, "_as_before", scan_preparation._periodic, raising=False)
    if step == "cut":
        whole = Profile.from_samples.__func__
        one_less = classmethod(lambda kind, *given, **named: whole(kind, given[0], given[1] - 1, *given[2:], **named))
        monkeypatch.setattr(Profile, "from_samples", one_less)
    else:
        FAULTS[step](monkeypatch)
    assert step in failing()
