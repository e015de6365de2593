"""The work of loops under every control is what their events release (energy_balance.py).

A rough profile on a layer is loaded and unloaded; targets on the way enclose where patches nearly detach, since the
load turns sharply there.  SI units.
"""

from __future__ import annotations

from validation.cases.paths.energy_balance import accounts, closed
from validation.cases.shared.checks import Against, case, posed
from validation.harness.case import Outcome
from validation.harness.schema import Cells, Table

SEPARATIONS = (40e-6, 62.5e-6, 65e-6, 70e-6, 40e-6)  # m; patches nearly detach at 63.7 um
PLATE = (40e-6, 62.5e-6, 65.5e-6, 70e-6, 40e-6)  # m, by which the plate is above first touch of the highest crest
LOADS = (1.2e4, 2000.0, -450.0, 2000.0)  # Pa
INCREMENTS = {"mean_pressure": 0.4}


def _loops() -> Outcome:
    highest = posed("thin_layer").surface().max_height
    targets = {
        "separation": list(SEPARATIONS),
        "mean_pressure": list(LOADS),
        "total_displacement": [highest - place for place in PLATE],
    }
    found, events, table = list[float](), 0, list[Cells]()
    for control, ways in targets.items():
        scene = posed("thin_layer", solid={"poisson_ratio": 0.3}, layer={"thickness": 1e-3},
                      adhesion={"work_of_adhesion": 0.1}, loading={"control": control, "targets": ways},
                      accuracy={"max_increment": INCREMENTS.get(control), "tolerance": None})  # fmt: skip
        result, accounted = accounts(scene)
        loop = closed(accounted[1:])
        found.append(loop.released / (loop.work - loop.growth))
        events += loop.events
        values = (loop.work, loop.growth, loop.released)
        table.append([control, len(result.states), loop.events, *(float(f"{v:.5g}") for v in values)])
    # the quadrature where the load turns sharply: 1.2e-9 in one loading
    row = Against("exact", "first law under every control").row(
        f"energy released over a loop, over what its work leaves: {', '.join(targets)}", "", [1.0] * 3, found,
        (4e-7, 1.6e-7))  # fmt: skip
    shown = Table(
        caption="Unloading and loading again; energies in J/m^2 of nominal area.",
        columns=["control", "states", "events", "work", "growth of the potential", "energy released"],
        rows=table,
    )
    return Outcome(rows=(row,), tables=(shown,), counts={"events": events})


CASES = (
    case("loop-work", "path", _loops,
         "Is what the work of a loop leaves the energy that its events release, whatever is controlled?",
         r"$\int F \, dv = \Phi_2 - \Phi_1$ + energy released, $v$ and $F$ of the control",
         "carbone2009 carbone2008", "layer adhesion slope_term load_control unloading", scene="thin_layer"),
)  # fmt: skip
