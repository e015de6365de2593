"""One random scene solved and judged: by itself, by its copies, and by dense algebra at its stored edges.

Every scene that has an answer is solved once more at a third of its increment and once as a copy (scaled, shifted,
mirrored or restarted: by its number, so that a fourth of the scenes are asked each way), and the stored states at its
targets are solved by dense algebra (references/dense_equilibrium.py), whose distance from them their error estimates
must bound.  Scenes taken to an extreme are judged by their own result alone: an answer or a refusal by name.
"""

import math
import re
import tempfile
import time
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from bem.elastic.layer import Layer
from bem.geometry.scaling import Solid
from bem.scene.result import Result, State
from bem.scene.scene import Scene, SceneError, parse_scene
from bem.solver import solve
from validation.corpus.hard.hard_case_run import TrialOutcome
from validation.corpus.random.random_checks import Objection, Units, energy_balance, findings_of
from validation.corpus.random.random_copies import COPIES, STATE, compared, smaller_increment
from validation.corpus.random.random_scenes import Drawn, draw
from validation.references.dense import dense_nodes
from validation.references.dense_equilibrium import NoReferenceError, reference

MOST_DENSE = 3  # states of a scene that are solved by dense algebra: the first, the last and one between
MOST_WORK = 2e7  # nodes squared times terms of the layer, below 1 s: states that need more are not


def case_of(name: str) -> Drawn:
    """The scene of a name.

    Examples
    --------
    >>> case_of("seed_3_scene_14").index
    14
    """
    found = re.fullmatch(r"seed_(\d+)_scene_(\d+)", name)
    if found is None:
        raise ValueError(f"{name!r}: seed_K_scene_k is the name of a random scene")
    return draw(int(found[1]), int(found[2]))


def run_case(drawn: Drawn, full: bool = False) -> TrialOutcome:
    """Solve and judge a random scene; `full` makes no difference.

    Whatever leaves `solve` besides a mistake of the scene is raised: that is the crash that the study counts.
    """
    begun = time.process_time()
    with tempfile.TemporaryDirectory() as name, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        folder = Path(name)
        drawn.write_scan(folder)
        try:
            scene = parse_scene(drawn.tables, folder)
            result = solve(scene)
        except SceneError as error:
            return _refused(drawn, error, time.process_time() - begun)
        seconds = time.process_time() - begun
        findings = [Objection("warning", text) for text in sorted({str(warning.message) for warning in caught})]
        findings += judged(drawn, scene, result, folder)
    if drawn.expected == "a refusal":
        findings.append(Objection("refusal", f"{drawn.special} is accepted"))
    extreme = drawn.expected == "an answer or a refusal" and result.failure is not None
    named = result.status == "unreachable" or extreme
    return TrialOutcome(
        id=drawn.id,
        expected=(drawn.expected,),
        observed=(drawn.expected if named else result.status,),
        converged=result.status == "converged",
        correct=not findings and (named or result.status == "converged"),
        refused_reason=f"{result.status} after {sum(state.found for state in result.targets)} targets"
        if named
        else None,
        findings=tuple(map(str, findings)),
        seconds=seconds,
        kinds=tuple(finding.kind for finding in findings),
    )


def judged(drawn: Drawn, scene: Scene, result: Result, folder: Path) -> list[Objection]:
    """What speaks against a result; copies only of ordinary scenes that ended by name."""
    findings = findings_of(scene, result)
    if drawn.expected != "an answer" or result.status not in ("converged", "unreachable"):
        return findings
    findings += dense_route(scene, result)
    other = COPIES[drawn.index % len(COPIES)]
    for make in (smaller_increment, other):
        made = make(drawn.tables, scene, result, folder)
        made = made or COPIES[drawn.index // len(COPIES) % (len(COPIES) - 1)](drawn.tables, scene, result, folder)
        if made is None:
            continue
        try:
            again = solve(made.scene)
            findings += compared(made, scene, result, again)
            if made.kind == "increment" and not any(energy_balance(made.scene, again, Units.of(made.scene))):
                findings = [finding for finding in findings if finding.kind != "energy balance"]  # quadrature alone
        except Exception as error:
            findings.append(Objection(made.kind, f"{type(error).__name__}: {error}"))
    return findings


def dense_route(scene: Scene, result: Result) -> Iterator[Objection]:
    """The equilibrium that dense algebra finds next to stored edges, against the errors estimated."""
    touching = [state for state in result.targets if state.edges and _dense_work(scene, state) <= MOST_WORK]
    chosen = sorted({round(k) for k in np.linspace(0, len(touching) - 1, MOST_DENSE)}) if touching else []
    units = Units.of(scene)
    for state in (touching[k] for k in chosen):
        goal = getattr(state, scene.loading.control)
        nearest = min(scene.loading.targets, key=lambda target: abs(target - goal))
        at = nearest if abs(nearest - goal) <= 1e-9 * units.unit(scene) else goal
        posed = replace(scene, loading=scene.loading.model_copy(update={"targets": (at,)}))
        try:
            known = reference(posed, state)
        except (NoReferenceError, np.linalg.LinAlgError, ValueError) as error:
            yield Objection("dense route", f"{type(error).__name__}: {error}, at {scene.loading.control} {goal:g}")
            continue
        wrong = list(_missed(units, state, known))
        if wrong:
            yield Objection("dense route", f"{', '.join(wrong)} at {scene.loading.control} {goal:g}")


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


def _refused(drawn: Drawn, error: SceneError, seconds: float) -> TrialOutcome:
    """A scene refused before it ran: right where it was expected and the mistake names the key.

    That the pressure shuts a flaw which is wider than half the shortest wave is known only when it is evaluated.
    """
    key, profile, flaw = drawn.special.split(" ")[0], drawn.tables["profile"], drawn.tables["loading"].get("flaw", 0.0)
    if drawn.expected == "an answer":
        most = max(profile.get("orders", [profile.get("harmonics", 1)]))
        key = "loading.flaw" if 2 * flaw * most > profile.get("period", 0.0) else key
    right = bool(key) and any(key in mistake.path for mistake in error.mistakes)
    findings = () if right else (Objection("refusal", f"of {drawn.expected}"),)
    return TrialOutcome(
        id=drawn.id,
        expected=(drawn.expected,),
        observed=(drawn.expected if right else "refused",),
        converged=False,
        correct=right,
        refused_reason=" ".join(str(error).split()),
        findings=tuple(map(str, findings)),
        seconds=seconds,
        kinds=tuple(finding.kind for finding in findings),
    )
