"""Hysteresis: what a loop dissipates, state by state and event by event, and the symmetry that a path breaks.

Work balance: int sigma_0 dDelta over a closed loop, integrated from loads alone, is the sum of the energies that its
events release (loop_work.py).

Seven equal waves in equal contact stay equal while the smallest eigenvalue is positive; the bifurcation is an event,
and no wave alone has one.
"""

import numpy as np

from bem.scene.result import Event
from validation.cases.paths.loop_work import accounts, closed, legs
from validation.cases.shared.checks import OVER_STATES, Against, Found, case, column, posed, solved, touching, work
from validation.harness.figure_data import axes, digits, drawn, marks, table, trace
from validation.references.closed_forms import Sinusoid

WAYS = {"loading": "line", "unloading to 70 um": "dashed", "loading again": "line", "unloading": "dashed"}


def _history() -> Found:
    result, ways = accounts(posed("hysteresis", accuracy={"max_increment": None}))  # nodes suffice
    apart, least = result.states[-1], min(event.energy_released or 0.0 for event in result.events)
    loops = [closed(ways[:2]), closed(ways)]  # 30 um, 70 um, 30 um; and on to 160 um, apart
    yield Against("exact", "first law: work = growth of U + energy released").row(
        "work of a loop (30, 70, 30 um) and of the way apart, over the largest", "J/m^2",
        [loop.growth + loop.released for loop in loops], column(loops, "work"), 1.2e-10, OVER_STATES,
        max(abs(loop.work) for loop in loops))  # fmt: skip
    yield Against("exact", "second law").count("least energy released by an event is not negative (1: yes)", 1.0,
                                               least >= 0)  # fmt: skip
    yield Against("exact", "nothing touches, nothing is stored").row(
        "energy once the surfaces are apart", "J/m^2", [0.0, 0.0], [apart.total_energy, apart.contact_fraction], 0.0,
        "absolute", required=1e-15, pinned="exact")  # fmt: skip
    # seven waves lose their symmetry on loading, on Johnson's stable branch, and one wave never does
    psi = np.linspace(_wave(7).fold(), 0.97 * np.pi / 2, 20001)
    lost = [float(np.interp(event.penetration, _wave(7).penetration(psi), psi) * 2 / np.pi)
            for event in _bifurcations(7)]  # fmt: skip
    yield Against("dense algebra", "a prototype, two digits: unstable above 0.76", 0.005).row(
        "contact fraction at which seven equal contacts lose their symmetry on loading", "", 0.76, lost[:1] or None,
        (0.01, 0.006), "absolute")  # fmt: skip
    yield Against("exact", "Johnson 1995: one branch up to complete contact").count(
        "bifurcations of one wave alone on loading", 0.0, len(_bifurcations(1)))  # fmt: skip
    events, height = result.events, result.states[0].separation + result.states[0].penetration
    yield drawn("hysteresis",
                "Mean pressure along two loops of separation: the area between the branches is what events release.",
                axes("separation / um", "mean pressure / kPa",
                     *(trace(word, column(there, "separation", 1e-6), column(there, "mean_pressure", 1e3), style)
                       for (word, style), (states, _) in zip(WAYS.items(), legs(result)[:4], strict=True)
                       for there in [touching(states)]),
                     marks("events", [(height - event.penetration) * 1e6 for event in events],
                           column(events, "mean_pressure", 1e3))))  # fmt: skip
    yield table("Events of the path in order.",
                {"event": column(events, "kind"),
                 "position / um": [None if event.position is None else round(event.position * 1e6, 2)
                                   for event in events],
                 "penetration / um": [round(event.penetration * 1e6, 4) for event in events],
                 "mean pressure / kPa": [round(event.mean_pressure / 1e3, 4) for event in events],
                 "energy released / (uJ/m^2)": [None if event.energy_released is None
                                                else float(f"{event.energy_released * 1e6:.4g}")
                                                for event in events]})  # fmt: skip
    yield table("Dissipation in J/m^2 of nominal area.",
                {"way": ("loop 30, 70, 30 um", "30 um and apart"), "events": column(loops, "events"),
                 "work": digits(column(loops, "work"), 5), "growth of U": digits(column(loops, "growth"), 5),
                 "energy released by events": digits(column(loops, "released"), 5)})  # fmt: skip
    yield work("events evaluations", result)


def _wave(order: int) -> Sinusoid:
    """One of so many equal waves, alpha = 0.3."""
    return Sinusoid(1e-4 / order, 0.01 / order, 1e6, 0.5, 0.3)


def _bifurcations(order: int) -> list[Event]:
    """Where the symmetric state of equal waves is lost on loading."""
    wave = _wave(order)
    deepest = float(wave.penetration(0.9 * np.pi / 2))
    result = solved("sinusoid", profile={"orders": [order], "amplitudes": [1e-4 / order]},
                    adhesion={"work_of_adhesion": wave.work_of_adhesion},
                    loading={"targets": [0.3 * deepest, deepest]}, accuracy={"tolerance": 1e-6})  # fmt: skip
    return [event for event in result.events if event.kind == "bifurcation"]


CASES = (
    case("loading-history", "path", _history,
         "Is what a loop dissipates the sum of what its events release, and is a lost symmetry an event?",
         r"$\int \sigma_0 \, d\Delta = U_2 - U_1$ + sum of energies released; energy released $\ge 0$",
         "carbone2009 johnson1995", "half_space adhesion slope_term unloading", scene="hysteresis"),
)  # fmt: skip
