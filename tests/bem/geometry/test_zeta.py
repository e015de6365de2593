"""Riemann's zeta function: the same as SciPy's."""

import numpy as np
from scipy import special

from bem.geometry.zeta import zeta


def test_zeta_is_that_of_scipy():
    order = np.arange(2.0, 61.0)
    np.testing.assert_allclose(zeta(order), special.zeta(order), rtol=6e-16)  # 2.2e-16
