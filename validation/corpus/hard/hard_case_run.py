"""One hard case solved and judged: converged and correct are two answers, a refusal is neither."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.geometry.profile import Profile
from bem.scene.result import Result
from bem.scene.scene import SceneError, parse_scene
from bem.solver import solve
from validation.corpus.hard.hard_case_checks import CHECKS
from validation.corpus.hard.hard_case_scenes import HardCase, Reached, Samples
from validation.references.paper_problem import PERIOD, RMS_HEIGHT, Table

ROUNDED = 1e-5  # of a contact fraction that is to be reached; measured 1.9e-6 at 1e-5
# Of E* h_rms^2 / period, besides the error that an event states: rounding of the energy that it releases.  Measured:
# 1e-12 below zero, where the event states 3e-12.
RELEASED = 1e-12


@dataclass(frozen=True)
class TrialOutcome:
    """What became of a hard case."""

    id: str
    expected: tuple[str, ...]  # status of the result, then of its targets
    observed: tuple[str, ...]  # the same as found; empty when refused
    converged: bool  # the solver ended as expected at every target
    correct: bool  # nothing was found against the result: certificates, events, independent checks
    refused_reason: str | None  # why the scene was refused or the run broke off
    findings: tuple[str, ...]  # what speaks against it
    seconds: float  # CPU time of the solution alone
    kinds: tuple[str, ...] = ()  # kind of each finding, where a corpus counts them


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A hard case of a reference: one question, of which the status is expected."""

    expected: str = "converged"  # status, or `refused: ARGUMENT`
    full: Table | None = None  # what the full form changes of the question, besides the resolution

    def expectation(self, full: bool) -> tuple[str, ...]:
        """The status expected, of both forms."""
        return (self.expected,)

    def changed(self, question: Table, full: bool) -> Table:
        """The question in a form."""
        return question | ((self.full or {}) if full else {})


def ended(
    name: str,
    expected: tuple[str, ...],
    solve: Callable[[], Any],
    refusals: tuple[type[Exception], ...],
    judge: Callable[[Any], list[str]],
) -> TrialOutcome:
    """A question put to a reference, and its answer judged; a refusal names its argument, or begins with it."""
    begun = time.process_time()
    try:
        found = solve()
    except refusals as error:
        seconds, named = time.process_time() - begun, getattr(error, "argument", str(error).split(":")[0])
        observed = (f"refused: {named}",)
        return TrialOutcome(name, expected, observed, False, observed == expected, str(error), (), seconds)
    seconds, observed = time.process_time() - begun, (found.status,)
    findings = tuple(judge(found))
    return TrialOutcome(name, expected, observed, observed == expected, not findings, None, findings, seconds)


def run_case(case: HardCase, full: bool = False) -> TrialOutcome:
    """Solve a hard case, in its reduced form or the full one, and judge it."""
    tables = case.full if full else case.reduced
    expected = case.expectation(full)
    start = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        if case.samples is not None:
            write_scan(case.samples, Path(folder) / tables["profile"]["file"])
        try:
            scene = parse_scene(tables, folder)
            result = solve(scene)
        except (SceneError, ArithmeticError, MemoryError) as error:
            reason = f"{type(error).__name__}: {error}"
            return TrialOutcome(case.id, expected, (), False, False, reason, (), time.process_time() - start)
    seconds = time.process_time() - start
    targets = tuple(state.status for state in result.targets)
    observed = (result.status, *targets)
    converged = observed == expected
    findings = [
        *judged(case, result, scene),
        *missed(case.reached_in_full if full else case.reached, result, scene),
        *(text for name in case.checks for text in CHECKS[name](tables, scene, result)),
    ]
    correct = not findings and bool(result.targets)
    return TrialOutcome(case.id, expected, observed, converged, correct, None, tuple(findings), seconds)


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
        allowed = noise + (event.error_estimate.energy_released or 0.0)
        if event.energy_released is not None and event.energy_released < -allowed:
            findings.append(f"{event.kind} releases {event.energy_released:.1e} J/m^2 at {event.penetration:.4g} m")
    return findings


def missed(wanted: Reached | None, result: Result, scene: Any) -> list[str]:
    """What the targets do not reach, without which the case is not as hard as intended."""
    if wanted is None:
        return []
    states = [state for state in result.targets if state.edges]
    period = scene.surface().period
    fractions = [state.contact_fraction for state in states]
    findings = []
    if wanted.least is not None and not min(fractions, default=np.inf) <= wanted.least * (1 + ROUNDED):
        findings.append(f"contact fraction {wanted.least:g} not reached from above")
    if wanted.largest is not None and not max(fractions, default=-np.inf) >= wanted.largest * (1 - ROUNDED):
        findings.append(f"contact fraction {wanted.largest:g} not reached from below")
    if wanted.gap is not None and not _near(wanted.gap, [gaps_of(state.edges, period).min() for state in states]):
        findings.append(f"no gap of {wanted.gap:g} periods")
    if wanted.patch is not None and not _near(wanted.patch, [np.diff(s.edges).min() / period for s in states]):
        findings.append(f"no patch of {wanted.patch:g} periods")
    return findings


def gaps_of(edges: tuple[tuple[float, float], ...], period: float) -> NDArray[np.float64]:
    """Widths of the gaps between patches, in periods, (n_patches,)."""
    left, right = np.array(edges).T
    return np.asarray((np.append(left[1:], left[0] + period) - right) / period)


def _near(wanted: float, found: list[float]) -> bool:
    return any(wanted / 2 <= width <= 2 * wanted for width in found)


def write_scan(samples: Samples, path: Path) -> None:
    """Write a rough profile with noise as two columns x, h."""
    surface = Profile.self_affine(PERIOD, 0.7, RMS_HEIGHT, 2000, samples.seed)
    x = np.arange(samples.number) * (PERIOD / samples.number)
    noise = np.random.default_rng(samples.seed).normal(0.0, samples.noise, samples.number)
    np.savetxt(path, np.column_stack([x, surface.height(x) + noise]), delimiter=",", fmt="%.12e")
