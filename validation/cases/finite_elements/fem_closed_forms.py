"""The finite element reference against closed forms, before it is a reference for anything.

- Complete contact of a sinusoid with a layer, any nu: energy h_1^2 / (4 c(q)) per area, c(q) of G. Carbone,
  L. Mangialardi, J. Mech. Phys. Solids 56 (2008) 684; order of convergence on meshes halved twice. The boundary
  elements' energy of the same contact stands beside it.
- One patch on a layer of two periods, which is a half-space to 1e-8: Johnson's state (closed_forms.py)
  with its edges prescribed (load and stress intensity asked), and by JKR closure (edges and load asked).

The true error over the uncertainty that the reference states of it is a quantity of its own: at most 1. SI units.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

import bem
import fem_reference
from fem_reference import Resolution, Result
from validation.harness.case import Case, Outcome
from validation.harness.compare import pairwise_orders
from validation.harness.figure_data import axes, drawn, loglog, marks, trace
from validation.harness.rows import compared
from validation.harness.schema import Figure, Level, Reference, Row
from validation.references import adapters, fem_adapter
from validation.references.closed_forms import Sinusoid, layer_compliance

PERIOD, AMPLITUDE, YOUNGS_MODULUS = 0.01, 50e-6, 1e6
GROUP = "finite elements against closed forms"
DOUBLING = 0.35 * float(np.expm1(1.0))  # thickness in periods at which rows of triangles double with the columns
CELLS = {2: (16, 32), 4: (8, 16)}  # by order
RATIOS = (-0.5, 0.3, 0.499999, 0.5)
ORDERS = {2: (4.0, 0.31), 4: (8.0, 1.27)}  # of the energy: predicted, measured distance from it
CHANGES_SIGN = 0.4  # nu from which the error of P2 changes its sign between the meshes, and has no order
LARGEST_ERROR = {2: (1.4e-5, 5.7e-6), 4: (1e-8, 3.9e-9)}  # of the energy on the finer mesh: tolerance, measured
NAMES = {2: "P2/P1", 4: "P4/P3"}
JOHNSON = Reference(kind="exact", source="Johnson 1995")


def _complete_fem(poisson_ratio: float, order: int, cells: int) -> Result:
    return fem_reference.solve(
        youngs_modulus=YOUNGS_MODULUS,
        poisson_ratio=poisson_ratio,
        thickness=DOUBLING * PERIOD,
        period=PERIOD,
        harmonics=([1], [AMPLITUDE], [0.0]),
        control="mean_pressure",
        value=0.0,
        edges="complete",
        resolution=Resolution(order, cells, 10),
    )


def _complete_bem(poisson_ratio: float) -> float:
    """Elastic energy per area by the boundary elements, at a pressure that closes every gap."""
    loading = {"control": "mean_pressure", "targets": [2e5], "initial": "separated"}
    changes: dict[str, dict[str, Any] | None] = {
        "solid": {"poisson_ratio": poisson_ratio},
        "layer": {"thickness": DOUBLING * PERIOD},
        "adhesion": None,
        "loading": loading,
        "accuracy": {"max_increment": 50.0},
    }
    state = bem.solve(adapters.scene("layer_sinusoid", changes)).targets[-1]
    return state.elastic_energy if state.status == "complete_contact" else float("nan")


def _complete() -> Outcome:
    exact = {
        nu: 0.25 * AMPLITUDE**2 / float(layer_compliance(2 * np.pi / PERIOD, DOUBLING * PERIOD, YOUNGS_MODULUS, nu))
        for nu in RATIOS
    }
    rows, series = [], []
    unknowns = 0
    for order in (2, 4):
        for nu in RATIOS:
            found = [_complete_fem(nu, order, cells) for cells in CELLS[order]]
            energies = [result.strain_energy / PERIOD for result in found]
            errors = [abs(energy / exact[nu] - 1) for energy in energies]
            observed = pairwise_orders([1 / cells for cells in CELLS[order]], errors)[0]
            rows += _complete_rows(order, nu, found[-1], exact[nu], observed)
            series.append(trace(f"{NAMES[order]}, nu = {nu:g}", CELLS[order], errors))
            unknowns = max(unknowns, found[-1].unknowns)
    ours = [_complete_bem(nu) for nu in RATIOS[1:]]
    rows.append(
        compared("energy per area, boundary elements, nu = 0.3, 0.499999, 0.5", "J/m^2",
                 Reference(kind="exact", source="Carbone and Mangialardi 2008"), [exact[nu] for nu in RATIOS[1:]], ours,
                 1e-13, MEASURED_BEM, "maximum over states", exact[0.3], code="bem"),
    )  # fmt: skip
    figure = drawn(
        "fem-complete",
        "Complete contact: relative error of the elastic energy against base cells per period.",
        loglog("cells per period", "relative error of the energy", *series),
    )
    return Outcome(rows=tuple(rows), figures=(figure,), counts={"unknowns of the finite elements": unknowns})


def _complete_rows(order: int, nu: float, fem: Result, exact: float, observed: float) -> list[Row]:
    name = f"{NAMES[order]}, nu = {nu:g}"
    source = Reference(kind="exact", source="Carbone and Mangialardi 2008")
    error = fem.strain_energy / PERIOD - exact
    spread = float(np.max(fem.uncertainty["strain_energy"])) / PERIOD
    tolerance, measured = LARGEST_ERROR[order]
    rows = [
        compared(f"energy per area, finite elements {name}", "J/m^2", source, [exact], [exact + error], tolerance,
                 measured, uncertainty=spread),
        _coverage(name, abs(error) / spread),
    ]  # fmt: skip
    if order == 4 or nu < CHANGES_SIGN:
        predicted, apart = ORDERS[order]
        theory = Reference(kind="theory", source="energy norm of order m, squared")
        rows.append(compared(f"observed order of the energy, {name}", "", theory, [predicted], [observed], 2.5 * apart,
                             apart, "absolute"))  # fmt: skip
    return rows


def _coverage(name: str, ratio: float) -> Row:
    return compared(f"true error over stated uncertainty, {name}", "",
                    Reference(kind="exact", source="the closed form"), [0.0], [ratio], 1.0, MEASURED_COVERAGE,
                    "absolute", basis="required", pinned="unconverged")  # fmt: skip


def _wave(poisson_ratio: float, alpha: float) -> Sinusoid:
    return Sinusoid(AMPLITUDE, PERIOD, YOUNGS_MODULUS, poisson_ratio, alpha)


def _layer(wave: Sinusoid, penetration: float) -> Any:
    changes: dict[str, dict[str, Any] | None] = {
        "solid": {"poisson_ratio": wave.poisson_ratio},
        "adhesion": {"work_of_adhesion": wave.work_of_adhesion, "slope_term": False},
        "loading": {"targets": [penetration]},
    }
    return adapters.scene("layer_sinusoid", changes)


STATES = ((0.1, 0.3, 0.1), (0.4, 0.5, 0.3), (0.7, 0.45, 0.3))  # contact fraction, nu, alpha of prescribed edges
PRESCRIBED = {2: Resolution(2, 10, 12), 4: Resolution(4, 10, 22)}
CLOSURE = {2: Resolution(2, 10, 10), 4: Resolution(4, 8, 18)}
# tolerance, measured: load over p* and stress intensity over critical of prescribed edges; width and load of a closure
ASKED = {
    2: ((1.2e-5, 4e-6), (4e-4, 1.4e-4), (3e-4, 1e-4), (6e-5, 2e-5)),
    4: ((1e-7, 9e-9), (1e-6, 6.2e-8), (1e-6, 1.6e-7), (1e-7, 1.5e-8)),
}


def _one_patch(order: int) -> Outcome:
    given = [_prescribed(order, *state) for state in STATES]
    closed = [_closed(order, fraction, nu, alpha) for fraction, nu, alpha in ((0.5, 0.3, 0.3), (0.35, 0.5, 0.2))]
    load, intensity, width, closed_load = ASKED[order]
    basis: Any = "measured" if order == 2 else "required"

    full = _wave(0.3, 0.0).full_contact_pressure

    def row(quantity: str, unit: str, values: list[tuple[float, float, float]], scale: float, asked: Any) -> Row:
        """Of values exact, computed and uncertain."""
        expected, computed, uncertain = (list(column) for column in zip(*values, strict=True))
        return compared(f"{quantity}, {NAMES[order]}", unit, JOHNSON, expected, computed, asked[0], asked[1],
                        "maximum over states", scale, basis=basis, uncertainty=max(uncertain))  # fmt: skip

    rows = (
        row("given edges: mean pressure over p*", "Pa", [(g[0], g[1], g[6]) for g in given], full, load),
        row("given edges: stress intensity over critical", "", [(1.0, g[2], g[7]) for g in given], 1.0, intensity),
        row("JKR closure: contact fraction, relative", "", [(1.0, c[1] / c[0], c[6] / c[0]) for c in closed], 1.0,
            width),
        row("JKR closure: mean pressure over p*", "Pa", [(c[2], c[3], c[7]) for c in closed], full, closed_load),
        _coverage(f"load at given edges, {NAMES[order]}", max(g[3] for g in given)),
        _coverage(f"edges of a closure, {NAMES[order]}", max(c[4] for c in closed)),
    )  # fmt: skip
    counts = {"unknowns of the finite elements": max(int(c[5]) for c in closed)}
    return Outcome(rows=rows, figures=(_figure(order, given),), counts=counts)


def _prescribed(order: int, fraction: float, nu: float, alpha: float) -> tuple[float, ...]:
    """Exact and computed pressure, K over critical, error over uncertainty, contact fraction, p*, two uncertainties."""
    wave, psi = _wave(nu, alpha), fraction * np.pi / 2
    crest = -0.7 / (2 * np.pi) * PERIOD
    half = 0.5 * fraction * PERIOD
    posed = _layer(wave, float(wave.penetration(psi)))
    fem = fem_adapter.solve_fem(posed, PRESCRIBED[order], edges=[[crest - half, crest + half]])
    exact = float(wave.mean_pressure(psi))
    critical = alpha * wave.full_contact_pressure * np.sqrt(PERIOD)
    covered = abs(fem.mean_pressure - exact) / float(np.max(fem.uncertainty["mean_pressure"]))
    farthest = fem.stress_intensity.ravel()[np.argmax(np.abs(fem.stress_intensity / critical - 1))]
    spread = float(np.max(fem.uncertainty["mean_pressure"])), float(np.max(fem.uncertainty["stress_intensity"]))
    found = fem.mean_pressure, float(farthest / critical), covered
    return (exact, *found, fraction, wave.full_contact_pressure, spread[0], spread[1] / critical)


def _closed(order: int, fraction: float, nu: float, alpha: float) -> tuple[float, ...]:
    """Exact and computed fraction and pressure, error of the fraction over uncertainty, unknowns, two uncertainties."""
    wave, psi = _wave(nu, alpha), fraction * np.pi / 2
    fem = fem_adapter.solve_fem(_layer(wave, float(wave.penetration(psi))), CLOSURE[order])
    found = fem.contact_fraction if fem.status == "converged" else float("nan")
    covered = abs(found - fraction) / float(np.sum(fem.uncertainty["edges"]) / PERIOD)
    spread = (float(np.max(fem.uncertainty[name])) for name in ("contact_fraction", "mean_pressure"))
    exact = float(wave.mean_pressure(psi))
    return fraction, found, exact, fem.mean_pressure, covered, float(fem.unknowns), *spread


def _figure(order: int, given: list[tuple[float, ...]]) -> Figure:
    curve = np.linspace(0.02, 0.9, 200)
    star = _wave(0.3, 0.0).full_contact_pressure
    return drawn(f"fem-one-patch-{NAMES[order].replace('/', '').lower()}",
                 f"Mean pressure of finite elements, {NAMES[order]}, at the edges of Johnson's states.",
                 axes("contact fraction", "mean pressure / p*",
                      *(
                          trace(f"Johnson 1995, alpha = {alpha:g}", curve,
                                _wave(0.3, alpha).mean_pressure(curve * np.pi / 2) / star)
                          for alpha in sorted({alpha for _, _, alpha in STATES})
                      ),
                      marks("finite elements", [g[4] for g in given], [g[1] / g[5] for g in given])),
                 axes("contact fraction", "signed error",
                      marks("mean pressure / p*", [g[4] for g in given], [(g[1] - g[0]) / g[5] for g in given]),
                      marks("stress intensity", [g[4] for g in given], [g[2] - 1 for g in given])))  # fmt: skip


MEASURED_BEM = 1e-15  # 5e-16 on one machine
MEASURED_COVERAGE = 0.4  # of the closures; in complete contact at most 0.31


def _case(identity: str, level: Level, question: str, equations: str, sources: tuple[str, ...], compute: Any) -> Case:
    return Case(id=identity, group=GROUP, level=level, code="fem",
                problem="complete contact of a layer" if compute is _complete else "adhesive wave",
                question=question,
                equations=equations,
                sources=sources, compute=compute, effects=("layer",),
                scene=adapters.scene_text("layer_sinusoid"))  # fmt: skip


ELEMENTS = ("gustafsson2020", "taylor1973", "roache1998")
ONE_PATCH = _case(
    "fem-one-patch",
    "standard",
    "Do the finite elements reproduce Johnson's states, at given edges and by their own closure?",
    r"$p = p^\ast [S - \alpha \sqrt{\tan \psi}]$, $K = \alpha p^\ast \sqrt{\lambda}$, $S = \sin^2 \psi$",
    ("johnson1995", "destuynder1983", "shih1986", *ELEMENTS),
    partial(_one_patch, 4),
)
CASES = (
    _case(
        "fem-complete-contact",
        "quick",
        "Do the finite elements converge at their order in complete contact, for any Poisson's ratio?",
        r"$U / \lambda = h_1^2 / (4 c(q))$; observed order 4 (P2/P1), 8 (P4/P3)",
        ("carbone2008", *ELEMENTS),
        _complete,
    ),
    replace(ONE_PATCH, id="fem-one-patch-coarse", level="quick", compute=partial(_one_patch, 2)),
    ONE_PATCH,
)
