"""One random scene as a case: judged by itself, by its copies, and by dense algebra at its stored edges.

Every scene that has an answer is solved once more at a third of its increment and once as a copy (scaled, shifted,
mirrored or restarted: by its number, so that a fourth of the scenes are asked each way), and the stored states at its
targets are solved by dense algebra (references/dense_equilibrium.py), whose distance from them their error estimates
must bound.  Scenes taken to an extreme are judged by their own result alone: an answer or a refusal by name.
"""

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bem.elastic.layer import Layer
from bem.geometry.scaling import Solid
from bem.scene.result import State
from bem.scene.scene import Scene, SceneError
from bem.solver import solve
from validation.corpus.hard import copies
from validation.corpus.hard.any_result import Solved, Units, energy_balance
from validation.corpus.hard.copies import STATE, Copy, compared
from validation.corpus.hard.hard_case_run import Finding
from validation.corpus.hard.scene_case import SceneCase
from validation.corpus.random.random_scenes import Drawn, draw
from validation.references.dense import dense_nodes
from validation.references.dense_equilibrium import NoReferenceError
from validation.routes.dense_algebra import reference

COPIES: tuple[Callable[[Solved], Copy | None], ...] = (
    copies.scaled,
    copies.shifted,
    copies.mirrored,
    copies.restarted,
)
MOST_DENSE = 3  # states of a scene that are solved by dense algebra: the first, the last and one between
MOST_WORK = 2e7  # nodes squared times terms of the layer, below 1 s: states that need more are not


def case_of(name: str) -> "RandomCase":
    """The case of a name.

    Examples
    --------
    >>> case_of("seed_3_scene_14").drawn.index
    14
    """
    found = re.fullmatch(r"seed_(\d+)_scene_(\d+)", name)
    if found is None:
        raise ValueError(f"{name!r}: seed_K_scene_k is the name of a random scene")
    return asked(draw(int(found[1]), int(found[2])))


def asked(drawn: Drawn) -> "RandomCase":
    """A scene drawn at random as a case; its full form is the same."""
    return RandomCase(drawn.id, drawn.reason, drawn.tables, expected=(drawn.expected,), drawn=drawn)


@dataclass(frozen=True, eq=False)
class RandomCase(SceneCase):
    """A scene drawn at random, of which no status is known beforehand."""

    drawn: Drawn = field(kw_only=True)

    def write(self, folder: Path) -> Path:
        """Write the scene file, and its scan beside it; the path of the scene file."""
        return self.drawn.write(folder)

    def write_scan(self, folder: Path) -> None:
        """Write the samples, if the profile has any."""
        self.drawn.write_scan(folder)

    def ended(self, found: Solved, full: bool) -> tuple[tuple[str, ...], bool, str | None]:
        """The status; a path that ends by name where it may is what was expected, and a refusal."""
        result, status = found.result, found.result.status
        extreme = self.drawn.expected == "an answer or a refusal" and result.failure is not None
        if status == "unreachable" or extreme:
            return self.expected, False, f"{status} after {sum(state.found for state in result.targets)} targets"
        return (status,), status == "converged", None

    def refused(self, error: Exception) -> tuple[tuple[str, ...], str, list[Finding]]:
        """Right where it was expected and a mistake names the key.

        That the pressure shuts a flaw which is wider than half the shortest wave is known only when it is evaluated.
        """
        key, profile, expected = self.drawn.special.split(" ")[0], self.question["profile"], self.drawn.expected
        if expected == "an answer":
            most = max(profile.get("orders", [profile.get("harmonics", 1)]))
            wide = 2 * self.question["loading"].get("flaw", 0.0) * most > profile.get("period", 0.0)
            key = "loading.flaw" if wide else key
        mistakes = error.mistakes if isinstance(error, SceneError) else ()
        reason = " ".join(str(error).split())
        if key and any(key in mistake.path for mistake in mistakes):
            return self.expected, reason, []
        return ("refused",), reason, [Finding("refusal", f"of {expected}")]

    def findings(self, found: Solved, full: bool) -> Iterator[Finding]:
        """What speaks against a result; copies only of ordinary scenes that ended by name."""
        itself = list(super().findings(found, full))
        if self.drawn.expected == "an answer" and found.result.status in ("converged", "unreachable"):
            others, balanced = self._copies(found)
            if balanced:
                itself = [finding for finding in itself if finding.kind != "energy balance"]  # quadrature alone
            itself += [*dense_route(found), *others]
        yield from itself
        if self.drawn.expected == "a refusal":
            yield Finding("refusal", f"{self.drawn.special} is accepted")

    def _copies(self, found: Solved) -> tuple[list[Finding], bool]:
        """What two copies say, and whether the energies of the one at a smaller increment balance."""
        index, findings, balanced = self.drawn.index, list[Finding](), False
        other = COPIES[index % len(COPIES)](found) or COPIES[index // len(COPIES) % (len(COPIES) - 1)](found)
        for made in (copies.smaller_increment(found), other):
            if made is None:
                continue
            try:
                again = solve(made.scene)
                findings += compared(made, found, again)
                if made.kind == "increment":
                    balanced = not any(energy_balance(replace(found, scene=made.scene, result=again)))
            except Exception as error:
                findings.append(Finding(made.kind, f"{type(error).__name__}: {error}"))
        return findings, balanced


def dense_route(solved: Solved) -> Iterator[Finding]:
    """The equilibrium that dense algebra finds next to stored edges, against the errors estimated."""
    scene, units = solved.scene, solved.units
    touching = [state for state in solved.touching if _dense_work(scene, state) <= MOST_WORK]
    chosen = sorted({round(k) for k in np.linspace(0, len(touching) - 1, MOST_DENSE)}) if touching else []
    for state in (touching[k] for k in chosen):
        goal = getattr(state, scene.loading.control)
        nearest = min(scene.loading.targets, key=lambda target: abs(target - goal))
        at = nearest if abs(nearest - goal) <= 1e-9 * units.unit(scene) else goal
        posed = replace(scene, loading=replace(scene.loading, targets=(at,)))
        try:
            known = reference(posed, state)
        except (NoReferenceError, np.linalg.LinAlgError, ValueError) as error:
            wrong = f"{type(error).__name__}: {error},"
        else:
            wrong = ", ".join(_missed(units, state, known))
        if wrong:
            yield Finding("dense route", f"{wrong} at {scene.loading.control} {goal:g}")


def _dense_work(scene: Scene, state: State) -> float:
    """Nodes that dense algebra needs at the edges of a state, squared, times the terms of a layer and its own ten."""
    surface, terms = scene.surface(), 0
    left, right = np.array(state.edges).T * surface.q0
    if scene.layer is not None:
        solid = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio)
        terms = Layer(scene.layer.thickness).kernel(solid, surface.period, 1e-16).terms
    return float(dense_nodes(surface.scaled(), left, right).sum()) ** 2 * (10 + terms)


def _missed(units: Units, state: State, known: dict[str, float]) -> Iterator[str]:
    """Names of the numbers farther from dense algebra than estimated."""
    soft = units.soft(state) / units.pressure
    intensity = {"stress_intensity_max": units.pressure * math.sqrt(units.period / (2 * math.pi))}
    for name, unit in (units.scales(state) | intensity).items():
        error = abs(float(getattr(state, name)) - known[name]) / unit
        estimate = (getattr(state.error_estimate, name) or 0.0) / unit
        if not error <= estimate + STATE + soft:
            yield f"{name} differs by {error:.1e}, {estimate:.1e} estimated"
