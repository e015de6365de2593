"""Comparison of paths at other increments and tolerances with the path in fine increments, over random scenes.

    python -m validation.command_line.path_comparison --seed 57 --count 100 --out FOLDER

Scene k of a seed is a scene of corpus/random_scenes.py with adhesion: with few waves, with many, or nearly repeating
within its period.  The reference of a scene is its path at the default tolerance in a third of its increment.
Differences are those of `linecontact compare`: numbers beyond the errors that both paths state, and what else differs,
such as the number of patches at a target or the sequence of events.  FOLDER/comparison.json counts both by setting; the
exit code is 1 if there are any.
"""

import argparse
import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import bem
from bem.scene.result import Result
from validation.command_line.comparison import compare_results
from validation.corpus.random_scenes import draw
from validation.references.paper_problem import Table

FINER = 3.0  # times the increments of the reference


def scenes(seed: int, count: int) -> Iterator[tuple[str, Table]]:
    """Yield name and tables of `count` scenes of a seed that have adhesion."""
    index = 0
    while count:
        drawn, index = draw(seed, index, (12, 60, 12)[index % 3]), index + 1
        if "adhesion" not in drawn.tables or drawn.scan is not None:
            continue
        tables, count = drawn.tables, count - 1
        if index % 3 == 0 and tables["profile"]["kind"] == "harmonics":
            tables = tables | {"profile": repeated(tables["profile"], np.random.default_rng([seed, index]))}
        tables["accuracy"].pop("tolerance", None)
        yield drawn.id, {name: table for name, table in tables.items() if name != "output"}


def repeated(profile: Table, rng: np.random.Generator) -> Table:
    """Return a profile that repeats two to eight times within its period, but for a long wave of a small height."""
    times, share = int(rng.integers(2, 9)), 10 ** rng.uniform(-4.0, -1.5)
    amplitudes = [profile["amplitudes"][0] * share, *profile["amplitudes"]]
    orders = [1, *(times * order for order in profile["orders"])]
    return profile | {"orders": orders, "amplitudes": amplitudes, "phases": [0.0, *profile["phases"]]}


def solved(tables: Table, increment: float, tolerance: float | None = None) -> Result:
    """Return the result of a scene at a part of its increment and at a tolerance; None is the default tolerance."""
    accuracy = {"max_increment": tables["accuracy"].get("max_increment", 0.05) * increment, "tolerance": tolerance}
    known = {name: value for name, value in accuracy.items() if value is not None}
    return bem.solve(bem.parse_scene(tables | {"accuracy": known}))


def main() -> int:
    """Compare the paths of scenes, print every difference and a table, and write comparison.json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=57)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--increments", type=float, nargs="+", default=[1.0])
    parser.add_argument("--tolerances", type=float, nargs="+", default=[1e-9, 1e-6, 1e-4, 1e-3, 1e-2])
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    totals: dict[str, Counter[str]] = {}
    for name, tables in scenes(options.seed, options.count):
        reference = solved(tables, 1 / FINER)
        for increment in options.increments:
            for tolerance in options.tolerances:
                setting = f"increment {increment:g}, tolerance {tolerance:g}"
                compared = compare_results(reference, solved(tables, increment, tolerance))
                apart = sum(number.differs for number in compared.numbers)
                counts = {"numbers": len(compared.numbers), "apart": apart, "other": len(compared.others)}
                totals.setdefault(setting, Counter()).update(counts)
                for line in compared.differing:
                    print(f"{name}, {setting}: {line}", flush=True)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "comparison.json").write_text(json.dumps(totals, indent=2) + "\n")
    for setting, count in totals.items():
        print(setting, dict(count))
    return int(any(count["apart"] or count["other"] for count in totals.values()))


if __name__ == "__main__":
    raise SystemExit(main())
