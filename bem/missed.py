"""Targets that a path does not meet: the reason, in the unit of the control, and remedies.

A target that is missed does not end the path.  Its row gives the reason, and the path goes on from the last state kept
to the next target: later states are those of a path that turned back, or went past the target, at that state.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from bem.elastic.hierarchical import IllConditionedSystemError
from bem.scene.result_views import UNITS
from bem.scene.state import Ending, NotFiniteError, State


class EnergyGainedError(ArithmeticError):
    """Error of a jump that gains energy beyond its error: an earlier event was missed, or its end cannot be reached."""


FAILURES = {  # of a point of a path
    "not_converged": "no equilibrium was found",
    "ill_conditioned": "the gaps are too narrow, or the layer too thin, to resolve",
    "jumps_again": "the contact jumps again and again",
}
NUMERICAL_FAILURES = (
    IllConditionedSystemError,
    NotFiniteError,
    EnergyGainedError,
    FloatingPointError,
    np.linalg.LinAlgError,
    MemoryError,
)
COARSER = "fewer profile.harmonics"
UNCERTIFIED_REMEDIES = ("half the accuracy.max_increment", "a larger accuracy.tolerance", COARSER)
REASONS_LISTED = 3  # format: targets missed whose reasons stand in the failure of a result


class MissedTargetError(Exception):
    """Error of a target that is not met: its status, the reason, and remedies in the order in which to try them."""

    def __init__(self, status: Ending, why: str, *remedies: str) -> None:
        super().__init__(why)
        self.status, self.why, self.remedies = status, why, remedies


def no_point(status: str, at: float, control: str, has_history: bool) -> MissedTargetError:
    """Return the error of a point without a state, by its status, at a value of the control in SI."""
    remedies = ["half the accuracy.max_increment", "a slightly different target"] if has_history else []
    remedies += ['loading.control = "separation"'] if has_history and control == "mean_pressure" else []
    return MissedTargetError("not_converged", f"{FAILURES[status]} at {at:.9g} {UNITS[control]}", *remedies, COARSER)


def not_computed(error: BaseException) -> MissedTargetError:
    """Return the error of a computation that double precision or memory ended."""
    return MissedTargetError("not_converged", f"{type(error).__name__}: {error}", COARSER)


def tension_apart() -> MissedTargetError:
    """Return the error of a tension that is asked for while the surfaces are apart."""
    why = "this path has no state there: separated surfaces carry no tension"
    return MissedTargetError("unreachable", why, "a target in compression before it")


def beyond_contact(deepest: float) -> MissedTargetError:
    """Return the error of a motion beyond complete contact, which is at the penetration `deepest`, m."""
    why = f"this path has no state there: complete contact is at {deepest:.9g} m"
    return MissedTargetError("unreachable", why, "a target before that", 'loading.control = "mean_pressure"')


def passed_over() -> MissedTargetError:
    """Return the error of a path that ended beside the target, at a state without edges."""
    why = "no equilibrium was found: the gap closed again, or the surfaces came apart"
    return MissedTargetError("not_converged", why, "another loading.flaw", "targets in smaller steps")


def came_apart(at: float) -> MissedTargetError:
    """Return the error of a tension that no contact carries: the last contact came apart at the pressure `at`, Pa."""
    why = f"this path has no state there: the surfaces came apart at {at:.9g} Pa"
    return MissedTargetError("unreachable", why, "less tension", 'loading.control = "separation"')


def flat_apart() -> MissedTargetError:
    """Return the error of a state that flat surfaces do not have."""
    why = "this path has no state there: flat surfaces neither overlap nor carry this tension"
    return MissedTargetError("unreachable", why, 'loading.control = "mean_pressure" in compression')


def advice(remedies: Sequence[str]) -> str:
    """Return remedies as a text, in the order in which to try them.

    Examples
    --------
    >>> advice(("less tension",)), advice(("a", "b"))
    ('what may help: less tension', 'what may help, in this order: (1) a, (2) b')
    """
    if len(remedies) == 1:
        return f"what may help: {remedies[0]}"
    return "what may help, in this order: " + ", ".join(f"({k}) {remedy}" for k, remedy in enumerate(remedies, 1))


def sentence(error: MissedTargetError, name: str, control: str, target: float) -> str:
    """Return a sentence on a missed target, named as in "target 2 of 6"."""
    return f"{name}, {control} = {target:.9g} {UNITS[control]}: {error.why}; {advice(error.remedies)}"


def verdict(states: Iterable[State]) -> tuple[Ending, str | None]:
    """Return the status of a path that visited all its targets, and the reason unless `converged`.

    Targets alone decide.  A state between targets that is not certified is the subject of a warning (record.py).
    """
    targets = [state for state in states if state.target]
    lost = [state for state in targets if not state.found]
    refused = [state for state in targets if state.found and not state.certificate.ok]
    reasons = [reason for state in lost[:REASONS_LISTED] for reason in state.certificate.reasons]
    if len(lost) > REASONS_LISTED:
        reasons.append(f"{len(lost) - REASONS_LISTED} more targets were not met either")
    if refused:
        count = f"{len(refused)} of {len(targets) - len(lost)} states at targets are not certified"
        reasons.append(f"{count}, the first {uncertified(refused[0])}; {advice(UNCERTIFIED_REMEDIES)}")
    if not reasons:
        return "converged", None
    unreachable = not refused and all(state.status == "unreachable" for state in lost)
    return "unreachable" if unreachable else "not_converged", "; ".join(reasons)


def uncertified(state: State) -> str:
    """Return the separation of an uncertified state, and the first demand that the state misses."""
    return f"at a separation of {state.separation:.9g} m: {next(iter(state.certificate.reasons), '')}"
