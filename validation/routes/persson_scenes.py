"""A scene for Persson's theory: raw E, nu, work of adhesion, and the lines of the profile."""

from typing import Any

import persson
from bem.scene.scene import Scene
from persson import AdhesiveContact, DiscreteSpectrum, NonadhesiveContact
from validation.routes.scenes import problem_of


def persson_spectrum(scene: Scene) -> DiscreteSpectrum:
    """Return the lines of the profile of a scene: wavenumbers in rad/m and amplitudes in m.

    ValueError for a layer, or anything else that the theory of the half-space does not know.
    """
    problem_of(scene, "Persson's theory", "adhesion")
    return DiscreteSpectrum.of_profile(scene.surface())


def persson_contact(scene: Scene, mean_pressure: float, **options: Any) -> AdhesiveContact | NonadhesiveContact:
    """Return the theory of a scene at a mean pressure in Pa, with adhesion where the scene has it."""
    problem = problem_of(scene, "Persson's theory", "adhesion")
    return persson.solve(
        DiscreteSpectrum.of_profile(scene.surface()),
        mean_pressure,
        youngs_modulus=problem.youngs_modulus,
        poisson_ratio=problem.poisson_ratio,
        work_of_adhesion=problem.work_of_adhesion,
        **options,
    )
