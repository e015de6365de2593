"""One rough profile where all three codes answer: boundary elements, finite elements, and Persson's theory.

A self-affine profile of 20 harmonics without adhesion, several contacts, at one load on a layer of two periods, the
half-space to 1e-8 (which the theory knows alone). Both solvers answer for this one realisation and are compared as
everywhere (fem_comparison.py). The theory has no realisation: it sees the spectrum, and its numbers are means over all
phases. So it is compared with the mean over realisations of the boundary elements, whose ratio to the theory is a known
discrepancy; and the realisation of the finite elements with the theory within the spread of that ensemble. SI units.
"""

from functools import partial

import numpy as np

import bem
from bem.scene.scene import Scene
from validation.cases.finite_elements import fem_comparison
from validation.cases.shared.checks import Against, case, column, posed
from validation.harness.case import Outcome
from validation.harness.schema import Cells, Row, Table
from validation.references import adapters

HARMONICS, SEED, REALISATIONS = 20, 1, 12
LOAD = 0.01 * 1e6 / (1 - 0.5**2)  # Pa, 0.01 E*
CAUSE = (
    "mean-field theory that neglects correlations between neighbouring contacts, strongest for roughness in one "
    "direction and for small contact"
)
SOURCE = "Carbone, Scaraggi, Tartaglino 2009, abstract: about 50 % for any given load, with adhesion"
# ratios to the theory, measured: means 1.33 +- 0.06 and 1.19 +- 0.05; one realisation 1.51 (spread 0.20), 1.14 (0.16)
BANDS_OF_MEAN = {"contact_fraction": (1.16, 1.50), "separation": (1.05, 1.33)}  # three standard errors on both sides
BANDS_OF_ONE = {"contact_fraction": (0.74, 1.92), "separation": (0.71, 1.66)}  # three standard deviations


def _posed(seed: int, layer: bool = True) -> Scene:
    return posed("rough_100", profile={"harmonics": HARMONICS, "seed": seed}, adhesion=None,
                 layer={"thickness": 0.02} if layer else None, accuracy={"tolerance": 1e-9},
                 loading={"control": "mean_pressure", "targets": [LOAD]})  # fmt: skip


def _rough(elements: str) -> Outcome:
    found = fem_comparison.compare_equilibria("one realisation", _posed(SEED), elements, None)
    states = [bem.solve(_posed(seed)).targets[-1] for seed in range(REALISATIONS)]
    if any(state.status != "converged" for state in states):
        raise ArithmeticError("a realisation did not converge")
    theory = adapters.persson_contact(_posed(SEED, layer=False), LOAD)
    judged, table = list(fem_comparison.rows(found)), []

    def over_theory(words: str, unit: str, value: float, uncertain: float, band: tuple[float, float]) -> Row:
        return Against("theory", "Persson 2001").ratio(
            f"{label}: {words}, over Persson", unit, expected, value, band, CAUSE, SOURCE, uncertainty=uncertain,
            review="2027-11-26")  # fmt: skip

    for name, unit in (("contact_fraction", ""), ("separation", "m")):
        ensemble, label = np.array(column(states, name)), name.replace("_", " ")
        mean, spread, expected = float(ensemble.mean()), float(ensemble.std(ddof=1)), float(getattr(theory, name))
        judged.append(over_theory(f"mean of {REALISATIONS} realisations, boundary elements", unit, mean,
                                  spread / REALISATIONS**0.5, BANDS_OF_MEAN[name]))  # fmt: skip
        line: Cells = [label, float(f"{ensemble[SEED]:.9g}")]
        if found.fem is not None:
            fem = float(getattr(found.fem, name))
            judged.append(over_theory("one realisation, finite elements", unit, fem, spread, BANDS_OF_ONE[name]))
            line.append(float(f"{fem:.9g}"))
        table.append([*line, float(f"{mean:.4g}"), float(f"{spread:.2g}"), float(f"{expected:.4g}")])
    shown = Table(
        caption=f"One load, 0.01 E*: what each code says, the ensemble of {REALISATIONS} realisations by their seeds.",
        columns=["quantity", "bem, one realisation", "fem, one realisation", "bem, mean", "spread", "Persson"],
        rows=table,
    )
    caption = f"Pressure of a rough profile of {HARMONICS} harmonics, {elements}."
    return Outcome(rows=tuple(judged), figures=fem_comparison.figure("fem-rough", caption, found), tables=(shown,),
                   counts=fem_comparison.counts([found]))  # fmt: skip


CASES = (
    case("fem-rough", fem_comparison.GROUP, partial(_rough, "P2/P1"),
         "What do boundary elements, finite elements and Persson's theory say of one rough profile?",
         fem_comparison.EQUATIONS + r"; theory: $A/A_0 = \text{erf}(\sqrt{2} \sigma_0 / (E^\ast h'_{rms}))$",
         f"{fem_comparison.SOURCES} persson2001", "layer load_control", level="standard", scene="rough_100"),
)  # fmt: skip
