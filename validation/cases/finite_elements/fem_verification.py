"""Code verification of the finite elements: manufactured solutions, orders, Richardson and GCI, and their uncertainty.

- A plane wave u = A sin(k x + c), p = p0 cos(k x + c) with the body force it needs, on uniform crisscross meshes: its
  errors in L2 fall as h^(m+1) for displacements of order m and h^m for pressures, any nu.
- Johnson's state at given edges on three meshes graded to the edges, each halved (r = 2: refined by halving, meshes of
  other ratios are not similar): the load is an energy and falls as h^2m. The observed order p, or 2 m where that is
  less, gives Richardson's value and the grid convergence index

      q_R = q_3 + (q_3 - q_2) / (r^p - 1),   GCI = 1.25 |q_3 - q_2| / (r^p - 1)

  (Roache 1998, ch. 5); meshes are in the asymptotic range where |q_2 - q_1| / |q_3 - q_2| = r^2m. Both stand
  beside the uncertainty that the reference states of itself, and the true error.
- Coverage: states, Poisson's ratios, adhesion and resolutions drawn at random from all that the reference accepts; how
  often the true error is within the uncertainty, and the largest ratio.

How P2 and P4 converge on uniform and on graded meshes: case convergence-rates. SI units.
"""

from itertools import pairwise
from typing import Any

import numpy as np
from scipy.sparse.linalg import spsolve

import fem_reference
from fem_reference import Resolution
from fem_reference.elasticity import assemble, taylor_hood
from fem_reference.mesh import crisscross
from fem_reference.refine import observed_order
from validation.cases.finite_elements.fem_closed_forms import given
from validation.cases.finite_elements.fem_comparison import NAMES
from validation.cases.shared.checks import Against, Found, case, in_forms
from validation.harness.arrays import FloatArray
from validation.harness.compare import pairwise_orders
from validation.harness.figure_data import drawn, loglog, table, trace
from validation.references.closed_forms import Sinusoid

RATIOS = (-0.5, 0.3, 0.499999, 0.5)
CELLS = {2: (8, 16), 4: (3, 6)}  # of the manufactured solution
WAVE_VECTOR, SHIFT = np.array([2.0, 3.0]), 0.3
LADDERS = {  # halved, tips keeping pace
    2: (Resolution(2, 6, 6), Resolution(2, 12, 10), Resolution(2, 24, 14)),
    4: (Resolution(4, 4, 6), Resolution(4, 8, 14), Resolution(4, 16, 22)),
}
SAFETY = 1.25  # of the grid convergence index on three meshes
PERIOD, AMPLITUDE, MODULUS = 0.01, 50e-6, 1e6
JOHNSON = Against("exact", "Johnson 1995")
ENERGY = Against("predicted order", "energy norm of order m, the load an energy: 2 m on graded meshes")
SEED = 47
MEASURED_ORDER = {2: (0.053, 0.017), 4: (0.065, 0.084)}
# order of the load, asymptotic ratio, Richardson's value, true error over stated uncertainty, and over the GCI
MEASURED_LADDER = {2: (0.024, 0.017, 8.1e-9, 0.022, 0.8), 4: (0.037, 0.026, 1.2e-9, 5e-4, 0.62)}
MEASURED_COVERAGE = {(2, 8): (0.0, 0.6), (2, 100): (0.0034, 1.18)}


def manufactured_errors(order: int, nu: float, cells: int) -> tuple[float, float]:
    """Errors in L2 of displacement and pressure on the unit square, E = 1."""
    mu, softness = 1 / (2 * (1 + nu)), 3 * (1 - 2 * nu)
    k = WAVE_VECTOR
    amplitude = np.array([1.0, 0.5]) if softness > 0 else np.array([3.0, -2.0])  # no change of volume
    p0 = -float(amplitude @ k) / softness if softness > 0 else 1.7

    def phase(x: FloatArray) -> FloatArray:
        return np.asarray(k[0] * x[0] + k[1] * x[1] + SHIFT)

    grid = np.linspace(0, 1, cells + 1)
    spaces = taylor_hood(crisscross(grid, grid), order, quadrature_order=2 * order + 2)
    V, Q = spaces.displacement, spaces.pressure
    n, m = spaces.sizes
    force = mu * ((k @ k) * amplitude + (amplitude @ k) * k / 3) - p0 * k  # times the sine: - div sigma
    sine = np.sin(phase(np.asarray(V.global_coordinates())))
    rhs = np.zeros(2 * n + m)
    for shape, (function, *_) in enumerate(V.basis):
        moments = np.sum(sine * np.asarray(function) * V.dx, axis=1)
        for component in range(2):
            np.add.at(rhs, component * n + V.element_dofs[shape], force[component] * moments)
    u, p = np.sin(phase(V.doflocs)), p0 * np.cos(phase(Q.doflocs))
    found = np.concatenate([amplitude[0] * u, amplitude[1] * u, p])
    edge = V.get_dofs().flatten()
    pinned = np.array([2 * n] if softness == 0 else [], dtype=edge.dtype)
    held = np.concatenate([edge, n + edge, pinned])  # one pressure where p is up to a constant
    free = np.setdiff1d(np.arange(2 * n + m), held)
    matrix = assemble(spaces, mu, softness).matrix
    found[free] = spsolve(matrix[free][:, free].tocsc(), (rhs - matrix[:, held] @ found[held])[free])
    square = 0.0
    for component in range(2):
        off = np.asarray(V.interpolate(found[component * n : (component + 1) * n])) - amplitude[component] * sine
        square += float(np.sum(off**2 * V.dx))
    off = np.asarray(Q.interpolate(found[2 * n :])) - p0 * np.cos(phase(np.asarray(Q.global_coordinates())))
    off -= np.sum(off * Q.dx) if softness == 0 else 0.0
    return float(np.sqrt(square)), float(np.sqrt(np.sum(off**2 * Q.dx)))


def _manufactured() -> Found:
    curves = []
    for order, cells in CELLS.items():
        found = {nu: np.array([manufactured_errors(order, nu, count) for count in cells]) for nu in RATIOS}
        for name, place, predicted in (("displacement", 0, order + 1), ("pressure", 1, order)):
            observed = []
            for nu in RATIOS:
                errors = found[nu][:, place].tolist()
                observed.append(pairwise_orders([1 / count for count in cells], errors)[0])
                curves.append(trace(f"{NAMES[order]}, {name}, nu = {nu:g}", cells, errors))
            yield Against("predicted order", "m + 1 and m in L2 on a manufactured plane wave").row(
                f"observed order of the {name} in L2, {NAMES[order]}, nu = -0.5, 0.3, 0.499999, 0.5", "",
                [predicted] * len(RATIOS), observed, MEASURED_ORDER[order][place], "absolute")  # fmt: skip
    yield drawn("fem-manufactured", "Manufactured plane wave on uniform meshes: errors in L2 against cells.",
                loglog("cells per side", "error in L2", *curves))  # fmt: skip


def _arguments(wave: Sinusoid, fraction: float) -> dict[str, Any]:
    """Johnson's state at a contact fraction, its edges given, on a layer of two periods."""
    half = 0.5 * fraction * PERIOD
    return given(wave, 2 * PERIOD) | {
        "work_of_adhesion": wave.work_of_adhesion,
        "control": "penetration",
        "value": float(wave.penetration(fraction * np.pi / 2)),
        "edges": [[-half, half]],
    }


def _richardson(order: int) -> Found:
    wave, fraction = Sinusoid(AMPLITUDE, PERIOD, MODULUS, 0.3, 0.3), 0.4
    exact, scale = float(wave.mean_pressure(fraction * np.pi / 2)), wave.full_contact_pressure
    ladder, name, predicted = LADDERS[order], NAMES[order], 2 * order
    found = fem_reference.refine(**_arguments(wave, fraction), resolutions=ladder).estimates["mean_pressure"]
    values = [float(value) for value in found.levels]
    sizes = [1 / resolution.cells for resolution in ladder]
    steps = [abs(b - a) for a, b in pairwise(values)]
    p = observed_order(steps, sizes) or float("nan")
    refined = (sizes[-2] / sizes[-1]) ** min(p, predicted) - 1
    richardson = values[-1] + (values[-1] - values[-2]) / refined
    index = SAFETY * steps[-1] / refined
    error, stated = abs(values[-1] - exact), float(found.uncertainty)
    coarse, middle, fine = (size**predicted for size in sizes)
    of_order, of_range, of_value, of_error, of_index = MEASURED_LADDER[order]
    yield ENERGY.row(f"observed order of the load, graded meshes, {name}", "", predicted, p, of_order, "absolute")
    yield ENERGY.row(f"asymptotic range: ratio of differences over that of the order {predicted}, {name}", "", 1.0,
                     steps[0] / steps[1] / ((coarse - middle) / (middle - fine)), of_range, "absolute")  # fmt: skip
    yield JOHNSON.row(f"Richardson's value of the load over p*, {name}", "Pa", exact, richardson, of_value, scale=scale,
                      uncertainty=index)  # fmt: skip
    yield JOHNSON.row(f"true error of the load over its GCI, {name}", "", 0.0, error / index, of_index, "absolute",
                      required=1.0, pinned="unconverged")  # fmt: skip
    yield JOHNSON.row(f"true error of the load over its stated uncertainty, {name}", "", 0.0, error / stated, of_error,
                      "absolute", required=1.0, pinned="unconverged")  # fmt: skip
    told = {"elements": name, "cells per period": ", ".join(str(resolution.cells) for resolution in ladder)}
    told |= {f"error, mesh {k}": f"{(value - exact) / scale:.2e}" for k, value in enumerate(values, start=1)}
    told |= {"observed order": f"{p:.2f}", "error of Richardson's value": f"{(richardson - exact) / scale:.1e}",
             "GCI": f"{index / scale:.1e}", "stated uncertainty": f"{stated / scale:.1e}"}  # fmt: skip
    yield table("Load over p* at given edges: errors are true ones.", {head: [said] for head, said in told.items()})


def ratios(order: int, draws: int) -> FloatArray:
    """True error over stated uncertainty of the load and of K at both edges, (draws, 3).

    Resolutions are among the coarsest that the reference accepts.
    """
    rng = np.random.default_rng([SEED, order])
    found = []
    for _ in range(draws):
        ratio, alpha = float(rng.choice([0.0, 0.5, rng.uniform(0, 0.5)])), float(rng.uniform(0.05, 0.5))
        cells = int(rng.integers(*((10, 17) if order == 2 else (6, 11))))
        tips = int(rng.integers(*((8, 15) if order == 2 else (12, 21))))
        wave, fraction = Sinusoid(AMPLITUDE, PERIOD, MODULUS, ratio, alpha), float(rng.uniform(0.08, 0.92))
        fem = fem_reference.solve(**_arguments(wave, fraction), resolution=Resolution(order, cells, tips))
        critical = wave.alpha * wave.full_contact_pressure * np.sqrt(PERIOD)
        off = abs(fem.mean_pressure - float(wave.mean_pressure(fraction * np.pi / 2)))
        intensity = np.abs(fem.stress_intensity - critical) / np.asarray(fem.uncertainty["stress_intensity"])
        found.append([off / float(np.max(fem.uncertainty["mean_pressure"])), *intensity.ravel()])
    return np.array(found)


def _coverage(order: int, draws: int) -> Found:
    found = ratios(order, draws)
    within, largest = float(np.mean(found <= 1.0)), float(np.max(found))
    missed, most = MEASURED_COVERAGE[order, draws]
    yield JOHNSON.row(f"values whose true error is within the uncertainty, {found.size} of {NAMES[order]}", "", 1.0,
                      within, missed, "absolute", required=0.05, pinned="unconverged")  # fmt: skip
    yield JOHNSON.row(f"largest true error over its uncertainty, {found.size} of {NAMES[order]}", "", 0.0, largest,
                      most, "absolute", required=2.0, pinned="unconverged")  # fmt: skip
    yield table(f"Share of true errors up to a part of the stated uncertainty, {NAMES[order]}.",
                {f"{at:g}": [float(np.mean(found.ravel() <= at))] for at in (0.1, 0.2, 0.5, 1.0, 2.0)})  # fmt: skip


GROUP, SOURCES = "code verification of the finite elements", "roache1998 taylor1973 gustafsson2020 johnson1995"
CASES = (
    case("fem-manufactured", GROUP, _manufactured,
         "Do the elements converge at their order on a manufactured solution, for any Poisson's ratio?",
         r"$\|u - u_h\|_{L_2} \propto h^{m+1}$, $\|p - p_h\|_{L_2} \propto h^m$", SOURCES, "layer", code="fem"),
    *in_forms({"fem-richardson-coarse": ("quick", 2), "fem-richardson": ("standard", 4)}, GROUP, _richardson,
              "Are the meshes in the asymptotic range, and how do Richardson's value and the GCI stand to the "
              "uncertainty?",
              r"$q_R = q_3 + (q_3 - q_2) / (r^p - 1)$, GCI $= 1.25 |q_3 - q_2| / (r^p - 1)$", SOURCES, "layer",
              code="fem"),
    *in_forms({"fem-coverage-coarse": ("quick", 2, 8), "fem-coverage": ("full", 2, 100)}, GROUP, _coverage,
              "Is the true error within the uncertainty that the finite elements state of themselves?",
              r"$|q - q_{exact}| \le U$", SOURCES, "layer", code="fem"),
)  # fmt: skip
