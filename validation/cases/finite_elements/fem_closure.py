"""Stress intensity and stability of the finite element closure: E* itself, which its edges do not show.

The closure moves edges until K = K_c.  Both are made with E*, from the energy release rate and from the work of
adhesion: a wrong E* leaves edges, load and energy as they are.  Against Johnson's state of one sinusoid on a layer of
two periods, a half-space to 1e-8:

- K at the edges the closure found is sqrt(2 E* gamma);
- the smallest eigenvalue of the energy in motions of the edges is that of one of two motions, K / E* times dK: both
  edges outwards at fixed penetration Delta, K = sqrt(wavelength / tan psi) pi E* (Delta - D S (1 - ln S)) /
  (wavelength ln S), S = sin^2 psi; or both to one side, which adds the odd pressure
  E* D q0^2 / 2 s (1 + S - 2 s^2) / sqrt(S - s^2), s = sin(q0 x / 2), per length (from the function
  1 - 2 s^2 - s (1 + S - 2 s^2) / sqrt(s^2 - S), which vanishes far from the face).

Limits: the eigenvalue is of the scouting mesh, by differences.  SI units.
"""

from __future__ import annotations

import numpy as np

import fem_reference
from fem_reference import Resolution
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared
from validation.harness.schema import Reference
from validation.references.closed_forms import Sinusoid

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
FRACTIONS = (0.3, 0.5, 0.7)
RESOLUTION = Resolution(2, 10, 10)


def stiffness(wave: Sinusoid, psi: float) -> tuple[float, float]:
    """Second derivatives in J/m^3 of the energy as both edges move outwards at fixed penetration, and to one side.

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


def _closure() -> Outcome:
    found = [
        fem_reference.solve(
            youngs_modulus=WAVE.youngs_modulus,
            poisson_ratio=WAVE.poisson_ratio,
            thickness=2 * WAVE.wavelength,
            period=WAVE.wavelength,
            harmonics=([1], [WAVE.amplitude], [0.0]),
            control="penetration",
            value=float(WAVE.penetration(fraction * np.pi / 2)),
            work_of_adhesion=WAVE.work_of_adhesion,
            resolution=RESOLUTION,
        )
        for fraction in FRACTIONS
    ]
    intensities = [float(value) for result in found for value in result.stress_intensity.ravel()]
    critical = float(np.sqrt(2 * WAVE.modulus * WAVE.work_of_adhesion))
    eigenvalues = [min(stiffness(WAVE, fraction * np.pi / 2)) for fraction in FRACTIONS]
    source = Reference(kind="exact", source="Johnson 1995")
    rows = (
        compared("stress intensity at the edges found, contact fractions 0.3, 0.5 and 0.7", "Pa m^1/2", source,
                 [critical] * len(intensities), intensities, 2.5 * MEASURED[0], MEASURED[0], scale=critical,
                 uncertainty=max(float(np.max(result.uncertainty["stress_intensity"])) for result in found)),
        compared("smallest eigenvalue of the energy, contact fractions 0.3, 0.5 and 0.7", "J/m^3", source, eigenvalues,
                 [result.min_eigenvalue for result in found], 2.5 * MEASURED[1], MEASURED[1], "maximum over states",
                 max(eigenvalues)),
    )  # fmt: skip
    return Outcome(rows=rows, counts={"unknowns of the finite elements": max(result.unknowns for result in found)})


MEASURED = (7.1e-9, 4.8e-4)  # the iteration ends below 1e-8

CASES = (
    Case(
        id="fem-closure-modulus", group="finite elements against closed forms", level="quick", code="fem",
        problem="adhesive wave, JKR closure",
        question="Has the contact whose edges the finite elements find the stress intensity and the stability it must?",
        equations=r"$K = \sqrt{2 E^\ast \gamma}$; "
        r"$\frac{d^2 U}{da^2} = \frac{dG}{da} = \frac{K}{E^\ast} \frac{dK}{da}$, "
        "both edges outwards or to one side",
        sources=("johnson1995",), compute=_closure, effects=("layer", "adhesion")
    ),
)  # fmt: skip
