"""Patches that stand: of two crests that differ by little one detaches, the other stays until its own pull-off.

A wave carries a ripple whose crests come in pairs of nearly equal height.  When one of a pair detaches, its tension is
missing and the other patch, narrower by then than a lone contact at pull-off, shrinks before it comes to rest.  The
reference follows the overdamped motion of the edges down the energy,

    d(edge)/dt ~ -dU/d(edge) l / w,   l the narrower of patch and gap,

from the state before, where the first of them detaches, in small explicit steps until the forces are a ten-thousandth
of w, and ends with Newton.  A patch is gone when it is narrower than a thousandth of what it was.  SI units.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import bem
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared, counted
from validation.harness.schema import Reference
from validation.references import adapters

ORDERS, AMPLITUDES, PHASES, WORK = (1, 24), (3e-5, 4e-6), (0.0, 0.02), 0.01
PERIOD, DEEPEST, BETWEEN = 0.01, 10e-6, 2.16e-6  # m; the outer pair detaches at penetrations of 2.22 and 2.11 um
PAST = 0.02e-6  # m beyond the fold, at which the motion would take for ever
STEP, LARGEST, STEPS = 0.2, 0.05, 5000  # of l: times the force over w, and at most; steps
NEWTON_STEPS, AT_REST, GONE = 4, 1e-4, 1e-3


def relaxed(edges: FloatArray, depth: float) -> FloatArray:
    """Edges in m, (n, 2), at rest at a penetration in m, from the given ones."""
    profile = bem.Profile.from_harmonics(PERIOD, ORDERS, AMPLITUDES, PHASES)
    widths = edges[:, 1] - edges[:, 0]
    for _ in range(STEPS):
        state = _state(profile, edges, depth)
        force = state.gradient / WORK
        if np.max(np.abs(force)) < AT_REST:
            break
        gap = np.append(edges[1:, 0], edges[0, 0] + PERIOD) - edges[:, 1]
        beside = np.stack([np.roll(gap, 1), gap], axis=1)
        scale = np.minimum(beside, (edges[:, 1] - edges[:, 0])[:, None])
        edges = edges - np.clip(STEP * force, -LARGEST, LARGEST) * scale
        stays = edges[:, 1] - edges[:, 0] > GONE * widths
        edges, widths = edges[stays], widths[stays]
    for _ in range(NEWTON_STEPS):
        state = _state(profile, edges, depth)
        edges = edges - np.linalg.solve(state.hessian, state.gradient.ravel()).reshape(edges.shape)
    return edges


def _state(profile: bem.Profile, edges: FloatArray, depth: float) -> bem.ContactState:
    return bem.ContactState(
        profile, bem.Solid(1e6, 0.5), edges, depth, adhesion=bem.Adhesion(WORK, False), tolerance=1e-8
    )


def _standing() -> Outcome:
    changes: dict[str, Any] = {
        "profile": {"orders": list(ORDERS), "amplitudes": list(AMPLITUDES), "phases": list(PHASES)},
        "adhesion": {"work_of_adhesion": WORK},
        "loading": {"targets": [DEEPEST, BETWEEN]},
        "accuracy": {"max_increment": 0.02, "tolerance": None},
    }
    result = bem.solve(adapters.scene("sinusoid", changes))
    last = result.targets[-1]
    before = next(s for s in reversed(result.states) if s.branch == "unloading" and s.n_patches > last.n_patches)
    event = next(e for e in result.events if e.kind == "detachment")
    rest = relaxed(relaxed(np.array(before.edges), event.penetration - PAST), BETWEEN)
    flow = Reference(kind="self", source="overdamped motion of the edges in small steps, from the state before")
    rows = (
        counted("patches before and after one of a pair has detached", flow, [5.0, float(len(rest))],
                [float(before.n_patches), float(last.n_patches)]),
        compared("contact fraction after it has detached", "", flow, [float(np.sum(rest[:, 1] - rest[:, 0])) / PERIOD],
                 [last.contact_fraction],
                 *MEASURED_REST),
    )  # fmt: skip
    return Outcome(rows=rows)


MEASURED_REST = (6e-12, 2.3e-12)  # rounding of the motion in small steps; the state is good to 2e-14

CASES = (
    Case(id="standing-patches", group="path", level="quick",
         question="Does a patch stand that shrinks, but comes to rest, when another one detaches?",
         equations="d(edge)/dt ~ -dU/d(edge)",
         sources=("carbone2009",), compute=_standing, effects=("half_space", "adhesion", "unloading"),
         scene=adapters.scene_text("sinusoid")),
)  # fmt: skip
