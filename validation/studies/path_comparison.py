"""Comparison of a path at other increments and tolerances with the path in fine increments, over random scenes.

    python -m validation.studies.path_comparison --seed 57 --count 100 --out FOLDER [--scenes FOLDER]

Scene k of a seed is a scene of corpus/random_scenes.py with adhesion: with few waves, with many, or nearly repeating
within its period; `--scenes` takes scene files in place of these.  The reference of a scene is its path at the default
tolerance in a third of its increment.  Counted are targets on another branch (another status or number of patches, or
numbers beyond the stated errors of both and 1e-6 of the largest), and events: absent, added, and located beyond
their stated errors and ten times these.  An event answers the event of its kind that is nearest.  The exit code is 1
if a target is on another branch.
"""

import argparse
import json
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import bem
from bem.scene.result import Event, Result
from bem.scene.scene import parse_scene
from bem.scene.state import State
from validation.corpus.random_scenes import draw
from validation.references.paper_problem import Table

FINER = 3.0  # times the increments of the reference
SAME = 1e-6  # of the largest of its kind: numbers of one branch with few digits
FAR = 1e-2  # of the largest penetration: events farther apart are two
ROUNDED = 1e-9  # of the largest of its kind: rounding of scenes of all sizes
NUMBERS = "mean_pressure", "contact_fraction", "penetration", "elastic_energy"
LOCATED = "penetration", "mean_pressure", "energy_released"


def scenes(seed: int, count: int) -> Iterator[tuple[str, Table, Path]]:
    """Yield name, tables and folder of `count` scenes of a seed that have adhesion and an answer."""
    index = 0
    while count:
        drawn, index = draw(seed, index, (12, 60, 12)[index % 3]), index + 1
        if drawn.expected != "an answer" or "adhesion" not in drawn.tables or drawn.scan is not None:
            continue
        tables, count = drawn.tables, count - 1
        if index % 3 == 0 and tables["profile"]["kind"] == "harmonics":
            tables = tables | {"profile": repeated(tables["profile"], np.random.default_rng([seed, index]))}
        tables["accuracy"].pop("tolerance", None)
        yield drawn.id, {name: table for name, table in tables.items() if name != "output"}, Path()


def repeated(profile: Table, rng: np.random.Generator) -> Table:
    """Return a profile that repeats two to eight times within its period, but for a long wave of a small height."""
    times, share = int(rng.integers(2, 9)), 10 ** rng.uniform(-4.0, -1.5)
    amplitudes = [profile["amplitudes"][0] * share, *profile["amplitudes"]]
    orders = [1, *(times * order for order in profile["orders"])]
    return profile | {"orders": orders, "amplitudes": amplitudes, "phases": [0.0, *profile["phases"]]}


def solved(tables: Table, folder: Path, increment: float, tolerance: float | None) -> Result:
    """Return the result of a scene at a part of its increment and at a tolerance; None is the tolerance it has."""
    accuracy = dict(tables.get("accuracy", {}))
    accuracy["max_increment"] = accuracy.get("max_increment", 0.05) * increment
    if tolerance is not None:
        accuracy["tolerance"] = tolerance
    return bem.solve(parse_scene(tables | {"accuracy": accuracy}, folder))


def compare(reference: Result, result: Result) -> Counter[str]:
    """Count the targets on another branch and the events that are absent, added, or beyond their errors."""
    count: Counter[str] = Counter(targets=len(reference.targets), events=len(reference.events))
    largest = {name: largest_of(reference.targets, name) for name in NUMBERS}
    for state, other in zip(reference.targets, result.targets, strict=True):
        alike = (state.status, state.n_patches) == (other.status, other.n_patches)
        count["on another branch"] += not (alike and all(near(state, other, name, largest[name]) for name in NUMBERS))
    left, deepest = list(result.events), largest["penetration"]
    for event in reference.events:
        match = min((e for e in left if e.kind == event.kind), key=lambda e: apart(event, e), default=None)
        if match is None or apart(event, match) > FAR * deepest:
            count["events absent"] += 1
            continue
        left.remove(match)
        off = max(beyond(event, match, name, largest_of(reference.events, name)) for name in LOCATED)
        count["beyond their errors"] += off > 1
        count["beyond ten errors"] += off > 10
    count["events added"] = len(left)
    return count


def apart(event: Event, other: Event) -> float:
    """Return the distance of two events in penetration."""
    return abs(event.penetration - other.penetration)


def largest_of(items: tuple[State, ...] | tuple[Event, ...], name: str) -> float:
    """Return the largest size of a number in states or events; 0 where none has one."""
    return float(np.nanmax([abs(getattr(item, name) or 0.0) for item in items], initial=0.0))


def near(state: State, other: State, name: str, largest: float) -> bool:
    """Return whether a number of two states is that of one branch."""
    values = [getattr(item, name) for item in (state, other)]
    if None in values or np.isnan(values).any():
        return values[0] is values[1] or bool(np.isnan(values).all())
    stated = sum(getattr(item.error_estimate, name) or 0.0 for item in (state, other))
    return bool(abs(values[0] - values[1]) <= max(stated, SAME * largest))


def beyond(event: Event, other: Event, name: str, largest: float) -> float:
    """Return the difference of a number of two events over the errors stated; 0 where there is no number."""
    values = [getattr(item, name) for item in (event, other)]
    if None in values or np.isnan(values).any():
        return 0.0
    stated = sum(getattr(item.error_estimate, name) or 0.0 for item in (event, other))
    return float(abs(values[0] - values[1]) / max(stated + ROUNDED * largest, np.finfo(float).tiny))


def main() -> int:
    """Compare the paths of scenes, print a line for each difference and a table, and write comparison.json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=57)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--scenes", type=Path, help="folder of folders with a scene.toml each")
    parser.add_argument("--increments", type=float, nargs="+", default=[1.0])
    parser.add_argument("--tolerances", type=float, nargs="+", default=[1e-9, 1e-6, 1e-4, 1e-3, 1e-2])
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    if options.scenes is None:
        drawn = list(scenes(options.seed, options.count))
    else:
        files = sorted(options.scenes.glob("*/scene.toml"))[: options.count]
        drawn = [(file.parent.name, tomllib.loads(file.read_text()), file.parent) for file in files]
    totals: dict[str, Counter[str]] = {}
    for name, tables, folder in drawn:
        try:
            reference = solved(tables, folder, 1 / FINER, None)
        except ValueError as error:  # a scene of another version, or out of range
            print(f"{name}: left out: {error}")
            continue
        for increment in options.increments:
            for tolerance in options.tolerances:
                setting = f"increment {increment:g}, tolerance {tolerance:g}"
                count = compare(reference, solved(tables, folder, increment, tolerance))
                totals.setdefault(setting, Counter()).update(count)
                differences = {key: n for key, n in count.items() if n and key not in ("targets", "events")}
                if differences:
                    print(f"{name}, {setting}: {differences}", flush=True)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "comparison.json").write_text(json.dumps(totals, indent=2) + "\n")
    for setting, count in totals.items():
        print(setting, dict(count))
    return int(any(count["on another branch"] for count in totals.values()))


if __name__ == "__main__":
    raise SystemExit(main())
