"""Patches that stand: of two crests that differ by little one detaches, the other stays until its own pull-off.

A wave carries a ripple whose crests come in pairs of nearly equal height.  When one of a pair detaches, its tension is
missing and the other patch, narrower by then than an isolated contact at pull-off, shrinks before it comes to rest.
Equal crests break their symmetry on unloading: one patch shrinks, its neighbours grow, the next ones shrink; which of
them detach follows from the way that this begins.  The reference follows the overdamped motion of the edges down the
energy,

    d(edge)/dt ~ -dU/d(edge) l / w,   l the narrower of patch and gap,

from the state before in small explicit steps until the forces are a ten-thousandth
of w, and ends with Newton.  A patch is gone when it is narrower than a thousandth of what it was.  SI units.
"""

from dataclasses import dataclass

import numpy as np

import bem
from bem.scene.result import Result
from validation.cases.shared.checks import Against, Found, beside, case, solved
from validation.harness.arrays import FloatArray

PERIOD, DEEPEST, BETWEEN = 0.01, 10e-6, 2.16e-6  # m; the outer pair detaches at penetrations of 2.22 and 2.11 um
AROUND, SMALLER = (-5.4e-6, -5.8e-6), 0.01  # m; widths: seven equal patches part at a penetration of -5.46 um
PAST = 0.02e-6  # m beyond the fold, at which the motion would take for ever
STEP, LARGEST, STEPS = 0.2, 0.05, 5000  # of l: times the force over w, and at most; steps
NEWTON_STEPS, AT_REST, GONE = 4, 1e-4, 1e-3


@dataclass(frozen=True)
class Waves:
    """Orders, amplitudes in m and phases of a profile, and its work of adhesion in J/m^2."""

    orders: tuple[int, ...]
    amplitudes: tuple[float, ...]
    phases: tuple[float, ...]
    work: float

    def state(self, edges: FloatArray, depth: float) -> bem.ContactState:
        """Contact of given patches, (n, 2) in m, at a penetration in m."""
        profile = bem.Profile.from_harmonics(PERIOD, self.orders, self.amplitudes, self.phases)
        adhesion = bem.Adhesion(self.work, False)
        return bem.ContactState(profile, bem.Solid(1e6, 0.5), edges, depth, adhesion=adhesion, tolerance=1e-8)

    def relaxed(self, edges: FloatArray, depth: float) -> FloatArray:
        """Edges in m, (n, 2), at rest at a penetration in m, from the given ones."""
        widths = edges[:, 1] - edges[:, 0]
        for _ in range(STEPS):
            force = self.state(edges, depth).gradient / self.work
            if np.max(np.abs(force)) < AT_REST:
                break
            edges = edges - np.clip(STEP * force, -LARGEST, LARGEST) * beside(edges, PERIOD)
            stays = edges[:, 1] - edges[:, 0] > GONE * widths
            edges, widths = edges[stays], widths[stays]
        for _ in range(NEWTON_STEPS):
            state = self.state(edges, depth)
            edges = edges - np.linalg.solve(state.hessian, state.gradient.ravel()).reshape(edges.shape)
        return edges

    def solved(self, targets: list[float]) -> Result:
        """The path of the solver to penetrations in m."""
        profile = {"orders": self.orders, "amplitudes": self.amplitudes, "phases": self.phases}
        return solved("sinusoid", profile={name: list(values) for name, values in profile.items()},
                      adhesion={"work_of_adhesion": self.work}, loading={"targets": targets},
                      accuracy={"max_increment": 0.02, "tolerance": None})  # fmt: skip


PAIRS = Waves((1, 24), (3e-5, 4e-6), (0.0, 0.02), 0.01)
EQUAL = Waves((7,), (2e-5,), (0.0,), 0.1)
FLOW = Against("self", "overdamped motion of the edges in small steps, from the state before")


def _standing() -> Found:
    result = PAIRS.solved([DEEPEST, BETWEEN])
    last = result.targets[-1]
    before = next(s for s in reversed(result.states) if s.branch == "unloading" and s.n_patches > last.n_patches)
    event = next(e for e in result.events if e.kind == "detachment")
    rest = PAIRS.relaxed(PAIRS.relaxed(np.array(before.edges), event.penetration - PAST), BETWEEN)
    width = float(np.sum(rest[:, 1] - rest[:, 0])) / PERIOD
    yield FLOW.count("patches before and after one of a pair has detached", [5.0, len(rest)],
                     [before.n_patches, last.n_patches])  # fmt: skip
    # rounding of the motion in small steps; the state is good to 2e-14
    yield FLOW.row("contact fraction after it has detached", "", width, last.contact_fraction, (6e-12, 2.3e-12))
    # patches left when the first of equal crests detaches; the motion begins with one patch made a little narrower
    first, after = EQUAL.solved([DEEPEST, *AROUND]).targets[1:]
    edges = np.array(first.edges)
    edges[0] += SMALLER * (edges[0, 1] - edges[0, 0]) * np.array([0.5, -0.5])
    yield FLOW.count("patches before and after the first of seven equal crests detaches",
                     [7.0, len(EQUAL.relaxed(edges, AROUND[1]))], [first.n_patches, after.n_patches])  # fmt: skip


CASES = (
    case("standing-patches", "path", _standing,
         "Does a patch stand that shrinks, but comes to rest, when another one detaches?",
         r"$\dot e \propto -\partial U / \partial e$ for every edge $e$",
         "carbone2009", "half_space adhesion unloading", scene="sinusoid"),
)  # fmt: skip
