"""Curves and shapes of a result by matplotlib, which is imported when something is drawn.

Limits: states in the order of the path, the two branches apart; error bars are the estimated errors.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from matplotlib import rc_context, rcParamsDefault
from matplotlib.figure import Figure
from numpy.typing import NDArray

CURVES = {  # quantities against which the mean pressure is drawn: label and factor of the axis
    "contact_fraction": ("contact fraction", 1.0),
    "separation": ("separation / µm", 1e6),
}
BRANCHES = {"loading": "o-", "unloading": "s--"}


@contextmanager
def own_settings(**settings: Any) -> Iterator[None]:
    """Set Matplotlib's defaults and some settings, whatever a matplotlibrc or MPLBACKEND of the user says."""
    chosen: dict[Any, Any] = {name: v for name, v in rcParamsDefault.items() if not name.startswith("backend")}
    chosen.update(settings)
    with rc_context(chosen):
        yield


class ShownFigure(Figure):
    """Figure that a notebook shows as a picture, with or without pyplot, and that is written with own settings."""

    def savefig(self, *target: Any, **options: Any) -> None:
        """Write the figure; arguments as of Matplotlib's."""
        with own_settings():
            super().savefig(*target, **options)

    def _repr_png_(self) -> bytes:
        """Return the picture for a notebook."""
        drawn = io.BytesIO()
        self.savefig(drawn, format="png")
        return drawn.getvalue()


@own_settings()
def curves(states: Sequence[Any], quantities: Sequence[str] = tuple(CURVES)) -> Figure:
    """Draw the mean pressure against each of some quantities of `CURVES`."""
    figure = ShownFigure(figsize=(6.4 * len(quantities), 4.8), layout="constrained")
    for place, quantity in enumerate(quantities, 1):
        label, factor = CURVES[quantity]
        axes = figure.add_subplot(1, len(quantities), place, xlabel=label, ylabel="mean pressure / Pa")
        for branch, marker in BRANCHES.items():
            chosen = [state for state in states if state.branch == branch]
            x = [factor * getattr(state, quantity) for state in chosen]
            y = [state.mean_pressure for state in chosen]
            error = [_finite(state.error_estimate.mean_pressure) for state in chosen]
            axes.errorbar(x, y, error, fmt=marker, markersize=3, label=branch)
        axes.legend()
    return figure


@own_settings()
def shape(fields: dict[str, NDArray[Any]], name: str) -> Figure:
    """Draw the displaced surface and the rigid profile of a stored shape, by its number in the names of the fields."""
    x, displacement, gap = (1e6 * fields[f"{quantity}_{name}"] for quantity in ("x", "displacement", "gap"))
    figure = ShownFigure(layout="constrained")
    axes = figure.add_subplot(xlabel="x / µm", ylabel="height / µm")
    axes.plot(x, displacement - gap, color="0.5", label="rigid profile")
    axes.plot(x, displacement, label="deformed surface")
    axes.legend()
    return figure


def _finite(error: float | None) -> float:
    """Return an estimated error, zero where it is unknown or infinite."""
    return 0.0 if error is None or not math.isfinite(error) else error
