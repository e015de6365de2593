"""`linecontact fem SCENE --out DIR`: the targets of a scene by the finite elements alone, without any other code.

Contacts are found as a profile is approached from apart: the first target begins at the highest crest, every other one
at the edges of the one before; where the profile enters the layer off the contact, a patch is begun there, and the
state is closed anew. So the history of a scene is followed as long as no patch is lost: a target at which one
detaches, or a gap closes, ends with that status and the reason, and so do those after it.

Written are result.json (values and uncertainties by the names of the boundary elements' result, SI units, energies per
nominal area), mesh.png and mesh.svg (the deformed layer of the last target with its stress), fields.vtu.

Limits: a layer, edges of the JKR closure; at most `LARGEST` unknowns.
"""

import argparse
import json
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import fem_reference
from bem.scene.atomic_file import write_atomically
from bem.scene.provenance import provenance
from bem.scene.scene import Scene, load_scene
from fem_reference import InvalidProblemError, Resolution, Result, SingularSystemError
from fem_reference.export import write_fields
from fem_reference.mesh import base_unknowns
from fem_reference.solve import problem_of
from validation.harness.arrays import FloatArray
from validation.routes.fem_scenes import fem_arguments

SCHEMA = "linecontact-fem/1"
ELEMENTS = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 8, 18)}
PER_PATCH = {2: 8e3, 4: 4.4e4}  # unknowns that a patch adds, measured
LARGEST = 6e5  # unknowns; 5.3e5 took 48 s (P4/P3, twelve patches)
MOST_PATCHES = 40
GRID = 64  # points per shortest wavelength at which the gap is looked at
DONE, FAILED, BAD_INPUT = 0, 1, 2
NUMBERS = ("penetration", "total_displacement", "mean_pressure", "contact_fraction")
ENERGIES = ("elastic_energy", "adhesion_energy", "total_energy")  # of a period; per area in what is written


def add_command(commands: Any, perform: Any) -> None:
    """Add `fem` to the commands of a program."""
    what = "solve a scene of a layer by finite elements; writes numbers, mesh and fields"
    fem = commands.add_parser("fem", help=what)
    fem.add_argument("scene", type=Path, help="scene file (TOML)")
    fem.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the answer, new or empty")
    fem.add_argument("--elements", choices=list(ELEMENTS), default="P4/P3", help="P4/P3 by default")
    fem.set_defaults(command=_fem, perform=perform)


def _fem(options: argparse.Namespace) -> int:
    """Solve a scene and write the answer."""
    scene, resolution = load_scene(options.scene), ELEMENTS[options.elements]
    try:
        arguments = fem_arguments(scene)
        _affordable(arguments, resolution, 1)
        if options.out.is_dir() and any(options.out.iterdir()):
            raise ValueError(f"{options.out} is not empty")
        answers = targets(arguments, [float(target) for target in scene.loading.targets], resolution)
    except (InvalidProblemError, SingularSystemError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD_INPUT
    options.out.mkdir(parents=True, exist_ok=True)
    states = [_state(result, seconds) for result, seconds in answers]
    _write(scene, states, options.out)
    last = answers[-1][0]
    write_fields(last, options.out / "fields.vtu")
    figures = import_module("validation.command_line.fem_figure")
    for ending in ("png", "svg"):
        figures.deformed_mesh(last).savefig(options.out / f"mesh.{ending}", dpi=150)
    failed = [state for state in states if state["status"] not in ("converged", "complete_contact")]
    print(f"{options.out}: {len(states) - len(failed)} of {len(scene.loading.targets)} targets; {last!r}")
    for state in failed:
        print(f"error: {state['status']}: {state['message']}", file=sys.stderr)
    return FAILED if failed else DONE


def _affordable(arguments: dict[str, Any], resolution: Resolution, patches: int) -> None:
    """Refuse a problem with too many unknowns before any mesh is made."""
    problem = problem_of(**{key: value for key, value in arguments.items() if key not in ("control", "value")})
    unknowns = base_unknowns(problem.depth, resolution, problem.highest_order) + patches * PER_PATCH[resolution.order]
    if unknowns > LARGEST:
        raise ValueError(
            f"scene: about {unknowns:.2g} unknowns of order {resolution.order} (harmonics up to "
            f"{problem.highest_order}, {problem.depth:.3g} periods thick, {patches} patches); at most {LARGEST:.2g}"
        )


def targets(arguments: dict[str, Any], values: list[float], resolution: Resolution) -> list[tuple[Result, float]]:
    """Solve for states at targets in order, ending with the first that does not converge; each with CPU seconds."""
    states: list[tuple[Result, float]] = []
    for value in values:
        begun = time.process_time()
        request = arguments | {"value": value, "resolution": resolution}
        known = states[-1][0].edges if states and len(states[-1][0].edges) else None
        result = fem_reference.solve(**request, start=known)
        while result.status == "interpenetration" and len(result.edges) < MOST_PATCHES:
            wider = with_entered(result)
            _affordable(arguments, resolution, len(wider))
            result = fem_reference.solve(**request, start=wider)
        states.append((result, time.process_time() - begun))
        if result.status != "converged":
            break
    return states


def with_entered(result: Result) -> FloatArray:
    """Return edges (n_patches, 2) in m of a state and of every interval in which the profile enters the layer."""
    period = result.problem.period
    count = GRID * result.problem.highest_order
    x = result.edges[0, 0] + np.arange(count) * (period / count)
    inside = np.zeros(count, dtype=bool)
    for a, b in result.edges:
        inside |= (x - a) % period <= b - a
    entered = ~inside & (result.gap(x) < -2.0 * float(np.max(result.uncertainty["gap"])))
    first, last = np.flatnonzero(entered & ~np.roll(entered, 1)), np.flatnonzero(entered & ~np.roll(entered, -1))
    half = 0.5 * period / count
    added = np.column_stack([x[first] - half, x[last] + half])
    every = np.vstack([result.edges, added])
    return np.asarray(every[np.argsort((every[:, 0] - x[0]) % period)])


def _state(result: Result, seconds: float) -> dict[str, Any]:
    """Return a state under the names of the boundary elements' result."""
    period = result.problem.period
    uncertain = {name: float(np.max(result.uncertainty[name])) for name in NUMBERS}
    uncertain |= {name: float(np.max(result.uncertainty[name])) / period for name in ENERGIES}
    uncertain["separation"] = uncertain["penetration"]
    intensity = np.asarray(result.stress_intensity)
    return {
        "status": result.status,
        "message": result.message,
        "target": True,
        **{name: float(getattr(result, name)) for name in NUMBERS},
        "separation": result.separation,
        **{name: float(getattr(result, name)) / period for name in ENERGIES},
        "n_patches": len(result.edges),
        "edges": result.edges.tolist(),
        "stress_intensity_max": float(np.max(intensity)) if intensity.size else None,
        "stable": result.stable,
        "error_estimate": {name: value if np.isfinite(value) else None for name, value in uncertain.items()},
        "unknowns": result.unknowns,
        "cpu_seconds": seconds,
    }


def _write(scene: Scene, states: list[dict[str, Any]], folder: Path) -> None:
    resolved = scene.resolved()
    content = {"schema": SCHEMA, "scene": resolved, "states": states, "provenance": provenance(resolved)}
    write_atomically(folder / "result.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
