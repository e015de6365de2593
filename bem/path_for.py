"""Path that a scene calls for: convex without adhesion, else event by event, with a flaw where the scene has one.

Where few digits are asked for, many patches on a half-space are followed in windows.  A flaw that the pressure shuts
where it would open is a mistake of the scene.  The modules of the other paths are not imported.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bem.geometry.ranges import Mistake
from bem.loading.complete_contact import CompleteContact, complete_contact
from bem.loading.crew import Crew
from bem.loading.loading_path import LoadingPath
from bem.path_increments import FEW_DIGITS, increments_of
from bem.problem import Problem, pose
from bem.scene.scene import Scene
from bem.scene.scene_error import SceneError

if TYPE_CHECKING:
    from bem.nonadhesive.convex_path import ContactPoint, ConvexPoint
    from bem.path.points_with_edges import Equilibrium, Point
    from bem.windows.windowed_path import AnyPoint


def check_path(scene: Scene) -> None:
    """Pose the path of a scene; raise SceneError for mistakes that only posing the path shows."""
    if not scene.surface().is_flat:
        problem = pose(scene)
        path_for(scene, problem, complete_contact(problem.profile, problem.law, problem.elastic.compliance))


def path_for(
    scene: Scene, problem: Problem, complete: CompleteContact, crew: Crew | None = None
) -> LoadingPath[Any, Any]:
    """Return the path that the effects of the scene require; the crew advances its independent parts.

    Raises
    ------
    SceneError
        The flaw of the scene holds no gap where it would open.
    """
    highest = problem.profile.highest_crests
    increments = increments_of(scene, problem)
    if problem.law is None:
        from bem.nonadhesive.completed_body import CompletedBody
        from bem.nonadhesive.convex_path import ConvexPath

        body = CompletedBody(complete, problem.profile.max_height, problem.compliance_ratio)
        stop = scene.loading.stop_at_mean_pressure
        convex: LoadingPath[ConvexPoint, ContactPoint] = ConvexPath(
            problem.elastic, problem.control, increments, body, highest, None if stop is None else problem.load_of(stop)
        )
        return convex
    from bem.adhesive.equilibrium import System
    from bem.path.opening import flaw_of
    from bem.path.path import Path

    system = System(problem.elastic, problem.law, problem.control)
    width, flaw = scene.loading.flaw, None
    if width is not None and problem.control.load_weight > 0:
        flaw = flaw_of(system, complete, width / problem.scales.length, increments.fine.tolerance)
        if flaw is None:
            shut = f"= {width:g}: the pressure would hold a part of it closed"
            raise SceneError([Mistake("loading.flaw", shut, "a narrower one")])
    stop = scene.loading.stop_at_mean_pressure
    pressures = (*scene.loading.at_mean_pressures, *(() if stop is None else (stop,)))
    asked = tuple(problem.load_of(pressure) for pressure in pressures)
    exact = Path(system, increments, highest, complete, flaw, asked)
    adhesive: LoadingPath[Point, Equilibrium] = exact
    if (
        scene.accuracy.tolerance >= FEW_DIGITS
        and problem.elastic.compliance is None
        and not problem.control.load_weight
    ):
        from bem.windows.windowed_path import WindowedPath

        windowed: LoadingPath[AnyPoint, Equilibrium] = WindowedPath(exact, crew or Crew())
        return windowed
    return adhesive
