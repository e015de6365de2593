"""A scene asked of the boundary elements: what any result must obey, and what a hard case asks besides.

Correct is apart from converged: certificates, identities, energies and events of any result (any_result.py), the
checks that the case names (hard_case_checks.py), and that its targets are as hard as intended.  SI units.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from bem.geometry.profile import Profile
from bem.scene.scene import SceneError, parse_scene
from bem.solver import solve
from validation.corpus.hard.any_result import Solved, findings_of
from validation.corpus.hard.hard_case_checks import CHECKS
from validation.corpus.hard.hard_case_run import Asked, Check, Finding
from validation.references.paper_problem import PERIOD, RMS_HEIGHT, Table

FINEST = 1000  # harmonics of the full form
ROUNDED = 1e-5  # of a contact fraction that is to be reached; measured 1.9e-6 at 1e-5


class SceneCase(Asked):
    """A case whose question is a scene."""

    refusals: ClassVar[tuple[type[Exception], ...]] = (SceneError,)
    known: ClassVar[Mapping[str, Check]] = CHECKS

    def write_scan(self, folder: Path) -> None:
        """Write the samples, if the profile has any."""

    def answer(self, full: bool, folder: Path) -> Solved:
        """The scene solved, with its scan beside it."""
        self.write_scan(folder)
        tables = self.posed(full)
        scene = parse_scene(tables, folder)
        return Solved(tables, solve(scene), scene, folder)

    def findings(self, found: Solved, full: bool) -> Iterator[Finding]:
        """What a result says against itself, and what its checks say."""
        if "not_converged" in self.ended(found, full)[0]:
            yield Finding("certificate", f"not converged: {found.result.failure}")
        yield from findings_of(found)
        yield from super().findings(found, full)


@dataclass(frozen=True, eq=False)
class HardCase(SceneCase):
    """A scene that is hard; the full form takes the finest profile, besides what it changes otherwise.

    Expected is every status at targets; converged where they are not said, or are not as many.
    """

    checks: tuple[str, ...] = ("dense",)
    events: tuple[str, ...] = ()  # kinds that must occur
    samples: tuple[int, float] | None = None  # the scan to write as profile.file: number, and rms noise in m
    reached: Table = field(default_factory=dict)  # what the targets must include, by the names in `missed`
    reached_in_full: Table = field(default_factory=dict)

    refusals: ClassVar[tuple[type[Exception], ...]] = (SceneError, ArithmeticError, MemoryError)

    def posed(self, full: bool) -> Table:
        """The scene in one of its forms."""
        profile = self.question["profile"]
        finest = {"profile": profile | {"harmonics": FINEST}} if full and "harmonics" in profile else {}
        return self.question | finest | (self.full if full else {})

    def expectation(self, full: bool) -> tuple[str, ...]:
        """Expected status of the result, then of each target."""
        count = len(self.posed(full)["loading"]["targets"])
        targets = self.expected if len(self.expected) == count else ("converged",) * count
        return ("unreachable" if "unreachable" in targets else "converged", *targets)

    def write_scan(self, folder: Path) -> None:
        """A rough profile with noise, as two columns x, h."""
        if self.samples is not None:
            number, noise = self.samples
            x = np.arange(number) * (PERIOD / number)
            height = Profile.self_affine(PERIOD, 0.7, RMS_HEIGHT, 2000, 0).height(x)
            height += np.random.default_rng(0).normal(0.0, noise, number)
            path = folder / self.question["profile"]["file"]
            np.savetxt(path, np.column_stack([x, height]), delimiter=",", fmt="%.12e")

    def findings(self, found: Solved, full: bool) -> Iterator[Finding]:
        """What a result says against itself, and what the case asks besides."""
        yield from super().findings(found, full)
        if not found.result.targets:
            yield Finding("targets", "none is there")
        happened = {event.kind for event in found.result.events}
        yield from (Finding("event", f"{kind} missing") for kind in self.events if kind not in happened)
        yield from (Finding("reached", text) for text in missed(self.reached_in_full if full else self.reached, found))


def missed(wanted: Table, found: Solved) -> Iterator[str]:
    """What the targets do not reach, without which the case is not as hard as intended.

    Of some target: a contact fraction at the `least`, or the `largest`; the narrowest `gap`, or `patch`, in periods, to
    a factor of two.
    """
    period, states = found.scene.surface().period, found.touching
    fractions = [state.contact_fraction for state in states]
    for name, value in wanted.items():
        if name == "least" and not min(fractions, default=np.inf) <= value * (1 + ROUNDED):
            yield f"contact fraction {value:g} not reached from above"
        if name == "largest" and not max(fractions, default=-np.inf) >= value * (1 - ROUNDED):
            yield f"contact fraction {value:g} not reached from below"
        if name in ("gap", "patch"):
            widths = [_widths(name, np.array(state.edges) / period).min() for state in states]
            if not any(value / 2 <= width <= 2 * value for width in widths):
                yield f"no {name} of {value:g} periods"


def _widths(name: str, edges: NDArray[np.float64]) -> NDArray[np.float64]:
    """Widths of patches, or of the gaps behind them, of edges in periods, (n_patches,)."""
    left, right = edges.T
    return np.asarray(right - left if name == "patch" else np.append(left[1:], left[0] + 1) - right)
