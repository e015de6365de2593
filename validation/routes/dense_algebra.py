"""Dense algebra next to a state of a scene; equations and limits: references/dense_equilibrium.py."""

from dataclasses import replace

from bem.scene.scene import Scene
from bem.scene.state import State
from validation.references.dense_equilibrium import equilibrium
from validation.routes.scenes import problem_of


def reference(scene: Scene, state: State, refinement: float = 1) -> dict[str, float]:
    """Return every scalar of the equilibrium next to a state of a scene, in its unit, at the nearest target.

    NoReferenceError where Newton does not converge, ValueError for a table that dense algebra does not provide.
    """
    problem = problem_of(scene, "dense algebra", "layer", "adhesion")
    if problem.control in ("penetration", "separation"):
        problem, target = replace(problem, control="penetration"), state.penetration
    else:
        reached = getattr(state, problem.control)
        target = min(problem.targets, key=lambda aim: abs(aim - reached))
    return equilibrium(problem, state.edges, state.penetration, target, refinement)
