"""Figures of cases from labels and numbers, with what most of them share."""

from collections.abc import Iterable
from functools import partial
from typing import Any

from validation.harness.schema import Figure, Panel, Series

Values = Iterable[float | None]


def trace(label: str, x: Values, y: Values, style: str = "line", hue: int | None = None) -> Series:
    """Return a curve through lists, arrays or generators of n numbers, None not drawn; style and hue as of `Series`."""
    numbers = {"x": _numbers(x), "y": _numbers(y)}
    return Series.model_validate({"label": label, **numbers, "style": style, "hue": hue})


def marks(label: str, x: Values, y: Values, hue: int | None = None) -> Series:
    """Return a series of points; arguments as of `trace`."""
    return trace(label, x, y, "points", hue)


def shaded(label: str, x: Values, lower: Values, upper: Values, hue: int | None = None) -> Series:
    """Return the band between two curves; arguments as of `trace`."""
    return Series(label=label, x=_numbers(x), y=_numbers(lower), upper=_numbers(upper), style="band", hue=hue)


def bars(label: str, x: Values, lower: Values, upper: Values, hue: int | None = None) -> Series:
    """Return error bars: vertical bars with caps from `lower` to `upper`; arguments as of `shaded`."""
    return shaded(label, x, lower, upper, hue).model_copy(update={"style": "bars"})


def axes(xlabel: str, ylabel: str, *series: Series, **scales: Any) -> Panel:
    """Return axes with at least one curve; `scales` are xscale and yscale of `Panel`, by default linear."""
    return Panel(xlabel=xlabel, ylabel=ylabel, series=list(series), **scales)


semilogx = partial(axes, xscale="log")
semilogy = partial(axes, yscale="log")
loglog = partial(axes, xscale="log", yscale="log")


def drawn(name: str, caption: str, solution: Panel) -> Figure:
    """Return a figure with a name unique in the report."""
    return Figure(id=name, caption=caption, solution=solution)


def _numbers(values: Values) -> list[float | None]:
    return [None if value is None else float(value) for value in values]
