"""The dense reference's state of given patches, its pressure in the record of bem that other modules take."""

from dataclasses import replace
from typing import Any

from bem.geometry.patches import PatchPressure
from validation.references import dense


def evaluate_dense(*given: Any, **named: Any) -> dense.DenseState:
    """Evaluate given patches by dense algebra; arguments as of validation/references/dense.py."""
    state = dense.evaluate_dense(*given, **named)
    pressure = state.pressure
    return replace(state, pressure=PatchPressure(pressure.left, pressure.right, pressure.charges))
