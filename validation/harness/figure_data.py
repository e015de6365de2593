"""Figures of cases from labels and numbers, with what most of them share."""

from __future__ import annotations

from collections.abc import Iterable

from validation.harness.schema import Figure, Panel, Series

Values = Iterable[float | None]


def trace(label: str, x: Values, y: Values, style: str = "line", hue: int | None = None) -> Series:
    """A curve through lists, arrays or generators of n numbers, None left out; style and hue as of `Series`."""
    numbers = {"x": _numbers(x), "y": _numbers(y)}
    return Series.model_validate({"label": label, **numbers, "style": style, "hue": hue})


def marks(label: str, x: Values, y: Values, hue: int | None = None) -> Series:
    """As `trace`, as points."""
    return trace(label, x, y, "points", hue)


def shaded(label: str, x: Values, lower: Values, upper: Values, hue: int | None = None) -> Series:
    """The band between two curves; arguments as of `trace`."""
    return Series(label=label, x=_numbers(x), y=_numbers(lower), upper=_numbers(upper), style="band", hue=hue)


def bars(label: str, x: Values, lower: Values, upper: Values, hue: int | None = None) -> Series:
    """As `shaded`, each pair joined by a vertical bar with caps: error bars."""
    return Series(label=label, x=_numbers(x), y=_numbers(lower), upper=_numbers(upper), style="bars", hue=hue)


def axes(xlabel: str, ylabel: str, *series: Series) -> Panel:
    """Axes with linear scales and at least one curve."""
    return Panel(xlabel=xlabel, ylabel=ylabel, series=list(series))


def semilogx(xlabel: str, ylabel: str, *series: Series) -> Panel:
    """As `axes`, x on a logarithmic scale."""
    return Panel(xlabel=xlabel, ylabel=ylabel, xscale="log", series=list(series))


def semilogy(xlabel: str, ylabel: str, *series: Series) -> Panel:
    """As `axes`, y on a logarithmic scale."""
    return Panel(xlabel=xlabel, ylabel=ylabel, yscale="log", series=list(series))


def loglog(xlabel: str, ylabel: str, *series: Series) -> Panel:
    """As `axes`, both on logarithmic scales."""
    return Panel(xlabel=xlabel, ylabel=ylabel, xscale="log", yscale="log", series=list(series))


def drawn(name: str, caption: str, solution: Panel, error: Panel | None = None) -> Figure:
    """A figure, its name unique in the report: a solution and, where there is one, its signed error below."""
    return Figure(id=name, caption=caption, solution=solution, error=error)


def _numbers(values: Values) -> list[float | None]:
    return [None if value is None else float(value) for value in values]
