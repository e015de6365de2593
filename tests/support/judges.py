"""References of the comparison that judge the tests of bem: closed forms of a wave, and states by dense algebra."""

from dataclasses import replace
from typing import Any

from bem.geometry.patches import PatchPressure
from validation.references import dense
from validation.references.closed_forms import Sinusoid
from validation.references.dense import SmoothKernel, dense_nodes

__all__ = ["Sinusoid", "SmoothKernel", "dense_nodes", "evaluate_dense"]


def evaluate_dense(*given: Any, **named: Any) -> dense.DenseState:
    """Evaluate given patches by dense algebra; arguments as of validation/references/dense.py."""
    state = dense.evaluate_dense(*given, **named)
    pressure = state.pressure
    return replace(state, pressure=PatchPressure(pressure.left, pressure.right, pressure.charges))
