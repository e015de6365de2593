"""Paths frozen at a commit, and the comparison with what the package finds now, at two increments.

    python tests/support/frozen_paths.py store GROUP [--count N] [--first K]
    python tests/support/frozen_paths.py compare GROUP [--count N] [--first K]

`store` writes tests/frozen_paths/GROUP.jsonl, one path a line: status, targets and events at the increment of the scene
and at a third of it, followed event by event.  `compare` solves again and says, scene by scene, whether both increments
give the same, and the same as was stored: states to 1e-8 of their unit, events of the same kinds, places to 1e-6 rms
heights and energies to 1e-5 of the largest.  Its last lines are the shares that agree, evaluations and CPU seconds.
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))

from frozen_scenes import frozen  # noqa: E402

import bem  # noqa: E402
from bem.scene.scene import SceneError, parse_scene  # noqa: E402

FOLDER = ROOT / "tests" / "frozen_paths"
FINER = 3
STATES, PLACES, ENERGIES = 1e-8, 1e-6, 1e-5
DEFAULT_INCREMENT = 0.05
EVENT_BY_EVENT = 1e-6  # tolerance of paths: from 1e-4 on they go by leaps, whose events are brackets

Record = dict[str, Any]


class _TooLongError(Exception):
    """A path that is not frozen for its length."""


def path_of(tables: Record, increment: float, limit: int) -> Record:
    """Status, targets and events of a scene; dimensionless by the rms height and what adhesion and heights give."""
    accuracy = tables.get("accuracy", {}) | {"max_increment": increment}
    accuracy["tolerance"] = min(accuracy.get("tolerance", EVENT_BY_EVENT), EVENT_BY_EVENT)
    tables = tables | {"accuracy": accuracy}
    scene, counts = parse_scene(tables), [0]
    if scene.surface().is_flat:
        raise SceneError([])  # nothing to follow
    begun = time.process_time()

    def stop(*_: object) -> None:
        raise _TooLongError

    signal.signal(signal.SIGALRM, stop)
    signal.alarm(limit)
    try:
        result = bem.solve(scene, progress=lambda now: counts.append(now.evaluations))
    except _TooLongError:
        return {"status": "too long", "targets": [], "events": []}
    finally:
        signal.alarm(0)
    surface = scene.surface()
    modulus = scene.solid.youngs_modulus / (1 - scene.solid.poisson_ratio**2)
    height, stress = surface.rms_height, modulus * surface.q0 * surface.rms_height / 2
    energy = modulus * height**2 * surface.q0 / (4 * np.pi)
    targets = [
        [state.status, _digits(state.contact_fraction), _digits(state.mean_pressure / stress)]
        for state in result.states
        if state.target
    ]
    events = []
    for event in result.events:
        numbers = [event.penetration / height, (event.energy_released or 0.0) / energy, event.mean_pressure / stress]
        error = event.error_estimate
        errors = [error.penetration / height, (error.energy_released or 0.0) / energy]
        events.append([event.kind, *map(_digits, numbers), *(float(f"{x:.2e}") for x in errors)])
    work = {"evaluations": max(counts), "cpu": round(time.process_time() - begun, 2)}
    return {"status": result.status, "targets": targets, "events": events} | work


def _digits(number: float) -> float:
    return float(f"{number:.12g}") if np.isfinite(number) else 0.0


def differences(ours: Record, theirs: Record) -> str:
    """What two paths of a scene differ in; empty where they agree."""
    if ours["status"] != theirs["status"]:
        return f"status {ours['status']} for {theirs['status']}"
    if ours["status"] == "too long":
        return "too long"
    if [state[0] for state in ours["targets"]] != [state[0] for state in theirs["targets"]]:
        return "statuses of targets"
    apart = max((abs(a[1] - b[1]) for a, b in zip(ours["targets"], theirs["targets"], strict=True)), default=0.0)
    text = [f"states {apart:.0e}"] if apart > STATES else []
    kinds = [[event[0] for event in path["events"]] for path in (ours, theirs)]
    if kinds[0] != kinds[1]:
        k = next((i for i, (a, b) in enumerate(zip(*kinds, strict=False)) if a != b), min(map(len, kinds)))
        one, two = ([event[:3] for event in path["events"][k : k + 2]] for path in (ours, theirs))
        return "; ".join([*text, f"events {len(kinds[0])} for {len(kinds[1])}, from {k}: {one} for {two}"])
    if kinds[0]:
        a, b = (np.array([event[1:3] for event in path["events"]]) for path in (ours, theirs))
        places, energies = np.abs(a - b).max(axis=0)
        largest = np.abs(b[:, 1]).max()
        if places > PLACES:
            text.append(f"places {places:.0e}")
        if energies > ENERGIES * largest:
            text.append(f"energies {energies / largest:.0e} of the largest")
    return "; ".join(text)


def unbounded(coarse: Record, fine: Record) -> tuple[int, int]:
    """Numbers of events that lie farther apart at two increments than three times the sum of their errors, of all."""
    if [event[0] for event in coarse["events"]] != [event[0] for event in fine["events"]]:
        return 0, 0
    pairs = list(zip(coarse["events"], fine["events"], strict=True))
    wrong = sum(abs(a[1] - b[1]) > a[4] + b[4] or abs(a[2] - b[2]) > a[5] + b[5] for a, b in pairs)
    return wrong, len(pairs)


def paths_of(tables: Record, limit: int) -> list[Record]:
    """A path at its increment and at a third of it."""
    increment = tables.get("accuracy", {}).get("max_increment", DEFAULT_INCREMENT)
    return [path_of(tables, increment / part, limit) for part in (1, FINER)]


def store(group: str, count: int, first: int, limit: int) -> None:
    """Write the paths of a group, adding to those that are there."""
    path = FOLDER / f"{group}.jsonl"
    known = {json.loads(line)["name"] for line in path.read_text("utf-8").splitlines()} if path.exists() else set()
    commit = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=ROOT, check=False
    )
    with path.open("a", encoding="utf-8") as file:
        for name, tables in frozen(group, count, first):
            if name in known:
                continue
            try:
                paths = paths_of(tables, limit)
            except SceneError:
                continue
            record = {"name": name, "commit": commit.stdout.strip() or "a766078", "paths": paths}
            file.write(json.dumps(record, separators=(",", ":")) + "\n")
            file.flush()


def compare(group: str, count: int, first: int, limit: int) -> None:
    """Solve the frozen scenes of a group again, and say what changed."""
    lines = (FOLDER / f"{group}.jsonl").read_text("utf-8").splitlines()
    known = {record["name"]: record["paths"] for record in map(json.loads, lines)}
    agree = {"both increments now": 0, "both increments then": 0, "now as then": 0}
    all_of, work, wrong = 0, np.zeros((2, 2)), np.zeros((2, 2), dtype=int)
    for name, tables in frozen(group, count, first):
        if name not in known or known[name][0]["status"] == "too long":
            continue
        try:
            now = paths_of(tables, limit)
        except Exception as error:  # a path that ends in an error is a difference, and the comparison goes on
            print(f"{name}: {type(error).__name__}: {error}", flush=True)
            all_of += 1
            continue
        then = known[name]
        found = {
            "both increments now": differences(*now),
            "both increments then": differences(*then),
            "now as then": differences(now[0], then[0]) if not differences(*then) else "",
        }
        all_of += 1
        for key, text in found.items():
            agree[key] += not text
        for k, paths in enumerate((now, then)):
            work[k] += [sum(path.get(key, 0) for path in paths) for key in ("evaluations", "cpu")]
            wrong[k] += unbounded(*paths)
        if any(found.values()):
            print(name, *(f"\n    {key}: {text}" for key, text in found.items() if text), flush=True)
    print(f"{group}: {all_of} scenes;", ", ".join(f"{key} {value}" for key, value in agree.items()))
    print(f"    evaluations {work[0, 0]:.0f} for {work[1, 0]:.0f}, CPU {work[0, 1]:.1f} s for {work[1, 1]:.1f} s")
    print(f"    events beyond their errors: {wrong[0, 0]} of {wrong[0, 1]}, then {wrong[1, 0]} of {wrong[1, 1]}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["store", "compare"])
    parser.add_argument("group", choices=["scenes", "patterns", "ripples", "waves", "random", "paper"])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--limit", type=int, default=120, help="seconds of a path")
    given = parser.parse_args()
    {"store": store, "compare": compare}[given.what](given.group, given.count, given.first, given.limit)
