"""One hard case solved and judged: converged and correct are two answers, a refusal is neither."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bem.profile import Profile
from bem.result import Result
from bem.scene import SceneError, parse_scene
from bem.solver import solve
from validation.cases.hard_case_checks import CHECKS
from validation.cases.hard_cases import PERIOD, RMS_HEIGHT, HardCase, Samples

RELEASED = 1e-12  # of E* h_rms^2 / period: rounding of the energy released by an event; none measured below zero


@dataclass(frozen=True)
class Outcome:
    """What became of a hard case.

    Attributes
    ----------
    expected : tuple of str
        Status of the result, then of its targets.
    observed : tuple of str
        The same as found; empty when refused.
    converged : bool
        The solver ended as expected at every target.
    correct : bool
        Nothing was found against the result: certificates, events, independent checks.
    refused_reason : str or None
        Why the scene was refused or the run broke off.
    findings : tuple of str
        What speaks against it.
    seconds : float
        CPU time of the solution alone.
    """

    id: str
    expected: tuple[str, ...]
    observed: tuple[str, ...]
    converged: bool
    correct: bool
    refused_reason: str | None
    findings: tuple[str, ...]
    seconds: float


def run_case(case: HardCase, full: bool = False) -> Outcome:
    """Solve a hard case and judge it.

    Parameters
    ----------
    case : HardCase
    full : bool
        The full form instead of the reduced one.
    """
    tables = case.full if full else case.reduced
    expected = (case.status, *(case.targets_of_full if full else case.targets))
    start = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        if case.samples is not None:
            write_scan(case.samples, Path(folder) / tables["profile"]["file"])
        try:
            scene = parse_scene(tables, folder)
            result = solve(scene)
        except (SceneError, ArithmeticError, MemoryError) as error:
            reason = f"{type(error).__name__}: {error}"
            return Outcome(case.id, expected, (), False, False, reason, (), time.process_time() - start)
    seconds = time.process_time() - start
    targets = tuple(state.status for state in result.targets)
    observed = (result.status, *targets)
    converged = observed == expected
    findings = [
        *judged(case, result, scene),
        *(text for name in case.checks for text in CHECKS[name](tables, scene, result)),
    ]
    correct = not findings and bool(result.targets)
    return Outcome(case.id, expected, observed, converged, correct, None, tuple(findings), seconds)


def judged(case: HardCase, result: Result, scene: Any) -> list[str]:
    """What the certificates and the events of a result say against it."""
    findings = [
        f"certificate not ok at separation {state.separation:.4g}"
        for state in result.targets
        if state.status != "unreachable" and not state.certificate.ok
    ]
    happened = {event.kind for event in result.events}
    findings += [f"event {kind} missing" for kind in case.events if kind not in happened]
    modulus = scene.solid.youngs_modulus / (1 - scene.solid.poisson_ratio**2)
    surface = scene.surface()
    noise = RELEASED * modulus * surface.rms_height**2 / surface.period
    for event in result.events:
        if event.energy_released is not None and event.energy_released < -noise:
            findings.append(f"{event.kind} releases {event.energy_released:.1e} J/m^2 at {event.penetration:.4g} m")
    return findings


def write_scan(samples: Samples, path: Path) -> None:
    """Write a rough profile with noise as two columns x, h."""
    surface = Profile.self_affine(PERIOD, 0.7, RMS_HEIGHT, 2000, samples.seed)
    x = np.arange(samples.number) * (PERIOD / samples.number)
    noise = np.random.default_rng(samples.seed).normal(0.0, samples.noise, samples.number)
    np.savetxt(path, np.column_stack([x, surface.height(x) + noise]), delimiter=",", fmt="%.12e")
