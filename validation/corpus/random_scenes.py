"""Scenes drawn at random from the whole contract of the scene file, each by its own seed.

Scene k of seed K comes from `default_rng([K, k])` alone, whatever else is drawn, in any worker.  Drawn are kinds of
profile, solids, layers from thin to thick, adhesion from none to strong (Johnson's alpha of a wave with the rms height
of the profile), controls, histories, accuracies and outputs, at lengths from nm to m and moduli from 1e2 to 1e13 Pa.
Every range is met at its ends now and then (`_within`).  Targets are parts of the way to complete contact, so that a
scene asks for something whatever its scale; increments are parts of the path, so that it is walked in a bounded number
of steps.

SI units.  Limits: few harmonics (`HARMONICS`), so that many scenes are affordable; equal crests come of waves of
one order and of phases that are multiples of pi/2.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bem.command_line.console import scene_text
from bem.elastic.layer import compliance_ratio
from bem.geometry.profile import Profile
from validation.references.closed_forms import uniform_compliance
from validation.references.paper_problem import Table

Numbers = NDArray[np.float64]

SCAN = "scan.csv"
HARMONICS = 12  # highest order of a profile
AT_THE_END = 0.12  # share of draws that are an end of their range
STEPS = (8.0, 60.0)  # of a path, at its largest increment; more only where the default increment is left in place
MOST_STEPS = 90.0


@dataclass(frozen=True, eq=False)
class Drawn:
    """A scene drawn at random."""

    seed: int  # and `index`: where it comes from
    index: int
    tables: Table  # the scene file
    scan: Numbers | None  # samples of profile.file, m, (n, 2)

    @property
    def id(self) -> str:
        """Name of the scene."""
        return f"seed_{self.seed}_scene_{self.index}"

    @property
    def reason(self) -> str:
        """Summary of the scene in a line."""
        tables, loading = self.tables, self.tables["loading"]
        parts = [tables["profile"]["kind"], str(loading["control"])]
        parts += [name for name in ("layer", "adhesion") if name in tables]
        return ", ".join(parts)

    def write(self, folder: Path) -> Path:
        """Write the scene file, and its scan beside it; return the path of the scene file."""
        self.write_scan(folder)
        path = folder / f"{self.id}.toml"
        path.write_text(scene_text({"title": self.id} | self.tables) + "\n", "utf-8")
        return path

    def write_scan(self, folder: Path) -> None:
        """Write the samples, if the profile has any."""
        if self.scan is not None:
            np.savetxt(folder / SCAN, self.scan, delimiter=",", fmt="%.17g")


def draw(seed: int, index: int, most: int = HARMONICS) -> Drawn:
    """Draw scene `index` of a seed, both >= 0; `most` is the highest order of a profile.

    Examples
    --------
    >>> draw(0, 7).tables == draw(0, 7).tables, draw(0, 7).tables == draw(1, 7).tables
    (True, False)
    """
    rng = np.random.default_rng([seed, index])
    period = 10 ** rng.uniform(-8.0, 0.0)
    solid = {
        "youngs_modulus": 10 ** _within(rng, 2.0, 13.0),
        "poisson_ratio": _within(rng, -0.9, 0.5, (0.0, 0.499999, 0.5)),
    }
    profile, scan, surface = _profile(rng, period, period * 10 ** rng.uniform(-5.0, -0.5), most)
    tables: Table = {"solid": solid, "profile": profile}
    if rng.random() < 0.45:
        tables["layer"] = {"thickness": period * 10 ** _within(rng, -2.0, 1.0)}
    if rng.random() < 0.7:
        tables["adhesion"] = _adhesion(rng, solid, surface)
    tables["loading"], span = _loading(rng, tables, surface)
    tables["accuracy"] = _accuracy(rng, span)
    output = _output(rng, tables["loading"])
    if output:
        tables["output"] = output
    return Drawn(seed, index, tables, scan)


def plane_strain_modulus(solid: Table) -> float:
    """Return E / (1 - nu^2) of [solid], Pa."""
    return float(solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2))


def complete_pressure(tables: Table, surface: Profile) -> float:
    """Return the mean pressure from which contact is complete without adhesion, Pa."""
    stiffness = plane_strain_modulus(tables["solid"]) * surface.q0 * surface.orders / 2
    if "layer" in tables:
        q_d = surface.q0 * surface.orders * tables["layer"]["thickness"]
        stiffness = stiffness / compliance_ratio(q_d, tables["solid"]["poisson_ratio"])
    amplitudes = stiffness * surface.amplitudes
    return Profile(surface.period, surface.orders, amplitudes, surface.phases + np.pi).max_height


def _within(rng: np.random.Generator, low: float, high: float, ends: tuple[float, ...] = ()) -> float:
    """Draw uniformly from a range, or with probability `AT_THE_END` one of its ends (or of the special values)."""
    if rng.random() < AT_THE_END:
        return float(rng.choice(ends or (low, high)))
    return float(rng.uniform(low, high))


def _profile(rng: np.random.Generator, period: float, rms: float, most: int) -> tuple[Table, Numbers | None, Profile]:
    """Draw [profile]; return the table, its samples if it has any, and the profile."""
    kind = rng.choice(["self_affine", "harmonics", "samples"], p=[0.4, 0.35, 0.25])
    if kind == "self_affine":
        hurst, count = _within(rng, 0.05, 0.95, (0.001, 0.999)), int(rng.integers(1, most + 1))
        table: Table = {"kind": "self_affine", "period": period, "hurst": hurst, "rms_height": rms, "harmonics": count}
        if rng.random() < 0.9:
            table["seed"] = int(rng.integers(2**31))
        return table, None, Profile.self_affine(period, hurst, rms, count, table.get("seed", 0))
    if kind == "harmonics":
        orders = np.sort(rng.choice(np.arange(1, most + 1), int(rng.integers(1, 6)), replace=False))
        amplitudes = rng.normal(size=orders.size) / orders
        amplitudes *= rms / np.sqrt(np.sum(amplitudes**2) / 2)
        phases = rng.uniform(-10.0, 10.0, orders.size)
        if rng.random() < 0.3:
            phases = rng.choice(np.pi / 2 * np.arange(-2, 3), orders.size)
        if rng.random() < 0.02:
            amplitudes = 0.0 * amplitudes
        surface = Profile.from_harmonics(period, orders, amplitudes, phases)
        lists = {"orders": orders, "amplitudes": amplitudes, "phases": phases}
        return {"kind": "harmonics", "period": period} | {k: v.tolist() for k, v in lists.items()}, None, surface
    return _sampled(rng, period, rms, most)


def _sampled(rng: np.random.Generator, period: float, rms: float, most: int) -> tuple[Table, Numbers | None, Profile]:
    """Draw [profile] of a noisy scan that may be inclined and start anywhere."""
    number = int(rng.integers(5, 8 * most))
    x = (np.arange(number) + float(rng.choice([0, 0, 1, -3, 0.5]))) * (period / number)
    wave = Profile.self_affine(period, rng.uniform(0.3, 0.9), rms, most, int(rng.integers(2**31)))
    tilt = float(rng.choice([0.0, 0.0, 2 * rms / period]))
    height = wave.height(x) + rng.normal(0.0, 0.05 * rms, number) + tilt * x
    count = int(rng.integers(1, min(most, (number - 1) // 2) + 1))
    detrend = str(rng.choice(["mean", "line"]))
    table: Table = dict.fromkeys(("unit_x", "unit_h"), "m")
    table |= {"kind": "samples", "file": SCAN, "detrend": detrend, "harmonics": count}
    if (number - 1) // 2 <= most and rng.random() < 0.3:
        del table["harmonics"]
        count = (number - 1) // 2
    if rng.random() < 0.3:
        table["period"] = period
    return table, np.column_stack([x, height]), Profile.from_samples(x, height, count, detrend)


def _adhesion(rng: np.random.Generator, solid: Table, surface: Profile) -> Table:
    """Draw [adhesion]: w = alpha^2 p*^2 period / (2 E*) of a wave of the rms height, alpha from weak to strong."""
    alpha = 10 ** _within(rng, -2.5, 0.0)
    height = np.sqrt(2) * surface.rms_height or surface.period
    work = (alpha * np.pi * height) ** 2 * plane_strain_modulus(solid) / (2 * surface.period)
    table: Table = {"work_of_adhesion": float(work)}
    if rng.random() < 0.6:
        table["slope_term"] = bool(rng.random() < 0.7)
    return table


def mean_compliance(tables: Table) -> float:
    """Return c(0) of a layer, m/Pa; 0 of a half-space, which has none."""
    if "layer" not in tables:
        return 0.0
    return uniform_compliance(tables["layer"]["thickness"], **tables["solid"])


def _loading(rng: np.random.Generator, tables: Table, surface: Profile) -> tuple[Table, float]:
    """Draw [loading]; return the table, and the length of its path over the length of an increment of 1."""
    controls = ["separation", "penetration", "mean_pressure", *["total_displacement"] * ("layer" in tables)]
    control = str(rng.choice(controls))
    complete = complete_pressure(tables, surface) or plane_strain_modulus(tables["solid"])
    highest = surface.max_height or surface.period

    def value(part: float) -> float:
        """Return the controlled quantity after a part of the way to complete contact; the load grows as the square."""
        pressure = complete * part * abs(part)
        ways = {
            "separation": max(highest * (1 - part), 0.0),
            "penetration": highest * part,
            "mean_pressure": pressure,
            "total_displacement": highest * part + mean_compliance(tables) * pressure,
        }
        return float(ways[control])

    parts, loading = _history(rng)
    loading = {"control": control} | {
        key: value(part) if isinstance(part, float) else part for key, part in loading.items()
    }
    if parts:
        loading["targets"] = [value(part) for part in parts]
    pressures = [complete * part**2 for part in np.sort(rng.uniform(0.02, 0.6, 2)).tolist()]
    extra = rng.random()
    if extra < 0.1:
        loading["stop_at_mean_pressure"] = pressures[1]
    elif extra < 0.2:
        loading["at_mean_pressures"] = pressures
    if loading.get("initial") == "complete_contact" and control == "mean_pressure" and "adhesion" in tables:
        loading["flaw"] = surface.period * 10 ** rng.uniform(-3.0, -0.7)
    unit = surface.rms_height or surface.period
    if control == "mean_pressure":
        unit = 1e-2 * (surface.rms_slope or 1.0) * plane_strain_modulus(tables["solid"])
    return loading, abs(value(1.0) - value(0.0)) / unit


def _history(rng: np.random.Generator) -> tuple[list[float], Table]:
    """Draw targets as parts of the way to complete contact, and the other keys of [loading]; floats are parts too."""
    deep = 1.0 if rng.random() < 0.05 else float(rng.uniform(0.03, rng.choice([0.35, 0.6, 0.95])))
    low = float(rng.choice([-0.2, 0.0, deep * rng.uniform(0.1, 0.9)]))
    form = rng.choice(["load", "load", "unload", "unload", "zigzag", "range", "back", "complete"])
    if form == "load":
        return [*np.sort(rng.uniform(0.01, deep, int(rng.integers(0, 3)))).tolist(), deep], {}
    if form == "unload":
        return [deep, *([(deep + low) / 2] if rng.random() < 0.5 else []), low], {}
    if form == "zigzag":
        return [deep * part for part in rng.uniform(0.1, 1.0, 4).tolist()], {}
    if form == "complete":
        return sorted({0.999, deep, low, float(rng.uniform(low, deep))}, reverse=True), {"initial": "complete_contact"}
    begin = deep * float(rng.uniform(0.0, 0.5))
    path: Table = {"start": begin, "stop": deep, "count": int(rng.integers(2, 6))}
    return [], path | ({"then_back_to": min(begin, low)} if form == "back" else {})


def _accuracy(rng: np.random.Generator, span: float) -> Table:
    """Draw [accuracy]: a path of a bounded number of increments, any tolerance."""
    table: Table = {}
    if span / 0.05 > MOST_STEPS or rng.random() < 0.6:
        table["max_increment"] = min(span / float(np.exp(rng.uniform(*np.log(STEPS)))), 100.0)
    if rng.random() < 0.6:
        table["tolerance"] = 10 ** _within(rng, -11.0, -2.0, (-12.0, -2.0))
    return table


def _output(rng: np.random.Generator, loading: Table) -> Table:
    """Draw [output], which most scenes lack."""
    table: Table = {}
    shares = rng.random(3)  # the third belonged to an output that is gone: draws after it stay as they were
    for name, share in zip(("spectra", "pressure_distribution"), shares, strict=False):
        if share < 0.12:
            table[name] = True
    if rng.random() < 0.12 and "targets" in loading and loading.get("initial") is None:
        table["shapes"] = [loading["targets"][0]]
    return table
