"""An adhesive wave: the largest tension on unloading by boundary elements, against Johnson's closed form.

p = p* [sin^2 psi - alpha sqrt(tan psi)] is least where 4 sin^(3/2) psi cos^(5/2) psi = alpha, at the smaller root; both
meet at tan^2 psi = 3/5.  Source: Johnson, Int. J. Solids Struct. 32 (1995) 423.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import bem
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid

pytestmark = pytest.mark.quick

SCENE = {
    "title": "an adhesive wave, pulled off at given penetration",
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-4], "phases": [0.0]},
}


@pytest.mark.parametrize("alpha", [0.1, 0.5, 1.0])
def test_largest_tension(rows, alpha):
    """Is the largest tension that a result reports that of Johnson's curve, where a given penetration passes it by?"""
    wave = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=alpha)
    psi = brentq(lambda a: 4 * np.sin(a) ** 1.5 * np.cos(a) ** 2.5 - alpha, 0.0, np.arctan(np.sqrt(0.6)), xtol=1e-15)
    adhesion, targets = {"work_of_adhesion": wave.work_of_adhesion}, [5e-5, -2e-4]
    loading = {"control": "penetration", "targets": targets}
    tension = bem.solve(bem.parse_scene(SCENE | {"adhesion": adhesion, "loading": loading})).largest_tension
    rows.compare("largest tension", tension.mean_pressure, float(wave.mean_pressure(psi)), of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.PRESSURE, uncertainty=tension.error_estimate.mean_pressure, unit="Pa",
                 source="Johnson 1995, dp/dpsi = 0")
