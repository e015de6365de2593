"""Judge of random scenes: each is solved at two increments, and its targets anew by dense algebra.

    python -m validation.cases.random_judge --seed 7 --count 100 --out FOLDER

writes the report of scenes 0..99 of seed 7, and the scene file of every scene that fails.  Scene k of seed K does not
depend on other scenes (corpus/random_scenes.py).
"""

import argparse
import time
from pathlib import Path

import numpy as np

import bem
from bem.scene.scene import Scene, SceneError, parse_scene
from bem.scene.state import State
from validation.corpus.random_scenes import Drawn, draw
from validation.plugin.rows import Code, Quantity, Rows
from validation.plugin.study_report import Part, write_study
from validation.references.dense import LayerKernel, dense_nodes
from validation.references.dense_equilibrium import NoReferenceError, equilibrium
from validation.references.waves import Waves
from validation.routes.scenes import problem_of

FINER = 3.0  # times the increments of the second solution
MOST_WORK = 2e7  # nodes squared times terms of the layer: dense algebra below 1 s
ROUNDINGS = 24 * float(np.finfo(float).eps)  # of the heights, seen through the stiffness of a state
COLUMNS = {
    "contact_fraction": (Quantity.AREA, ""),
    "mean_pressure": (Quantity.PRESSURE, "Pa"),
    "elastic_energy": (Quantity.ENERGY, "J/m^2"),
    "penetration": (Quantity.LENGTH, "m"),
}


def judge(rows: Rows, drawn: Drawn, folder: Path) -> None:
    """Add the rows of a scene: its ending, its targets at a third of the increment, and by dense algebra."""
    drawn.write_scan(folder)
    try:
        scene = parse_scene(drawn.tables, folder)
        result = bem.solve(scene)
    except (SceneError, ValueError) as error:  # a flaw wider than half the shortest wave may be held closed
        profile = drawn.tables["profile"]
        most = max(profile.get("orders", [profile.get("harmonics", 1)]))
        wide = 2 * drawn.tables["loading"].get("flaw", 0.0) * most > profile.get("period", 0.0)
        ending(rows, f"refused: {error}", wide and "loading.flaw" in str(error))
        return
    ending(rows, f"{result.status}: {result.failure}", result.status in ("converged", "unreachable"))
    met = [state for state in result.targets if state.status == "converged"]
    if not met:
        return
    surface = Waves.of(scene.surface())
    soft = [ROUNDINGS * surface.highest * abs(state.contact_stiffness or 0.0) for state in met]
    accuracy = drawn.tables["accuracy"] | {"max_increment": scene.accuracy.max_increment / FINER}
    again = [s for s in bem.solve(parse_scene(drawn.tables | {"accuracy": accuracy}, folder)).targets
             if s.status == "converged"]
    known = [by_dense_algebra(scene, surface, state) for state in met]
    confirmed = [(k, each) for k, each in enumerate(known) if each is not None]
    for name, (quantity, unit) in COLUMNS.items():
        values = np.array([getattr(state, name) for state in met])
        own = np.array([getattr(state.error_estimate, name) or 0.0 for state in met])
        scale = np.maximum(np.abs(values), natural(scene, surface)[name])
        rounding = 1e-10 * scale + (np.array(soft) if name == "mean_pressure" else 0.0)
        other = [getattr(state, name) for state in again]
        if len(other) == len(values):
            own = np.maximum(own, [getattr(state.error_estimate, name) or 0.0 for state in again])
        rows.compare(f"{name.replace('_', ' ')} at a third of the increment", values, other, of=Code.BEM,
                     by=Code.IDENTITY, quantity=quantity, unit=unit, kind="construction",
                     required=2 * (own + rounding), because="errors that both estimate")
        if confirmed:
            at = [k for k, _ in confirmed]
            held = {"separation": "penetration"}.get(scene.loading.control, scene.loading.control)
            rows.compare(name.replace("_", " "), values[at], [each[name] for _, each in confirmed], of=Code.BEM,
                         by=Code.DENSE, quantity=quantity, unit=unit, source="equilibrium next to the edges",
                         kind="construction" if name == held else "accuracy",
                         uncertainty=(own[at], rounding[at]))


def ending(rows: Rows, words: str, expected: bool) -> None:
    """Add the row of how a scene ended."""
    rows.compare("endings that are not allowed", float(not expected), 0.0, of=Code.BEM, by=Code.IDENTITY,
                 quantity=Quantity.COUNT, kind="construction", required=0.5, because=words)


def natural(scene: Scene, surface: Waves) -> dict[str, float]:
    """Return the unit of every quantity: 1, E* h_rms / period, E* h_rms^2 / period, the largest height."""
    modulus = scene.solid.youngs_modulus / (1 - scene.solid.poisson_ratio**2)
    rms = surface.rms_height or surface.period
    return {"contact_fraction": 1.0, "mean_pressure": np.pi * modulus * rms / surface.period,
            "elastic_energy": modulus * rms**2 / surface.period, "penetration": max(surface.highest, rms)}


def by_dense_algebra(scene: Scene, surface: Waves, state: State) -> dict[str, float] | None:
    """Return the equilibrium next to a state; None where it costs too much or two gaps leave no digits."""
    left, right = np.array(state.edges).T * 2 * np.pi / surface.period
    terms = 0
    if scene.layer is not None:
        depth = 2 * np.pi / surface.period * scene.layer.thickness
        terms = LayerKernel.of(depth, scene.solid.poisson_ratio).order.size
    if float(dense_nodes(surface, left, right).sum()) ** 2 * (10 + terms) > MOST_WORK:
        return None
    problem = problem_of(scene, "dense algebra", "layer", "adhesion")
    reached = getattr(state, problem.control)
    target = min(problem.targets, key=lambda aim: abs(aim - reached))
    unit = {"mean_pressure": natural(scene, surface)["mean_pressure"]}.get(problem.control, surface.highest)
    if abs(target - reached) > 1e-9 * unit:  # a state at one of `at_mean_pressures`
        target = reached
    try:
        return equilibrium(problem, state.edges, state.penetration, target)
    except NoReferenceError:
        gaps = np.append(left[1:], left[0] + 2 * np.pi) - right
        if min(gaps.min(), (right - left).min()) < 0.02:  # edges that rounding moves
            return None
        raise


def main() -> int:
    """Judge scenes of a seed and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    parts = []
    for index in range(options.count):
        drawn, rows, begun, message = draw(options.seed, index), Rows(), time.process_time(), ""
        try:
            judge(rows, drawn, options.out)
        except Exception as error:
            message = f"{type(error).__name__}: {error}"
        part = Part(drawn.id, drawn.reason, rows, seconds=time.process_time() - begun, message=message)
        parts.append(part)
        if part.case()["outcome"] != "passed":
            print(f"{drawn.id}: {part.case()['message']}", drawn.write(options.out))
    command = f"python -m validation.cases.random_judge --seed {options.seed} --count {options.count}"
    content = write_study(options.out, command, parts)
    print(content["headline"])
    return 1 if content["failed"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
