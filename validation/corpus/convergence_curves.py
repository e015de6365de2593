"""Errors against what is refined, code by code, with the rate that theory predicts and where the reference is from.

- bem: K and load of a sinusoid at Johnson's own edges, nodes per patch.  The pressure is analytic inside the Bernstein
  ellipse that touches the nearest edge of the next patch, at 1 + gap / half width: K, which interpolation gives, falls
  like rho^-n, the load, which Gauss's quadrature gives, like rho^-2n, rho = z + sqrt(z^2 - 1) (Trefethen,
  Approximation Theory and Approximation Practice, 2013, ch. 8 and 19).
- fem: load at prescribed edges, cells per period.  The energy norm falls like h^m with elements of order m on meshes
  graded so that the tip keeps pace, and like h^(1/2) on uniform ones, whatever m: the displacement is of the
  form r^(1/2) at an edge (Strang and Fix, An Analysis of the Finite Element Method, 1973, ch. 8).  The load is
  an energy, its order twice that: 2 m and 1.
- persson: area of the diffusion towards a barrier at rest, exact; second order in the cells, third in the steps.
- paper's method: contact fraction closed by itself, cells per patch; second order.
- ensemble: spread of means over groups of n realisations; order 1/2 (the realisations are independent).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import erf

import bem
from bem.geometry.scaling import Scales
from fem_reference.closure import Evaluation, evaluate
from fem_reference.mesh import LayerMesh, Resolution, crisscross
from fem_reference.result import quantities
from fem_reference.solve import control_of, prescribed, problem_of
from persson.diffusion import march
from validation.corpus.effects import Changes, solved
from validation.corpus.rates import Law, Rate, algebraic, geometric
from validation.harness.schema import ReferenceKind
from validation.references.closed_forms import Sinusoid
from validation.references.dense import evaluate_dense
from validation.references.paper_method import Surface, solve
from validation.routes.scenes import posed

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.3)
FEM_DEPTH = 0.02  # two periods: the half-space within 4e-9
FEM_FRACTION = 0.5  # edges on vertices of the uniform meshes
TIP_LEVELS = {2: 8, 4: 14}  # halvings at the edges with 8 cells per period, by order of the elements
BARRIER, LOAD = 0.5, 1.0  # in standard deviations of the last stress variance, 1


@dataclass(frozen=True)
class Curve:
    """Errors of one quantity against what is refined."""

    id: str
    code: str
    quantity: str
    knob: str
    sizes: tuple[float, ...]
    errors: tuple[float, ...]  # relative to the natural scale of the quantity
    law: Law
    predicted: float  # order, or factor per unit of size
    low: float  # and `high`: bounds of the fitted rate, on both sides
    high: float
    why: str  # where the prediction comes from
    kind: ReferenceKind  # and `reference`: what the errors are measured against
    reference: str
    floor: float = 0.0  # error known to remain: of the reference, or of what is not refined
    samples: tuple[float, ...] = ()  # what the errors are the spread of, where they are one

    @cached_property
    def rate(self) -> Rate:
        """Fitted; raises `RateError` when too few points fall."""
        fit = geometric(self.sizes, self.errors) if self.law == "geometric" else None
        return fit or algebraic(self.sizes, self.errors, self.floor)

    @property
    def met(self) -> bool:
        """Whether the fitted rate is within its bounds."""
        return self.low <= self.rate.value <= self.high


def predicted_line(curve: Curve) -> tuple[list[float], list[float]]:
    """Sizes that were fitted, and the errors there by the predicted rate, through the last of them."""
    used = curve.rate.used
    at, last = [curve.sizes[i] for i in used], curve.errors[used[-1]]
    if curve.law == "geometric":
        return at, [last * curve.predicted ** (at[-1] - n) for n in at]
    return at, [last * (at[-1] / n) ** curve.predicted for n in at]


def bem_curves(fraction: float, sizes: Sequence[int]) -> tuple[Curve, Curve]:
    """K and load of the dense evaluation at Johnson's edges, against nodes."""
    psi = fraction * np.pi / 2
    profile = bem.Profile.from_harmonics(WAVE.wavelength, [1], [WAVE.amplitude])
    scales = Scales(WAVE.wavelength, profile.rms_height, WAVE.modulus)
    critical = 2 * np.sqrt(WAVE.work_of_adhesion / scales.release_rate)
    edge, depth = np.array([2 * psi]), float(WAVE.penetration(psi)) / scales.height
    states = [evaluate_dense(profile.scaled(), -edge, edge, depth, np.array([n])) for n in sizes]
    exact, scale = float(WAVE.mean_pressure(psi)), WAVE.full_contact_pressure
    intensity = tuple(float(np.max(np.abs(state.stress_intensity / critical - 1))) for state in states)
    # errors of exactly zero, which happen at rounding, as the rounding unit
    load = tuple(max(abs(state.load * scales.force / WAVE.wavelength - exact) / scale, 2.0**-53) for state in states)
    reach = 1 + 2 * (1 - fraction) / fraction
    rho = reach + np.sqrt(reach**2 - 1)
    at = tuple(float(n) for n in sizes)
    source = f"Johnson 1995, contact fraction {fraction:g}, alpha 0.3"
    why = f"ellipse through the next edge, rho = {rho:.3f}"
    # measured 2 % (K) and 4 % (load) above rho and rho^2: the singularity at the next edge is an integrable one
    return (
        Curve(f"bem-intensity-{fraction:g}", "bem", "stress intensity", "nodes per patch", at, intensity,
              "geometric", rho, 0.95 * rho, 1.08 * rho, why, "exact", source),
        Curve(f"bem-load-{fraction:g}", "bem", "mean pressure over p*", "nodes per patch", at, load,
              "geometric", rho**2, 0.92 * rho**2, 1.15 * rho**2, why + ", squared", "exact", source),
    )  # fmt: skip


def fem_curve(order: int, cells: Sequence[int], graded: bool) -> Curve:
    """Mean pressure at prescribed edges against cells per period."""
    psi = FEM_FRACTION * np.pi / 2
    exact, scale = float(WAVE.mean_pressure(psi)), WAVE.full_contact_pressure
    errors = tuple(abs(float(quantities(_fem(order, n, graded))["mean_pressure"]) - exact) / scale for n in cells)
    predicted = 2.0 * order if graded else 1.0
    low, high = (0.85 * predicted, 1.25 * predicted) if graded else (0.95, 1.2)
    why = f"energy norm of order {predicted / 2:g}, " + (
        "that of the elements: the tips keep pace" if graded else "whatever the elements: r^(1/2) at the edges"
    )
    source = f"Johnson 1995, contact fraction {FEM_FRACTION:g}; layer of two periods"
    return Curve(f"fem-p{order}-{'graded' if graded else 'uniform'}", f"fem P{order}", "mean pressure over p*",
                 "cells per period", tuple(map(float, cells)), errors, "algebraic", predicted, low, high, why, "exact",
                 source, floor=4e-9)  # fmt: skip


def persson_curves(cells: Sequence[int], steps: Sequence[int]) -> tuple[Curve, Curve]:
    """Area left by a barrier at rest against cells in stress, and against steps in the variance."""
    exact = float(erf((LOAD + BARRIER) / np.sqrt(2)))

    def error(n_cells: int, n_steps: int, first: float) -> float:
        nodes = np.concatenate([[0.0], np.geomspace(first, 1.0, n_steps + 1)])
        area = march(np.array([LOAD]), nodes, np.full((1, nodes.size), BARRIER), n_cells).area[0, -1]
        return abs(float(area) - exact)

    source = "erf((sigma_0 + a) / sqrt(2 V)), barrier at rest"
    in_cells = tuple(error(n, 400, 1e-3) for n in cells)
    in_steps = tuple(error(1600, n, 1e-2) for n in steps)
    return (
        Curve("persson-cells", "persson", "contact fraction", "finite volumes", tuple(map(float, cells)), in_cells,
              "algebraic", 2.0, 1.9, 2.15, "central differences in stress", "exact", source),
        Curve("persson-steps", "persson", "contact fraction", "steps in the slope variance", tuple(map(float, steps)),
              in_steps, "algebraic", 3.0, 2.7, 3.2, "Runge-Kutta of third order", "exact", source,
              floor=error(1600, 1600, 1e-2)),
    )  # fmt: skip


def paper_method_curve(cells: Sequence[int]) -> Curve:
    """Contact fraction of the paper's own method, which finds its edges, against cells per patch."""
    surface = Surface(1e6, 0.5, WAVE.wavelength, [1], [WAVE.amplitude], [0.0], WAVE.work_of_adhesion)
    fraction = 0.6
    depth = float(WAVE.penetration(fraction * np.pi / 2))
    found = [solve(surface, depth, [[-0.0025, 0.0025]], n, allowed_residual=1e-8) for n in cells]
    unknowns = tuple(float(state.unknowns) for state in found)
    errors = tuple(abs(state.contact_fraction - fraction) for state in found)
    return Curve("paper-method", "paper's method", "contact fraction", "cells per patch", unknowns, errors,
                 "algebraic", 2.0, 1.9, 2.15, "cells of uniform pressure, graded to the edges", "exact",
                 "Johnson 1995, contact fraction 0.6, alpha 0.3")  # fmt: skip


def ensemble_curve(harmonics: int, realisations: int) -> Curve:
    """Spread of the mean area over groups of realisations, with the area of each, at a separation of 0.8 h_rms."""
    areas = np.array([_area(harmonics, seed) for seed in range(realisations)])
    sizes = [2**k for k in range(10) if 2**k <= realisations // 6]
    spread = [float(np.std(areas[: realisations // n * n].reshape(-1, n).mean(axis=1), ddof=1)) for n in sizes]
    errors, bound = tuple(value / float(areas.mean()) for value in spread), 1.6 / np.sqrt(realisations)
    return Curve("ensemble-area", "bem", "spread of the mean contact fraction, over its mean",
                 "realisations in the mean", tuple(map(float, sizes)), errors, "algebraic", 0.5, 0.5 - bound,
                 0.5 + bound, "independent realisations; bounds are two standard deviations of the fit", "theory",
                 "central limit theorem", samples=tuple(areas.tolist()))  # fmt: skip


def _area(harmonics: int, seed: int) -> float:
    """Contact fraction of one realisation."""
    changes: Changes = {"profile": {"harmonics": harmonics, "seed": seed}, "loading": {"targets": [40e-6]}}
    return solved(posed("rough_100", **changes)).targets[-1].contact_fraction


def path_targets(harmonics: int, increment: float) -> tuple[list[float], int]:
    """Contact fractions at the targets of a loading and unloading path, and the evaluations they cost."""
    changes: Changes = {"profile": {"harmonics": harmonics}, "accuracy": {"max_increment": increment}}
    result = solved(posed("rough_100", **changes))
    return [state.contact_fraction for state in result.targets], sum(state.evaluations for state in result.states)


def _fem(order: int, cells: int, graded: bool) -> Evaluation:
    """The layer at prescribed edges on one mesh."""
    psi = FEM_FRACTION * np.pi / 2
    problem = problem_of(
        WAVE.youngs_modulus, WAVE.poisson_ratio, FEM_DEPTH, WAVE.wavelength,
        ([1], [WAVE.amplitude], [0.0]), WAVE.work_of_adhesion, False,
    )  # fmt: skip
    control = control_of(problem, "penetration", float(WAVE.penetration(psi)))
    half = FEM_FRACTION * WAVE.wavelength / 2
    if graded:
        levels = min(24, max(4, round(TIP_LEVELS[order] + 2 * order * np.log2(cells / 8))))
        resolution = Resolution(order, cells, levels)
        mesh = prescribed(problem, control, [[-half, half]], [resolution])[0][1]
        return evaluate(problem, mesh, resolution, control)
    depth = FEM_DEPTH / WAVE.wavelength
    rows = int(np.ceil(0.35 * cells * np.log1p(depth / 0.35)))
    y = 0.35 * np.expm1(np.linspace(0.0, np.log1p(depth / 0.35), rows + 1))
    y[-1] = depth
    triangles = crisscross(np.linspace(0.0, 1.0, cells + 1), y)
    local, edges = np.array([[0.25, 0.75]]), np.array([[-0.25, 0.25]])
    mesh = LayerMesh(triangles, triangles.p, local, edges, seam=0.5, depth=depth)
    return evaluate(problem, mesh, Resolution(order, cells, 4), control)
