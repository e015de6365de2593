"""Where the time of the solver goes: CPU seconds and calls of each stage, measured from outside.

While `timed_stages` is open, the functions of STAGES are replaced, in every module of the solver that holds them, by
ones that note when they are entered and left; afterwards everything is as it was.  A stage's own seconds leave out
those of stages that run inside it, so that the stages and the rest add up to the whole; its seconds in all do not.
The overhead is two readings of the clock a call: a run that is to be timed runs without.
"""

import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import wraps
from importlib import import_module
from types import SimpleNamespace
from typing import Any

STAGES: tuple[tuple[str, str, str], ...] = (
    ("bem.elastic.collocation", "right_hand_sides", "right-hand sides"),
    ("bem.elastic.half_space", "between_nodes", "assembly"),
    ("bem.elastic.half_space", "within_patch", "assembly"),
    ("bem.elastic.separated_kernel", "separated_kernel", "kernel between clusters"),
    ("bem.elastic.hierarchical", "solved", "factorisation"),  # in C all of the system
    ("bem.elastic.hierarchical", "lapack.dtrtrs", "triangular solves"),
    ("bem.elastic.hierarchical", "_joined", "joining of clusters"),
    ("bem.elastic.collocation", "evaluate", "evaluation, rest"),
    ("bem.elastic.sensitivities", "stress_intensity_jacobian", "sensitivities"),
    ("bem.adhesive.lowest_modes", "lowest_modes", "eigenvalues"),
    ("bem.adhesive.relaxation", "interpenetration", "gap search"),
    ("bem.nonadhesive.nonadhesive", "low_minima", "gap search"),
    ("bem.path.steps", "step_from", "Newton, rest"),
    ("bem.path.locating", "settle", "Newton, rest"),
    ("bem.nonadhesive.nonadhesive", "solve_contact", "Newton, rest"),
    ("bem.nonadhesive.grid_contact", "GridProblem.patches", "start on a grid"),
    ("bem.adhesive.relaxation", "relax", "events, rest"),
    ("bem.path.locating", "locate", "events, rest"),
    ("bem.path.symmetry", "other_branch", "events, rest"),
    ("bem.path.jump", "Jumps._minimum", "events, rest"),
    ("bem.path.touch", "locate_touch", "events, rest"),
    ("bem.certified_states", "equilibrium_state", "states kept, rest"),
    ("bem.audit.certificate", "certify", "certificate"),
    ("bem.path.path", "Path.assess", "error estimate"),
    ("bem.nonadhesive.convex_path", "ConvexPath.assess", "error estimate"),
    ("bem.observables.observables", "contact_fields", "outputs"),
)
REST = "path, rest"


@dataclass
class StageTimes:
    """Seconds of each stage without those inside it, with them, and calls."""

    own: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    whole: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    calls: Counter[str] = field(default_factory=Counter)
    total: float = 0.0

    def shares(self) -> dict[str, float]:
        """Own seconds of every stage and of the rest, adding up to the total."""
        known = dict(self.own)
        return known | {REST: self.total - sum(known.values())}


@contextmanager
def timed_stages() -> Iterator[StageTimes]:
    """Measure the stages of all that runs inside."""
    for module, _, _ in STAGES:
        import_module(module)
    times = StageTimes()
    stack: list[list[Any]] = []  # [stage, seconds inside]
    restore: list[tuple[Any, str, Any]] = []
    wrapped: dict[int, Any] = {}

    def replace(holder: Any, name: str, value: Any) -> None:
        restore.append((holder, name, getattr(holder, name)))
        setattr(holder, name, value)

    for module, path, stage in STAGES:
        holder, name = import_module(module), path
        if "." in path:
            first, name = path.split(".")
            owner = getattr(holder, first)
            if not isinstance(owner, type):  # a foreign module: only the solver's view of it changes
                view = owner if isinstance(owner, SimpleNamespace) else SimpleNamespace(**vars(owner))
                replace(holder, first, view)
                owner = view
            holder = owner
        original = getattr(holder, name)
        timed = wrapped.setdefault(id(original), _timed(original, stage, times, stack))
        replace(holder, name, timed)
        for other in list(sys.modules):
            held = sys.modules[other]
            if other.startswith("bem") and "." not in path and vars(held).get(name) is original:
                replace(held, name, timed)
    begun = time.process_time()
    try:
        yield times
    finally:
        times.total = time.process_time() - begun
        for holder, name, value in reversed(restore):
            setattr(holder, name, value)


def _timed(function: Callable[..., Any], stage: str, times: StageTimes, stack: list[list[Any]]) -> Callable[..., Any]:
    @wraps(function)
    def inner(*args: Any, **options: Any) -> Any:
        nested = any(entry[0] == stage for entry in stack)
        stack.append([stage, 0.0])
        begun = time.process_time()
        try:
            return function(*args, **options)
        finally:
            seconds = time.process_time() - begun
            _, inside = stack.pop()
            times.own[stage] += seconds - inside
            times.calls[stage] += 1
            if not nested:
                times.whole[stage] += seconds
            if stack:
                stack[-1][1] += seconds

    return inner
