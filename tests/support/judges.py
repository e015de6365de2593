"""References of the comparison that judge the tests of bem: closed forms of a wave, and states by dense algebra."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.patches import PatchPressure
from validation.references import dense
from validation.references.closed_forms import Sinusoid
from validation.references.dense import dense_nodes

__all__ = ["Sinusoid", "SmoothKernel", "dense_nodes", "evaluate_dense"]


@dataclass(frozen=True, eq=False)
class SmoothKernel:
    """Even, smooth, 2 pi-periodic addition S(x) to the kernel log|2 sin(x/2)|, and dS/dx."""

    value: Callable[[FloatArray], FloatArray]
    derivative: Callable[[FloatArray], FloatArray]

    def matrices(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return S(x_k - x_j) and dS/dx(x_k - x_j), (n, n) each."""
        difference = np.subtract.outer(x, x)
        return self.value(difference), self.derivative(difference)


def evaluate_dense(*given: Any, **named: Any) -> dense.DenseState:
    """Evaluate given patches by dense algebra; arguments as of validation/references/dense.py."""
    state = dense.evaluate_dense(*given, **named)
    pressure = state.pressure
    return replace(state, pressure=PatchPressure(pressure.left, pressure.right, pressure.charges))
