"""Scenes with adhesion whose paths are frozen, by group: small ones first; each is a function of its name alone.

`random` are those of validation/corpus/random (seed 44) that ask for an answer with adhesion; `waves` are rough,
rippled and few-wave profiles (seed 45), harder for their sizes; `paper` are realisations of the paper's profile, by
seed.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from validation.corpus.random.random_scenes import draw

Table = dict[str, Any]

ROOT = Path(__file__).parents[2]
RANDOM_SEED, WAVE_SEED = 44, 45
PERIOD, HEIGHT = 0.01, 5e-5
MODULUS = 4e6 / 3


def frozen(group: str, count: int, first: int = 0) -> Iterator[tuple[str, Table]]:
    """Names and tables of a group; `first` and `count` choose among the groups that have no end."""
    if group in ("random", "waves", "paper"):
        make = {"random": _random, "waves": _waves, "paper": _paper}[group]
        for index in range(first, first + count):
            tables = make(index)
            if tables is not None:
                yield f"{group}-{index}", tables
        return
    for name, tables in {"scenes": _scenes, "patterns": _patterns, "ripples": _ripples}[group]():
        if "adhesion" in tables:
            yield name, tables


def _random(index: int) -> Table | None:
    drawn = draw(RANDOM_SEED, index)
    usual = drawn.expected == "an answer" and "adhesion" in drawn.tables and drawn.scan is None
    return {key: table for key, table in drawn.tables.items() if key != "output"} if usual else None


def _paper(seed: int) -> Table:
    tables = tomllib.loads((ROOT / "validation/cases/scenes/paper_profile.toml").read_text("utf-8"))
    tables["profile"]["seed"] = seed
    return tables


def _waves(index: int) -> Table:
    rng = np.random.default_rng([WAVE_SEED, index])
    solid = {"youngs_modulus": 1e6, "poisson_ratio": float(rng.choice([0.3, 0.45, 0.5]))}
    tables: Table = {"solid": solid}
    if rng.random() < 0.4:
        tables["layer"] = {"thickness": PERIOD * 10 ** rng.uniform(-1.3, 0.0)}
    kind, work = rng.choice(["rough", "ripple", "few"]), 10 ** rng.uniform(-3.0, -1.3)
    if kind == "rough":
        count = int(rng.choice([20, 40, 60, 120], p=[0.35, 0.35, 0.2, 0.1]))
        profile: Table = {"kind": "self_affine", "rms_height": HEIGHT, "hurst": float(rng.choice([0.5, 0.7, 0.9]))}
        profile |= {"harmonics": count, "seed": int(rng.integers(1000))}
        targets = [6e-5, 4e-5, 2e-5, 1e-5]
    elif kind == "ripple":
        order, ripple = int(rng.choice([1, 2])), int(rng.choice([40, 98, 150, 200]))
        phase = float(rng.choice([0.0, 0.3, 1e-6, rng.uniform(0, 6)]))
        profile = _harmonics([order, ripple], [HEIGHT, 10 ** rng.uniform(-8.0, -6.0)], [0.0, phase])
        targets, work = [2e-6, 7e-7, 1.3e-5, 3e-5], 10 ** rng.uniform(-2.0, -0.5)
    else:
        orders = np.sort(rng.choice(np.arange(1, 25), int(rng.integers(2, 5)), replace=False))
        heights = HEIGHT * rng.uniform(0.2, 1.0, orders.size) * (orders[0] / orders) ** 1.3
        phases = rng.uniform(0, 6, orders.size) if rng.random() < 0.6 else np.zeros(orders.size)
        profile = _harmonics(orders.tolist(), heights.tolist(), phases.tolist())
        targets = [8e-5, 4e-5, 2e-5, 1e-5]
    loading: Table = {"control": "separation", "targets": rng.choice(targets, 2, replace=False).tolist()}
    fate = rng.random()
    if fate < 0.25:
        loading["initial"] = "complete_contact"
    elif fate < 0.5:
        full = MODULUS * HEIGHT / PERIOD
        loading = {"control": "mean_pressure", "targets": (full * np.array([rng.choice([0.05, 0.2]), -0.02])).tolist()}
    adhesion: Table = {"work_of_adhesion": float(work), "slope_term": bool(rng.random() < 0.5)}
    return tables | {"profile": profile | {"period": PERIOD}, "adhesion": adhesion, "loading": loading}


def _harmonics(orders: list[int], amplitudes: list[float], phases: list[float]) -> Table:
    return {"kind": "harmonics", "orders": orders, "amplitudes": amplitudes, "phases": phases}


def _scenes() -> Iterator[tuple[str, Table]]:
    for folder in ("cases/scenes", "command_line/examples"):
        for path in sorted((ROOT / "validation" / folder).glob("*.toml")):
            tables = tomllib.loads(path.read_text("utf-8"))
            tables.pop("output", None)
            if tables["profile"].get("kind") != "samples" and tables["profile"].get("harmonics", 0) < 1000:
                yield path.stem, tables


def _crests(order: int, alpha: float, delta: float, loading: Table, layer: float | None) -> Table:
    """Equal crests but for a wave of order 1; alpha is Johnson's of one of them."""
    height, full = 1e-4, np.pi * MODULUS * 1e-4 * order / PERIOD
    orders, heights = ([order], [height]) if not delta else ([1, order], [delta * height, height])
    tables: Table = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5 if layer is None else 0.45},
        "profile": _harmonics(orders, heights, [0.3, 0.0][-len(orders) :]) | {"period": PERIOD},
        "adhesion": {"work_of_adhesion": (alpha * full) ** 2 * PERIOD / order / (2 * MODULUS)},
        "loading": loading,
    }
    return tables if layer is None else tables | {"layer": {"thickness": layer}}


def _patterns() -> Iterator[tuple[str, Table]]:
    back = {0.01: 1.2e-6, 0.02: 2.1e-6, 0.05: 5.3e-6, 0.1: 1.13e-5, 0.3: 3.89e-5}
    for order, alpha, delta, layer in (
        (1, 0.1, 0.0, None), (2, 0.02, 0.0, None), (2, 0.05, 1e-3, None), (2, 0.3, 1e-12, None), (2, 0.02, 0.0, 1e-3),
        (3, 0.01, 1e-5, None), (3, 0.1, 0.0, None), (3, 0.05, 1e-5, 2e-3), (4, 0.02, 0.0, None), (4, 0.05, 1e-12, None),
        (4, 0.01, 1e-8, None), (7, 0.02, 0.0, None), (7, 0.1, 1e-3, None), (7, 0.3, 0.0, 5e-3), (7, 0.3, 1e-8, None),
        (12, 0.05, 0.0, None), (12, 0.02, 1e-3, 1e-3), (12, 0.1, 1e-8, None),
    ):  # fmt: skip
        targets = [0.3e-4, 1e-4 + back[alpha], 1e-4 + 1.5 * back[alpha]]
        loading: Table = {"control": "separation", "targets": targets}
        yield f"crests-{order}-{alpha}-{delta}-{layer}", _crests(order, alpha, delta, loading, layer)
    for order, alpha, layer in ((4, 0.3, None), (9, 0.3, None), (3, 0.08, None), (5, 0.08, None), (5, 0.12, 1e-3)):
        loading = {"control": "separation", "initial": "complete_contact", "targets": [0.2e-4, 0.8e-4, 1.5e-4]}
        yield f"opened-{order}-{alpha}-{layer}", _crests(order, alpha, 0.0, loading, layer)
    for order, alpha, delta in ((2, 0.02, 0.0), (4, 0.3, 1e-3), (7, 0.05, 0.0)):
        full = np.pi * MODULUS * 1e-4 * order / PERIOD
        loading = {"control": "mean_pressure", "targets": [0.1 * full, -0.5 * alpha * full, -2 * alpha * full]}
        yield f"load-{order}-{alpha}-{delta}", _crests(order, alpha, delta, loading, None)
    for order, alpha, layer in ((7, 0.05, 1e-3), (3, 0.02, 3e-3)):
        loading = {"control": "total_displacement", "targets": [0.5e-4, -back[alpha], -3 * back[alpha]]}
        yield f"plate-{order}-{alpha}", _crests(order, alpha, 0.0, loading, layer)


def _ripples() -> Iterator[tuple[str, Table]]:
    opening: Table = {"control": "separation", "initial": "complete_contact"}
    for order, height, phase, targets in (
        (300, 1e-8, 0.0, [1e-6]), (300, 1e-8, 0.3, [1e-6]), (200, 2e-8, 0.0, [20e-6, 30e-6, 10e-6]),
        (150, 4e-8, 0.0, [1.265176e-6]), (300, 1e-8, 0.3, [1e-6, 0.0]), (40, 1e-6, 1e-6, [2e-6, 7e-7, 1.3e-5]),
    ):  # fmt: skip
        tables = {"solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5}, "adhesion": {"work_of_adhesion": 0.3}}
        tables["profile"] = _harmonics([1, order], [HEIGHT, height], [phase, 0.0]) | {"period": PERIOD}
        yield f"ripple-{order}-{phase}-{len(targets)}", tables | {"loading": opening | {"targets": targets}}
    for case in ("rippled_wave",):
        yield case, tomllib.loads((ROOT / f"validation/cases/scenes/{case}.toml").read_text("utf-8"))
