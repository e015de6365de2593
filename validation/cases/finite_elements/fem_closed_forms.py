"""The finite element reference against closed forms, before it is a reference for anything.

- Complete contact of a sinusoid with a layer, any nu: energy h_1^2 / (4 c(q)) per area, c(q) of G. Carbone,
  L. Mangialardi, J. Mech. Phys. Solids 56 (2008) 684; order of convergence on similar meshes, what comes after
  the leading term fitted. The boundary elements' energy of the same contact stands beside it.
- One patch on a layer of two periods, which is a half-space to 1e-8: Johnson's state (closed_forms.py)
  with its edges prescribed (load and stress intensity asked), and by JKR closure (edges and load asked).
- The closure moves edges until K = K_c.  Both are made with E*, from the energy release rate and from the work of
  adhesion: a wrong E* leaves edges, load and energy as they are.  So K at the edges the closure found is asked, which
  is sqrt(2 E* gamma), and the smallest eigenvalue of the energy in motions of the edges (`stiffness`), of the scouting
  mesh, by differences.

The true error over the uncertainty that the reference states of it is a quantity of its own: at most 1. SI units.
"""

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

import fem_reference
from bem.scene.scene import Scene
from fem_reference import Resolution, Result
from fem_reference.solve import companions
from validation.cases.finite_elements.fem_comparison import NAMES, uncertain, within
from validation.cases.shared.checks import OVER_STATES, Against, Found, case, column, in_forms, posed, solved
from validation.harness.figure_data import axes, drawn, loglog, marks, trace
from validation.harness.schema import Row
from validation.references import fem_adapter
from validation.references.closed_forms import Sinusoid, layer_compliance

PERIOD, AMPLITUDE, YOUNGS_MODULUS = 0.01, 50e-6, 1e6
HALVED = 0.35 * float(np.expm1(0.5 / 0.35))  # thickness in periods at which meshes have half as many rows as columns
RATIOS = (-0.5, 0.3, 0.499999, 0.5)
ORDERS = {  # of the energy, by elements and nu: predicted, measured distance from it
    (2, -0.5): (4.0, 0.0037),
    (2, 0.3): (4.0, 0.11),
    (2, 0.499999): (4.0, 0.117),
    (2, 0.5): (4.0, 0.117),
    (4, -0.5): (8.0, 0.031),
    (4, 0.3): (8.0, 0.27),
}
NO_ORDER = 0.4  # nu from which P4 meets rounding, 1e-11, before its asymptotic range (its order: fem-manufactured)
JOHNSON = Against("exact", "Johnson 1995")
CARBONE = Against("exact", "Carbone and Mangialardi 2008")


def given(wave: Sinusoid, thickness: float) -> dict[str, Any]:
    """A wave on a layer of a thickness in m as `fem_reference.solve` takes it: raw numbers, without adhesion."""
    return {
        "youngs_modulus": wave.youngs_modulus,
        "poisson_ratio": wave.poisson_ratio,
        "thickness": thickness,
        "period": wave.wavelength,
        "harmonics": ([1], [wave.amplitude], [0.0]),
    }


def _complete_bem(poisson_ratio: float) -> float | None:
    """Elastic energy per area by the boundary elements, at a pressure that closes every gap."""
    state = solved("layer_sinusoid", solid={"poisson_ratio": poisson_ratio}, layer={"thickness": HALVED * PERIOD},
                   adhesion=None, loading={"control": "mean_pressure", "targets": [2e5], "initial": "separated"},
                   accuracy={"max_increment": 50.0}).targets[-1]  # fmt: skip
    return state.elastic_energy if state.status == "complete_contact" else None


def _complete() -> Found:
    exact = {
        nu: 0.25 * AMPLITUDE**2 / float(layer_compliance(2 * np.pi / PERIOD, HALVED * PERIOD, YOUNGS_MODULUS, nu))
        for nu in RATIOS
    }
    series, unknowns = [], []
    for order, nu in product((2, 4), RATIOS):
        ordered, name = order == 2 or nu < NO_ORDER, f"{NAMES[order]}, nu = {nu:g}"
        ladder = companions(Resolution(order, 24 if ordered else 16, 10))  # 14, 18 and 24 cells
        found = fem_reference.refine(**given(_wave(nu, 0.0), HALVED * PERIOD), control="mean_pressure", value=0.0,
                                     edges="complete", resolutions=ladder)  # fmt: skip
        energy = found.estimates["strain_energy"]
        value, spread = float(energy.value) / PERIOD, float(np.max(energy.uncertainty)) / PERIOD
        yield within(f"energy per area, finite elements {name}", "J/m^2", CARBONE, exact[nu], value, spread, exact[nu],
                     "fem")  # fmt: skip
        yield _coverage(name, abs(value - exact[nu]) / spread)
        errors = [abs(float(level) / PERIOD / exact[nu] - 1) for level in energy.levels]
        cells = [resolution.cells for resolution in ladder]
        if ordered:
            predicted, measured = ORDERS[order, nu]
            yield Against("predicted order", "energy norm of order m, squared").row(
                f"observed order of the energy, {name}", "", predicted,
                order_of_even([1 / count for count in cells], errors), measured, "absolute")  # fmt: skip
        series.append(trace(name, cells, errors))
        unknowns.append(found.result.unknowns)
    yield CARBONE.row("energy per area, boundary elements, nu = 0.3, 0.499999, 0.5", "J/m^2",
                      [exact[nu] for nu in RATIOS[1:]], map(_complete_bem, RATIOS[1:]), (1e-13, 1e-15), OVER_STATES,
                      exact[0.3], code="bem")  # fmt: skip
    yield drawn("fem-complete", "Complete contact: relative error of the elastic energy against base cells per period.",
                loglog("cells per period", "relative error of the energy", *series))  # fmt: skip
    yield {"unknowns of the finite elements": max(unknowns)}


def order_of_even(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """The order p of errors C h^p (1 + b h^2) on three meshes: what smooth solutions leave on uniform ones.

    Examples
    --------
    >>> sizes = [1 / 14, 1 / 18, 1 / 24]
    >>> round(order_of_even(sizes, [3 * h**4 * np.exp(20 * h**2) for h in sizes]), 9)
    4.0
    """
    h = np.asarray(sizes)
    terms = np.column_stack([np.log(h), h**2, np.ones(3)])
    return float(np.linalg.solve(terms, np.log(np.asarray(errors)))[0])


def _coverage(name: str, ratio: float) -> Row:
    """0.4 was measured of the closures; in complete contact at most 0.31."""
    return Against("exact", "the closed form").row(f"true error over stated uncertainty, {name}", "", 0.0, ratio, 0.4,
                                                   "absolute", required=1.0, pinned="unconverged")  # fmt: skip


def _wave(poisson_ratio: float, alpha: float) -> Sinusoid:
    return Sinusoid(AMPLITUDE, PERIOD, YOUNGS_MODULUS, poisson_ratio, alpha)


def layered(wave: Sinusoid, penetration: float, **loading: Any) -> Scene:
    """The scene of a wave on a layer of two periods, at a penetration in m, or under another loading."""
    adhesion = {"work_of_adhesion": wave.work_of_adhesion, "slope_term": False}
    return posed("layer_sinusoid", solid={"poisson_ratio": wave.poisson_ratio}, adhesion=adhesion,
                 loading={"targets": [penetration]} | loading)  # fmt: skip


STATES = ((0.1, 0.3, 0.1), (0.4, 0.5, 0.3), (0.7, 0.45, 0.3))  # contact fraction, nu, alpha of prescribed edges
CLOSED = ((0.5, 0.3, 0.3), (0.35, 0.5, 0.2))  # the same of closures
PRESCRIBED = {2: Resolution(2, 10, 12), 4: Resolution(4, 10, 22)}
CLOSURE = {2: Resolution(2, 10, 10), 4: Resolution(4, 8, 18)}
# tolerance, measured: load over p* and stress intensity over critical of prescribed edges; width and load of a closure
ASKED = {
    2: ((1.2e-5, 4e-6), (4e-4, 1.4e-4), (3e-4, 1e-4), (6e-5, 2e-5)),
    4: ((1e-7, 9e-9), (1e-6, 6.2e-8), (1e-6, 1.6e-7), (1e-7, 1.5e-8)),
}


def _solved(resolution: Resolution, fraction: float, nu: float, alpha: float, *, given: bool = False) -> Result:
    """One of Johnson's states at its penetration, its edges given or found."""
    wave, half, crest = _wave(nu, alpha), 0.5 * fraction * PERIOD, -0.7 / (2 * np.pi) * PERIOD
    scene = layered(wave, float(wave.penetration(fraction * np.pi / 2)))
    return fem_adapter.solve_fem(scene, resolution, edges=[[crest - half, crest + half]] if given else None)


def _load(fraction: float, nu: float, alpha: float) -> float:
    return float(_wave(nu, alpha).mean_pressure(fraction * np.pi / 2))


def _one_patch(order: int) -> Found:
    name, star = NAMES[order], _wave(0.3, 0.0).full_contact_pressure
    given = [_solved(PRESCRIBED[order], *state, given=True) for state in STATES]
    closed = [_solved(CLOSURE[order], *state) for state in CLOSED]
    loads, stars = [_load(*state) for state in STATES], [_wave(nu, 0.0).full_contact_pressure for _, nu, _ in STATES]
    critical = [alpha * own * np.sqrt(PERIOD) for (_, _, alpha), own in zip(STATES, stars, strict=True)]
    ratios = [fem.stress_intensity.ravel() / one for fem, one in zip(given, critical, strict=True)]
    farthest = [float(ratio[np.argmax(np.abs(ratio - 1))]) for ratio in ratios]
    fractions = [fraction for fraction, _, _ in CLOSED]
    widths = [fem.contact_fraction if fem.status == "converged" else float("nan") for fem in closed]
    for (quantity, unit, expected, computed, spread, scale), (allowed, measured) in zip((
        ("given edges: mean pressure over p*", "Pa", loads, column(given, "mean_pressure"),
         [uncertain(fem, "mean_pressure") for fem in given], star),
        ("given edges: stress intensity over critical", "", [1.0] * len(given), farthest,
         [uncertain(fem, "stress_intensity") / one for fem, one in zip(given, critical, strict=True)], 1.0),
        ("JKR closure: contact fraction, relative", "", [1.0] * len(closed), np.divide(widths, fractions),
         [uncertain(fem, "contact_fraction") / one for fem, one in zip(closed, fractions, strict=True)], 1.0),
        ("JKR closure: mean pressure over p*", "Pa", [_load(*state) for state in CLOSED],
         column(closed, "mean_pressure"), [uncertain(fem, "mean_pressure") for fem in closed], star),
    ), ASKED[order], strict=True):  # fmt: skip
        yield JOHNSON.row(f"{quantity}, {name}", unit, expected, computed, (allowed, measured), OVER_STATES, scale,
                          required=allowed if order == 4 else None, uncertainty=max(spread))  # fmt: skip
    apart = np.subtract(column(given, "mean_pressure"), loads)
    yield _coverage(f"load at given edges, {name}", max(
        abs(off) / uncertain(fem, "mean_pressure") for off, fem in zip(apart, given, strict=True)))  # fmt: skip
    yield _coverage(f"edges of a closure, {name}", max(
        abs(found - fraction) / float(np.sum(fem.uncertainty["edges"]) / PERIOD)
        for found, fraction, fem in zip(widths, fractions, closed, strict=True)))  # fmt: skip
    curve, at = np.linspace(0.02, 0.9, 200), [fraction for fraction, _, _ in STATES]
    yield drawn(f"fem-one-patch-{name.replace('/', '').lower()}",
                f"Mean pressure of finite elements, {name}, at the edges of Johnson's states.",
                axes("contact fraction", "mean pressure / p*",
                     *(trace(f"Johnson 1995, alpha = {alpha:g}", curve,
                             _wave(0.3, alpha).mean_pressure(curve * np.pi / 2) / star)
                       for alpha in sorted({alpha for _, _, alpha in STATES})),
                     marks("finite elements", at, np.divide(column(given, "mean_pressure"), stars))),
                axes("contact fraction", "signed error", marks("mean pressure / p*", at, apart / stars),
                     marks("stress intensity", at, np.subtract(farthest, 1))))  # fmt: skip
    yield {"unknowns of the finite elements": max(column(closed, "unknowns"))}


WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
FRACTIONS = (0.3, 0.5, 0.7)


def stiffness(wave: Sinusoid, psi: float) -> tuple[float, float]:
    """Second derivatives in J/m^3 of the energy as both edges move outwards at fixed penetration, and to one side.

    K / E* times dK: outwards K = sqrt(wavelength / tan psi) pi E* (Delta - D S (1 - ln S)) / (wavelength ln S),
    S = sin^2 psi; a shift adds the odd pressure E* D q0^2 / 2 s (1 + S - 2 s^2) / sqrt(S - s^2), s = sin(q0 x / 2), per
    length (from the function 1 - 2 s^2 - s (1 + S - 2 s^2) / sqrt(s^2 - S), which vanishes far from the face).

    Examples
    --------
    >>> [round(value, 3) for value in stiffness(WAVE, np.pi / 4)]
    [1600.35, 1022.185]
    """
    share, length = np.sin(psi) ** 2, wave.wavelength
    intensity = np.sqrt(2 * wave.modulus * wave.work_of_adhesion)
    per_lift = np.sqrt(length / np.tan(psi)) * np.pi * wave.modulus / (length * np.log(share))  # dK/dDelta
    outwards = -intensity * (1 / np.sin(2 * psi) + 2 / (np.tan(psi) * np.log(share)))
    outwards += per_lift * wave.amplitude * np.log(share) * np.sin(2 * psi)
    curvature = wave.amplitude * (2 * np.pi / length) ** 2
    aside = wave.modulus * curvature * np.sqrt(2 * length * np.sin(2 * psi)) * np.cos(psi) / 4
    rate = intensity / wave.modulus
    return float(rate * outwards * np.pi / length), float(rate * aside)


def _closure() -> Found:
    found = [fem_reference.solve(**given(WAVE, 2 * WAVE.wavelength), control="penetration",
                                 value=float(WAVE.penetration(fraction * np.pi / 2)),
                                 work_of_adhesion=WAVE.work_of_adhesion, resolution=CLOSURE[2])
             for fraction in FRACTIONS]  # fmt: skip
    intensities = np.concatenate([result.stress_intensity.ravel() for result in found])
    critical = float(np.sqrt(2 * WAVE.modulus * WAVE.work_of_adhesion))
    eigenvalues = [min(stiffness(WAVE, fraction * np.pi / 2)) for fraction in FRACTIONS]
    # the iteration ends below 1e-8
    yield JOHNSON.row("stress intensity at the edges found, contact fractions 0.3, 0.5 and 0.7", "Pa m^1/2",
                      [critical] * intensities.size, intensities, 7.1e-9, scale=critical,
                      uncertainty=max(uncertain(fem, "stress_intensity") for fem in found))  # fmt: skip
    yield JOHNSON.row("smallest eigenvalue of the energy, contact fractions 0.3, 0.5 and 0.7", "J/m^3", eigenvalues,
                      column(found, "min_eigenvalue"), 4.8e-4, OVER_STATES, max(eigenvalues))  # fmt: skip
    yield {"unknowns of the finite elements": max(column(found, "unknowns"))}


GROUP = "finite elements against closed forms"
ELEMENTS = "gustafsson2020 taylor1973 roache1998"


CASES = (
    case("fem-complete-contact", GROUP, _complete,
         "Do the finite elements converge at their order in complete contact, for any Poisson's ratio?",
         r"$U / \lambda = h_1^2 / (4 c(q))$; observed order 4 (P2/P1), 8 (P4/P3)",
         f"carbone2008 {ELEMENTS}", "layer", code="fem", scene="layer_sinusoid",
         problem="complete contact of a layer"),
    *in_forms({"fem-one-patch-coarse": ("quick", 2), "fem-one-patch": ("standard", 4)}, GROUP, _one_patch,
              "Do the finite elements reproduce Johnson's states, at given edges and by their own closure?",
              r"$p = p^\ast [S - \alpha \sqrt{\tan \psi}]$, $K = \alpha p^\ast \sqrt{\lambda}$, $S = \sin^2 \psi$",
              f"johnson1995 destuynder1983 shih1986 {ELEMENTS}", "layer", code="fem", scene="layer_sinusoid",
              problem="adhesive wave"),
    case("fem-closure-modulus", GROUP, _closure,
         "Has the contact whose edges the finite elements find the stress intensity and the stability it must?",
         r"$K = \sqrt{2 E^\ast \gamma}$; "
         r"$\frac{d^2 U}{da^2} = \frac{dG}{da} = \frac{K}{E^\ast} \frac{dK}{da}$, both edges outwards or to one side",
         "johnson1995", "layer adhesion", code="fem", problem="adhesive wave, JKR closure"),
)  # fmt: skip
