"""One patch in closed form (one_patch.py): how it jumps from ripple to ripple, and how two crests merge to it.

A wave that carries a ripple, loaded and unloaded.  The mean pressure p(a) of one patch in equilibrium rises and falls
with every ripple that the edges cross.  While the load grows a branch ends at a maximum of p, or before it where the
gap at the next crest closes;
contact then spreads at that load to the next a of equal pressure and sets free

    U(a_1) - U(a_2) - p (Delta(a_1) - Delta(a_2)).

A crest on the way is a contact of its own, one each side, if the gap there closes before the edge arrives.  While the
load falls branches end at minima of p.  The ripple makes a loop of what would be one curve: it holds the surfaces
together (Guduru, J. Mech. Phys. Solids 55 (2007) 445).  Under separation control jumps break the symmetry, edge by
edge, but the states between them are those of one patch: at given Delta the first a to which contact spreads.  The
closed form knows nothing of the path of the solver: a jump that ends beyond the nearest minimum, or is found too late,
is seen as a number.

Two crests with a shallow dip at y = 0 between them and a deep valley behind, h = A (cos y - b cos 2y), b > 1/4.  The
period begins in the dip or in the valley; the closed form knows nothing of it.  Limits: symmetric profiles, one patch;
where patches merge is the solver's own.  SI units.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import chain

import numpy as np
from scipy.optimize import brentq, minimize_scalar

import bem
from bem.scene.result import Event, Result
from validation.cases.shared.checks import Against, Found, as_many, case, column, solved, work
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.references.one_patch import OnePatch

PERIOD, MODULUS, AMPLITUDE = 0.01, 1e6 / 0.75, 1e-4
MOST = 0.6  # contact fraction beyond which nothing is looked for
POINTS_PER_RIPPLE = 10
APPROACH = 60  # half widths at which the gap at a crest is looked at while an edge approaches it
ROUNDING = 1e-13  # of the units of pressure and energy


@dataclass(frozen=True)
class Jump:
    """From one half width a to another at a mean pressure, Pa: energy released, J/m^2, and crests touched each side."""

    start: float
    end: float
    pressure: float
    released: float
    touched: int


@dataclass(frozen=True, eq=False)
class RippledWave:
    """The wave of the scene rippled_wave with a ripple of this order, amplitude in m and work of adhesion in J/m^2."""

    order: int
    ripple: float
    work: float

    @cached_property
    def patch(self) -> OnePatch:
        """Its closed form."""
        return OnePatch(PERIOD, MODULUS, (AMPLITUDE, *[0.0] * (self.order - 2), self.ripple), self.work)

    @property
    def profile(self) -> bem.Profile:
        """Its heights."""
        return bem.Profile.from_harmonics(PERIOD, [1, self.order], [AMPLITUDE, self.ripple])

    @cached_property
    def crests(self) -> list[float]:
        """Crests of the ripple on the right, y in (0, pi)."""
        places = 2 * np.pi / PERIOD * self.profile.crests[0]
        return [float(y) for y in places if 1e-9 < y < np.pi]

    def loaded(self, *ends: float) -> tuple[list[Jump], list[float]]:
        """Jumps while the mean pressure grows from first touch to the last of some in Pa, and half widths a at each."""
        a, reached = self._next(self._grid, 0.0, 0.0), list[float]()
        jumps = [Jump(0.0, a, 0.0, -float(self.patch.energy(a)), 0)]
        while True:
            top = min(t for t in self.turning[1.0] if t > a)
            ahead = min(y for y in self.crests if y > top)
            if self._clearance(top, ahead) < 0:
                top = float(brentq(lambda b, ahead=ahead: self._clearance(b, ahead), a, top, xtol=1e-13))
            pressure = float(self.patch.mean_pressure(top))
            for end in (end for end in ends[len(reached) :] if end < pressure):
                reached.append(a if end <= jumps[-1].pressure else _root(self.patch.mean_pressure, end, a, top))
            if len(reached) == len(ends):
                return jumps, reached
            a = self._next(self._grid, pressure, top)
            jumps.append(self._jump(top, a))

    def unloaded(self, start: float, *ends: float) -> tuple[list[Jump], list[float]]:
        """Jumps while it falls from that at a half width to the last of some in Pa, and the half width at each."""
        a, jumps, reached = start, list[Jump](), list[float]()
        while True:
            dip = max(t for t in self.turning[-1.0] if t < a)
            pressure = float(self.patch.mean_pressure(dip))
            for end in (end for end in ends[len(reached) :] if end > pressure):
                reached.append(_root(self.patch.mean_pressure, end, dip, a))
            if len(reached) == len(ends):
                return jumps, reached
            a = self._next(self._grid[::-1], pressure, dip)
            jumps.append(self._jump(dip, a))

    def spread(self, penetration: float) -> float:
        """Half width a to which contact has spread at a penetration in m."""
        missing = self.patch.penetration(self._grid) - penetration
        up = int(np.flatnonzero((missing[:-1] < 0) & (missing[1:] >= 0))[0])
        return _root(self.patch.penetration, penetration, *self._grid[up : up + 2])

    @cached_property
    def _grid(self) -> FloatArray:
        """Half widths a, ascending."""
        count = int(POINTS_PER_RIPPLE * self.order * MOST / 2)
        return np.asarray(np.pi * MOST * (np.arange(count) + 1.0) / count)

    @cached_property
    def turning(self) -> dict[float, list[float]]:
        """Half widths of the maxima (sign 1) and minima (-1) of the mean pressure, ascending."""
        grid, value = self._grid, self.patch.mean_pressure(self._grid)
        found = {}
        for sign in (1.0, -1.0):
            rises = sign * np.diff(value)
            tops = np.flatnonzero((rises[:-1] > 0) & (rises[1:] <= 0)) + 1
            lowered = partial(self._lowered, sign)
            found[sign] = [_least(lowered, grid[i - 1], grid[i + 1], 1e-12)[0] for i in tops]
        return found

    def _lowered(self, sign: float, a: float) -> float:
        return -sign * float(self.patch.mean_pressure(a))

    def _next(self, grid: FloatArray, pressure: float, start: float) -> float:
        """The next a on the way of the grid from a start at which a stable branch has this mean pressure.

        ValueError where contact that jumps at it does not come to rest, below `MOST` or before it is gone.
        """
        outward = grid[1] > grid[0]
        beyond = grid[grid > start] if outward else grid[grid < start]
        missing = self.patch.mean_pressure(beyond) - pressure
        risen = (missing[:-1] < 0) & (missing[1:] >= 0) if outward else (missing[:-1] > 0) & (missing[1:] <= 0)
        if not risen.any():
            raise ValueError(f"mean pressure: contact that jumps at {pressure:g} Pa does not come to rest")
        at = int(np.flatnonzero(risen)[0])
        return _root(self.patch.mean_pressure, pressure, *sorted(beyond[at : at + 2]))

    def _jump(self, start: float, end: float) -> Jump:
        pressure = float(self.patch.mean_pressure(start))
        energy, depth = self.patch.energy([start, end]), self.patch.penetration([start, end])
        touched = sum(self._touches(start, crest, pressure) for crest in self.crests if start < crest < end)
        released = float(energy[0] - energy[1] - pressure * (depth[0] - depth[1]))
        return Jump(start, end, pressure, released, touched)

    def _touches(self, start: float, crest: float, pressure: float) -> bool:
        """Whether the gap at a crest closes while an edge approaches it from a start."""
        approach = start + (crest - start) * np.arange(APPROACH) / APPROACH
        return min(self.patch.gap(float(a), pressure, crest) for a in approach) < 0

    def _clearance(self, angle: float, crest: float) -> float:
        """Least gap in m about a crest beside a patch in equilibrium."""
        pressure, reach = float(self.patch.mean_pressure(angle)), 0.5 * np.pi / self.order
        return _least(lambda y: self.patch.gap(angle, pressure, y), max(angle, crest - reach), crest + reach, 1e-10)[1]

    def solved(self, control: str, targets: list[float], max_increment: float | None = None) -> Result:
        """The path of the solver."""
        profile = {"orders": [1, self.order], "amplitudes": [AMPLITUDE, self.ripple]}
        return solved("rippled_wave", profile=profile, adhesion={"work_of_adhesion": self.work},
                      loading={"control": control, "targets": targets},
                      accuracy={"max_increment": max_increment})  # fmt: skip


def _root(quantity: Callable[[float], FloatArray], value: float, low: float, high: float) -> float:
    """The half width between two at which a quantity has a value."""
    return float(brentq(lambda a: float(quantity(a)) - value, low, high, xtol=1e-15))


def _least(quantity: Callable[[float], float], low: float, high: float, close: float) -> tuple[float, float]:
    """Where a quantity is least between two places, and its value there."""
    found = minimize_scalar(quantity, bounds=(low, high), method="bounded", options={"xatol": close})
    return float(found.x), float(found.fun)


CRESTS = OnePatch(PERIOD, MODULUS, (AMPLITUDE, -0.5 * AMPLITUDE), 0.003)  # of the scene merged_crests
BEFORE, MERGED = 3, (1e4, 2e4, 4e4)  # loads before the coalescence, and mean pressures in Pa behind it
DIPS = {0.0: ("dip across the end of the period", "dots"), 0.5: ("dip in the middle of the period", "points")}
WAVE = RippledWave(30, 2e-6, 0.062)  # of the scene rippled_wave, and its mean pressures in Pa
LOADING, UNLOADING = (0.0, 1e3, 3e3, 6e3, 1e4, 1.4e4), (1.2e4, 1e4, 6e3, 3e3, 0.0, -1e3, -1.6e3)
COARSE, FINE = RippledWave(20, 4e-6, 0.06), RippledWave(40, 2e-6, 0.06)
COARSE_LOADS = (0.0, 1e4, 0.0, -1500.0)  # Pa
SEPARATIONS = (60e-6, 20e-6)  # m, of the fine one
LONGEST = 1.0  # rms heights: twenty times the largest increment by default
# of the work of adhesion, by a jump: what releases less is a fold's edge; measured 0.017 to 0.23
LEAST_RELEASED = 1e-3
EXACT = Against("exact", "closed form of one patch")


def _released(result: Result, wave: RippledWave) -> list[Event]:
    """The events that are jumps."""
    return [event for event in result.events if (event.energy_released or 0.0) > LEAST_RELEASED * wave.work]


def _rippled_wave() -> Found:
    result = solved("rippled_wave")
    up, widths = WAVE.loaded(*LOADING)
    down, narrower = WAVE.unloaded(widths[-1], *UNLOADING)
    legs = (  # with errors measured: the largest over a work of adhesion of 0.058 to 0.07 and max_increment 1.5 and 2
        ("grows", "loading", widths, 1.8e-13),
        ("falls", "unloading", narrower, 2e-13),
    )
    expected = [jump.pressure for jump in (*up[1:], *down)]
    met = [event for event in _released(result, WAVE) if event.kind != "first_touch"]
    known = Against("exact", "closed form of one patch, first and last passage of its mean pressure")
    states = {"grows": result.targets[: len(LOADING)], "falls": result.targets[len(LOADING) :]}
    exact = {way: [a / np.pi for a in angles] for way, _, angles, _ in legs}
    fractions, loads = ({way: column(there, name, unit) for way, there in states.items()}
                        for name, unit in (("contact_fraction", 1.0), ("mean_pressure", 1e3)))  # fmt: skip
    for way, _, _, measured in legs:
        yield known.row(f"contact fraction while the load {way}", "", exact[way], fractions[way], measured)
    yield known.count("patches of every state, and jumps after first touch",
                      [1.0] * len(result.targets) + [len(expected)],
                      [*column(result.targets, "n_patches"), len(met)])  # fmt: skip
    yield known.row("mean pressures at the jumps", "Pa", expected,
                    as_many(column(met, "mean_pressure"), expected), 1e-9, scale=max(expected))  # fmt: skip
    curve = np.linspace(0.03, 0.5, 600)
    yield drawn("rippled-wave",
                "Contact fraction against mean pressure: contact spreads and recedes from ripple to ripple, along the "
                "outer branches of the closed form.",
                axes("mean pressure / kPa", "contact fraction",
                     *(marks(f"bem, {name}", loads[way], fractions[way]) for way, name, _, _ in legs),
                     trace("closed form of one patch", WAVE.patch.mean_pressure(np.pi * curve) / 1e3, curve)),
                axes("mean pressure / kPa", "signed error of the contact fraction",
                     *(marks(name, loads[way], np.subtract(fractions[way], exact[way]))
                       for way, name, _, _ in legs)))  # fmt: skip
    yield work("evaluations states", result)


def _ripple_jumps() -> Found:
    result = COARSE.solved("mean_pressure", list(COARSE_LOADS))
    driven, hurried = (FINE.solved("separation", list(SEPARATIONS), longest) for longest in (None, LONGEST))
    up, widths = COARSE.loaded(*COARSE_LOADS[:2])
    down, narrower = COARSE.unloaded(widths[-1], *COARSE_LOADS[2:])
    jumps, met, kinds = [*up, *down], _released(result, COARSE), column(result.events, "kind")
    wide = [a / np.pi for a in (*widths, *narrower)]
    spread = [FINE.spread(FINE.profile.max_height - s) / np.pi for s in SEPARATIONS]
    pairs = list(zip(as_many(met, jumps), jumps, strict=True))
    touched = 2.0 * sum(jump.touched for jump in jumps)
    yield EXACT.row("contact fraction under a load that grows and falls, order 20", "", wide,
                    column(result.targets, "contact_fraction"), (1.4e-13, 5.5e-14))  # fmt: skip
    yield EXACT.row("contact fraction at two separations, order 40", "", spread,
                    column(driven.targets, "contact_fraction"), (5e-14, 2.1e-14))  # fmt: skip
    yield EXACT.row("energy released by every jump, over that of the closed form", "", [1.0] * len(jumps),
                    [None if event is None else (event.energy_released or 0.0) / jump.released
                     for event, jump in pairs], 8.9e-12)  # fmt: skip
    yield EXACT.row("mean pressure at every jump, over the largest", "Pa", column(jumps, "pressure"),
                    as_many(column(met, "mean_pressure"), jumps), 4.4e-12)  # fmt: skip
    yield EXACT.row("jumps whose pressure or energy is farther from the closed form than estimated", "", 0.0,
                    sum(event is None or _misjudged(event, jump) for event, jump in pairs), (0.01, 0.0), "absolute",
                    pinned="exact")  # fmt: skip
    # whether an edge meets a crest
    yield Against("self", "the same path in increments as they are by default").count(
        "jumps on the way, order 40, in increments of an rms height", len(_released(driven, FINE)),
        len(_released(hurried, FINE)))  # fmt: skip
    yield EXACT.count("new contacts, coalescences, and jumps", [touched, touched, len(jumps)],
                      [kinds.count("new_contact"), kinds.count("coalescence"), len(met)])  # fmt: skip
    curve = np.linspace(0.01, 0.4, 300)
    yield drawn("ripple-jumps",
                "Mean pressure of one patch on a rippled wave: jumps at constant load from ripple to ripple.",
                axes("contact fraction", "mean pressure / kPa",
                     trace("closed form of one patch", curve, COARSE.patch.mean_pressure(np.pi * curve) / 1e3),
                     *(trace("jump", [jump.start / np.pi, jump.end / np.pi], [jump.pressure / 1e3] * 2, "thin")
                       for jump in jumps),
                     marks("bem", column(result.states, "contact_fraction"),
                           column(result.states, "mean_pressure", 1e3))))  # fmt: skip
    yield work("evaluations", result, driven)


def _misjudged(event: Event, jump: Jump) -> bool:
    """Whether the errors that an event estimates are too small, beyond the rounding of the closed form."""
    estimate = event.error_estimate
    pressure, released = event.mean_pressure - jump.pressure, (event.energy_released or 0.0) - jump.released
    noise = ROUNDING * MODULUS * AMPLITUDE / PERIOD, ROUNDING * COARSE.work
    return (
        abs(pressure) > (estimate.mean_pressure or 0.0) + noise[0]
        or abs(released) > (estimate.energy_released or 0.0) + noise[1]
    )


def _off_dip(x: float | None, dip: float) -> float | None:
    """Distance from the middle of the dip, over the period, to the nearest image."""
    if x is None:
        return None
    distance = x / PERIOD - dip
    return distance - round(distance)


def _at(load: float) -> float:
    """Contact fraction of one patch at a mean pressure in Pa."""
    return float(brentq(lambda f: float(CRESTS.mean_pressure(np.pi * f)) - load, 0.4, 0.9, xtol=1e-15))


def _merged_crests() -> Found:
    results = {dip: solved("merged_crests", profile={"phases": [-2 * np.pi * dip, np.pi - 4 * np.pi * dip]})
               for dip in DIPS}  # fmt: skip
    exact = [_at(load) for load in MERGED]
    fractions = [column(result.targets, "contact_fraction") for result in results.values()]
    kinds = [column(result.events, "kind") for result in results.values()]
    merged = {dip: [event.position for event in result.events if event.kind == "coalescence"]
              for dip, result in results.items()}  # fmt: skip
    middles = [_off_dip(sum(state.edges[0]) / 2 if state.n_patches == 1 else None, dip)
               for dip, result in results.items() for state in result.targets[BEFORE:]]  # fmt: skip
    places = [_off_dip(met[0] if met else None, dip) for dip, met in merged.items()]
    symmetry = Against("exact", "symmetry about the dip")
    crests = Against("exact", "two crests, which merge between the third and the fourth load")
    # errors measured: the largest over a work of adhesion of 0.002 to 0.004 and a second harmonic of 0.45 and 0.5
    yield Against("exact", "closed form of one patch").row(
        "contact fraction behind the coalescence", "", exact * 2, [*fractions[0][BEFORE:], *fractions[1][BEFORE:]],
        2.8e-14)  # fmt: skip
    yield Against("self", "the same surface shifted by half a period").row(
        "contact fraction before the coalescence", "", fractions[1][:BEFORE], fractions[0][:BEFORE],
        2.9e-14)  # fmt: skip
    yield symmetry.row("middle of the contact from the dip, over the period", "", [0.0] * len(middles), middles,
                       6.6e-14, "absolute")  # fmt: skip
    # a fold is located to rounding of its neutral mode: the largest of three processors
    yield symmetry.row("place of the coalescence from the dip, over the period", "", [0.0] * 2, places, 3e-13,
                       "absolute")  # fmt: skip
    patches = chain.from_iterable(column(result.targets, "n_patches") for result in results.values())
    yield crests.count("patches", [2.0, 2.0, 2.0, 1.0, 1.0, 1.0] * 2, patches)
    yield crests.count("coalescences", [1.0] * 2, map(len, merged.values()))
    yield crests.count("first touches, and events of all kinds", [2.0, 3.0] * 2,
                       chain.from_iterable((met.count("first_touch"), len(met)) for met in kinds))  # fmt: skip
    curve = np.linspace(exact[0] - 0.05, exact[-1] + 0.05, 100)
    yield drawn("merged-crests",
                "Contact fraction against mean pressure: two patches merge, behind that the closed form of one holds.",
                axes("mean pressure / kPa", "contact fraction",
                     trace("closed form of one patch", CRESTS.mean_pressure(np.pi * curve) / 1e3, curve),
                     *(trace(label, column(results[dip].targets, "mean_pressure", 1e3), found, style)
                       for (dip, (label, style)), found in zip(DIPS.items(), fractions, strict=True))),
                axes("mean pressure / kPa", "signed error of the contact fraction",
                     *(trace(label, [p / 1e3 for p in MERGED], np.subtract(found[BEFORE:], exact), style)
                       for (label, style), found in zip(DIPS.values(), fractions, strict=True))))  # fmt: skip
    yield work("evaluations states", *results.values())


CASES = (
    case("merged-crests", "closed forms", _merged_crests,
         "Do two patches that merge across the end of the period become the one patch of the closed form?",
         r"$p = Q(y) / \sqrt{(\cos y - \cos a) / 2}$, $Q(a) = -\sqrt{E^\ast w q \sin a / (2 \pi)}$, "
         r"mean pressure $= \sum_k c_k L_k(\cos a)$",
         "westergaard1939 johnson1995 muskhelishvili1953", "half_space adhesion", scene="merged_crests"),
    case("rippled-wave", "closed forms", _rippled_wave,
         "Does contact on a rippled wave spread and recede by the jumps of the closed form?",
         r"$p(f) = \sum_k c_k L_k(\cos \pi f)$; loading: $f = \min \{f: p(f) \ge \text{load}\}$, "
         r"unloading: $f = \max \{f: p(f) \le \text{load}\}$",
         "guduru2007 johnson1995 muskhelishvili1953", "half_space adhesion", scene="rippled_wave"),
    case("ripple-jumps", "closed forms", _ripple_jumps,
         "Does every jump from ripple to ripple happen where it must, touch the crests it must, and release "
         "what it must?",
         r"released $= U(a_1) - U(a_2) - p \, (\Delta(a_1) - \Delta(a_2))$, $p(a_1) = p(a_2)$ a maximum or a touch",
         "johnson1995 muskhelishvili1953", "half_space adhesion load_control unloading", scene="rippled_wave"),
)  # fmt: skip
