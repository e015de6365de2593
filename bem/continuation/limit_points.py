"""Limit points: where a branch of equilibria ends or turns unstable, located by their own equation, with an error.

At a limit point the equilibrium is neutral: with the gradient g of the potential, its Hessian H and the control tau

    g(x, tau) = 0,   mu(x, tau) = 0,   mu the smallest eigenvalue of H, v its mode,

motions of the edges being in units of the root of edge scale over work of adhesion (softness.py).

At a fold the load works on the mode (v . dg/dtau != 0): Newton on both equations at once, the last row of which is
d mu = D_v H v . dx + v . dH/dtau v dtau (Seydel, Practical Bifurcation and Stability Analysis, 2010, section 5.4).
Both derivatives of H are exact (third_derivatives.py).  Where the mode breaks a symmetry that loading keeps, the load
does no work on it, and the branch continues unstable: mu changes sign along it.  Newton on the same equations finds
that, with the modes that break the symmetry at rest.  Coarse evaluations lead to a fold, the finest alone to where a
symmetry breaks, since coarse ones are less symmetric than the profile; finer ones improve it, and
what the finest change after them, of a smaller tolerance or else another resolution, is its error; what Newton had left
before is part of it.
Dimensionless.  Limits: at a fold one mode alone is neutral.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.equilibrium import Balance, System, balance, symmetric_part
from bem.adhesive.third_derivatives import with_slopes
from bem.continuation.foretold_folds import Foretold, foretell_folds
from bem.continuation.softness import (
    LONGEST_STEP,
    NEAR,
    LostError,
    Soft,
    after_step,
    eigenvalue_gradient,
    forces_at,
    is_at_rest,
    refined,
    to_rest,
)
from bem.continuation.turning_points import turning_points
from bem.elastic.collocation import finer, resolve
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.path_events import EventNumbers

STEPS = 8  # of Newton; it takes one to three, more where a fold is about to vanish (a cusp)
CLOSE = 3e-6  # of the edge scale: what the next step leaves is below 1e-9, a hundred times its square
NEUTRAL = 1e-4  # eigenvalue, of order 1: the same where edges hardly move on the way to the end of their branch
SOFT = 1e-2  # eigenvalues of modes that are neutral together; in this scale all are of order 1
SIDES = (1.0, 0.3, 3.0)  # cube roots of the push on a mode: where Newton for the fold beside it begins
FELT = 1e-9  # of the work of adhesion: a force on a mode, which then breaks no symmetry that the profile has


@dataclass(frozen=True, eq=False)
class LimitPoint:
    """An equilibrium at which a branch ends or loses its stability.

    Attributes
    ----------
    kind : {"fold", "broken_symmetry"}
    balance : Balance
        Forces next to it.
    exact, error : EventNumbers
        Its numbers, and what the last refinement changed.
    modes : (2 L, n) array
        Outward motions of the edges without resistance; one at a fold, to the side on which the potential falls.
    bend : float
        At a fold, -d2(tau)/ds2 / 2 on the branch, s in units of the mode.
    push : (2 L,) array
        Where a symmetry breaks, the force on the modes that are neutral, over the work of adhesion, as an outward
        motion: 0 but for rounding if the profile has the symmetry.  Others hold what pushes them.
    """

    kind: Literal["fold", "broken_symmetry"]
    balance: Balance
    exact: EventNumbers
    error: EventNumbers
    modes: FloatArray
    bend: float
    push: FloatArray = field(default_factory=lambda: np.zeros(0))

    @property
    def is_pushed(self) -> bool:
        """Whether a force acts along the modes of a bifurcation: the profile does not quite have the symmetry."""
        return bool(np.linalg.norm(self.push) > FELT)


class UndecidedError(Exception):
    """Coarse evaluations lead to a limit point that finer ones do not find, or find behind another one.

    Or they find none, where two modes are to fold at once.
    """


@dataclass(frozen=True)
class Search:
    """Where a limit point is looked for, and how.

    Parameters
    ----------
    reach : float
        How far the control may change, with the sign of its motion.
    tolerances : (float, float, float)
        Of coarse evaluations, finer ones, and the last.
    thorough : bool
        Whether the branch is followed around its fold where Newton fails: almost symmetric profiles turn sharply.
    refused : callable, optional
        Whether a fold is of no use, from the forces next to it and its value, while it is known coarsely.
    """

    reach: float
    tolerances: tuple[float, float, float]
    thorough: bool = False
    refused: Callable[[Balance, float], bool] | None = None


def locate_limit_point(system: System, start: Balance, value: float, search: Search) -> LimitPoint | None:
    """The limit point that ends the branch of an equilibrium, None where none is found.

    Parameters
    ----------
    system : System
    start : Balance
        At `value` of the control, before the limit point.
    value : float
        Of the control.
    search : Search

    Raises
    ------
    UndecidedError
        There is none where the coarse evaluations of the search lead.
    """
    try:
        return if_solvable(_located, system, start, value, search)
    except (LostError, np.linalg.LinAlgError):
        return None


def _located(system: System, start: Balance, value: float, search: Search) -> LimitPoint | None:
    """The fold or bifurcation next to a branch: first what breaks a symmetry, then the fold beside it or alone."""
    reach, broken = search.reach, None
    start = with_slopes(system, start, value, search.tolerances[0])
    soft = Soft(system, start, value, start.scale)
    if is_at_rest(soft, soft.mode) or np.ptp(soft.eigenvalues[:2]) < SOFT:
        soft = Soft(system, start, value, start.scale, every=True)
        for _ in range(2):  # or else what the modes that break a symmetry carry of the error between targets stays
            here = refined(system, soft, to_rest(soft), value, search.tolerances[2], False)
            soft = Soft(system, here, value, start.scale, every=True)
    if is_at_rest(soft, soft.mode):
        # coarser evaluations are less symmetric than the profile, and nearly equal modes of both kinds mix
        search = replace(search, tolerances=(search.tolerances[2],) * 3)
        broken = _neutral(system, soft, value, replace(search, refused=None), breaking=True)
        if broken is not None and not broken.is_pushed:
            return broken
        found = None if broken is None else _beside(system, broken, soft.scale, replace(search, refused=None))
        if found is not None:
            return found
    unasked = replace(search, refused=None)
    expected = foretell_folds(system, soft, reach)
    near = soft if expected is None else _near(system, soft, expected, reach, search.tolerances[0])
    rivals = near is not None and expected is not None and expected.has_rivals
    if near is None and search.thorough:
        near = soft
    found = None if near is None else _neutral(system, near, value, search, breaking=False)
    if found is None and rivals and search.tolerances[0] > search.tolerances[2]:
        raise UndecidedError
    if found is not None and (expected is None or _is_expected(found, soft, expected)):
        return found
    if search.thorough or broken is not None:
        for near in turning_points(system, soft, reach, search.tolerances[0]):
            with suppress(LostError):
                found = _neutral(system, near, value, unasked, breaking=False)
                if found is not None:
                    return found
    return broken if search.thorough else None


def _near(system: System, soft: Soft, expected: Foretold, reach: float, tolerance: float) -> Soft | None:
    """The forces where the branch of a point is expected to fold first, or on the way there.

    None where that is too far or no such place, or where a symmetry breaks first by a mode that is not the softest yet.
    """
    if expected.distance > 2 * abs(reach) or expected.breaks[0]:
        return None
    motion, change = expected.next_to_fold(soft)
    resolution = resolve(system.elastic, soft.here.state.patches, tolerance)
    try:
        here = forces_at(system, soft, motion, soft.value + change, tolerance, resolution)
    except LostError:
        return None
    return Soft(system, here, soft.value + change, soft.scale, expected.modes[:, 0])


def _is_expected(fold: LimitPoint, soft: Soft, expected: Foretold) -> bool:
    """Whether the modes are as soft at a fold as a point of its branch foretells, and the load works on its own.

    Where it does not, a symmetry breaks just before the fold, by a mode that is stiffer at the point.
    """
    at = Soft(soft.system, fold.balance, fold.exact.value, soft.scale)
    if is_at_rest(at, fold.modes[:, 0] / soft.scale):
        return False
    return expected.have_softened(symmetric_part(fold.balance.hessian, soft.scale), fold.exact.value - soft.value)


def _step(soft: Soft, slope: FloatArray, breaking: bool) -> tuple[FloatArray, float]:
    """Newton step of the edges and of the control towards g = 0, mu = 0; modes that break a symmetry stay at rest.

    `slope` is the derivative of the smallest eigenvalue by the edges, (2 L,).
    """
    if breaking:
        basis = soft.modes[:, ~_broken(soft)]
        hessian, pull, force = basis.T @ soft.hessian @ basis, basis.T @ soft.pull, basis.T @ soft.gradient
        slope = slope @ basis
    else:
        hessian, pull, force = soft.hessian, soft.pull, soft.gradient
    size = pull.size
    matrix = np.empty((size + 1, size + 1))
    matrix[:size, :size], matrix[:size, size] = hessian, pull
    matrix[size, :size], matrix[size, size] = slope, soft.eigenvalue_rate
    step = np.linalg.solve(matrix, -np.append(force, soft.eigenvalues[0]))
    if not np.all(np.isfinite(step)):
        raise LostError
    return np.asarray(basis @ step[:size] if breaking else step[:size]), float(step[size])


def _broken(soft: Soft) -> NDArray[np.bool_]:
    """Which soft modes break a symmetry that loading keeps, (number of modes,)."""
    return np.asarray(is_at_rest(soft, soft.modes) & (soft.eigenvalues < 2 * abs(soft.eigenvalues[0]) + SOFT))


@dataclass(frozen=True, eq=False)
class _Newton:
    """An iterate of Newton's method on the equilibrium and its neutrality, with the step to the next.

    `gradient` is the derivative of the smallest eigenvalue by the edges, (2 L,).
    """

    soft: Soft
    gradient: FloatArray
    step: FloatArray
    change: float

    @property
    def size(self) -> float:
        """Of the step, in parts of the edge scale."""
        return self.soft.size(self.step)

    @property
    def close(self) -> bool:
        """Whether one more step reaches the limit point."""
        return self.size <= CLOSE and abs(float(self.soft.eigenvalues[0])) <= NEUTRAL


def _neutral(system: System, soft: Soft, begin: float, search: Search, breaking: bool) -> LimitPoint | None:
    """A fold, or the point where a symmetry breaks: reached by coarse evaluations, then improved by finer ones."""
    reach, tolerances = search.reach, search.tolerances
    near = _approached(system, soft, begin, reach, tolerances[0], breaking)
    if near is None:
        return None
    here, value = near.soft.here, near.soft.value + near.change
    ends = not breaking and _ends_branch(near.soft, near.gradient, reach)
    if search.refused is not None and ends and search.refused(here, value):
        raise LostError
    try:
        improved = _improved(system, near, tolerances[1:], breaking)
    except LostError:
        improved = None
    if improved is None or not (breaking or _ends_branch(improved[0].soft, improved[0].gradient, reach)):
        if ends and tolerances[0] > tolerances[2]:
            raise UndecidedError
        return None
    at, exact, error = improved
    soft = at.soft
    if breaking:
        broken = _broken(soft)
        if not broken[0]:
            return None
        modes = soft.modes[:, broken] * soft.scale[:, None]
        push = _push(soft.here, modes[:, soft.eigenvalues[broken] <= NEUTRAL])
        kept, held = soft.modes[:, ~broken], soft.eigenvalues[~broken]
        rate = soft.eigenvalue_rate - float((at.gradient @ kept) @ ((soft.pull @ kept) / held))  # along the branch
        shift = float(np.linalg.norm(push)) ** (2 / 3) / abs(rate)  # of a fold beside the bifurcation
        error = replace(error, value=error.value + shift)
        return LimitPoint("broken_symmetry", soft.here, exact, error, modes, 0.0, push)
    cubic, work = float(at.gradient @ soft.mode), float(soft.pull @ soft.mode)
    mode = -np.sign(cubic) * soft.mode * soft.scale
    return LimitPoint("fold", soft.here, exact, error, mode[:, None], cubic / (2 * work))


def _ends_branch(soft: Soft, gradient: FloatArray, reach: float) -> bool:
    """Whether a fold ends its branch: not where another limit point lies before it, or where it begins a branch."""
    cubic, work = float(gradient @ soft.mode), float(soft.pull @ soft.mode)
    return soft.is_alone and cubic * work * reach > 0


def _newton(system: System, soft: Soft, breaking: bool) -> _Newton:
    """The iterate at some forces."""
    gradient = eigenvalue_gradient(soft)
    return _Newton(soft, gradient, *_step(soft, gradient, breaking))


def _approached(
    system: System, soft: Soft, begin: float, reach: float, tolerance: float, breaking: bool
) -> _Newton | None:
    """Newton until the next step is short; None where steps do not shrink, or lead too far from `begin`."""
    before, resolution = np.inf, resolve(system.elastic, soft.here.state.patches, tolerance)
    for count in range(STEPS):
        at = _newton(system, soft, breaking)
        if at.size <= NEAR:
            return at
        if count > 1 and at.size > before:
            return None
        part, before = min(1.0, LONGEST_STEP / at.size), at.size
        value = soft.value + part * at.change
        if not -0.5 <= (value - begin) / reach <= 2:
            return None
        here = forces_at(system, soft, part * at.step, value, tolerance, resolution)
        soft = Soft(system, here, value, soft.scale, soft.mode, breaking)
    return None


def _improved(
    system: System, at: _Newton, tolerances: tuple[float, ...], breaking: bool
) -> tuple[_Newton, EventNumbers, EventNumbers] | None:
    """Finer steps until one is short, then those of the finest evaluations until one is close.

    With the numbers after the last step, and how far those after the last finer one are from them.
    """
    fine, finest = tolerances
    before: EventNumbers | None = None
    for _ in range(STEPS):
        value = at.soft.value + at.change
        tolerance, other = (fine, False) if before is None else (finest, finest == fine)
        here = refined(system, at.soft, at.step, value, tolerance, other)
        at = _newton(system, Soft(system, here, value, at.soft.scale, at.soft.mode, breaking), breaking)
        if at.size > 10 * NEAR:
            return None
        numbers = after_step(system, here, value, at.step * at.soft.scale, at.change)
        if before is not None and at.close:
            return at, numbers, numbers.apart(before, system.control.force(here.state))
        if before is None and at.size <= NEAR:
            before = numbers
    return None


def sharper(system: System, limit: LimitPoint, tolerance: float) -> LimitPoint:
    """A fold as one more evaluation gives it, of more nodes and modes, and what that changes as its error.

    The error of a limit point is otherwise what the last tolerance changes, which may be a thousand times more.  The
    fold as it is where the evaluation fails.

    Raises
    ------
    IllConditionedSystemError
    """
    state, value, mode = limit.balance.state, limit.exact.value, limit.modes[:, 0]
    known = Soft(system, limit.balance, value, limit.balance.scale)
    more = finer(system.elastic, state.patches, state.resolution, 1e-2 * tolerance)
    with suppress(LostError, np.linalg.LinAlgError):
        again = forces_at(system, known, np.zeros(mode.size), value, tolerance, more)
        at = _newton(system, Soft(system, again, value, known.scale, mode / known.scale), breaking=False)
        if at.close:
            exact = after_step(system, again, value, at.step * known.scale, at.change)
            error = exact.apart(limit.exact, system.control.force(again.state))
            return replace(limit, balance=again, exact=exact, error=error)
    return limit


def before_fold(limit: LimitPoint, value: float) -> Patches:
    """Edges on the branch that a fold ends, at a value of the control close before it."""
    back = np.sqrt(max((limit.exact.value - value) / limit.bend, 0.0))
    return limit.balance.state.patches.moved(-back * limit.modes[:, 0])


def _beside(system: System, broken: LimitPoint, scale: FloatArray, search: Search) -> LimitPoint | None:
    """The fold beside a bifurcation of an almost symmetric profile, whose modes are pushed a little: Newton from there.

    With the push f, the branch s of the mode and its fold obey f + mu s + c s^3 = 0 and mu + 3 c s^2 = 0: s ~ f^(1/3).
    """
    state, value = broken.balance.state, broken.exact.value
    way = broken.push / float(np.max(np.abs(broken.push) / state.patches.edge_scale))
    middle = float(np.cbrt(np.linalg.norm(broken.push)))
    for side in SIDES:
        patches = state.patches.moved(side * middle * way)
        here = balance(system.sloped, patches, state.penetration, value, search.tolerances[0])
        found = _neutral(system, Soft(system, here, value, scale), value, search, breaking=False)
        if found is not None:
            return found
    return None


def _push(here: Balance, modes: FloatArray) -> FloatArray:
    """Force along modes over the work of adhesion, as an outward motion, (2 L,)."""
    unit = modes / np.linalg.norm(modes, axis=0)
    return np.asarray(-unit @ (here.gradient @ unit) / np.max(here.work))
