"""One patch in closed form (references/one_patch.py): its jumps from ripple to ripple, and how two crests merge to it.

A wave that carries a ripple (references/rippled_wave.py), loaded and unloaded.  The closed form knows nothing of the
path of the solver: a jump that ends beyond the nearest minimum, or is found too late, is seen as a number.

Two crests with a shallow dip at y = 0 between them and a deep valley behind, h = A (cos y - b cos 2y), b > 1/4.  The
period begins in the dip or in the valley; the closed form knows nothing of it.  Limits: symmetric profiles, one patch;
where patches merge is the solver's own.  SI units.
"""

from itertools import chain

import numpy as np
from scipy.optimize import brentq

from bem.scene.result import Event, Result
from validation.cases.shared.checks import Against, Found, as_many, case, column, solved, work
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.references.one_patch import OnePatch
from validation.references.rippled_wave import AMPLITUDE, MODULUS, PERIOD, WAVE, Jump, RippledWave

ROUNDING = 1e-13  # of the units of pressure and energy


def _solved(wave: RippledWave, control: str, targets: list[float], max_increment: float | None = None) -> Result:
    """The path of the solver."""
    profile = {"orders": [1, wave.order], "amplitudes": [AMPLITUDE, wave.ripple]}
    return solved("rippled_wave", profile=profile, adhesion={"work_of_adhesion": wave.work},
                  loading={"control": control, "targets": targets},
                  accuracy={"max_increment": max_increment})  # fmt: skip


CRESTS = OnePatch(PERIOD, MODULUS, (AMPLITUDE, -0.5 * AMPLITUDE), 0.003)  # of the scene merged_crests
BEFORE, MERGED = 3, (1e4, 2e4, 4e4)  # loads before the coalescence, and mean pressures in Pa behind it
DIPS = {0.0: ("dip across the end of the period", "dots"), 0.5: ("dip in the middle of the period", "points")}
# mean pressures in Pa, of WAVE
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
    result = _solved(COARSE, "mean_pressure", list(COARSE_LOADS))
    driven, hurried = (_solved(FINE, "separation", list(SEPARATIONS), longest) for longest in (None, LONGEST))
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
