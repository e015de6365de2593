"""States of given patches by the dense reference, whose pressure is a record of bem, for the tests of bem."""

from dataclasses import replace
from typing import Any

from bem.geometry.patches import PatchPressure
from validation.references import dense
from validation.references.dense import SmoothKernel, dense_nodes

__all__ = ["SmoothKernel", "dense_nodes", "evaluate_dense"]


def evaluate_dense(*given: Any, **named: Any) -> dense.DenseState:
    """Evaluate given patches by dense algebra; arguments as of validation/references/dense.py."""
    state = dense.evaluate_dense(*given, **named)
    pressure = state.pressure
    return replace(state, pressure=PatchPressure(pressure.left, pressure.right, pressure.charges))
