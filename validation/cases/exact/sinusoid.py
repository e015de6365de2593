"""One sinusoid: the JKR curve of Johnson on a whole loop, and Westergaard's without adhesion, against closed forms."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import bem
from bem.audit.dense import evaluate_dense
from bem.geometry.scaling import Scales
from bem.scene.result import Result
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, semilogy, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Figure, Reference
from validation.references import adapters
from validation.references.closed_forms import Sinusoid

AMPLITUDE, WAVELENGTH, YOUNGS_MODULUS, POISSON_RATIO = 1e-4, 0.01, 1e6, 0.5
EQUATIONS = (
    r"$p = p^\ast [\sin^2 \psi - \alpha \sqrt{\tan \psi}]$, "
    r"$\Delta = D S (1 - \ln S) + \frac{\alpha p^\ast \lambda}{\pi E^\ast} \sqrt{\tan \psi} \ln S$, "
    r"$S = \sin^2 \psi$, $\psi = \pi a / \lambda$, $p^\ast = \pi E^\ast D / \lambda$"
)


def _wave(alpha: float) -> Sinusoid:
    return Sinusoid(AMPLITUDE, WAVELENGTH, YOUNGS_MODULUS, POISSON_RATIO, alpha)


def _loop(wave: Sinusoid) -> tuple[Result, float]:
    """Load from first touch to contact fraction 0.95, unload beyond pull-off; the result and the fold."""
    fold = wave.fold()
    closed = float(wave.penetration(0.95 * np.pi / 2))
    lowest = float(wave.penetration(fold))
    loading = list(np.linspace(0.02 * closed, closed, 14))
    unloading = list(np.linspace(closed, lowest + 1e-3 * (closed - lowest), 16)[1:])
    changes: dict[str, Any] = {
        "adhesion": {"work_of_adhesion": wave.work_of_adhesion},
        "loading": {"targets": [*loading, *unloading, lowest - 0.05 * closed]},
    }
    return bem.solve(adapters.scene("sinusoid", changes)), lowest


def _johnson(alpha: float) -> Outcome:
    wave = _wave(alpha)
    result, lowest = _loop(wave)
    states = [state for state in result.states if state.n_patches == 1]
    psi = np.array([state.contact_fraction for state in states]) * np.pi / 2
    pressure = np.array([state.mean_pressure for state in states])
    penetration = np.array([state.penetration for state in states])
    exact_pressure, exact_penetration = wave.mean_pressure(psi), wave.penetration(psi)
    pull_off = [event.penetration for event in result.events if event.kind == "pull_off"]
    johnson = Reference(kind="exact", source="Johnson 1995, at the solver's own contact width")
    scale = wave.full_contact_pressure
    rows = (
        compared("mean pressure over p*", "Pa", johnson, exact_pressure, pressure,
                 2.5 * MEASURED[alpha][0], MEASURED[alpha][0], "maximum over states", scale),
        compared("penetration over amplitude", "m", johnson, exact_penetration, penetration,
                 2.5 * MEASURED[alpha][1], MEASURED[alpha][1], "maximum over states", AMPLITUDE),
        compared("penetration at pull-off over amplitude", "m",
                 Reference(kind="exact", source="fold of Johnson's penetration"), [lowest], pull_off[:1] or [None],
                 2.5 * MEASURED[alpha][2], MEASURED[alpha][2], "absolute", AMPLITUDE),
        counted("states whose certificate is not ok",
                Reference(kind="exact", source="every state of the loop is an equilibrium"), [0.0],
                [float(sum(not state.certificate.ok for state in result.states))]),
    )  # fmt: skip
    return Outcome(
        rows=rows,
        figures=(_figure(alpha, wave, psi, pressure, exact_pressure, penetration, exact_penetration),),
        counts={
            "unknowns": max(state.unknowns for state in states),
            "evaluations": sum(state.evaluations for state in result.states),
            "states": len(result.states),
        },
    )


def _figure(
    alpha: float,
    wave: Sinusoid,
    psi: np.ndarray[tuple[int], np.dtype[np.float64]],
    pressure: np.ndarray[tuple[int], np.dtype[np.float64]],
    exact_pressure: np.ndarray[tuple[int], np.dtype[np.float64]],
    penetration: np.ndarray[tuple[int], np.dtype[np.float64]],
    exact_penetration: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> Figure:
    fraction = (psi * 2 / np.pi).tolist()
    curve = np.linspace(0.01, 0.97, 300)
    scale = wave.full_contact_pressure
    return drawn(f"johnson-{alpha:g}",
                 f"Mean pressure against contact fraction on loading and unloading, alpha = {alpha:g}.",
                 axes("contact fraction", "mean pressure / p*",
                      trace("Johnson 1995", curve, wave.mean_pressure(curve * np.pi / 2) / scale),
                      marks("bem", fraction, pressure / scale)),
                 axes("contact fraction", "signed error",
                      marks("mean pressure / p*", fraction, (pressure - exact_pressure) / scale),
                      marks("penetration / amplitude", fraction,
                            (penetration - exact_penetration) / AMPLITUDE)))  # fmt: skip


def _westergaard() -> Outcome:
    wave = _wave(0.0)
    fractions = np.array([0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
    targets = wave.penetration(fractions * np.pi / 2).tolist()
    result = bem.solve(adapters.scene("sinusoid", {"adhesion": None, "loading": {"targets": targets}}))
    computed = [state.contact_fraction for state in result.targets]
    pressure = [state.mean_pressure for state in result.targets]
    source = Reference(kind="exact", source="Westergaard 1939")
    rows = (
        compared("contact fraction", "", source, fractions, computed, 1e-10, MEASURED[0.0][0], "maximum over states",
                 1.0, basis="required"),
        compared("mean pressure over p*", "Pa", source, wave.mean_pressure(fractions * np.pi / 2),
                 pressure, 2.5 * MEASURED[0.0][1], MEASURED[0.0][1], "maximum over states", wave.full_contact_pressure),
    )  # fmt: skip
    error = [a - b for a, b in zip(computed, fractions, strict=True)]
    figure = drawn("westergaard", "Contact fraction against penetration without adhesion.",
                   axes("penetration / amplitude", "contact fraction",
                        trace("Westergaard 1939", [t / AMPLITUDE for t in targets], fractions),
                        marks("bem", [t / AMPLITUDE for t in targets], computed)),
                   axes("penetration / amplitude", "signed error of the contact fraction",
                        marks("bem", [t / AMPLITUDE for t in targets], error)))  # fmt: skip
    return Outcome(
        rows=rows,
        figures=(figure,),
        counts={
            "unknowns": max(state.unknowns for state in result.states),
            "evaluations": sum(state.evaluations for state in result.states),
        },
    )


def _dense_errors(wave: Sinusoid, psi: float) -> tuple[list[float], list[float]]:
    """Unknowns and errors of the stress intensity over critical, by the plain dense evaluation."""
    profile = bem.Profile.from_harmonics(WAVELENGTH, [1], [AMPLITUDE])
    scales = Scales(WAVELENGTH, profile.rms_height, wave.modulus)
    critical = 2 * np.sqrt(wave.work_of_adhesion / scales.release_rate)
    edge = np.array([2 * psi])
    sizes = list(range(4, 31, 2))
    states = [
        evaluate_dense(profile.scaled(), -edge, edge, float(wave.penetration(psi)) / scales.height, np.array([size]))
        for size in sizes
    ]
    return [float(n) for n in sizes], [float(np.max(np.abs(s.stress_intensity / critical - 1))) for s in states]


def _convergence() -> Outcome:
    """The load and stress intensity of a Johnson state at its exact edges, for one tolerance after the other."""
    wave = _wave(0.3)
    fraction = 0.6
    psi = fraction * np.pi / 2
    half = fraction * WAVELENGTH / 2
    profile = bem.Profile.from_harmonics(WAVELENGTH, [1], [AMPLITUDE])
    solid = bem.Solid(YOUNGS_MODULUS, POISSON_RATIO)
    critical = float(np.sqrt(2 * wave.modulus * wave.work_of_adhesion))
    unknowns, load_error, intensity_error = [], [], []
    for exponent in range(0, 14):
        tolerance = 10.0**-exponent if exponent else 0.3
        state = bem.ContactState(profile, solid, [[-half, half]], float(wave.penetration(psi)), tolerance=tolerance)
        if state.evaluation.unknowns in unknowns:
            continue
        unknowns.append(state.evaluation.unknowns)
        load_error.append(abs(state.mean_pressure - float(wave.mean_pressure(psi))) / wave.full_contact_pressure)
        intensity_error.append(float(np.max(np.abs(state.stress_intensity / critical - 1))))
    source = Reference(kind="exact", source="Johnson 1995, contact fraction 0.6, alpha 0.3")
    rows = (
        compared("mean pressure over p* at the finest setting", "", source, [0.0], [load_error[-1]], 2e-15,
                 MEASURED_PLATEAU[0], "absolute"),
        compared("stress intensity over critical at the finest setting", "", source, [0.0], [intensity_error[-1]],
                 2e-14, MEASURED_PLATEAU[1], "absolute"),
    )  # fmt: skip
    dense_unknowns, dense_error = _dense_errors(wave, psi)
    shown = (
        ("mean pressure / p*", unknowns, load_error),
        ("stress intensity", unknowns, intensity_error),
        ("stress intensity, dense", dense_unknowns, dense_error),
    )
    figure = drawn(
        "landing-error-against-unknowns",
        "What accuracy costs: error of one adhesive contact against the unknowns of its system, for the "
        "compressed evaluation and the plain dense one; the reference is Johnson's closed form.",
        semilogy(
            "unknowns",
            "relative error",
            *(marks(label, x, [max(error, SMALLEST_SHOWN) for error in errors]) for label, x, errors in shown),
        ),
    )
    return Outcome(rows=rows, figures=(figure,), counts={"unknowns": unknowns[-1]})


MEASURED_PLATEAU = (3e-16, 7.4e-15)  # rounding: the largest over the BLAS kernels of five processors (least 1.4e-15)

SMALLEST_SHOWN = 1e-17

# errors measured, alpha = 0 the largest over the BLAS kernels of five processors (least 1.3e-11);
# alpha: mean pressure, penetration, pull-off (0: contact fraction, mean pressure)
MEASURED = {
    0.0: (5.5e-11, 8.2e-13),
    0.1: (6.3e-13, 2.3e-13, 1.5e-14),
    0.3: (1.5e-13, 1.6e-13, 1.5e-14),
    0.5: (5.3e-13, 2.3e-13, 9.5e-15),
}

CASES = (
    *(
        Case(id=f"johnson-alpha-{alpha:g}", group="closed forms", level="quick",
             problem=f"adhesive wave, alpha {alpha:g}, loop to pull-off",
             question="Does the solver follow the JKR curve of one sinusoid along a whole loop, up to pull-off?",
             equations=EQUATIONS,
             sources=("johnson1995", "carbone2009"), compute=partial(_johnson, alpha),
             effects=("half_space", "adhesion", "unloading"), scene=adapters.scene_text("sinusoid"))
        for alpha in (0.1, 0.3, 0.5)
    ),
    Case(id="sinusoid-convergence", group="convergence", level="quick", problem="adhesive wave, given edges",
         question="How many unknowns does an adhesive contact need for a given accuracy?",
         equations=r"geometric decay: the coupled modes of a patch fall as $\rho^{-n}$, $\rho$ from the nearest gap",
         sources=("johnson1995",), compute=_convergence, effects=("half_space", "adhesion")),
    Case(id="westergaard", group="closed forms", level="quick", problem="wave without adhesion",
         question="Does contact without adhesion reproduce the sinusoid of Westergaard?",
         equations=r"contact fraction $2 \psi / \pi$ at $\Delta = D S (1 - \ln S)$, $p = p^\ast S$, $S = \sin^2 \psi$",
         sources=("westergaard1939",), compute=_westergaard, effects=("half_space",),
         scene=adapters.scene_text("sinusoid")),
)  # fmt: skip
