"""Persson's theory with adhesion: what it says of a contact.

Area and effective work of adhesion over magnification, stress distribution with the paper's double Gaussian as a fit,
and separation.
"""

from __future__ import annotations

import numpy as np

import persson
from validation.cases.theory.theory_accuracy import EQUATIONS, MODULUS, Q0, SCENE, adhesive, dry, spectra
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, loglog, marks, semilogx, semilogy, trace
from validation.harness.rows import compared
from validation.harness.schema import Reference, Table

MAGNIFICATIONS = np.unique(np.round(np.geomspace(1.0, 1000.0, 61)))  # those at which a line is added
AREA_LOADS = (0.005, 0.02, 0.1)
FIT_LOADS = (0.005, 0.02, 0.05, 0.1, 0.2)
FIT_LOAD = 0.1
FIT_POINTS = 600
FIT_REACH = 5.0  # standard deviations of the full-contact stress above sigma_0
SEPARATION_LOADS = np.geomspace(0.001, 0.1, 13)
STEP = 0.02  # of the load, in central differences
LINES = "paper's lines"


def _magnification() -> Outcome:
    spectrum = spectra()[LINES]
    states = {load: adhesive(spectrum, load) for load in AREA_LOADS}
    zeta = MAGNIFICATIONS.tolist()
    with_adhesion = {
        load: [state.contact_fraction_at(z * Q0) for z in MAGNIFICATIONS] for load, state in states.items()
    }
    without = {load: [dry(spectrum, load).contact_fraction_at(z * Q0) for z in MAGNIFICATIONS] for load in AREA_LOADS}
    orders = (1, 10, 100, 300, 500, 1000)
    integral = adhesive(spectrum, 0.02, route="volterra")
    rows = (
        compared("A/A0 at 0.02 E*, magnifications 1, 10, 100, 300, 500, 1000", "",
                 Reference(kind="self", source="the integral equation at the same magnifications"),
                 [integral.contact_fraction_at(order * Q0) for order in orders],
                 [states[0.02].contact_fraction_at(order * Q0) for order in orders], 1e-5, MEASURED_MAGNIFICATION,
                 "absolute", basis="required"),
        compared("gamma_eff / gamma with all roughness resolved", "",
                 Reference(kind="exact", source="nothing is left unresolved"), [1.0] * len(AREA_LOADS),
                 [float(state.effective_work[-1] / state.work_of_adhesion) for state in states.values()], 1e-12, 0.0,
                 "absolute", basis="required"),
    )  # fmt: skip
    area = drawn(
        "theory-area-over-magnification",
        "Contact fraction that is left when wavenumbers up to zeta q0 are resolved, with adhesion (lines) and "
        "without (dashed). Contact with adhesion levels off where the effective work of adhesion turns positive.",
        loglog("magnification zeta = q / q0", "A / A0",
               *(trace(f"{load} E*", zeta, with_adhesion[load]) for load in AREA_LOADS),
               *(trace(f"{load} E*, no adhesion", zeta, without[load], "dashed") for load in AREA_LOADS))
    )  # fmt: skip
    resolved = [spectrum.resolved_variance(z * Q0) for z in MAGNIFICATIONS]
    work = drawn(
        "theory-effective-work",
        "Effective work of adhesion at each magnification. Where it is negative, over most of the decades, the "
        "elastic energy of the finer roughness outweighs its adhesion and the barrier stays at zero.",
        semilogx(
            "magnification zeta = q / q0",
            "gamma_eff / gamma",
            *(
                trace(f"{load} E*", zeta, np.interp(resolved, s.slope_variances, s.effective_work) / s.work_of_adhesion)
                for load, s in states.items()
            ),
        ),
    )
    return Outcome(rows=rows, figures=(area, work))


def _fit(state: persson.AdhesiveContact) -> tuple[persson.DoubleGaussian, np.ndarray[tuple[int], np.dtype[np.float64]]]:
    """The double Gaussian fitted from the barrier to FIT_REACH standard deviations, and the stresses in Pa."""
    top = state.mean_pressure + FIT_REACH * state.spectrum.slope_rms / 2 * MODULUS
    stress = np.linspace(-state.detachment_stress, top, FIT_POINTS)
    return persson.fit_double_gaussian(stress, state.pressure_distribution(stress), state.mean_pressure), stress


def _distribution() -> Outcome:
    spectrum = spectra()[LINES]
    states = {
        (load, width): adhesive(spectrum, load, detached_width=width) for load in FIT_LOADS for width in (1.0, 0.5)
    }
    fits = {key: _fit(state)[0] for key, state in states.items()}
    whole, half = states[FIT_LOAD, 1.0], states[FIT_LOAD, 0.5]
    fit, stress = _fit(whole)
    density = whole.pressure_distribution(stress)
    distribution = whole.stress_distribution()
    rows = (
        compared("int P dsigma at 0.1 E*", "", Reference(kind="self", source="A/A0 by the integral equation"),
                 [adhesive(spectrum, FIT_LOAD, route="volterra").contact_fraction], [float(distribution.area[0])], 1e-5,
                 MEASURED_DISTRIBUTION, "absolute", basis="required"),
        compared("sigma_a with half the detached width over that with the whole, 0.1 E*", "",
                 Reference(kind="exact", source="sigma_a = sqrt(2 E* gamma_eff q)/pi, the width 2 pi/q at the end"),
                 [2**0.5], [half.detachment_stress / whole.detachment_stress], 3e-12, 1e-12, "absolute"),
    )  # fmt: skip
    table = Table(
        caption="Ours: the printed double Gaussian, sigma_a and G relaxed, fitted to the theory's own P from the "
        "barrier to five standard deviations of the full-contact stress; G over that of full contact, residual rms "
        "over the largest P. The theory's barrier moves with the wavenumber, so that its P is no double Gaussian and "
        "the fit ends at a third of its sigma_a. Half the detached width raises sigma_a by sqrt 2, the area by a few "
        "per cent.",
        columns=["load / E*", "detached width", "A/A0", "sigma_a / E*", "fitted sigma_a / E*", "fitted G / G",
                 "residual"],
        rows=[[load, width, state.contact_fraction, state.detachment_stress / MODULUS,
               fits[load, width].detachment_stress / MODULUS,
               fits[load, width].diffusivity * 8 * load**2 / spectrum.total_slope_variance, fits[load, width].residual]
              for (load, width), state in states.items()]
    )  # fmt: skip
    scaled = (stress / MODULUS).tolist()
    coarser = [
        trace(f"zeta = {order}", scaled, whole.pressure_distribution(stress, order * Q0) * MODULUS)
        for order in (10, 100)
    ]
    figure = drawn(
        "theory-stress-distribution",
        "Stress distribution at 0.1 E* with the roughness up to three magnifications resolved, and the double "
        "Gaussian fitted to the finest; tension is negative. Below: the fit less the theory.",
        axes(
            "stress / E*",
            "P E*",
            trace("zeta = 1000", scaled, density * MODULUS),
            trace("fit to zeta = 1000", scaled, fit(stress) * MODULUS, "dashed"),
            *coarser,
        ),
        axes("stress / E*", "fit - theory", trace("fit - theory", scaled, (fit(stress) - density) * MODULUS)),
    )
    return Outcome(rows=rows, figures=(figure,), tables=(table,))


def _separation() -> Outcome:
    spectrum = spectra()[LINES]
    states = [adhesive(spectrum, float(load), with_separation=True) for load in SEPARATION_LOADS]
    without = [dry(spectrum, float(load)) for load in SEPARATION_LOADS]
    balance = []
    for load in (0.005, 0.02):
        below, above = (adhesive(spectrum, load * (1 + sign * STEP), with_separation=True) for sign in (-1, 1))
        if below.separation is None or above.separation is None:
            raise ValueError("separation: None where it was asked for")
        balance.append(
            (below.total_energy - above.total_energy) / (above.separation - below.separation) / load / MODULUS
        )
    rows = (
        compared("-dU_tot/ds over sigma_0 at 0.005 and 0.02 E*", "",
                 Reference(kind="exact", source="work of the load; central differences over 4 % of the load"),
                 [1.0, 1.0], balance, 2.5 * MEASURED_WORK, MEASURED_WORK, scale=1.0),
    )  # fmt: skip
    reached = [None if state.separation is None else state.separation / spectrum.h_rms for state in states]
    apart = [state.separation / spectrum.h_rms for state in without]
    figure = drawn(
        "theory-separation",
        "Load against separation of the mean planes with and without adhesion, and below how much closer adhesion "
        "brings them at the same load.",
        semilogy("separation / h_rms", "load / E*",
                 marks("with adhesion", reached, SEPARATION_LOADS),
                 trace("no adhesion", apart, SEPARATION_LOADS, "dashed")),
        axes("separation / h_rms without adhesion", "change / h_rms",
             trace("with less without adhesion", apart, [None if one is None else one - other
                   for one, other in zip(reached, apart, strict=True)]))
    )  # fmt: skip
    return Outcome(rows=rows, figures=(figure,))


MEASURED_MAGNIFICATION = 5.2e-7
MEASURED_DISTRIBUTION = 1.3e-6
MEASURED_WORK = 3.2e-4

CASES = (
    Case(
        id="theory-magnification",
        group="theory",
        code="persson",
        level="quick",
        question="How much contact is left as finer roughness is resolved, and from where does adhesion act?",
        equations=EQUATIONS,
        sources=("carbone2009", "persson2002"),
        compute=_magnification,
        effects=("adhesion",),
        scene=SCENE,
    ),
    Case(
        id="theory-distribution",
        group="theory",
        code="persson",
        level="quick",
        question="Which stresses does the contact carry, how well does the double Gaussian fit, and what does half the "
        "detached width change?",
        equations=(
            r"$P = \frac{1}{2 \sigma_0 \sqrt{\pi G}} [e^{-(s - \sigma_0)^2 / 4 G \sigma_0^2} "
            r"- e^{-(s + \sigma_0)^2 / 4 G \sigma_0^2}]$, $s = \sigma + \sigma_a$, a fit in $\sigma_a$ and $G$"
        ),
        sources=("carbone2009",),
        compute=_distribution,
        effects=("adhesion",),
        scene=SCENE,
    ),
    Case(
        id="theory-separation",
        group="theory",
        code="persson",
        level="quick",
        question="How far apart are the mean planes, and does the load do the work of approaching them?",
        equations=r"$s = s_0 + \int \frac{1}{\sigma} \frac{dD}{d\sigma} \, d\sigma$, "
        r"$D = U_{\text{tot}} - U_{\text{el}}$ without adhesion",
        sources=("carbone2009", "persson2007"),
        compute=_separation,
        effects=("adhesion",),
        scene=SCENE,
    ),
)
