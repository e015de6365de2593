"""Mean contact areas of boundary-element ensembles whose realisations differ in their phases alone.

The spectra, loads (p / (E* h'_rms)), works of adhesion (theta, over the elastic energy of full contact), realisations
and seed roots are in plans.json.  All profiles share the period and the rms slope of the paper's profile.  The phases
of a realisation are default_rng([root, crc32(name of the group), number]), independent between groups.

A realisation without adhesion is solved at every load by itself; a realisation with adhesion is loaded from first touch
and stored at every load.  A load at which a realisation has no state, because contact is complete, has the area nan.
Limits: half-space, loading, tolerance 1e-3, no slope term.
"""

import json
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import bem
from bem.loading.crew import at_work
from persson import DiscreteSpectrum
from validation.harness.arrays import FloatArray
from validation.references.paper_problem import MODULUS, PERIOD, RMS_SLOPE, lines, scene, up_to

SHORT = {"self-affine": "sa", "roll-off": "ro", "band": "nb", "gaussian": "ga", "lines": "li"}
SAME_LOAD = 1e-7  # of E*
DEEPEST = 1e-4  # separation in rms heights; the last load ends the path before it


@dataclass(frozen=True)
class Group:
    """Realisations of one spectrum.

    Attributes
    ----------
    spectrum : kind of spectrum, a key of `SHORT`.
    parameters : parameters that `shape` evaluates.
    realisations : number for each seed root.
    loads_up_to : largest load.
    left_out : numbers of realisations that the solver did not finish.
    """

    spectrum: str
    parameters: Sequence[Any]
    realisations: Sequence[int]
    loads_up_to: float = np.inf
    left_out: Sequence[int] = ()

    @property
    def name(self) -> str:
        """Name that seeds the phases."""
        return "-".join([SHORT[self.spectrum], *map(str, self.parameters)]).replace(" ", "")

    @property
    def shape(self) -> tuple[FloatArray, FloatArray]:
        """Orders and relative heights of the lines, (n_lines,) each."""
        kind, given = self.spectrum, self.parameters
        if kind == "lines":
            order = np.array(given[0], dtype=np.float64)
            return order, order ** -given[1]
        order = np.arange(given[0] if kind == "band" else 1, given[-1] + 1.0)
        if kind == "self-affine":
            return order, order ** -(given[0] + 0.5)
        if kind == "roll-off":
            return order, np.maximum(order, given[0]) ** -(given[1] + 0.5)
        return order, np.exp(-((order / given[0]) ** 2) / 2) if kind == "gaussian" else 1 / order

    @property
    def lines(self) -> DiscreteSpectrum:
        """Lines with the rms slope that all groups share."""
        order, height = self.shape
        wavenumber = 2 * np.pi / PERIOD * order
        return DiscreteSpectrum(wavenumber, height * RMS_SLOPE / np.sqrt(np.sum((wavenumber * height) ** 2) / 2))


@dataclass(frozen=True)
class Plan:
    """Ensembles of a fit or of a hold-out."""

    seed_roots: Sequence[int]
    loads: FloatArray
    thetas: Sequence[float]
    groups: Sequence[Group]


def read_plan(law: str, part: str, seed: int | None = None) -> Plan:
    """Read the plan of a law ("dry" or "wet") and a part ("fit" or "hold_out"), with another seed root if given."""
    content = json.loads((Path(__file__).parent / "plans.json").read_text("utf-8"))[law][part]
    roots = content["seed_roots"] if seed is None else [seed]
    groups = [Group(**fields) for fields in content["groups"]]
    return Plan(roots, np.array(content["loads"]), content["thetas"], groups)


def scene_of(group: Group, loads: FloatArray, root: int, number: int, theta: float) -> dict[str, Any]:
    """Return the scene of one realisation, at loads over E* h'_rms; theta = 0 for no adhesion."""
    order, spectrum = group.shape[0], group.lines
    seed = [root, zlib.crc32(group.name.encode()), number]
    phases = np.random.default_rng(seed).uniform(-np.pi, np.pi, order.size)
    pressures = (loads[loads <= group.loads_up_to] * RMS_SLOPE * MODULUS).tolist()
    loading = {"control": "mean_pressure", "targets": pressures}
    if theta:
        loading = up_to(pressures, DEEPEST * spectrum.h_rms)
    work = theta * MODULUS * spectrum.full_contact_energy or None
    profile = lines(order, spectrum.amplitudes, phases)
    return scene(f"{group.name}, root {root}, {number}", profile, loading, work, accuracy={"tolerance": 1e-3})


def areas_of(path: tuple[FloatArray, float], task: tuple[Group, int, int]) -> FloatArray:
    """Solve one realisation (group, root, number) at loads and theta; return its contact fractions, (n_loads,)."""
    loads, theta = path
    fractions = np.full(loads.size, np.nan)
    for state in bem.solve(scene_of(task[0], loads, task[1], task[2], theta)).targets:
        distance = np.abs(loads * RMS_SLOPE - state.mean_pressure / MODULUS)
        if distance.min() < SAME_LOAD:
            fractions[np.argmin(distance)] = state.contact_fraction
    return fractions


def solve_groups(plan: Plan, theta: float, jobs: int) -> Iterator[tuple[Group, FloatArray]]:
    """Yield each group with the contact fractions of its realisations, (n_realisations, n_loads)."""
    with at_work(jobs, (plan.loads, theta)) as each:
        for group in plan.groups:
            numbers = zip(plan.seed_roots, group.realisations, strict=True)
            tasks = [(group, root, k) for root, count in numbers for k in range(count) if k not in group.left_out]
            yield group, np.array(list(each(areas_of, tasks)))
