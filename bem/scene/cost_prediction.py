"""What a scene will cost: evaluations, from its path and the crests that it passes, times seconds of one evaluation.

With adhesion a path takes evaluations for its increments, for the crests of the profile that touch or part on the way
(each is one or more events), for the waves that edges pass (bem/geometry/contact_extent.py), and for its targets;
without, for its targets alone.  Crests on the way are those of the profile between the separations of the legs; a mean
pressure p stands for the separation at which the profile is above the plane over `AREA` times the area
erf(sqrt(2) p / (E* h'_rms)) of Persson's theory (J. Chem. Phys. 115 (2001) 3840), with adhesion at the pressure that
its pull adds to.
An evaluation takes seconds that grow with the patches, at most the crests above the plane of waves that adhesion does
not close, with the harmonics, and on a layer with its waves and the unknowns: these are the modes of the kernel or,
where they are fewer, those of the pressure (bem/elastic/kernel_series.py).

The constants are fitted to every other scene of a list; the others and random ones judge them (within a factor of 3
for nine of ten: validation/corpus/cost_scenes.py).  Seconds are those of one core on which the reference kernel takes
`KERNEL_SECONDS`; `pace` compares this machine with it.  Whether kernels are compiled is known.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from bem.compiled.kernels import IN_USE
from bem.geometry.arrays import FloatArray
from bem.geometry.contact_extent import ContactExtent
from bem.geometry.profile import Profile
from bem.scene.scene import Scene

PER_INCREMENT, PER_CREST, PER_TARGET, PER_WAVE = 3.8, 16.1, 5.7, 10.0  # prediction: evaluations with adhesion
DIGITS = 1e-2, 1e-3, 1e-4, 1e-6, 1e-9  # prediction: accuracies that are priced
LOADED = 0.5  # prediction: increments under a given load count so much: fewer states are stored on the way
BEGINNING = 5.0  # prediction: increments of a leg under load though the contact hardly moves: the first ones are short
PER_BARE_TARGET = 6.0  # prediction: without, of few crests
FEW_CRESTS, MORE_BY_CREST = 40, 0.35  # prediction: these, and the power with which more of them take more evaluations
AREA = 2.5  # prediction: geometric overlap over the area of contact
LEAST_AREA = 1e-3  # prediction: at which a load is first felt
FINE = 6.5  # prediction: rms slope over rms height and least wavenumber, from which the area falls like its inverse
OPENS = 0.2  # prediction: of E* h'_rms: complete contact has opened before its mean pressure falls to this
LAYER_WAVES = 2.8  # prediction: by period over thickness
KERNEL_MODES, EDGE_MODES = 7.0, 12.0  # prediction: of a patch, by width over thickness and by the root of it
EQUAL = 9  # prediction: digits to which crests that touch at once are of one height
LAYER_GIGABYTES = 0.25, 0.03  # prediction: by square of thousands of unknowns, and by thousands of waves times modes
HARMONIC_GIGABYTES = 1.4e-5  # prediction: GB by harmonic: tables; 1.49 GB at 100,000
LONG_SECONDS, MANY_GIGABYTES = 3600.0, 8.0  # prediction: of which a run warns before it begins
CLOCKS = (("years", 3.156e7), ("days", 86400.0), ("hours", 3600.0))
KERNEL_SECONDS, KERNEL_RUNS = 0.7e-3, 7  # prediction: of the reference kernel; the least of so many runs counts
# of an evaluation: least, by crest, by harmonic; of one without adhesion; of a layer: least, and in thousands by square
# and cube of its unknowns, by unknowns times waves, and this times modes of a patch
MILLISECONDS = {
    "compiled": ((0.89, 0.012, 4e-5), (1.5, 0.06, 0.006), (0.31, 25.0, 10.0, 15.0, 40.0)),
    "NumPy": ((1.6, 0.051, 5.4e-4), (3.0, 0.12, 0.008), (0.43, 250.0, 50.0, 30.0, 40.0)),
}


@dataclass(frozen=True)
class Leg:
    """The way to a target."""

    start: float  # what is controlled, m or Pa, where it begins
    stop: float  # and where it ends
    plane: float  # the separation at its end, m
    increments: float
    crests: int  # that touch or part
    waves: float = 0.0  # that each edge passes

    @property
    def evaluations(self) -> float:
        """What it takes with adhesion, its target included."""
        on_the_way = PER_INCREMENT * self.increments + PER_CREST * self.crests + PER_WAVE * self.waves
        return on_the_way + PER_TARGET


@dataclass(frozen=True)
class Cost:
    """What a scene is predicted to cost."""

    legs: tuple[Leg, ...]  # one for each target
    bare: float  # evaluations that the targets would take without adhesion
    evaluations: float
    milliseconds: float  # of one evaluation, on the machine of the constants
    layer_share: float  # of these, what the layer adds
    gigabytes: float = 0.0  # of memory

    @property
    def seconds(self) -> float:
        """On this machine, one core."""
        return 1e-3 * self.evaluations * self.milliseconds * pace()

    def done(self, index: int, value: float) -> float:
        """Share of the evaluations behind one who is on the way to target `index`, at a value of what is controlled."""
        spent = sum(leg.evaluations for leg in self.legs[:index])
        whole = sum(leg.evaluations for leg in self.legs)
        leg = self.legs[index]
        way = leg.stop - leg.start
        passed = min(1.0, max(0.0, (value - leg.start) / way)) if way != 0 and math.isfinite(value) else 0.0
        return (spent + passed * leg.evaluations) / whole if whole else 0.0


def cost_of(scene: Scene, kernels: str = IN_USE) -> Cost:
    """The predicted cost of a scene with these kernels, "compiled" or "NumPy".

    Examples
    --------
    >>> from bem.scene.scene import parse_scene
    >>> scene = parse_scene({
    ...     "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    ...     "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
    ...     "adhesion": {"work_of_adhesion": 1e-3},
    ...     "loading": {"control": "penetration", "targets": [1e-5]},
    ... })
    >>> round(cost_of(scene).evaluations)  # solved: 118
    131
    """
    surface = scene.surface()
    if surface.is_flat:
        return Cost(tuple(Leg(0.0, 0.0, 0.0, 0.0, 0) for _ in scene.loading.targets), 0.0, 0.0, 0.0, 0.0)
    levels = np.sort(surface.grid[1])
    crests = np.sort(np.round(surface.crests[1] / surface.max_height, EQUAL) * surface.max_height)
    legs = _legs(scene, surface, levels, crests)
    lowest = min(leg.plane for leg in legs)
    crowds = np.array([crests.size - int(np.searchsorted(crests, leg.plane, side="right")) for leg in legs])
    bare = PER_BARE_TARGET * float(np.sum(np.maximum(1.0, crowds / FEW_CRESTS) ** MORE_BY_CREST))
    (least, by_crest, by_harmonic), of_bare, of_layer = MILLISECONDS[kernels]
    if scene.adhesion is None:
        above = crests.size - int(np.searchsorted(crests, lowest, side="right"))
    else:
        above = _extent(scene, surface).crests_above(lowest)
    area = 1 - float(np.searchsorted(levels, lowest, side="right")) / levels.size
    if scene.loading.initial == "complete_contact":
        area = 1.0
    extra, gigabytes = 0.0, HARMONIC_GIGABYTES * surface.max_order
    if scene.layer is not None:
        extra, memory = _layer(surface.period / scene.layer.thickness, area, max(1, above), of_layer)
        gigabytes += memory
    if scene.adhesion is None:
        plain = of_bare[0] + of_bare[1] * float(crowds.mean()) + of_bare[2] * surface.max_order
        return Cost(legs, bare, bare, plain + extra, extra / (plain + extra), gigabytes)
    plain = least + by_crest * above + by_harmonic * surface.max_order
    evaluations = sum(leg.evaluations for leg in legs)
    return Cost(legs, bare, evaluations, plain + extra, extra / (plain + extra), gigabytes)


def _layer(thicknesses: float, area: float, patches: int, prices: tuple[float, ...]) -> tuple[float, float]:
    """What a layer adds, ms and GB an evaluation: the period in thicknesses, the fraction of contact, its patches."""
    width, waves = thicknesses * area / patches, LAYER_WAVES * thicknesses / 1000
    modes = min(KERNEL_MODES * width, EDGE_MODES * math.sqrt(width)) / 1000
    unknowns = patches * modes
    counts = 1.0, unknowns**2, unknowns**3, unknowns * waves, unknowns * waves * modes
    gigabytes = LAYER_GIGABYTES[0] * unknowns**2 + LAYER_GIGABYTES[1] * waves * modes
    return sum(price * count for price, count in zip(prices, counts, strict=True)), gigabytes


def seconds_by_digits(scene: Scene) -> dict[float, float]:
    """What each of some values of `accuracy.tolerance` would cost, s."""
    accuracies = (scene.accuracy.model_copy(update={"tolerance": tolerance}) for tolerance in DIGITS)
    priced = (cost_of(replace(scene, accuracy=accuracy)).seconds for accuracy in accuracies)
    return dict(zip(DIGITS, priced, strict=True))


def warning_of(cost: Cost) -> str:
    """What has to be said before hours are spent or memory is filled; empty where neither is predicted.

    Examples
    --------
    >>> warning_of(Cost((), 0.0, 1e6, 2.7e6, 0.9, 12.0)).partition(" of one core")[2]
    ' and 12 GB of memory are predicted; try a thicker layer, fewer harmonics or targets, or a larger max_increment'
    >>> warning_of(Cost((), 0.0, 100.0, 1.0, 0.0, 0.1))
    ''
    """
    if cost.seconds < LONG_SECONDS and cost.gigabytes < MANY_GIGABYTES:
        return ""
    unit, size = next(((unit, size) for unit, size in CLOCKS if cost.seconds >= size), ("s", 1.0))
    return (
        f"{cost.seconds / size:.2g} {unit} of one core and {cost.gigabytes:.2g} GB of memory are predicted; try "
        "a thicker layer, fewer harmonics or targets, or a larger max_increment"
    )


def _legs(scene: Scene, surface: Profile, levels: FloatArray, crests: FloatArray) -> tuple[Leg, ...]:
    """The legs of the path."""
    loading, scale = scene.loading, _pressure_scale(scene, surface)
    pressed, complete = loading.control == "mean_pressure", loading.initial == "complete_contact"
    lowest, highest, passed = float(levels[0]), surface.max_height, np.unique(crests)
    largest = scene.accuracy.max_increment
    legs: list[Leg] = []
    extent = None if scene.adhesion is None else _extent(scene, surface)
    value, plane = _start(scene, surface, scale), lowest if complete else highest
    before: float | None = None if complete else 0.0  # waves; what opens at a flaw passes none in its first leg
    for target, ahead in _route(scene, surface, levels, extent):
        ahead = min(max(ahead, lowest), highest)
        below = np.searchsorted(passed, (plane, ahead), side="right")
        count = abs(int(below[0]) - int(below[1]))
        increments = abs(ahead - plane) / (largest * surface.rms_height)
        if pressed:
            loaded = LOADED * abs(target - value) / (1e-2 * largest * scale)
            increments = min(loaded, max(increments, BEGINNING))
        gone = 0.0 if extent is None else extent.waves_passed(ahead)
        legs.append(Leg(value, target, ahead, increments, count, 0.0 if before is None else abs(gone - before)))
        value, plane, before = target, ahead, gone
    rest = Leg(value, value, plane, 0.0, 0)
    return (*legs, *(rest for _ in range(len(loading.targets) - len(legs))))


def _extent(scene: Scene, surface: Profile) -> ContactExtent:
    """What adhesion makes of the contacts."""
    work = math.nan if scene.adhesion is None else scene.adhesion.work_of_adhesion
    return ContactExtent(surface, scene.solid.youngs_modulus / (1 - scene.solid.poisson_ratio**2), work)


def _route(
    scene: Scene, surface: Profile, levels: FloatArray, extent: ContactExtent | None
) -> Iterator[tuple[float, float]]:
    """Targets, each with the separation that it is or stands for, up to where the path stops."""
    loading, scale = scene.loading, _pressure_scale(scene, surface)
    stop = math.inf if loading.stop_at_mean_pressure is None else loading.stop_at_mean_pressure
    end = -math.inf if math.isinf(stop) else _plane(levels, stop / scale)
    for target in loading.targets:
        if loading.control == "mean_pressure":
            opens = loading.initial == "complete_contact"
            pressure = target if extent is None or opens else extent.pulled(target)
            value, plane = min(target, stop), _plane(levels, pressure / scale)
            if loading.initial == "complete_contact":
                value = min(value, OPENS * scale)
                if target >= 0:  # what adhesion holds together opens at its flaw, not at crests, while it is pressed
                    plane = float(levels[0])
        else:
            value, plane = target, target if loading.control == "separation" else surface.max_height - target
            plane = _yielding(surface, levels, plane)
        yield value, max(plane, end)
        if plane <= end:
            return


def _pressure_scale(scene: Scene, surface: Profile) -> float:
    """E* h'_rms, Pa."""
    return scene.solid.youngs_modulus / (1 - scene.solid.poisson_ratio**2) * surface.rms_slope


def _start(scene: Scene, surface: Profile, scale: float) -> float:
    """What is controlled, where the path begins: at first touch, or where complete contact opens."""
    complete = scene.loading.initial == "complete_contact"
    if scene.loading.control == "mean_pressure":
        return min(scene.origin, OPENS * scale) if complete else scene.origin
    if math.isfinite(scene.origin):
        return scene.origin
    return surface.max_height if complete != (scene.loading.control == "separation") else 0.0


def _yielding(surface: Profile, levels: FloatArray, plane: float) -> float:
    """The separation above which crests touch: fine crests, steeper than the rest, press the solid back.

    The load at a separation hardly depends on them, and the area falls like the inverse of the slope.
    """
    fineness = surface.rms_slope / (surface.q0 * float(np.min(surface.orders)) * surface.rms_height)
    if fineness <= FINE:
        return plane
    above = levels.size - float(np.searchsorted(levels, plane, side="right"))
    return float(levels[-1 - min(levels.size - 1, int(above * FINE / fineness))])


def _plane(levels: FloatArray, pressure: float) -> float:
    """Separation that a mean pressure over E* h'_rms stands for."""
    area = min(max(AREA * math.erf(math.sqrt(2) * pressure), LEAST_AREA), 1.0)
    return float(levels[max(0, min(levels.size - 1, round((1 - area) * levels.size)))])


@lru_cache(maxsize=1)
def pace() -> float:
    """Seconds of this machine over those of the one of the constants, in steps of the root of 2."""
    taken = []
    for _ in range(KERNEL_RUNS):
        begun = time.perf_counter()
        _reference_kernel()
        taken.append(time.perf_counter() - begun)
    return float(2 ** (round(2 * math.log2(min(taken) / KERNEL_SECONDS)) / 2))


def _reference_kernel() -> float:
    """Small factorisations, logarithms and a loop: what an evaluation is made of, in NumPy."""
    places = np.arange(64.0)
    matrix = 0.01 * np.cos(0.1 * np.subtract.outer(places, places)) + np.eye(64)
    total = 0.0
    for _ in range(20):
        factor = np.linalg.cholesky(matrix)
        total += float(np.log(np.abs(factor) + 1).sum())
        for k in range(100):
            total += k * 1e-9
    return total
