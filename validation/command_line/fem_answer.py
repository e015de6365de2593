"""`linecontact fem SCENE --out DIR`: the targets of a scene by the finite elements alone, without any other code.

The path is followed from first touch on a coarse mesh (`fem_reference.path`), through loading and unloading, with
patches that appear, merge and detach. Every target is then closed on three meshes, starting at the edges of the path.

Written are result.json (values and uncertainties by the names of the boundary elements' result, SI units, energies per
nominal area; events as the coarse mesh locates them, to about 1e-3 rms heights), and for the last target in contact
fields.vtu: the mesh with its displacement and stress, for ParaView.

Limits: a layer, edges of the JKR closure; at most `LARGEST` unknowns.
"""

import argparse
import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

import numpy as np

import fem_reference
from bem.scene.atomic_file import write_atomically
from bem.scene.provenance import provenance
from bem.scene.scene import Scene, load_scene
from fem_reference import InvalidProblemError, Resolution, Result, SingularSystemError
from fem_reference.export import write_fields
from fem_reference.mesh import base_unknowns
from fem_reference.path import Path, follow
from fem_reference.result import quantities
from fem_reference.solve import control_of, problem_of
from validation.routes.fem_scenes import fem_arguments

SCHEMA = "linecontact-fem/2"
ELEMENTS = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 8, 18)}
PER_PATCH = {2: 8e3, 4: 4.4e4}  # unknowns that a patch adds, measured
LARGEST = 6e5  # unknowns; 5.3e5 took 48 s (P4/P3, twelve patches)
DONE, FAILED, BAD_INPUT = 0, 1, 2
NUMBERS = ("penetration", "total_displacement", "mean_pressure", "contact_fraction")
MESSAGES = {"unreachable": "no state under this control: a load that nothing carries, or a penetration above h_max"}
ENERGIES = ("elastic_energy", "adhesion_energy", "total_energy")  # of a period; per area in what is written


def add_command(commands: Any, perform: Any) -> None:
    """Add `fem` to the commands of a program."""
    what = "solve a scene of a layer by finite elements; writes numbers, mesh and fields"
    fem = commands.add_parser("fem", help=what)
    fem.add_argument("scene", type=FilePath, help="scene file (TOML)")
    fem.add_argument("--out", type=FilePath, required=True, metavar="DIR", help="folder for the answer, new or empty")
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
        path, answers = answered(arguments, [float(target) for target in scene.loading.targets], resolution)
    except (InvalidProblemError, SingularSystemError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD_INPUT
    options.out.mkdir(parents=True, exist_ok=True)
    states = [answer.state() for answer in answers]
    _write(scene, states, events(path, arguments["period"]), options.out)
    results = [answer.result for answer in answers if answer.result is not None]
    if results:
        write_fields(results[-1], options.out / "fields.vtu")
    failed = [state for state in states if state["status"] not in ("converged", "complete_contact", "separated")]
    print(
        f"{options.out}: {len(states) - len(failed)} of {len(states)} targets; {results[-1] if results else 'apart'!r}"
    )
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


@dataclass(frozen=True)
class Answer:
    """A target: its status on the path, the reason where it fails, the closed state, and CPU seconds."""

    target: float
    control: str
    status: str
    message: str
    result: Result | None
    seconds: float

    def state(self) -> dict[str, Any]:
        """Return the state under the names of the boundary elements' result."""
        plain = {"status": self.status, "message": self.message, "target": True, "cpu_seconds": self.seconds}
        if self.result is not None:
            return _numbers(self.result) | plain
        if self.status != "separated":
            return plain | dict.fromkeys(NUMBERS + ENERGIES) | {self.control: self.target, "edges": [], "n_patches": 0}
        zero = dict.fromkeys(("mean_pressure", "contact_fraction", *ENERGIES), 0.0)
        return plain | zero | {self.control: self.target, "edges": [], "n_patches": 0}


def answered(arguments: dict[str, Any], values: list[float], resolution: Resolution) -> tuple[Path, list[Answer]]:
    """Follow the path through targets in SI units, in order, and close each of them on fine meshes."""
    control = arguments["control"]
    problem = problem_of(**{key: value for key, value in arguments.items() if key not in ("control", "value")})
    wanted = [control_of(problem, control, value) for value in values]
    path = follow(problem, "penetration" if control == "separation" else control, [each.value for each in wanted])
    answers = []
    for value, target in zip(values, path.targets, strict=True):
        begun = time.process_time()
        status, message = str(target.status), MESSAGES.get(target.status, path.failure)
        result = None
        request = arguments | {"value": value, "resolution": resolution}
        if target.status == "converged":
            _affordable(arguments, resolution, len(target.edges))
            result = fem_reference.solve(**request, start=target.edges * problem.period)
        elif target.status == "complete_contact":
            result = fem_reference.solve(**request, edges="complete")
        if result is not None:
            status, message = result.status, result.message
        answers.append(Answer(value, control, status, message, result, time.process_time() - begun))
    return path, answers


def events(path: Path, period: float) -> list[dict[str, Any]]:
    """Return the jumps of a path under the names of the boundary elements' events, from the coarse mesh."""
    listed = []
    for jump in path.jumps:
        before = dict.fromkeys(NUMBERS, 0.0) if jump.before is None else quantities(jump.before.evaluation)
        numbers = {name: float(before[name]) for name in NUMBERS[:3]}
        for change in jump.changes:
            listed.append({"kind": change.kind, "cause": jump.cause, "position": change.position * period, **numbers})
    return listed


def _numbers(result: Result) -> dict[str, Any]:
    """Return the numbers of a closed state under the names of the boundary elements' result."""
    period = result.problem.period
    uncertain = {name: float(np.max(result.uncertainty[name])) for name in NUMBERS}
    uncertain |= {name: float(np.max(result.uncertainty[name])) / period for name in ENERGIES}
    uncertain["separation"] = uncertain["penetration"]
    intensity = np.asarray(result.stress_intensity)
    return {
        **{name: float(getattr(result, name)) for name in NUMBERS},
        "separation": result.separation,
        **{name: float(getattr(result, name)) / period for name in ENERGIES},
        "n_patches": len(result.edges),
        "edges": result.edges.tolist(),
        "stress_intensity_max": float(np.max(intensity)) if intensity.size else None,
        "stable": result.stable,
        "error_estimate": {name: value if np.isfinite(value) else None for name, value in uncertain.items()},
        "unknowns": result.unknowns,
    }


def _write(scene: Scene, states: list[dict[str, Any]], jumps: list[dict[str, Any]], folder: FilePath) -> None:
    """Write result.json."""
    resolved = scene.resolved()
    content = {"schema": SCHEMA, "scene": resolved, "states": states, "events": jumps}
    content["provenance"] = provenance(resolved)
    write_atomically(folder / "result.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
